// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/task_chain.h"

#include <algorithm>
#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Words = std::vector<std::string>;

namespace {

constexpr std::uint64_t mb = 1'000'000;

struct Shop {
    explicit Shop(const std::string& keys = "") {
        std::ofstream(folder.path() / "a.obj") << "";
        std::ofstream(folder.path() / "plan.jsonl") << "{\"model\": \"a.obj\"" << keys << "}\n";
        job = read_plan({{(folder.path() / "plan.jsonl").string()}, {}, "{name}", folder.path() / "out"}).front();
    }
    [[nodiscard]] TaskChain chain(const JobEstimate& estimate, const ChainOptions& options = {}) const {
        return task_chain(job, estimate, options);
    }
    io::TemporaryFolder folder;
    PlannedJob job;
};

JobEstimate estimate_with(double loop_s, double layers_s, double predict_s = 0) {
    JobEstimate estimate;
    estimate.layers = 4000;
    estimate.phases = {{Phase::read, 10, 8, 300 * mb, true}, {Phase::separate, 1, 1, 310 * mb, false}};
    if (loop_s > 0) {
        estimate.loop = true;
        estimate.phases.push_back({Phase::prepare_loop, 5, 5, 400 * mb, false});
        estimate.phases.push_back({Phase::loop, loop_s, loop_s, 2000 * mb, false});
    }
    estimate.phases.push_back({Phase::layers, layers_s, layers_s, 800 * mb, false});
    if (predict_s > 0) {
        estimate.prediction = true;
        estimate.phases.push_back({Phase::predict, predict_s, predict_s, 3000 * mb, false});
    }
    estimate.phases.push_back({Phase::report, 2, 2, 500 * mb, false});
    return estimate;
}

bool has(const Words& arguments, const Words& in_a_row) {
    return std::search(arguments.begin(), arguments.end(), in_a_row.begin(), in_a_row.end()) != arguments.end();
}

/// An eighth more than the largest phase, beside 64 MB for what starts it.
std::uint64_t with_margin(std::uint64_t bytes) { return bytes + bytes / 8 + 64 * mb; }

}  // namespace

TEST_CASE("A job whose layers take minutes is one task") {
    const Shop shop;
    const TaskChain chain = shop.chain(estimate_with(600, 100, 50));
    REQUIRE(chain.stages.size() == 1);
    const ChainStage& whole = chain.stages[0];
    CHECK(whole.stage == TaskStage::whole);
    CHECK(whole.tasks == 1);
    CHECK(whole.arguments[0] == "slice");
    CHECK(has(whole.arguments, {"--out", (shop.folder.path() / "out/a").string()}));
    CHECK_FALSE(has(whole.arguments, {"--until"}));
    CHECK(arguments_of(whole, 1) == whole.arguments);
    CHECK(whole.memory_bytes >= with_margin(3000 * mb));
    CHECK(whole.memory_bytes < 4000 * mb);
    CHECK(whole.cores == 8);  // 768 s of processors
    CHECK(whole.expected_s > 768.0 / 8);
    CHECK(whole.limit_s == Approx(600 + 3 * whole.expected_s));
}

