// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

TEST_CASE("Usage errors end with 2, help and version with 0") {
    CHECK(run_program("").exit_code == 2);
    CHECK(run_program("slise").exit_code == 2);
    CHECK(run_program("slice --sise 60mm model.obj -o out").exit_code == 2);
    const Outcome version = run_program("--version");
    CHECK(version.exit_code == 0);
    CHECK_THAT(version.out, Catch::Matchers::Matches("voxtone 0\\.[0-9]+\\.[0-9]+ \\(.*build [0-9a-f]{16}\\)\n"));
    const Outcome help = run_program("slice --help");
    CHECK(help.exit_code == 0);
    for (const char* option : {"--printer", "--resins", "--size", "--scale", "--unit", "--rotate", "--layers",
                               "--screen", "--width", "--thickness", "--repair", "--keep-thin", "--job",
                               "--dump-default", "--json", "--quiet", "--threads", "--seed"})
        CHECK_THAT(help.out, Contains(option));
    const Outcome rule = run_program("slice model.obj -o out --depth 0");
    CHECK(rule.exit_code == 2);
    CHECK_THAT(rule.err, Contains("--depth"));
}

TEST_CASE("A dumped default is a job file that slices") {
    const Folder folder("dump");
    const Outcome dump = run_program("slice --dump-default");
    REQUIRE(dump.exit_code == 0);
    auto job = nlohmann::json::parse(dump.out);
    folder.write("marker.obj", marker_obj());
    job["model"] = "marker.obj";
    job["out"] = folder / "out";
    job["layers"] = "0-1";
    job["report"] = false;
    folder.write("job.json", job.dump());
    CHECK(run_program("slice --quiet --job " + (folder / "job.json")).exit_code == 0);
    // Quietly the events of --json are warnings and the result: those of progress are many.
    const Outcome events = run_program("slice --quiet --json --overwrite --layers 0-1 --job " + (folder / "job.json"));
    CHECK_THAT(events.out, Contains(R"({"event":"result")") && !Contains(R"("event":"progress")") &&
                               !Contains(R"("event":"stage")"));
    // The command line wins over the file.
    CHECK(run_program("slice --quiet --layers 0-99999 --overwrite --job " + (folder / "job.json")).exit_code == 0);
    CHECK(nlohmann::json::parse(read_file(folder / "out/manifest.json"))["layers"] > 2);
    folder.write("bad.json", R"({"format": "voxtone-job", "version": 1, "modle": "x"})");
    const Outcome bad = run_program("slice --job " + (folder / "bad.json"));
    CHECK(bad.exit_code == 3);
    CHECK_THAT(bad.err, Contains("modle") && Contains("model"));
}

