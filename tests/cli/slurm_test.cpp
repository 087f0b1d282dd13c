// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone batch --slurm` on a real Slurm: what comes out of a cluster is what a local batch makes, whatever ends on
// the way.
#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "one_node_slurm.h"
#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone::test;
namespace io = voxtone::io;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;

/// Models in a folder that shells and sbatch could stumble over.
struct Workshop {
    Workshop() : folder("batch on a cluster") {
        folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "iterations": 0, "predict": "none"})");
        folder.write("a box.obj", soft_box_obj(4, 3, 2));
    }
    void plan(const std::string& lines) const { folder.write("plan.jsonl", lines); }
    [[nodiscard]] std::string at(const std::string& name) const {
        std::string quoted = folder / name;
        for (std::size_t i = 0; (i = quoted.find('\'', i)) != std::string::npos; i += 4) quoted.replace(i, 1, "'\\''");
        return "'" + quoted + "'";
    }
    [[nodiscard]] Outcome batch(const std::string& out, const std::string& options = "") const {
        return run_program(
            fmt::format("batch {} --preset {} -o {} {}", at("plan.jsonl"), at("quick.json"), at(out), options));
    }
    [[nodiscard]] nlohmann::json state(const std::string& name) const {
        return nlohmann::json::parse(read_file(folder.path() / "cluster/batch" / (name + ".json")), nullptr, false);
    }
    /// What its tasks and Slurm said.
    [[nodiscard]] std::string said(const std::string& name) const {
        std::string all;
        for (const auto& entry : fs::directory_iterator(folder.path() / "cluster/batch/slurm" / name))
            all += "--- " + entry.path().filename().string() + "\n" + read_file(entry.path());
        return all;
    }
    /// Of a stack, all that does not tell of times. Shards of a tray know no verdicts of its parts.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> stack(const std::string& job) const {
        auto files = read_tree(folder.path() / job / "layers");
        std::string manifest = read_file(folder.path() / job / "manifest.json");
        if (auto of_tray = nlohmann::json::parse(manifest); of_tray.contains("members")) {
            for (nlohmann::json& member : of_tray["members"]) member.erase("verdict");
            of_tray.erase("manifest_sha256");
            manifest = of_tray.dump();
        }
        files.emplace_back("manifest.json", std::move(manifest));
        return files;
    }
    Folder folder;
};

const std::string spot = source_dir() + "/examples/models/spot/spot.obj";

std::string line(const std::string& name, const std::string& more = "", const std::string& model = "a box.obj") {
    return nlohmann::json({{"model", model}, {"name", name}}).dump().insert(1, more) + "\n";
}

bool lacks_slurm() {
    const std::string missing = OneNodeSlurm::what_is_missing();
    if (!missing.empty()) skip(missing);
    return !missing.empty();
}

}  // namespace

