// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone batch` and `voxtone status`, as a user meets them.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// A folder with small models; jobs over them take a second each.
struct Workshop {
    explicit Workshop(const std::string& name) : folder(name) {
        for (int i = 1; i <= 3; ++i) folder.write(fmt::format("box{}.obj", i), soft_box_obj(2 + 0.5 * i, 2, 1));
        folder.write("quick.json",
                     R"({"format": "voxtone-job", "version": 1, "iterations": 0, "report": false, "formats": "png"})");
    }
    [[nodiscard]] std::string at(const std::string& name) const { return "'" + (folder / name) + "'"; }
    void plan(const std::string& text) const { folder.write("plan.jsonl", text); }
    [[nodiscard]] Outcome batch(const std::string& more = {}, const std::string& plan = "plan.jsonl") const {
        return run_program(fmt::format("batch {} --preset {} -o {} {}", at(plan), at("quick.json"), at("out"), more));
    }
    [[nodiscard]] std::string state_text(const std::string& name) const {
        return read_file(folder / ("out/batch/" + name + ".json"));
    }
    [[nodiscard]] nlohmann::json state(const std::string& name) const {
        return nlohmann::json::parse(state_text(name));
    }
    /// Names of the files in the batch's folder that belong to nobody.
    [[nodiscard]] std::vector<std::string> leftovers() const {
        std::vector<std::string> left;
        for (const auto& entry : fs::recursive_directory_iterator(folder / "out"))
            if (entry.path().filename().string().starts_with('.')) left.push_back(entry.path().string());
        return left;
    }

    Folder folder;
};

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

const std::string started = "\"state\": \"started\"";

}  // namespace

TEST_CASE("A batch makes what slice makes, goes past what fails, and does nothing twice") {
    const Workshop shop("batch");
    shop.folder.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    shop.plan(
        "{\"model\": \"box1.obj\"}\n{\"model\": \"broken.obj\"}\n{\"model\": \"box2.obj\", \"name\": \"second\"}\n");
    const Outcome first = shop.batch();
    INFO(first.err);
    CHECK(first.exit_code == 3);
    CHECK_THAT(first.out, Contains("2 of 3 jobs done, 1 failed") && Contains("broken failed (exit code 3)"));
    CHECK(shop.state("box1")["state"] == "done");
    CHECK(shop.state("second")["state"] == "done");
    CHECK(shop.state("broken")["state"] == "failed");
    CHECK_THAT(shop.state("broken")["message"].get<std::string>(), Contains("broken.obj"));
    for (const char* name : {"box1", "second", "broken"})
        CHECK(io::schema_faults("batch-job", shop.state_text(name)) == std::vector<std::string>{});
    REQUIRE(run_program(fmt::format("slice {} --iterations 0 --no-report --formats png -o {}", shop.at("box1.obj"),
                                    shop.at("alone")))
                .exit_code == 0);
    CHECK(read_tree(shop.folder / "out/box1/layers") == read_tree(shop.folder / "alone/layers"));
    CHECK(read_file(shop.folder / "out/box1/manifest.json") == read_file(shop.folder / "alone/manifest.json"));

    const std::string stack_before = shop.state_text("box1");
    const Outcome again = shop.batch();
    CHECK(again.exit_code == 3);
    CHECK_THAT(again.out, Contains("(2 before, and unchanged)"));
    CHECK(shop.state_text("box1") == stack_before);

    shop.folder.write("broken.obj", soft_box_obj(3, 3, 1));
    const Outcome mended = shop.batch();
    CHECK(mended.exit_code == 0);
    CHECK_THAT(mended.out, Contains("3 of 3 jobs done (2 before, and unchanged)"));
    for (const char* name : {"box1", "second", "broken"})
        CHECK(run_program("verify " + shop.at(std::string("out/") + name)).exit_code == 0);
    CHECK(shop.leftovers().empty());
    const std::string csv = read_file(shop.folder / "out/summary.csv"),
                      page = read_file(shop.folder / "out/index.html");
    CHECK(count_of(csv, "\r\n") == 4);
    CHECK_THAT(page, Contains(">second<") && Contains("summary.csv"));
    CHECK_THAT(run_program("status " + shop.at("out")).out, Contains("3 jobs, 3 done"));
}