TEST_CASE("Missing and invalid inputs have their own exit codes and one clear sentence") {
    const Folder folder("inputs");
    const std::string out = " -o " + (folder / "out");
    const Outcome missing = run_program("slice " + (folder / "nothing.obj") + out);
    CHECK(missing.exit_code == 4);
    CHECK_THAT(missing.err, Contains("nothing.obj"));
    folder.write("file", "no folder");
    CHECK(run_program("slice " + (folder / "nothing.obj") + " -o " + (folder / "file")).exit_code == 4);
    folder.write("empty.obj", "");
    CHECK(run_program("slice " + (folder / "empty.obj") + out).exit_code == 3);
    folder.write("marker.obj", marker_obj());
    folder.write("marker.fbx", marker_obj());
    const Outcome misnamed = run_program("slice " + (folder / "marker.fbx") + out);
    CHECK(misnamed.exit_code == 3);
    CHECK_THAT(misnamed.err, Contains("an OBJ model") && Contains("rename it marker.obj"));
    folder.write("notes.qqq", "of no kind that anybody knows");
    const Outcome unread = run_program("slice " + (folder / "notes.qqq") + out);
    CHECK(unread.exit_code == 3);
    CHECK_THAT(unread.err, Contains("PNG, JPEG") && Contains("if it is a model") && Contains(".obj, .ply"));
    for (const char* verb : {"predict ", "proof "}) {
        const Outcome unsliced = run_program(verb + (folder / "marker.obj") + " -o " + (folder / "x.png"));
        CHECK(unsliced.exit_code == 3);
        CHECK_THAT(unsliced.err, Contains("no layer stack") && Contains("voxtone slice"));
    }
    const std::string slice = "slice " + (folder / "marker.obj") + out;
    CHECK(run_program(slice + " --printer no-such-printer").exit_code == 3);
    CHECK(run_program(slice + " --resins no-such-set").exit_code == 3);
    CHECK(run_program(slice + " --load C,M,Q").exit_code == 3);
    CHECK(run_program(slice + " --printer stratasys-j750-hs --load C,M,Y,K,W").exit_code == 3);
    const Outcome large = run_program(slice + " --size 5m");
    CHECK(large.exit_code == 3);
    CHECK_THAT(large.err, Contains("tray"));
    CHECK_FALSE(std::filesystem::exists(folder / "out/manifest.json"));
    // A folder with somebody's files in it is not touched.
    std::filesystem::create_directory(folder / "mine");
    folder.write("mine/letter.txt", "dear");
    CHECK(run_program("slice " + (folder / "marker.obj") + " -o " + (folder / "mine")).exit_code != 0);
    CHECK(read_tree(folder / "mine").size() == 1);
}

TEST_CASE("A limit of this process is named, and not the file that was read under it") {
    const Folder folder("limits");
    const std::string deep(200, 'd');  // what its reader is told is more than a block of `ulimit -f`
    std::filesystem::create_directory(folder / deep);
    const std::string small = "v 0 0 0\nv 8 0 0\nv 0 8 0\nv 0 0 8\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    struct Limit {
        std::string ulimit, model, text, says;
    };
    for (const Limit& limit : {Limit{"-n 8", "marker.obj", marker_obj(), "ulimit -n"},
                               Limit{"-f 1", "marker.obj", marker_obj(), "ulimit -f"},
                               Limit{"-f 1", deep + "/marker.obj", marker_obj(), "ulimit -f"},
                               Limit{"-f 3", "small.obj", small, "could not be written (File too large)"}}) {
        CAPTURE(limit.ulimit, limit.model);
        folder.write(limit.model, limit.text);
        // Into pipes: files are what is limited. As a shell starts it: what ran the tests may ignore the signal.
        const std::string line = fmt::format(
            "(ulimit {} && exec env --default-signal=XFSZ {} slice {} --iterations 0 --predict none --no-report -o {}) "
            "2>&1 | cat >{}",
            limit.ulimit, program(), folder / limit.model, folder / "out", folder / "said");
        (void)run_shell(line);
        // How many descriptors are open already is the caller's: the program may not get as far as to its reader.
        const std::string said = read_file(folder / "said");
        CHECK_THAT(said, Contains(limit.says) || Contains("Too many open files"));
        CHECK_THAT(said, !Contains("damaged"));
        CHECK_FALSE(std::filesystem::exists(folder / "out/manifest.json"));
    }
}

