// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job in shards, merged, is the job: the same files bit for bit, the manifest included, in any number and order, with
// a loop and without; and what is missing, broken or of another job is refused in one sentence.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <random>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/places.h"

using namespace voxtone::test;

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

const std::string spot = source_dir() + "/examples/models/spot/spot.obj";
// As small as has slabs of layers enough to be shared out: nine of 13.
const std::string reported_job = fmt::format("slice --quiet --iterations 0 --predict none --size 3mm {}", spot);
const std::string plain_job = reported_job + " --no-report";

/// All files of a stack that say the same however it was made: what tells of times does not.
std::map<std::string, std::string> stack_in(const Folder& folder, const std::string& out) {
    std::map<std::string, std::string> files;
    for (auto& [name, bytes] : read_tree(folder / out))
        if (!name.starts_with("shards") && name != "report.html" && name != "report.json" && name != "skin.mixtures")
            files.emplace(name, std::move(bytes));
    return files;
}

Outcome shard(const std::string& job, const Folder& folder, const std::string& out, int i, int n) {
    return run_program(fmt::format("{} -o {} --shard {}/{}", job, folder / out, i, n));
}

void make_shards(const std::string& job, const Folder& folder, const std::string& out, int n) {
    for (int i = n; i >= 1; --i) REQUIRE(shard(job, folder, out, i, n).exit_code == 0);
}

Outcome merge(const Folder& folder, const std::string& out, const std::string& options = "") {
    return run_program(fmt::format("merge --quiet {} {}", options, folder / out));
}

std::string record(const Folder& folder, const std::string& out, const std::string& name) {
    return folder / (out + "/shards/" + name + ".json");
}

bool is_one_sentence(const Outcome& outcome) {
    return std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1 && outcome.err.starts_with("voxtone: ");
}

/// What the report's viewer cuts.
std::string voxels_of_page(const Folder& folder, const std::string& out) {
    const std::string page = read_file(folder / (out + "/report.html"));
    const std::size_t from = page.find("id=\"voxel-data\"");
    REQUIRE(from != page.npos);
    return page.substr(from, page.find("</script>", from) - from);
}

}  // namespace

TEST_CASE("A job in shards, merged, is the job, bit for bit, and done") {
    const Folder folder("shards");
    REQUIRE(run_program(fmt::format("{} -o {}", reported_job, folder / "whole")).exit_code == 0);
    const auto whole = stack_in(folder, "whole");
    REQUIRE(whole.size() > 110);
    REQUIRE(whole.contains("manifest.json"));
    const int all_layers = nlohmann::json::parse(whole.at("manifest.json")).at("layers").get<int>();
    for (const int n : {3, 10}) {  // of ten some have no slab
        INFO(n << " shards");
        const std::string out = fmt::format("parts{}", n);
        make_shards(reported_job, folder, out, n);
        int layers = 0, most = 0, empty = 0;
        CHECK_FALSE(fs::exists(folder / (out + "/manifest.json")));
        for (int i = 1; i <= n; ++i) {
            const std::string text = read_file(record(folder, out, fmt::format("{:04}-of-{:04}", i, n)));
            CHECK(voxtone::io::schema_faults("shard", text).empty());
            const int of_shard = nlohmann::json::parse(text).at("layers").get<int>();
            layers += of_shard;
            most = std::max(most, of_shard);
            empty += of_shard == 0;
        }
        CHECK(layers == all_layers);
        CHECK((empty > 0) == (n == 10));
        if (n > 1) CHECK(4 * most < 3 * all_layers);  // none has most of it
        REQUIRE(merge(folder, out).exit_code == 0);
        CHECK(stack_in(folder, out) == whole);
        CHECK(voxels_of_page(folder, out) == voxels_of_page(folder, "whole"));
        CHECK(run_program(fmt::format("verify --quiet {}", folder / out)).exit_code == 0);
    }
    // Merging again does nothing, and what is merged is done.
    const auto before = read_tree(folder / "parts3");
    const std::string told = "slice" + reported_job.substr(std::string("slice --quiet").size());
    CHECK_THAT(run_program("merge " + folder / "parts3").out, Contains("nothing was done"));
    CHECK_THAT(shard(told, folder, "parts3", 1, 3).out, Contains("nothing was done"));
    CHECK_THAT(run_program(fmt::format("{} -o {}", told, folder / "parts3")).out, Contains("nothing was done"));
    const Outcome again = merge(folder, "parts3");
    CHECK((again.exit_code == 0 && again.out.empty()));
    CHECK(read_tree(folder / "parts3") == before);
}

