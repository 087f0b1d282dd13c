// SPDX-License-Identifier: GPL-3.0-or-later
//
// A batch given away as a template of Open Job Description: run here as a worker would run it, it makes what the batch
// makes, and says on stdout how far it is.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string replaced(std::string text, const std::map<std::string, std::string>& values) {
    for (const auto& [name, value] : values) {
        const std::string reference = "{{" + name + "}}";
        for (std::size_t at = text.find(reference); at != std::string::npos; at = text.find(reference, at))
            text.replace(at, reference.size(), value);
    }
    return text;
}

/// A worker for one machine: steps in their order, whose dependencies stand before them; the tasks of a step backwards.
class Worker {
public:
    explicit Worker(const std::string& file) : template_(json::parse(read_file(file))) {
        for (const json& parameter : template_["parameterDefinitions"])
            values_["Param." + parameter["name"].get<std::string>()] = parameter["default"];
    }
    void run(const std::function<void(const std::string& step, const Outcome&)>& look) {
        std::set<std::string> done;
        for (const json& step : template_["steps"]) {
            for (const json& needed : step.value("dependencies", json::array()))
                REQUIRE(done.contains(needed["dependsOn"].get<std::string>()));
            for (int task = tasks_of(step); task >= 1; --task) {
                values_["Task.Param.Shard"] = std::to_string(task);
                look(step["name"], run_action(step["script"]["actions"]["onRun"]));
            }
            done.insert(step["name"].get<std::string>());
        }
    }

private:
    static int tasks_of(const json& step) {
        if (!step.contains("parameterSpace")) return 1;
        const std::string range = step["parameterSpace"]["taskParameterDefinitions"][0]["range"];
        return std::stoi(range.substr(range.find('-') + 1));
    }
    Outcome run_action(const json& action) {
        REQUIRE(replaced(action["command"], values_) == program());
        std::string line;
        for (const json& word : action["args"]) line += quoted(replaced(word, values_)) + " ";
        return run_program(line);
    }

    json template_;
    std::map<std::string, std::string> values_;
};

struct Workshop {
    explicit Workshop(const std::string& name) : folder(name) {
        folder.write("box.obj", soft_box_obj(3, 2, 1));
        folder.write("marker.obj", marker_obj());
        folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "formats": "png", "predict": "none"})");
        folder.write("plan.jsonl",
                     "{\"model\": \"box.obj\", \"name\": \"a box's $(name)\", \"iterations\": 1}\n"
                     "{\"model\": \"marker.obj\", \"iterations\": 0}\n");
    }
    [[nodiscard]] Outcome batch(const std::string& more, const std::string& out = "out") const {
        return run_program(fmt::format("batch {} --preset {} -o {} {}", folder / "plan.jsonl", folder / "quick.json",
                                       folder / out, more));
    }
    /// Of both jobs, without what tells of times.
    [[nodiscard]] std::map<std::string, std::string> stacks(const std::string& out) const {
        std::map<std::string, std::string> files;
        for (const char* const job : {"a box's $(name)", "marker"})
            for (auto& [name, bytes] : read_tree(folder.path() / out / job))
                if (name.starts_with("layers") || name == "manifest.json") files.emplace(job + ("/" + name), bytes);
        return files;
    }
    Folder folder;
};

}  // namespace

TEST_CASE("A template's tasks make what the batch makes, and say how far they are") {
    const Workshop shop("openjd");
    const std::string file = shop.folder / "job.json";
    const Outcome handed = shop.batch("--shards 2 --openjd " + file);
    INFO(handed.err);
    REQUIRE(handed.exit_code == 0);
    CHECK_THAT(handed.out, Contains("2 jobs in 7 tasks stand in " + file));
    CHECK_FALSE(fs::exists(shop.folder.path() / "out" / "marker"));

    std::size_t tasks = 0;
    Worker(file).run([&](const std::string& step, const Outcome& outcome) {
        INFO(step << "\n" << outcome.out << outcome.err);
        ++tasks;
        CHECK(outcome.exit_code == 0);
        CHECK_THAT(outcome.out, Contains("openjd_progress: 100\n"));
        if (step != "summary") CHECK_THAT(outcome.out, Contains("openjd_status: "));
        if (step.find("layers") != std::string::npos) CHECK_THAT(outcome.out, Contains("openjd_status: layers, "));
    });
    CHECK(tasks == 8);
    REQUIRE(shop.batch("--quiet", "local").exit_code == 0);
    CHECK(shop.stacks("out").size() > 200);
    CHECK(shop.stacks("out") == shop.stacks("local"));
    CHECK_THAT(run_program("status " + (shop.folder / "out")).out, Contains("2 jobs, 2 done"));

    // Done is done, for a template and for a batch here.
    fs::remove(file);
    CHECK_THAT(shop.batch("--shards 2 --openjd " + file).out, Contains("nothing is left to do"));
    CHECK_FALSE(fs::exists(file));
    CHECK_THAT(shop.batch("").out, Contains("2 before, and unchanged"));
    CHECK(shop.batch("--quiet").out.empty());
}

TEST_CASE("A task that fails says why, and its job stands as failed") {
    const Workshop shop("openjd-fails");
    const std::string file = shop.folder / "job.json";
    REQUIRE(shop.batch("--openjd " + file).exit_code == 0);
    shop.folder.write("marker.obj", "v 0 0 0\nf 1 2 3\n");
    bool failed = false;
    Worker(file).run([&](const std::string& step, const Outcome& outcome) {
        if (step.find("marker") == std::string::npos) return;
        INFO(outcome.out);
        failed = true;
        CHECK(outcome.exit_code == 3);
        CHECK_THAT(outcome.out, Contains("openjd_fail: "));
    });
    CHECK(failed);
    CHECK_THAT(run_program("status " + (shop.folder / "out")).out, Contains("1 done") && Contains("1 failed"));
}

TEST_CASE("What cannot be estimated is left out of a template and stands as failed") {
    const Workshop shop("openjd-broken");
    const std::string file = shop.folder / "job.json";
    shop.folder.write("box.obj", "v 0 0 0\nf 1 2 3\n");
    const Outcome handed = shop.batch("--openjd " + file);
    CHECK(handed.exit_code == 3);
    CHECK_THAT(handed.out, Contains("1 failed") && Contains("box.obj"));
    CHECK(json::parse(read_file(file))["steps"].size() == 2);
    CHECK(shop.batch("--slurm --openjd " + file).exit_code == 2);
    CHECK(shop.batch("--jobs 2 --openjd " + file).exit_code == 2);
    CHECK(shop.batch("--shards 2").exit_code == 2);
    CHECK(run_program(fmt::format("task {} --job nobody --stage whole --progress openjd", shop.folder / "out"))
              .out.starts_with("openjd_fail: "));
}