TEST_CASE("A changed input, a changed option and a changed result are made anew, nothing else is") {
    const Workshop shop("batch-changes");
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\"}\n{\"model\": \"box3.obj\"}\n");
    REQUIRE(shop.batch().exit_code == 0);
    const auto digest = [&](const char* name) { return shop.state(name)["figures"]["content_sha256"]; };
    const auto first = digest("box1"), second = digest("box2"), third = digest("box3");
    shop.folder.write("box1.obj", soft_box_obj(4, 2, 1));
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\", \"flip-x\": true}\n{\"model\": \"box3.obj\"}\n");
    fs::remove_all(shop.folder / "out/box3");
    const Outcome changed = shop.batch("--json");
    INFO(changed.err);
    REQUIRE(changed.exit_code == 0);
    CHECK(count_of(changed.out, started) == 3);
    CHECK(digest("box1") != first);
    CHECK(digest("box2") != second);
    CHECK(digest("box3") == third);
    CHECK(run_program("verify " + shop.at("out/box1")).exit_code == 0);
    // The same bytes under a new time are no change.
    fs::last_write_time(shop.folder / "box1.obj", fs::file_time_type::clock::now());
    const Outcome touched = shop.batch("--json");
    CHECK(touched.exit_code == 0);
    CHECK(count_of(touched.out, started) == 0);
}

TEST_CASE("What another build of the program made is made anew") {
    const Workshop shop("batch-builds");
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\"}\n");
    REQUIRE(shop.batch().exit_code == 0);
    nlohmann::json state = shop.state("box1");
    const std::string program = state["program"];
    CHECK_THAT(program, Contains(" build "));
    state["program"] = "0.0.9";
    shop.folder.write("out/batch/box1.json", state.dump());
    const Outcome again = shop.batch("--json");
    INFO(again.err);
    CHECK(again.exit_code == 0);
    CHECK(count_of(again.out, started) == 1);
    CHECK(shop.state("box1")["program"] == program);
    CHECK(shop.state("box1")["state"] == "done");
    CHECK_THAT(shop.state("box1")["command"].dump(), Contains("box1.obj"));
}

TEST_CASE("A stack that is nobody's of this batch is not replaced") {
    const Workshop shop("batch-strange");
    shop.plan("{\"model\": \"box1.obj\"}\n");
    REQUIRE(shop.batch().exit_code == 0);
    REQUIRE(
        run_program(fmt::format("slice {} --iterations 0 --no-report -o {}", shop.at("box2.obj"), shop.at("out/box3")))
            .exit_code == 0);
    const auto before = read_tree(shop.folder / "out/box3");
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"box3.obj\"}\n");
    for (int i = 0; i < 2; ++i) {
        CHECK(shop.batch().exit_code == 3);
        CHECK(read_tree(shop.folder / "out/box3") == before);
        CHECK_THAT(shop.state("box3")["message"].get<std::string>(), Contains("holds a stack"));
    }
}

TEST_CASE("A faulty plan starts nothing") {
    const Workshop shop("batch-plan");
    shop.folder.write("plan.csv", "model,sise\nbox1.obj,1mm\n");
    const Outcome csv = shop.batch("", "plan.csv");
    CHECK(csv.exit_code == 3);
    CHECK_THAT(csv.err, Contains("plan.csv: line 2: ") && Contains("did you mean 'size'"));
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"gone.obj\"}\n{\"model\": \"box1.obj\"}\n");
    const Outcome list = shop.batch();
    CHECK(list.exit_code == 3);
    CHECK_THAT(list.err, Contains("2 faults") && Contains("line 2: model") && Contains("line 3: is called 'box1'"));
    CHECK_FALSE(fs::exists(shop.folder / "out"));
    const Outcome counted_names = shop.batch("--name '{name}-{n:03}' --print-commands", "box1.obj");
    CHECK_THAT(counted_names.out, Contains("/out/box1-001 "));
    CHECK_FALSE(fs::exists(shop.folder / "out"));
}