TEST_CASE("Colour that is lost is said once, with --strict it ends the job with 3") {
    const Folder folder("lost");
    const std::string corners = "v 0 0 0\nv 5 0 0\nv 0 5 0\nv 0 0 5\n", faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\n";
    const std::string options = " --layers 0-1 --iterations 0 --predict none --no-report -o ";
    folder.write("torn.obj", "mtllib gone.mtl\n" + corners + "usemtl red\n" + faces + "usemtl blue\nf 2 3 4\n");
    const Outcome lost = run_program("slice --quiet " + (folder / "torn.obj") + options + (folder / "a"));
    CHECK(lost.exit_code == 0);
    CHECK_THAT(lost.err, Contains("gone.mtl"));
    CHECK(lost.err.find("gone.mtl") == lost.err.rfind("gone.mtl"));
    const Outcome refused = run_program("slice --strict --quiet " + (folder / "torn.obj") + options + (folder / "b"));
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("gone.mtl") && Contains("--strict"));
    CHECK_FALSE(std::filesystem::exists(folder / "b"));

    // A model with colours of which nothing is on its outside.
    folder.write("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl white\nKd 1 1 1\n");
    std::string inner =
        "v 0.5 0.5 0.5\nv 1 0.5 0.5\nv 0.5 1 0.5\nv 0.5 0.5 1\nusemtl red\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";
    folder.write("hidden.obj", "mtllib m.mtl\n" + corners + "usemtl white\n" + faces + "f 2 3 4\n" + inner);
    const Outcome white = run_program("slice --quiet " + (folder / "hidden.obj") + options + (folder / "c"));
    CHECK(white.exit_code == 0);
    CHECK_THAT(white.err, Contains("all white"));
    CHECK(run_program("slice --strict --quiet " + (folder / "hidden.obj") + options + (folder / "d")).exit_code == 3);
    // What has no colour at all is not to blame, and what shows some is fine.
    folder.write("plain.obj", corners + faces + "f 2 3 4\n");
    CHECK(run_program("slice --strict --quiet " + (folder / "plain.obj") + options + (folder / "e")).exit_code == 0);
    folder.write("red.obj", "mtllib m.mtl\n" + corners + "usemtl white\n" + faces + "usemtl red\nf 2 3 4\n");
    const Outcome red = run_program("slice --strict --quiet " + (folder / "red.obj") + options + (folder / "f"));
    CHECK(red.exit_code == 0);
    CHECK(red.err.find("all white") == std::string::npos);
    // Pictures are textures already.
    CHECK(run_program("slice p.png --texture q.png -o " + (folder / "g")).exit_code == 2);
}

TEST_CASE("With --json: events and one result, one JSON object a line") {
    const Folder folder("json");
    folder.write("marker.obj", marker_obj());
    const Outcome outcome =
        run_program("slice --json --layers 0-3 " + (folder / "marker.obj") + " -o " + (folder / "out"));
    REQUIRE(outcome.exit_code == 0);
    std::size_t results = 0, stages = 0;
    std::string last;
    for (std::size_t begin = 0; begin < outcome.out.size();) {
        const std::size_t end = outcome.out.find('\n', begin);
        REQUIRE(end != std::string::npos);
        const auto event = nlohmann::json::parse(outcome.out.substr(begin, end - begin));
        last = event.at("event").get<std::string>();
        results += last == "result";
        stages += last == "stage";
        begin = end + 1;
    }
    CHECK(results == 1);
    CHECK(last == "result");
    CHECK(stages >= 3);
}

TEST_CASE("Ctrl-C stops with 5, SIGTERM and SIGUSR1 with 85, and nothing is left that looks whole") {
    const Folder folder("cancel");
    folder.write("box.obj", ramp_box_obj(60, 60, 30));
    const std::string slice = "slice --json --iterations 0 --predict none " + (folder / "box.obj") + " -o ";
    for (const auto& [signal, code] : {std::pair(SIGINT, 5), std::pair(SIGTERM, 85), std::pair(SIGUSR1, 85)})
        for (const char* const stage : {"read model", "layers"}) {
            const std::string out = folder / fmt::format("out-{}", signal);
            const Outcome outcome = run_and_signal(slice + out, fmt::format("\"stage\":\"{}\"", stage), signal);
            INFO(outcome.out << outcome.err);
            CHECK(outcome.exit_code == code);
            CHECK_THAT(outcome.err,
                       Contains(signal == SIGINT ? "cancelled" : "nothing of it is saved yet: run the same"));
            CHECK_FALSE(std::filesystem::exists(out + "/manifest.json"));
            CHECK(run_program("verify " + out).exit_code != 0);
        }
}