TEST_CASE("Pictures, resin bitmaps, error diffusion and a range of layers go in shards too") {
    const Folder folder("shards-kinds");
    const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png";
    const std::string kinds[] = {
        fmt::format("slice --quiet --iterations 0 --predict none --width 4mm --thickness 1.5mm {}", picture),
        fmt::format("slice --quiet --iterations 0 --no-report --printer stratasys-j55 --formats png1 --screen "
                    "error-diffusion --size 2mm {}",
                    spot),
        fmt::format(
            "slice --quiet --iterations 0 --no-report --formats tiff --flip-x --swap-xy --layers 17-9999 --size "
            "3mm {}",
            spot)};
    for (std::size_t k = 0; k < std::size(kinds); ++k) {
        INFO(kinds[k]);
        const std::string whole = fmt::format("whole{}", k), parts = fmt::format("parts{}", k);
        REQUIRE(run_program(fmt::format("{} -o {}", kinds[k], folder / whole)).exit_code == 0);
        make_shards(kinds[k], folder, parts, 2);
        REQUIRE(merge(folder, parts).exit_code == 0);
        CHECK(stack_in(folder, whole).size() > 30);
        CHECK(stack_in(folder, parts) == stack_in(folder, whole));
    }
}

TEST_CASE("The loop is run once, and shards that read what it came to make the job that has it") {
    const Folder folder("shards-loop");
    const std::string job = fmt::format("slice --quiet --iterations 1 --size 2.5mm {}", spot);
    REQUIRE(run_program(fmt::format("{} -o {}", job, folder / "whole")).exit_code == 0);

    const Outcome early = shard(job, folder, "parts", 1, 2);
    CHECK(early.exit_code == 3);
    CHECK_THAT(early.err, Contains("skin.mixtures") && Contains("--until loop"));
    // One sentence, after a warning of walls of 0.4 mm.
    CHECK(early.err.find("voxtone: ") != std::string::npos);
    CHECK(early.err.find("voxtone: ") == early.err.rfind("voxtone: "));
    CHECK_FALSE(fs::exists(folder / "parts"));

    REQUIRE(run_program(fmt::format("{} -o {} --until loop", job, folder / "parts")).exit_code == 0);
    CHECK_FALSE(fs::exists(folder / "parts/manifest.json"));
    make_shards(job, folder, "parts", 2);
    REQUIRE(merge(folder, "parts", "--predict").exit_code == 0);
    CHECK(stack_in(folder, "parts") == stack_in(folder, "whole"));  // with predicted.glb

    // A whole job reads it too, from wherever it lies.
    REQUIRE(run_program(fmt::format("{} -o {} --mixtures {}", job, folder / "again", folder / "parts/skin.mixtures"))
                .exit_code == 0);
    CHECK(stack_in(folder, "again") == stack_in(folder, "whole"));

    const std::string other = fmt::format("slice --quiet --iterations 1 --size 3mm {} -o {} --mixtures {}", spot,
                                          folder / "other", folder / "parts/skin.mixtures");
    const Outcome refused = run_program(other);
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("of another job"));
    CHECK(is_one_sentence(refused));
    std::string skin = read_file(folder / "parts/skin.mixtures");
    skin[skin.size() / 2] = char(skin[skin.size() / 2] ^ 1);
    folder.write("broken.mixtures", skin);
    const Outcome broken =
        run_program(fmt::format("{} -o {} --mixtures {}", job, folder / "other", folder / "broken.mixtures"));
    CHECK(broken.exit_code == 4);
    CHECK_THAT(broken.err, Contains("is broken"));
}

