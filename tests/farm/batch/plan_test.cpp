// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/plan.h"

#include <algorithm>
#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/options/job_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::farm;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

/// A folder with three models, and plans over them.
struct Workshop {
    Workshop() {
        for (const char* model : {"a.obj", "b.obj", "c d.glb", "picture.png"}) write(model, "");
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder.path() / name) << text; }
    [[nodiscard]] std::string at(const std::string& name) const { return (folder.path() / name).string(); }

    [[nodiscard]] PlanOptions options(const std::string& plan) const {
        return {{at(plan)}, {}, "{name}", folder.path() / "out"};
    }
    [[nodiscard]] std::vector<PlannedJob> plan(const std::string& name, const std::string& text) const {
        write(name, text);
        return read_plan(options(name));
    }
    /// What is said of the plan; it must be for good.
    [[nodiscard]] std::string fault(const std::string& name, const std::string& text) const {
        try {
            (void)plan(name, text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }

    io::TemporaryFolder folder;
};

}  // namespace

TEST_CASE("A job list has one job a line") {
    const Workshop shop;
    const auto jobs =
        shop.plan("plan.jsonl",
                  "# Monday\n{\"model\": \"a.obj\", \"size\": \"40mm\"}\n\n"
                  "{\"model\": \"b.obj\", \"name\": \"big\", \"report\": false, \"load\": [\"C\", \"W\"]}\r\n");
    REQUIRE(jobs.size() == 2);
    CHECK(jobs[0].name == "a");
    CHECK(jobs[0].options.size_mm == 40);
    CHECK(jobs[0].out == shop.at("out/a"));
    CHECK(jobs[0].options.out == shop.at("out/a"));
    CHECK(jobs[0].place == shop.at("plan.jsonl") + ": line 2");
    CHECK(jobs[0].command == Words{"slice", shop.at("a.obj"), "--out", shop.at("out/a"), "--size", "40mm"});
    CHECK(jobs[1].name == "big");
    CHECK(jobs[1].options.load == Words{"C", "W"});
    CHECK(jobs[1].place == shop.at("plan.jsonl") + ": line 4");
}

TEST_CASE("A table has one job a row, and empty cells say nothing") {
    const Workshop shop;
    const auto jobs = shop.plan("plan.csv", "name,model,size,flip-x\none,a.obj,40mm,true\n,\"c d.glb\",,\n");
    REQUIRE(jobs.size() == 2);
    CHECK(jobs[0].name == "one");
    CHECK(jobs[0].options.flip_x);
    CHECK(jobs[1].name == "c d");
    CHECK(jobs[1].options.size_mm == 0);
    CHECK(jobs[1].options.model == shop.at("c d.glb"));
}

