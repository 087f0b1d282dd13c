// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/slurm_script.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "farm/cluster/slurm_joins.h"
#include "farm/cluster/slurm_lanes.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

ChainStage layers(int tasks) {
    ChainStage stage;
    stage.stage = TaskStage::layers;
    stage.arguments = {"slice", "/m/it's \"one\".obj", "--size", "60mm"};
    stage.tasks = tasks;
    stage.cores = 4;
    stage.memory_bytes = 1'000'000'001;
    stage.limit_s = 601;
    return stage;
}

/// What a script hands to `voxtone`, word by word.
Words words_run(const std::string& script, const std::string& environment, const std::string& first_word) {
    const io::TemporaryFolder folder;
    const fs::path program = folder.path() / "voxtone", said = folder.path() / "said";
    std::ofstream(program) << "#!/bin/sh\nfor word in \"$@\"; do printf '%s\\n' \"$word\"; done >'" << said.string()
                           << "'\n";
    fs::permissions(program, fs::perms::owner_all);
    std::ofstream(folder.path() / "script.sh") << script;
    const std::string command =
        fmt::format("PATH='{0}':\"$PATH\" {1} sh '{0}/script.sh' {2}", folder.path().string(), environment, first_word);
    if (std::system(command.c_str()) != 0) return {"failed"};
    std::ifstream in(said);
    Words arguments;
    for (std::string line; std::getline(in, line);) arguments.push_back(line);
    return arguments;
}

}  // namespace

TEST_CASE("A script asks for what the stage is to be given, and says in words what it does") {
    const ScriptFrame frame{"/opt/vox tone/voxtone", "/out/mon day", 5};
    const std::string text = stage_script(frame, "it's\tone", layers(16));
    INFO(text);
    CHECK(text.starts_with("#!/bin/sh\n# Job it's?one of a batch: layers, 16 tasks."));
    CHECK_THAT(text, Contains("'/opt/vox tone/voxtone' slice '/m/it'\\''s \"one\".obj' --size 60mm --shard I/16\n"));
    for (const char* line :
         {"--job-name=it_s_one:layers", "--nodes=1", "--ntasks=1", "--cpus-per-task=4", "--mem=954M", "--time=11",
          "--signal=B:TERM@60", "--requeue", "--kill-on-invalid-dep=yes", "--open-mode=append"})
        CHECK_THAT(text, Contains(std::string("\n#SBATCH ") + line + "\n"));
    // No name can end a comment and begin a command.
    ChainStage broken = layers(1);
    broken.arguments = {"slice", "/m/a\nrm -rf /"};
    std::istringstream lines(stage_script(frame, "a\nb", broken));
    int commands = 0;
    for (std::string line; std::getline(lines, line);) commands += !line.starts_with('#') && line.starts_with("rm");
    CHECK(commands == 0);
    CHECK_THAT(last_script(frame), Contains("\nexec '/opt/vox tone/voxtone' task '/out/mon day' --last\n"));
}

TEST_CASE("A script hands on exactly its words, and the number of its task") {
    const std::string name = "it's a \"$HOME\" `job`";
    const ScriptFrame frame{"voxtone", "/out/it's $1", 3};
    const Words expected{"task", "/out/it's $1", "--job=" + name, "--stage", "layers", "--retries",
                         "3",    "--shard",      "7/16"};
    CHECK(words_run(stage_script(frame, name, layers(16)), "SLURM_ARRAY_TASK_ID=7", "") == expected);
    Words later = expected;
    later.back() = "15/16";
    CHECK(words_run(stage_script(frame, name, layers(16)), "SLURM_ARRAY_TASK_ID=5", "10") == later);
    later.back() = "11/16";  // where there are no arrays
    CHECK(words_run(stage_script(frame, name, layers(16)), "env -u SLURM_ARRAY_TASK_ID", "10") == later);
    ChainStage merge = layers(1);
    merge.stage = TaskStage::merge;
    CHECK(words_run(stage_script(frame, name, merge), "", "") ==
          Words{"task", "/out/it's $1", "--job=" + name, "--stage", "merge", "--retries", "3"});
    CHECK(words_run(last_script(frame), "", "") == Words{"task", "/out/it's $1", "--last"});
}