TEST_CASE("A scheduler's tasks are shards, and those of a second array are too") {
    const Folder folder("shards-slurm");
    const auto with = [&](int id, int first, int last, int count) {
        setenv("SLURM_ARRAY_TASK_ID", std::to_string(id).c_str(), 1);
        setenv("SLURM_ARRAY_TASK_MIN", std::to_string(first).c_str(), 1);
        setenv("SLURM_ARRAY_TASK_MAX", std::to_string(last).c_str(), 1);
        setenv("SLURM_ARRAY_TASK_COUNT", std::to_string(count).c_str(), 1);
        const Outcome outcome = run_program(fmt::format("{} -o {} --shard", plain_job, folder / "parts"));
        for (const char* name : {"ID", "MIN", "MAX", "COUNT"})
            unsetenv(fmt::format("SLURM_ARRAY_TASK_{}", name).c_str());
        return outcome;
    };
    const Outcome none = run_program(fmt::format("{} -o {} --shard", plain_job, folder / "parts"));
    CHECK(none.exit_code == 2);
    CHECK_THAT(none.err, Contains("SLURM_ARRAY_TASK_ID") && Contains("--shard 3/16"));
    CHECK(with(9, 3, 9, 4).exit_code == 2);  // --array=3,7-9 of nothing that is there
    REQUIRE(with(1, 0, 4, 5).exit_code == 0);
    CHECK(fs::exists(record(folder, "parts", "0002-of-0005")));
    REQUIRE(with(3, 0, 4, 5).exit_code == 0);
    const Outcome missing = merge(folder, "parts");
    CHECK(missing.exit_code == 3);
    CHECK_THAT(missing.err, Contains("3 shards of 5 missing") && Contains("--array=0,2,4"));
    for (const int id : {0, 2, 4}) REQUIRE(with(id, 0, 4, 3).exit_code == 0);
    CHECK(fs::exists(record(folder, "parts", "0005-of-0005")));
    CHECK(merge(folder, "parts").exit_code == 0);
}

TEST_CASE("A shard that is made twice at once, killed, or made again does no harm") {
    const Folder folder("shards-twice");
    REQUIRE(run_program(fmt::format("{} -o {}", plain_job, folder / "whole")).exit_code == 0);
    REQUIRE(shard(plain_job, folder, "parts", 1, 2).exit_code == 0);
    std::vector<std::thread> twins;
    std::array<int, 3> codes{};
    for (int& code : codes) twins.emplace_back([&] { code = shard(plain_job, folder, "parts", 2, 2).exit_code; });
    for (std::thread& twin : twins) twin.join();
    CHECK(codes == std::array<int, 3>{});
    const std::string told = "slice" + plain_job.substr(std::string("slice --quiet").size());
    const Outcome again = shard(told, folder, "parts", 2, 2);
    CHECK(again.exit_code == 0);
    CHECK_THAT(again.out, Contains("made already"));

    const std::string first = record(folder, "parts", "0001-of-0002");
    // A kill may come after the end; of some one comes before.
    bool was_killed = false;
    for (int trial = 0; trial < 10 && !was_killed; ++trial) {
        fs::remove(first);
        const Outcome killed = run_and_signal(fmt::format("{} -o {} --shard 1/2 --json", told, folder / "parts"),
                                              "\"stage\":\"layers\"", SIGKILL);
        was_killed = killed.exit_code == 128 + SIGKILL;
    }
    REQUIRE(was_killed);
    CHECK_FALSE(fs::exists(first));
    CHECK(merge(folder, "parts").exit_code == 3);
    REQUIRE(shard(plain_job, folder, "parts", 1, 2).exit_code == 0);
    REQUIRE(merge(folder, "parts").exit_code == 0);
    CHECK(stack_in(folder, "parts") == stack_in(folder, "whole"));
    for (const auto& [name, bytes] : read_tree(folder / "parts")) CHECK_THAT(name, !Contains(".part"));
}