TEST_CASE("A folder that is no batch's, or of another version, is left alone") {
    const Workshop shop("batch-folder");
    shop.plan("{\"model\": \"box1.obj\"}\n");
    fs::create_directory(shop.folder / "out");
    shop.folder.write("out/letter.txt", "Dear");
    const Outcome foreign = shop.batch();
    CHECK(foreign.exit_code == 3);
    CHECK_THAT(foreign.err, Contains("letter.txt") && Contains("no batch's folder"));
    CHECK(read_tree(shop.folder / "out").size() == 1);
    CHECK(run_program("status " + shop.at("out")).exit_code == 3);
    fs::remove(shop.folder / "out/letter.txt");
    shop.folder.write("out/batch.json", R"({"format": "voxtone-batch", "version": 2})");
    const Outcome newer = shop.batch();
    CHECK(newer.exit_code == 3);
    CHECK_THAT(newer.err, Contains("version 2"));
    const Outcome file = run_program("batch " + shop.at("plan.jsonl") + " -o " + shop.at("all.gcvf"));
    CHECK(file.exit_code == 2);
    CHECK_THAT(file.err, Contains("a batch has a folder"));
    CHECK_FALSE(fs::exists(shop.folder / "all.gcvf"));
    CHECK(read_tree(shop.folder / "out").size() == 1);
}

TEST_CASE("Printed commands make the same stack") {
    const Workshop shop("batch-commands");
    shop.folder.write("it's a box.obj", soft_box_obj(2, 2, 1));
    shop.folder.write("models.csv", "model\n\"it's a box.obj\"\n");
    const Outcome commands = shop.batch("--print-commands", "models.csv");
    REQUIRE(commands.exit_code == 0);
    shop.folder.write("run.sh", commands.out);
    REQUIRE(run_shell("sh " + shop.at("run.sh") + " >/dev/null 2>&1") == 0);
    const auto made = read_tree(shop.folder / "out/it's a box/layers");
    fs::remove_all(shop.folder / "out");
    REQUIRE(shop.batch("", "models.csv").exit_code == 0);
    CHECK(read_tree(shop.folder / "out/it's a box/layers") == made);
}

TEST_CASE("A batch that is told to stop saves what runs, and goes on from there") {
    const Workshop shop("batch-stop");
    // A loop that takes longer than the signal.
    shop.plan("{\"model\": \"box1.obj\", \"iterations\": 40, \"viewing-distance\": 200}\n{\"model\": \"box2.obj\"}\n");
    const auto began = std::chrono::steady_clock::now();
    const auto stopped = run_and_signal(fmt::format("batch {} --preset {} -o {} --json --jobs 1", shop.at("plan.jsonl"),
                                                    shop.at("quick.json"), shop.at("out")),
                                        started, SIGTERM);
    INFO(stopped.err);
    CHECK(stopped.exit_code == 85);
    CHECK(std::chrono::steady_clock::now() - began < std::chrono::seconds(30));  // is promised; a second as a rule
    CHECK_THAT(stopped.err, Contains("run the same command again"));
    CHECK(shop.state("box1")["state"] == "queued");
    CHECK(shop.state("box1")["exit_code"] == 85);
    CHECK(shop.state("box2")["state"] == "queued");
    CHECK_THAT(run_program("status " + shop.at("out")).out, Contains("2 jobs, 2 queued"));
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\"}\n");
    const Outcome on = shop.batch();
    INFO(on.err);
    CHECK(on.exit_code == 0);
    CHECK(shop.leftovers().empty());
}

TEST_CASE("Two batches over one folder share the work") {
    const Workshop shop("batch-twins");
    std::string plan;
    for (int i = 0; i < 6; ++i)
        plan += fmt::format("{{\"model\": \"box{}.obj\", \"name\": \"job{}\"}}\n", i % 3 + 1, i);
    shop.plan(plan);
    const std::string command = fmt::format("{} batch {} --preset {} -o {} --json --jobs 1", program(),
                                            shop.at("plan.jsonl"), shop.at("quick.json"), shop.at("out"));
    REQUIRE(run_shell(fmt::format("{0} >{1} 2>&1 & {0} >{2} 2>&1 || exit 1; wait $!", command, shop.at("one"),
                                  shop.at("two"))) == 0);
    const std::string one = read_file(shop.folder / "one"), two = read_file(shop.folder / "two");
    INFO(one << two);
    CHECK(count_of(one, started) + count_of(two, started) == 6);
    CHECK(count_of(one, started) > 0);
    CHECK(count_of(two, started) > 0);
    CHECK_THAT(one, Contains("\"done\": 6"));
    CHECK_THAT(two, Contains("\"done\": 6"));
    CHECK(shop.leftovers().empty());
}