TEST_CASE("Plans of Windows are read: UTF-16, semicolons, tabs, backslashes, empty columns, .tsv and .txt") {
    const Workshop shop;
    fs::create_directories(shop.folder.path() / "models");
    shop.write("models/sub.obj", "");
    const auto utf16 = [](const std::string& text) {
        std::string bytes = "\xFF\xFE";
        for (const char c : text) bytes += {c, '\0'};
        return bytes;
    };
    const std::string tabs = "model\tsize\tlabel\r\nmodels\\sub.obj\t6mm\t\"A\r\nB\"\r\n.\\a.obj\t7mm\t\r\n";
    const std::string semicolons =
        "\xEF\xBB\xBFmodel;size;label;\r\nmodels\\sub.obj;6mm;\"A\r\nB\";\r\n.\\a.obj;7mm;;\r\n;;;\r\n";
    for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
             {"p.csv", semicolons},
             {"p.csv", "sep=;\r\n" + semicolons.substr(3)},
             {"p.csv", utf16(semicolons.substr(3))},
             {"p.tsv", tabs},
             {"p.TSV", tabs},
             {"p.tab", tabs},
             {"p.txt", utf16(tabs)},
             {"p.txt", tabs},
             {"p.jsonl", utf16("{\"model\": \"models\\\\sub.obj\", \"size\": \"6mm\", \"label\": \"A\\\\nB\"}\r\n"
                               "{\"model\": \".\\\\a.obj\", \"size\": \"7mm\"}\r\n")}}) {
        CAPTURE(name, text);
        const auto jobs = shop.plan(name, text);
        REQUIRE(jobs.size() == 2);
        CHECK(jobs[0].name == "sub");
        CHECK(jobs[0].options.model == shop.at("models/sub.obj"));
        CHECK(jobs[0].options.size_mm == 6);
        CHECK(jobs[1].options.model == shop.at("a.obj"));
        CHECK(jobs[1].options.labels.empty());
    }
    CHECK(shop.plan("p.csv", semicolons)[0].options.labels == Words{"text=A\\nB"});  // one of two lines
    // A name that has a backslash in it, as Linux allows, stays what it is.
    shop.write("od\\d.obj", "");
    CHECK(shop.plan("p.csv", "model\nod\\d.obj\n")[0].options.model == shop.at("od\\d.obj"));
    CHECK_THAT(shop.fault("p.csv", "model\nmodels\\none.obj\n"), Contains("models\\none.obj"));
    // A preset that PowerShell has written.
    shop.write("preset.json", utf16(R"({"format": "voxtone-job", "version": 1, "size": "30mm"})"));
    shop.write("one.jsonl", "{\"model\": \"a.obj\"}\n");
    PlanOptions options = shop.options("one.jsonl");
    options.preset = shop.at("preset.json");
    CHECK(read_plan(options).at(0).options.size_mm == 30);
}

TEST_CASE("Columns whose header is in braces are values for labels") {
    const Workshop shop;
    const auto jobs = shop.plan("plan.csv", "model,label,{serial}\na.obj,{job}: {serial},A-17\nb.obj,plain,\n");
    REQUIRE(jobs.size() == 2);
    CHECK(jobs[0].options.labels == Words{"text={job}: A-17"});
    CHECK(jobs[1].options.labels == Words{"text=plain"});
    CHECK_THAT(shop.fault("plan.csv", "model,label\na.obj,{serial}\n"), Contains("{serial} stands for nothing"));
    CHECK_THAT(shop.fault("plan.csv", "model,{serial\na.obj,1\n"), Contains("{serial"));
}

TEST_CASE("A folder is its models, a pattern what it matches, several words are models each") {
    const Workshop shop;
    shop.write(".hidden.obj", "");
    const auto names = [&](const Words& plan) {
        PlanOptions options = shop.options("");
        options.plan = plan;
        Words found;
        for (const PlannedJob& job : read_plan(options)) found.push_back(job.name);
        return found;
    };
    CHECK(names({shop.folder.path().string()}) == Words{"a", "b", "c d"});
    CHECK(names({shop.at("*.obj")}) == Words{"a", "b"});
    CHECK(names({shop.at("*.png")}) == Words{"picture"});
    CHECK(names({shop.at("b.obj"), shop.at("a.obj")}) == Words{"b", "a"});
    CHECK(names({shop.at("a.obj")}) == Words{"a"});
    CHECK_THROWS_WITH(names({shop.at("*.ply")}), Contains("no file matches"));
    CHECK_THROWS_AS(names({shop.at("*.obj"), shop.folder.path().string()}), UsageError);
}

TEST_CASE("A preset is what every job begins with, but for what it would ignore of it") {
    const Workshop shop;
    shop.write("preset.json",
               R"({"format": "voxtone-job", "version": 1, "size": "30mm", "iterations": 0, "texture": "picture.png",
                   "out": "elsewhere", "overwrite": true})");
    shop.write("plan.jsonl",
               "{\"model\": \"a.obj\"}\n{\"model\": \"b.obj\", \"size\": \"50mm\"}\n"
               "{\"model\": \"picture.png\", \"width\": \"20mm\"}\n");
    PlanOptions options = shop.options("plan.jsonl");
    options.preset = shop.at("preset.json");
    const auto jobs = read_plan(options);
    REQUIRE(jobs.size() == 3);
    CHECK(jobs[0].options.size_mm == 30);
    CHECK(jobs[0].options.iterations == "0");
    CHECK(jobs[0].options.texture == shop.at("picture.png"));
    CHECK_FALSE(jobs[0].options.overwrite);
    CHECK(jobs[1].options.size_mm == 50);
    CHECK(jobs[2].options.size_mm == 0);  // a picture has none
    CHECK(jobs[2].options.texture.empty());
}