TEST_CASE("Shards and merges that are killed at any moment cost nothing but time") {
    const Folder folder("shards-killed");
    const std::string job = fmt::format("slice --quiet --iterations 1 --predict none --size 2.5mm {}", spot);
    const auto began = std::chrono::steady_clock::now();
    REQUIRE(run_program(fmt::format("{} -o {}", job, folder / "whole")).exit_code == 0);
    const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - began;
    constexpr int shards = 3, rounds = 15;
    const std::string steps[] = {fmt::format("{} -o {} --until loop", job, folder / "parts"),
                                 fmt::format("{} -o {} --shard 1/3", job, folder / "parts"),
                                 fmt::format("{} -o {} --shard 2/3", job, folder / "parts"),
                                 fmt::format("{} -o {} --shard 3/3", job, folder / "parts"),
                                 fmt::format("merge --quiet {}", folder / "parts")};
    std::mt19937 random(17);
    // Later moments of a step matter as much as early ones, however long it is here.
    std::uniform_real_distribution<double> moment(0.02, 0.9 * whole.count());
    int killed = 0;
    for (int round = 0; round < rounds; ++round) {
        const std::string& step = steps[std::size_t(round) % std::size(steps)];
        const int code = run_shell(fmt::format("timeout -s KILL {:.3f} {} {} >/dev/null 2>'{}'", moment(random),
                                               program(), step, folder / "err"));
        INFO(step << ": " << code << ", " << read_file(folder / "err"));
        killed += code == 128 + SIGKILL || code == -1;
        // What is not killed is done, or says what is missing still.
        CHECK((code == 0 || code == 3 || code == 4 || code == 75 || code == 128 + SIGKILL || code == -1));
    }
    CHECK(killed > 0);
    // A loop that was killed in its midst goes on when it is told to.
    if (run_program(steps[0]).exit_code != 0) REQUIRE(run_program(steps[0]).exit_code == 0);
    for (int i = 1; i <= shards; ++i) REQUIRE(run_program(steps[i]).exit_code == 0);
    REQUIRE(run_program(steps[4]).exit_code == 0);
    CHECK(stack_in(folder, "parts") == stack_in(folder, "whole"));
    CHECK(run_program(fmt::format("verify --quiet {}", folder / "parts")).exit_code == 0);
    for (const auto& [name, bytes] : read_tree(folder / "parts")) CHECK_THAT(name, !Contains(".part"));
}

TEST_CASE("Shards that take a folder over at once leave each other's work alone") {
    const Folder folder("shards-at-once");
    make_shards(plain_job, folder, "parts", 4);
    const std::string other = plain_job + " --depth 0.5mm";
    std::vector<std::thread> at_once;
    std::array<int, 4> codes{};
    for (int i = 1; i <= 4; ++i)
        at_once.emplace_back(
            [&, i] { codes[std::size_t(i - 1)] = shard(other + " --overwrite", folder, "parts", i, 4).exit_code; });
    for (std::thread& one : at_once) one.join();
    CHECK(codes == std::array<int, 4>{});
    CHECK(merge(folder, "parts").exit_code == 0);
    REQUIRE(run_program(fmt::format("{} -o {}", other, folder / "whole")).exit_code == 0);
    CHECK(stack_in(folder, "parts") == stack_in(folder, "whole"));
}