TEST_CASE("Five jobs in two shards each, with a node that dies, are what a local batch makes") {
    if (lacks_slurm()) return;
    const Workshop shop;
    const std::vector<std::string> names{"it's one", "two $HOME", "three", "four", "five"};
    std::string lines = line(names[0]) + line(names[1], "\"flip-x\": true, ") +
                        line(names[2], "\"rotate\": \"x90\", ") + line(names[3], "\"iterations\": 1, \"size\": 3, ") +
                        line(names[4], "\"screen\": \"error-diffusion\", \"size\": 4, ", spot);
    shop.plan(lines);
    REQUIRE(shop.batch("local").exit_code == 0);

    OneNodeSlurm slurm;
    const std::string options = "--slurm --shards 2 --threads 1";
    const Outcome submitted = shop.batch("cluster", options + " --json");
    INFO(submitted.err);
    REQUIRE(submitted.exit_code == 0);
    for (const std::string& name : names)
        CHECK(io::schema_faults("submission", read_file(shop.folder.path() / "cluster/batch/slurm" / name /
                                                        "submission.json")) == std::vector<std::string>{});
    // What waits or runs is not submitted again.
    const Outcome again = shop.batch("cluster", options);
    CHECK_THAT(again.out, Contains("5 jobs, 5 queued"));

    // The first shards work; in the midst of that the node dies, and comes up again.
    REQUIRE(OneNodeSlurm::wait_until([&] { return shop.state(names[0]).value("state", "") == "running"; }));
    slurm.crash_node();
    CHECK(shop.state(names[0]).value("state", "") == "running");  // nobody could say otherwise
    slurm.start_node();
    const bool all_ended = OneNodeSlurm::queue_empties();
    INFO(OneNodeSlurm::ask("squeue 2>&1"));
    if (!all_ended) FAIL(slurm.logs());
    CHECK_THAT(OneNodeSlurm::ask("scontrol show jobs"), Contains("Restarts=1"));

    for (const std::string& name : names) {
        INFO(name);
        INFO(shop.said(name));
        CHECK(shop.state(name).value("state", "") == "done");
        CHECK(io::schema_faults("batch-job", read_file(shop.folder.path() / "cluster/batch" / (name + ".json"))) ==
              std::vector<std::string>{});
        CHECK(shop.stack("cluster/" + name) == shop.stack("local/" + name));
        CHECK(shop.stack("local/" + name).size() > 30);
        CHECK(run_program("verify --quiet " + shop.at("cluster/" + name)).exit_code == 0);
    }
    CHECK_THAT(run_program("status " + shop.at("cluster")).out, Contains("5 jobs, 5 done"));
    CHECK(read_file(shop.folder.path() / "cluster/summary.csv").find("\"two $HOME\"") == std::string::npos);
    CHECK_THAT(read_file(shop.folder.path() / "cluster/summary.csv"), Contains("two $HOME,done"));
    CHECK_THAT(shop.batch("cluster").out, Contains("5 of 5 jobs done (5 before, and unchanged)"));
    CHECK_THAT(shop.batch("cluster", options).out, Contains("5 jobs, 5 unchanged"));
}

TEST_CASE("A job that fails in Slurm stands as failed, stops no other, and goes on when it is submitted again") {
    if (lacks_slurm()) return;
    const Workshop shop;
    shop.folder.write("mended.obj", soft_box_obj(3, 3, 2));
    const std::string bad = nlohmann::json({{"model", "mended.obj"}}).dump() + "\n";
    shop.plan(bad + line("whole") + line("sharded", "\"size\": 5, "));
    OneNodeSlurm slurm;
    // It is estimated, and then is no model any more.
    REQUIRE(run_shell("scontrol update partitionname=main state=down") == 0);
    const std::string options = "--slurm --shards 2 --threads 1 --throttle 2 --sbatch-option comment=x";
    const Outcome first = shop.batch("cluster", options);
    INFO(first.err);
    REQUIRE(first.exit_code == 0);
    shop.folder.write("mended.obj", "v 0 0 0\nf 1 2 3\n");
    REQUIRE(run_shell("scontrol update partitionname=main state=up") == 0);
    INFO(slurm.logs());
    REQUIRE(OneNodeSlurm::queue_empties());
    CHECK(shop.state("mended")["state"] == "failed");
    CHECK(shop.state("mended")["exit_code"] == 3);
    CHECK_THAT(shop.state("mended")["message"].get<std::string>(), Contains("mended.obj"));
    CHECK(shop.state("whole")["state"] == "done");
    CHECK(shop.state("sharded")["state"] == "done");
    const Outcome status = run_program("status " + shop.at("cluster"));
    CHECK_THAT(status.out, Contains("3 jobs, 2 done, 1 failed"));

    shop.folder.write("mended.obj", soft_box_obj(3, 3, 2));
    const Outcome second = shop.batch("cluster", options);
    CHECK_THAT(second.out, Contains("1 submitted, 2 unchanged"));
    REQUIRE(OneNodeSlurm::queue_empties());
    CHECK(shop.state("mended")["state"] == "done");
}