TEST_CASE("A whole job file is a row as well") {
    const Workshop shop;
    SliceOptions options;
    options.model = "a.obj";
    options.size_mm = 25;
    std::string text = job_json(options);
    std::replace(text.begin(), text.end(), '\n', ' ');
    const auto jobs = shop.plan("plan.jsonl", "{\"name\": \"x\", \"model\": \"a.obj\"}\n");
    REQUIRE(jobs.size() == 1);
    options.model = shop.at("a.obj");
    text = job_json(options);
    std::replace(text.begin(), text.end(), '\n', ' ');
    CHECK(shop.plan("plan.jsonl", text + "\n").at(0).options.size_mm == 25);
    // Or a plan of its own, as it lies in the folder of a stack.
    const auto own = shop.plan("job.json", job_json(options));
    REQUIRE(own.size() == 1);
    CHECK(own[0].options.size_mm == 25);
    CHECK(own[0].options.model == options.model);
}

TEST_CASE("Every fault of a plan is told with its line, at once") {
    const Workshop shop;
    const std::string said = shop.fault("plan.jsonl",
                                        "{\"model\": \"a.obj\"}\n"
                                        "{\"model\": \"a.obj\", \"sise\": \"1mm\"}\n"
                                        "{\"model\": \"gone.obj\"}\n"
                                        "{\"model\": \"b.obj\", \"size\": \"large\"}\n"
                                        "{\"model\": \"b.obj\", \"depth\": \"40mm\"}\n"
                                        "{\"model\": \"b.obj\", \"printer\": \"toaster\"}\n"
                                        "{\"model\": \"b.obj\", \"out\": \"x\"}\n"
                                        "{\"model\": \"b.obj\", \"resume\": true}\n"
                                        "{\"model\": \"b.obj\", \"name\": \"../b\"}\n"
                                        "{\"size\": \"1mm\"}\n"
                                        "{\"model\": \"b.obj\",\n"
                                        "[]\n"
                                        "{\"model\": \"a.obj\"}\n");
    INFO(said);
    const std::string plan = shop.at("plan.jsonl");
    const std::array<std::pair<int, const char*>, 12> wanted{{{2, "did you mean 'size'"},
                                                              {3, "gone.obj is not there"},
                                                              {4, "key `size`"},
                                                              {5, "depth"},
                                                              {6, "toaster"},
                                                              {7, "key `out`"},
                                                              {8, "key `resume`"},
                                                              {9, "'../b'"},
                                                              {10, "names no model"},
                                                              {11, "no valid JSON"},
                                                              {12, "expected a JSON object"},
                                                              {13, "is called 'a', as"}}};
    CHECK_THAT(said, Contains("12 faults") && Contains("no job was started"));
    std::istringstream lines(said);
    std::string line;
    std::getline(lines, line);
    for (const auto& [number, what] : wanted) {
        REQUIRE(std::getline(lines, line));
        CHECK(line.starts_with(plan + ": "));
        CHECK_THAT(line, Contains(what));
        CHECK_THAT(line, Contains(fmt::format("line {}: ", number)));
    }
    CHECK_FALSE(std::getline(lines, line));
    CHECK_FALSE(fs::exists(shop.folder.path() / "out"));
}

TEST_CASE("A batch says which words of its plan it takes for texts of the user's own") {
    const Workshop shop;
    shop.write("plan.csv", "Model,klant,Size\na.obj,Ada,9mm\nb.obj,Bob,8mm\n");
    struct Notes final : Progress {
        std::vector<std::string> all;
        void on_note(const std::string& note) override { all.push_back(note); }
    } notes;
    CHECK(read_plan(shop.options("plan.csv"), &notes).size() == 2);
    CHECK(notes.all ==
          std::vector<std::string>{"klant is no key of a plan: taken as a text of your own, which labels have in "
                                   "braces ({klant})"});
}