TEST_CASE("Broken shards and those of another job are refused, and nothing is lost") {
    const Folder folder("shards-bad");
    make_shards(plain_job, folder, "parts", 3);
    const std::string second = record(folder, "parts", "0002-of-0003"), good = read_file(second);
    const auto refused = [&](const char* words) {
        const Outcome outcome = merge(folder, "parts");
        CHECK(outcome.exit_code == 3);
        CHECK_THAT(outcome.err, Contains(words));
        CHECK(is_one_sentence(outcome));
        CHECK_FALSE(fs::exists(folder / "parts/manifest.json"));
    };
    std::string changed = good;
    changed.insert(changed.find("\"body_voxels\": ") + 15, "1");
    folder.write("parts/shards/0002-of-0003.json", changed);
    refused("was changed since");
    folder.write("parts/shards/0002-of-0003.json", good.substr(0, good.size() / 2));
    refused("0002-of-0003.json");
    fs::remove(second);
    refused("--array=2 ");
    folder.write("parts/shards/0002-of-0003.json", good);

    const fs::path layers = [&] {
        for (const auto& entry : fs::directory_iterator(folder / "parts/shards"))
            if (entry.is_directory()) return entry.path() / "layers";
        return fs::path();
    }();
    const fs::path layer = layers / "slice_00100.png";
    const std::string bytes = read_file(layer);
    fs::resize_file(layer, bytes.size() - 1);
    refused("slice_00100.png");
    fs::remove(layer);
    refused("slice_00100.png");
    // Its shard says so too, and mends it, also where what the first one prepared is broken.
    const std::string prepared = fs::path(layers).parent_path().string() + ".prepared";
    REQUIRE(fs::exists(prepared));
    fs::resize_file(prepared, fs::file_size(prepared) - 9);
    for (int i = 1; i <= 3; ++i) REQUIRE(shard(plain_job, folder, "parts", i, 3).exit_code == 0);
    CHECK(read_file(layer) == bytes);

    // Of another job: neither a shard nor a whole job takes the folder, of a body or of a tray.
    const std::string other = plain_job + " --depth 0.5mm", tray = other + " --copies 2";
    for (const std::string& asked : {other + " --shard 1/3", other, tray + " --shard 1/3", tray}) {
        const Outcome outcome = run_program(fmt::format("{} -o {}", asked, folder / "parts"));
        CHECK(outcome.exit_code == 3);
        CHECK_THAT(outcome.err, Contains("shards of another job"));
        CHECK(is_one_sentence(outcome));
    }
    make_shards(other, folder, "foreign", 3);
    fs::copy_file(record(folder, "foreign", "0002-of-0003"), second, fs::copy_options::overwrite_existing);
    refused("of different jobs");
    folder.write("parts/shards/0002-of-0003.json", good);
    REQUIRE(merge(folder, "parts").exit_code == 0);

    const Outcome vdb = run_program(fmt::format("{} --formats vdb -o {} --shard 1/2", plain_job, folder / "vdb"));
    CHECK(vdb.exit_code == 2);
    CHECK_THAT(vdb.err, Contains("volume.vdb"));
    for (const char* bad : {"0/4", "5/4", "4", "a/b", "1/2/3"})
        CHECK(run_program(fmt::format("{} -o {} --shard {}", plain_job, folder / "x", bad)).exit_code == 2);
    CHECK(merge(folder, "nowhere").exit_code == 4);
    fs::create_directory(folder / "nothing");
    CHECK(merge(folder, "nothing").exit_code == 3);
}

TEST_CASE("An old stack stays until the shards that replace it are merged") {
    const Folder folder("shards-old");
    REQUIRE(run_program(fmt::format("{} -o {}", plain_job, folder / "out")).exit_code == 0);
    const auto old = read_tree(folder / "out");
    const std::string other = plain_job + " --depth 0.5mm";
    CHECK(shard(other, folder, "out", 1, 2).exit_code == 3);
    CHECK(read_tree(folder / "out") == old);
    for (int i = 1; i <= 2; ++i) REQUIRE(shard(other + " --overwrite", folder, "out", i, 2).exit_code == 0);
    CHECK(run_program(fmt::format("verify --quiet {}", folder / "out")).exit_code == 0);
    CHECK(merge(folder, "out").exit_code == 3);
    REQUIRE(merge(folder, "out", "--overwrite").exit_code == 0);
    REQUIRE(run_program(fmt::format("{} -o {}", other, folder / "whole")).exit_code == 0);
    CHECK(stack_in(folder, "out") == stack_in(folder, "whole"));
}