TEST_CASE("What was held by another is tried again, within bounds") {
    const Workshop shop("batch-held");
    if (!is_here("flock")) {
        skip("flock is not here");
        return;
    }
    shop.plan("{\"model\": \"box1.obj\"}\n");
    fs::create_directories(shop.folder / "out/box1");
    shop.folder.write("out/batch.json", R"({"format": "voxtone-batch", "version": 1})");
    const std::string held = shop.at("out/box1/.voxtone-lock");
    shop.folder.write(
        "go.sh", fmt::format("{} batch {} --preset {} -o {} --retries 0 >{} 2>&1", program(), shop.at("plan.jsonl"),
                             shop.at("quick.json"), shop.at("out"), shop.at("said")));
    CHECK(run_shell(fmt::format("flock {} sh {}", held, shop.at("go.sh"))) == 75);
    CHECK_THAT(read_file(shop.folder / "said"), Contains("being written by another"));
    CHECK(shop.state("box1")["state"] == "failed");
    CHECK(shop.state("box1")["exit_code"] == 75);
    CHECK(shop.batch().exit_code == 0);
}

TEST_CASE("A command follows each result, and takes nothing from it") {
    const Workshop shop("batch-after");
    shop.plan("{\"model\": \"box1.obj\"}\n{\"model\": \"box2.obj\"}\n");
    shop.folder.write("after.sh",
                      "json=$(cat); echo \"$json\" >>told; case $json in *'\"box1\"'*) echo no; exit 7;; esac\n");
    const Outcome outcome = shop.batch(fmt::format("--after 'cd \"{}\" && sh after.sh'", shop.folder.path().string()));
    INFO(outcome.err);
    CHECK(outcome.exit_code == 0);
    CHECK_THAT(outcome.err,
               Contains("box1: warning: the command of --after failed (exit code 7)") && Contains("[after-failed]"));
    const std::string told = read_file(shop.folder / "told");
    CHECK(count_of(told, "\"content_sha256\"") == 2);
    CHECK(shop.state("box1")["after"]["exit_code"] == 7);
    CHECK(shop.state("box2")["after"]["exit_code"] == 0);
    CHECK(shop.state("box1")["state"] == "done");
    CHECK(shop.batch("--after 'echo again >>" + (shop.folder / "told") + "'").exit_code == 0);
    CHECK(read_file(shop.folder / "told") == told);
}

TEST_CASE("With --fail-fast the first failure ends the batch") {
    const Workshop shop("batch-fail");
    shop.folder.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    shop.plan("{\"model\": \"broken.obj\"}\n{\"model\": \"box1.obj\"}\n");
    const Outcome outcome = shop.batch("--fail-fast --jobs 1");
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.out, Contains("0 of 2 jobs done, 1 failed, 1 left"));
    CHECK(shop.state("box1")["state"] == "queued");
    CHECK_FALSE(fs::exists(shop.folder / "out/box1"));
}

TEST_CASE("A watched model waits for what it names, and is sliced again when that comes after all") {
    const Workshop shop("batch-watch-beside");
    fs::create_directory(shop.folder / "in");
    const std::string box =
        "usemtl a\nv 0 0 0\nv 3 0 0\nv 3 2 0\nv 0 2 0\nv 0 0 1\nv 3 0 1\nv 3 2 1\nv 0 2 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    shop.folder.write("in/s.obj", "mtllib s.mtl\n" + box);
    shop.folder.write("t.obj", "mtllib t.mtl\n" + box);
    shop.folder.write("red.mtl", "newmtl a\nKd 0.8 0.1 0.1\n");
    shop.folder.write("watch.sh", fmt::format(R"(set -u
{0} batch --watch {1} --preset {2} -o {3} --json --wait-for-files 8 --after 'echo "<$VOXTONE_LOST_COLOURS>" >>{7}' >{4} 2>&1 &
said() {{ for i in $(seq 600); do [ $(grep -c "$1" {4}) -ge $2 ] && return; sleep 0.1; done; kill $!; exit 9; }}
said 'waits up to 8 s.*s.mtl' 1
cat {5} >{1}/s.mtl
said '"state": "done"' 1
cat {6} >{1}/t.obj
said 'is sliced without.*t.mtl' 1
said '"state": "done"' 2
said '"state": "warned".*LOST' 1
cat {5} >{1}/t.mtl
said '"state": "done"' 3
kill -TERM $!
wait $!
)",
                                              program(), shop.at("in"), shop.at("quick.json"), shop.at("out"),
                                              shop.at("said"), shop.at("red.mtl"), shop.at("t.obj"), shop.at("after")));
    const int code = run_shell("sh " + shop.at("watch.sh"));
    const std::string said = read_file(shop.folder / "said");
    INFO(said);
    CHECK(code == 85);
    CHECK_THAT(said, Contains("t.obj: what it names has come or changed: it is sliced again") && !Contains("no-model"));
    CHECK(count_of(said, started) == 3);
    for (const char* name : {"s", "t"}) CHECK_FALSE(shop.state(name)["figures"].contains("lost_colours"));
    CHECK(io::schema_faults("batch-job", shop.state_text("t")) == std::vector<std::string>{});
    const std::string after = read_file(shop.folder / "after");
    CHECK(count_of(after, "<>") == 2);
    CHECK_THAT(after, Contains("LOST") && Contains("[lost-colour]>"));
}