TEST_CASE("An array that Slurm would not take is cut") {
    CHECK(array_parts(16, 1001) == std::vector<ArrayPart>{{0, 16, true}});
    CHECK(array_parts(1, 1001) == std::vector<ArrayPart>{{0, 1, false}});
    CHECK(array_parts(1000, 1001) == std::vector<ArrayPart>{{0, 1000, true}});
    CHECK(array_parts(1001, 1001) == std::vector<ArrayPart>{{0, 1000, true}, {1000, 1, true}});
    CHECK(array_parts(25, 11) == std::vector<ArrayPart>{{0, 10, true}, {10, 10, true}, {20, 5, true}});
    CHECK(array_parts(2, 0) == std::vector<ArrayPart>{{0, 1, false}, {1, 1, false}});  // there are no arrays
    CHECK(array_parts(2, 1) == array_parts(2, 0));
}

TEST_CASE("sbatch is told whom a job waits for") {
    CHECK(sbatch_words("/o/a.sh", "/o", {0, 16, true}, 4, {{"7", "8"}, {"3"}}, "a.out", {"--partition=long"}) ==
          Words{"--chdir=/o", "--output=a.out", "--array=1-16%4", "--dependency=afterok:7:8,afterany:3",
                "--partition=long", "/o/a.sh"});
    CHECK(sbatch_words("/o/a.sh", "/o", {10, 3, true}, 4, {}, "a.out", {}) ==
          Words{"--chdir=/o", "--output=a.out", "--array=1-3", "/o/a.sh", "10"});
    CHECK(sbatch_words("/o/a.sh", "/o", {}, 0, {{}, {"3"}}, "a.out", {}) ==
          Words{"--chdir=/o", "--output=a.out", "--dependency=afterany:3", "/o/a.sh"});
}

TEST_CASE("What Slurm says of a task goes into a file of its own, whatever its job is called") {
    CHECK(output_of("50% cow", TaskStage::layers, {0, 16, true}) == "slurm/50%% cow/layers.%A_%a.out");
    CHECK(output_of("cow", TaskStage::merge, {}) == "slurm/cow/merge.%j.out");
    CHECK_THAT(join_script(), Contains("\nexit 0\n") && Contains("--kill-on-invalid-dep=yes"));
}

TEST_CASE("However many jobs are waited for, their numbers go into one word, and each is waited for once") {
    for (const std::size_t count : {0u, 1u, 1000u, 1001u, 16'000u, 1'000'001u}) {
        Words numbers;
        for (std::size_t i = 0; i < count; ++i) numbers.push_back(std::to_string(10'000'000 + i));
        std::map<std::string, Words> stands_for;
        const Words few = joined(numbers, [&](std::span<const std::string> some) {
            CHECK(some.size() <= 1000);
            const std::string number = "j" + std::to_string(stands_for.size());
            stands_for[number] = {some.begin(), some.end()};
            return number;
        });
        CHECK(few.size() <= 1000);
        CHECK(sbatch_words("/o/last.sh", "/o", {}, 0, {{}, few}, "last.out", {})[2 - (count == 0)].size() < 128 * 1024);
        if (count <= 1000) CHECK(few == numbers);
        Words reached, left = few;
        while (!left.empty()) {
            const std::string number = left.back();
            left.pop_back();
            const auto join = stands_for.find(number);
            if (join == stands_for.end())
                reached.push_back(number);
            else
                left.insert(left.end(), join->second.begin(), join->second.end());
        }
        std::sort(reached.begin(), reached.end());
        CHECK(reached == numbers);
    }
}

TEST_CASE("Lanes keep to the number of tasks that is allowed") {
    for (int throttle : {1, 2, 3, 8, 100})
        for (int widest : {1, 2, 5, 16}) {
            Lanes lanes(throttle, widest);
            CHECK(int(lanes.count()) * lanes.next().throttle <= throttle);
            CHECK(lanes.next().throttle >= 1);
        }
    Lanes free(0, 16);
    CHECK(free.count() == 1);
    CHECK(free.next().throttle == 0);
    free.next().take({"1"}, 5);
    CHECK(free.next().before.empty());

    Lanes two(4, 2);
    REQUIRE(two.count() == 2);
    two.next().take({"1", "2"}, 100);
    CHECK(two.next().before.empty());
    two.next().take({"3"}, 10);
    CHECK(two.next().before == Words{"3"});
    two.next().take({"4"}, 200);
    CHECK(two.next().before == Words{"1", "2"});
}