TEST_CASE("A loop that Slurm asks to stop saves itself, is put back into the queue and goes on") {
    if (lacks_slurm()) return;
    const Workshop shop;
    shop.plan(line("loop", "\"size\": 5, \"iterations\": 8, \"viewing-distance\": 200, "));
    OneNodeSlurm slurm;
    REQUIRE(shop.batch("cluster", "--slurm --threads 1").exit_code == 0);
    const fs::path checkpoint = shop.folder.path() / "cluster/loop/loop.checkpoint";
    REQUIRE(OneNodeSlurm::wait_until([&] { return fs::exists(checkpoint); }));
    REQUIRE(run_shell("scancel --batch --signal=TERM 1") == 0);
    INFO(slurm.logs());
    const std::string log = (shop.folder.path() / "cluster/batch/slurm/loop/whole-1.log").string();
    REQUIRE(OneNodeSlurm::wait_until([&] { return fs::exists(log); }));
    REQUIRE(OneNodeSlurm::queue_empties());
    INFO(read_file(log));
    CHECK(shop.state("loop")["state"] == "done");
    CHECK(shop.state("loop")["attempts"] == 2);
    CHECK_THAT(read_file(log), Contains("--resume"));
    REQUIRE(shop.batch("local").exit_code == 0);
    CHECK(shop.stack("cluster/loop") == shop.stack("local/loop"));
}

TEST_CASE("A job that is cancelled while it runs stays out of Slurm, and goes on when it is submitted again") {
    if (lacks_slurm()) return;
    const Workshop shop;
    shop.plan(line("loop", "\"size\": 5, \"iterations\": 8, \"viewing-distance\": 200, "));
    const OneNodeSlurm slurm;
    REQUIRE(shop.batch("cluster", "--slurm --threads 1").exit_code == 0);
    const fs::path checkpoint = shop.folder.path() / "cluster/loop/loop.checkpoint";
    REQUIRE(OneNodeSlurm::wait_until([&] { return fs::exists(checkpoint); }));
    REQUIRE(run_shell("scancel 1") == 0);
    if (!OneNodeSlurm::queue_empties()) FAIL(slurm.logs());
    CHECK(shop.state("loop")["state"] == "failed");
    CHECK_THAT(shop.state("loop")["message"].get<std::string>(), Contains("its tasks ended before it was done"));
    CHECK_THAT(OneNodeSlurm::ask("scontrol show job 1"), Contains("JobState=CANCELLED") && Contains("Restarts=0"));
    REQUIRE(shop.batch("cluster", "--slurm --threads 1").exit_code == 0);
    REQUIRE(OneNodeSlurm::queue_empties());
    INFO(shop.said("loop"));
    CHECK(shop.state("loop")["state"] == "done");
    CHECK_THAT(shop.said("loop"), Contains("--resume"));
}

TEST_CASE("The shards of a tray on a cluster merge to the bits of one go") {
    if (lacks_slurm()) return;
    const Workshop shop;
    shop.folder.write("b.obj", soft_box_obj(3, 2, 3));
    shop.folder.write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "a box.obj", "copies": 3}, {"model": "b.obj", "size": 2}]})");
    shop.plan(line("tray", "\"size\": 3, ", "tray.json"));
    shop.folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "iterations": 1, "predict": "none"})");
    REQUIRE(shop.batch("local").exit_code == 0);
    const OneNodeSlurm slurm;
    const Outcome submitted = shop.batch("cluster", "--slurm --shards 2 --threads 1");
    INFO(submitted.err);
    REQUIRE(submitted.exit_code == 0);
    if (!OneNodeSlurm::queue_empties()) FAIL(slurm.logs());
    INFO(shop.said("tray"));
    CHECK(shop.state("tray").value("state", "") == "done");
    CHECK(shop.stack("cluster/tray") == shop.stack("local/tray"));
    CHECK(shop.stack("local/tray").size() > 30);
}