TEST_CASE("Layers that take hours are cut, and each shard takes minutes") {
    const Shop shop;
    const TaskChain chain = shop.chain(estimate_with(600, 100'000, 50));
    REQUIRE(chain.stages.size() == 3);
    const ChainStage &prepare = chain.stages[0], &layers = chain.stages[1], &merge = chain.stages[2];
    CHECK(prepare.stage == TaskStage::prepare);
    CHECK(has(prepare.arguments, {"--until", "loop"}));
    CHECK(prepare.memory_bytes >= with_margin(2000 * mb));
    CHECK(layers.stage == TaskStage::layers);
    CHECK(layers.tasks == chain.shards);
    CHECK(chain.shards == 29);  // 100000 s on eight cores of which one does 5 % alone: 16875 s, in parts of 600 s
    CHECK(layers.expected_s < 600 + 10 + 1);
    CHECK(layers.memory_bytes >= with_margin(800 * mb));
    CHECK(layers.memory_bytes < 1100 * mb);  // without the loop's and the prediction's
    CHECK_FALSE(has(layers.arguments, {"--until"}));
    CHECK(has(arguments_of(layers, 3), {"--shard", "3/29"}));
    CHECK(merge.arguments == Words{"merge", (shop.folder.path() / "out/a").string(), "--shards", "29", "--predict"});
    CHECK(merge.memory_bytes >= with_margin(3000 * mb));
    CHECK(merge.expected_s > 100'000.0 / 8);  // a prediction needs all layers in memory

    const TaskChain unpredicted = shop.chain(estimate_with(600, 100'000));
    CHECK_FALSE(has(unpredicted.stages[2].arguments, {"--predict"}));
    CHECK(unpredicted.stages[2].memory_bytes < 700 * mb);
    CHECK(unpredicted.stages[2].expected_s < 60);
}

TEST_CASE("All tasks of a job are told the memory that loop and reading may take here") {
    const Shop shop;
    const TaskChain chain = shop.chain(estimate_with(600, 100'000));
    const auto memory_in = [](const Words& arguments) {
        const auto found = std::find(arguments.begin(), arguments.end(), "--memory");
        return found == arguments.end() ? std::string() : *(found + 1);
    };
    CHECK(std::stod(memory_in(chain.stages[0].arguments)) > 0);
    CHECK(has(chain.stages[0].arguments, {"--read-memory"}));
    CHECK(has(chain.stages[1].arguments, {"--read-memory"}));
    CHECK(memory_in(chain.stages[0].arguments) == memory_in(chain.stages[1].arguments));
    const Shop other(", \"memory\": 3");
    CHECK(memory_in(other.chain(estimate_with(600, 10)).stages[0].arguments) == "3");
    const Shop none(", \"iterations\": 0, \"predict\": \"none\"");
    CHECK(memory_in(none.chain(estimate_with(0, 10)).stages[0].arguments).empty());  // there is no use for it
}

TEST_CASE("Whoever hands jobs over is told whose memory they go by") {
    std::vector<PlannedJob> jobs(3);
    for (PlannedJob& job : jobs) {
        job.options.model = "a.obj";
        job.options.out = "out";
    }
    CHECK_THAT(note_of_memory(jobs), Contains("of 3 jobs may take") && Contains("on this machine"));
    jobs[0].options.memory_gib = 3;
    jobs[1].options.iterations = "0";
    jobs[1].options.predict = "none";
    CHECK_THAT(note_of_memory(jobs), Contains("of 1 job may take"));
    CHECK(note_of_memory({jobs.data(), 2}).empty());
}

TEST_CASE("Without a loop, or with one that was run before, shards come first") {
    for (const char* keys : {", \"iterations\": 0", ", \"mixtures\": \"kept.mixtures\""}) {
        const Shop shop(keys);
        ChainOptions options;
        options.shards = 2;
        const TaskChain chain = shop.chain(estimate_with(0, 10), options);
        INFO(keys);
        REQUIRE(chain.stages.size() == 2);
        CHECK(chain.stages[0].stage == TaskStage::layers);
        CHECK(chain.stages[0].tasks == 2);
        CHECK(chain.stages[0].cores == 1);  // ten seconds
        CHECK(chain.stages[1].stage == TaskStage::merge);
    }
}

TEST_CASE("Shards are as many as were asked for, where there is a layer for each and the job can be cut") {
    const Shop shop;
    ChainOptions options;
    options.shards = 3;
    CHECK(shop.chain(estimate_with(0, 1), options).shards == 3);
    options.shards = 1;
    CHECK(shop.chain(estimate_with(0, 1e6), options).shards == 1);
    options.shards = 100;
    JobEstimate flat = estimate_with(0, 1);
    flat.layers = 7;
    CHECK(shop.chain(flat, options).shards == 7);
    options.shards = 0;
    options.most_shards = 5;
    CHECK(shop.chain(estimate_with(0, 1e7), options).shards == 5);

    const Shop container(", \"formats\": [\"gcvf\"]");
    const TaskChain asked = container.chain(estimate_with(0, 1e7), {.shards = 4});
    CHECK(asked.stages.size() == 1);
    CHECK(asked.why_whole == "stack.gcvf is one file of the whole stack");
    CHECK(container.chain(estimate_with(0, 1e7)).why_whole.empty());
}

TEST_CASE("A job that says its threads gets as many cores") {
    const Shop shop(", \"threads\": 3");
    const TaskChain chain = shop.chain(estimate_with(0, 10));
    CHECK(chain.stages[0].cores == 3);
    CHECK(Shop().chain(estimate_with(0, 1e5), {.most_cores = 4, .shards = 1}).stages[0].cores == 4);
    CHECK(Shop().chain(estimate_with(0, 1e5), {.most_cores = 3, .shards = 1}).stages[0].cores == 2);
}