TEST_CASE("Of what arrives in a watched folder may be told alone") {
    const Workshop shop("batch-watch-tell");
    fs::create_directory(shop.folder / "in");
    shop.folder.write("in/s.obj",
                      "mtllib s.mtl\nusemtl a\nv 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
    shop.folder.write("in/s.mtl", "newmtl a\nKd 0.8 0.1 0.1\n");
    shop.folder.write("watch.sh", fmt::format(R"(set -u
{0} batch --watch {1} -o {2} --json --only-tell >{3} 2>&1 &
for i in $(seq 600); do [ $(grep -c arrived {3}) -ge 1 ] && break; sleep 0.1; done
kill -TERM $!
wait $!
)",
                                              program(), shop.at("in"), shop.at("out"), shop.at("said")));
    CHECK(run_shell("sh " + shop.at("watch.sh")) == 85);
    const std::string said = read_file(shop.folder / "said");
    CHECK_THAT(said, Contains(fmt::format(R"({{"event": "arrived", "model": "{}", "beside": ["{}"], "again": false}})",
                                          (shop.folder / "in/s.obj"), (shop.folder / "in/s.mtl"))));
    CHECK_FALSE(fs::exists(shop.folder / "out"));
    const Outcome outcome = run_program("batch --only-tell plan.jsonl -o " + shop.at("out"));
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains("--only-tell is for --watch"));
}

TEST_CASE("A watched folder's models are sliced when they are complete, and again when they are written anew") {
    const Workshop shop("batch-watch");
    fs::create_directory(shop.folder / "in");
    shop.folder.write("in/first.obj", soft_box_obj(2, 2, 1));
    shop.folder.write("in/bad.obj", "v 0 0 0\n");
    shop.folder.write("watch.sh", fmt::format(R"(set -u
{0} batch --watch {1} --preset {2} -o {3} --json >{4} 2>&1 &
said() {{ for i in $(seq 600); do [ $(grep -c "$1" {4}) -ge $2 ] && return; sleep 0.1; done; exit 9; }}
said '"state": "done"' 1
cat {5} >{1}/second.obj
said '"state": "done"' 2
cat {6} >{1}/first.obj
said '"state": "done"' 3
echo 'no model' >{1}/notes.txt
said no-model 1
kill -TERM $!
wait $!
)",
                                              program(), shop.at("in"), shop.at("quick.json"), shop.at("out"),
                                              shop.at("said"), shop.at("box1.obj"), shop.at("box3.obj")));
    const int code = run_shell("sh " + shop.at("watch.sh"));
    const std::string said = read_file(shop.folder / "said");
    INFO(said);
    CHECK(code == 85);
    CHECK_THAT(said, Contains("notes.txt is a document") && Contains("[no-model]"));
    CHECK(shop.state("first")["state"] == "done");
    CHECK(shop.state("first")["figures"]["size_mm"][0] == 3.5);
    CHECK(shop.state("second")["state"] == "done");
    CHECK(shop.state("bad")["state"] == "failed");
    CHECK_THAT(read_file(shop.folder / "out/index.html"), Contains(">second<"));
    CHECK(shop.leftovers().empty());
    CHECK(run_program(fmt::format("batch --watch {} -o {} --name '{{n}}'", shop.at("in"), shop.at("x"))).exit_code ==
          2);
    CHECK(run_program(fmt::format("batch {0} --watch {0} -o {1}", shop.at("in"), shop.at("x"))).exit_code == 2);
}