TEST_CASE("Who reads a job's events may leave: the stack is whole, and the exit code says that they were not read") {
    const Folder folder("program-reader-left");
    folder.write("box.obj", ramp_box_obj(2, 2, 1));
    const std::string command =
        fmt::format("(\"{}\" slice '{}' --iterations 0 --no-report --json -o '{}'; echo $? > '{}') 2>'{}' | head -n 1",
                    program(), folder / "box.obj", folder / "out", folder / "code", folder / "err");
    CHECK(std::system(command.c_str()) == 0);
    CHECK(read_file(folder / "code") == "75\n");
    CHECK_THAT(read_file(folder / "err"), Contains("Broken pipe"));
    CHECK(run_program("verify '" + (folder / "out") + "'").exit_code == 0);
}

TEST_CASE("A resin that is as clear as air is a resin") {
    const Folder folder("program-clear");
    folder.write("box.obj", ramp_box_obj(4, 4, 3));
    const Outcome outcome = run_program(fmt::format(
        "slice '{}' --resins vero-opaque-clear --load C,M,Y,K,W,T --core T --iterations 0 --no-report -o '{}'",
        folder / "box.obj", folder / "out"));
    INFO(outcome.err);
    CHECK(outcome.exit_code == 0);
}

TEST_CASE("A job that left job.json runs again from anywhere, and says what has changed") {
    const Folder folder("again");
    std::filesystem::create_directories(folder / "desk/models");
    folder.write("desk/models/box.obj", "mtllib box.mtl\nusemtl red\n" + marker_obj());
    folder.write("desk/models/box.mtl", "newmtl red\nKd 0.5 0.1 0.1\n");
    const std::string quick = " --iterations 0 --predict none --no-report ";
    // Relative paths, seen from where the command is given.
    const std::string here = std::filesystem::current_path().string();
    std::filesystem::current_path(folder / "desk");
    const int first = run_program("slice --quiet --size 3mm models/box.obj -o prints/out" + quick).exit_code;
    std::filesystem::current_path(here);
    REQUIRE(first == 0);
    const auto digest = [&](const std::string& out) {
        return nlohmann::json::parse(read_file(folder / (out + "/manifest.json")))
            .at("content_sha256")
            .get<std::string>();
    };
    const std::string again = "slice --job " + (folder / "moved/prints/out/job.json") + " -o ";
    std::filesystem::rename(folder / "desk", folder / "moved");
    const Outcome same = run_program(again + (folder / "same"));
    INFO(same.err);
    CHECK(same.exit_code == 0);
    CHECK(same.err.find("SHA-256") == std::string::npos);
    CHECK(digest("same") == digest("moved/prints/out"));

    folder.write("moved/models/box.mtl", "newmtl red\nKd 0.1 0.1 0.5\n");
    const Outcome changed = run_program(again + (folder / "changed"));
    CHECK(changed.exit_code == 0);
    CHECK_THAT(changed.err, Contains("box.mtl") && Contains("SHA-256"));
    CHECK(digest("changed") != digest("same"));
}

TEST_CASE("slice --dump-default takes the options given") {
    const auto job = nlohmann::json::parse(run_program("slice --dump-default --size 6cm --load K,W a.obj").out);
    CHECK(job.at("size") == "60mm");
    CHECK(job.at("load") == nlohmann::json{"K", "W"});
    CHECK(job.at("model") == (std::filesystem::current_path() / "a.obj").string());
    CHECK(run_program("slice --dump-default --screen lines").exit_code == 2);
}

TEST_CASE("list names the printers and the resin sets") {
    const Outcome printers = run_program("list printers");
    CHECK(printers.exit_code == 0);
    for (const char* id :
         {"stratasys-j750-hm", "stratasys-j750-hq", "stratasys-j750-hs", "stratasys-j55", "mimaki-3duj-553", "generic"})
        CHECK_THAT(printers.out, Contains(id));
    const Outcome resins = run_program("list resins");
    CHECK(resins.exit_code == 0);
    CHECK_THAT(resins.out, Contains("vero-opaque") && Contains("channels: R, G, B"));
    CHECK(run_program("list cows").exit_code == 2);
}