TEST_CASE("Faults of a table are told with their lines, those of its form too") {
    const Workshop shop;
    CHECK_THAT(shop.fault("plan.csv", "model,sise\na.obj,1mm\n"), Contains("plan.csv: line 2: ") && Contains("'size'"));
    CHECK_THAT(shop.fault("plan.csv", "model,size\na.obj,1mm\nb.obj\n"),
               Contains("plan.csv: line 3: has 1 cell") && Contains("no job was started"));
    CHECK_THAT(shop.fault("plan.csv", "model,size\n"), Contains("lists no job"));
    CHECK_THAT(shop.fault("plan.csv", "model,copeis\na.obj,3\n"),
               Contains("line 2") && Contains("did you mean 'copies'"));
    for (const std::string word : {"count", "quantity"})
        CHECK_THAT(shop.fault("plan.csv", "model," + word + "\na.obj,3\n"),
                   Contains("plan.csv: line 2: key `" + word + "`: copies are a tray's") && Contains("voxtone tray"));
    CHECK_THAT(shop.fault("plan.jsonl", "{\"model\": \"a.obj\", \"copies\": 2}\n"), Contains("copies are a tray's"));
    CHECK_THAT(shop.fault("plan.csv", "model,size\na.obj,\nb.obj,large\n"), Contains("plan.csv: line 3: key `size`"));
}

TEST_CASE("What is neither a model nor a picture is told by what it is") {
    const Workshop shop;
    shop.write("part.step", "ISO-10303-21;");
    CHECK_THAT(shop.fault("plan.jsonl", "{\"model\": \"part.step\", \"size\": \"9mm\"}\n{\"model\": \"gone.dae\"}\n"),
               Contains("line 1: part.step is a STEP file") && Contains("line 2"));
    fs::create_directory(shop.folder.path() / "cad");
    fs::rename(shop.at("part.step"), shop.at("cad/part.step"));
    CHECK_THROWS_WITH(read_plan(shop.options("cad")), Contains("holds no model") && Contains("part.step is a STEP"));
}

TEST_CASE("What is no plan is refused") {
    const Workshop shop;
    CHECK_THROWS_AS(read_plan(shop.options("gone.jsonl")), FileError);
    CHECK_THAT(shop.fault("plan.jsonl", ""), Contains("lists no job"));
    CHECK_THROWS_AS(read_plan({{}, {}, "{name}", "out"}), UsageError);
    PlanOptions options = shop.options("a.obj");
    options.preset = shop.at("gone.json");
    CHECK_THROWS_AS(read_plan(options), FileError);
    options.preset.clear();
    options.name = "{what}";
    CHECK_THROWS_AS(read_plan(options), UsageError);
}

TEST_CASE("A model whose name is no UTF-8 is a job like any other, through a plan and through its job file") {
    const Workshop shop;
    const std::string name = "caf\xE9.obj";
    shop.write(name, "");
    for (const char* text : {"", "job"}) {
        INFO(text);
        std::vector<PlannedJob> jobs;
        if (std::string(text).empty()) {
            jobs = read_plan({{shop.folder.path().string()}, {}, "{name}", shop.folder.path() / "out"});
            REQUIRE(jobs.size() == 4);
        } else {
            jobs = shop.plan("plan.csv", "model\n" + name + "\n");
            REQUIRE(jobs.size() == 1);
        }
        const auto job = std::find_if(jobs.begin(), jobs.end(), [](const auto& one) { return one.name == "caf%E9"; });
        REQUIRE(job != jobs.end());
        CHECK(job->options.model == shop.at(name));
        CHECK(job->command[1] == shop.at(name));
        shop.write("job.json", job_json(job->options));
        SliceOptions read;
        read_job(shop.at("job.json"), read);
        CHECK(read.model == shop.at(name));
    }
}
