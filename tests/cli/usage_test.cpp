// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program says to command lines that it cannot follow, and that every failure is told in the same voice.
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/pictures/picture.h"
#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

void refused(const std::string& arguments, int exit_code, const std::string& words) {
    INFO(arguments);
    const Outcome outcome = run_program(arguments);
    CHECK(outcome.exit_code == exit_code);
    CHECK_THAT(outcome.err, Contains(words));
    CHECK_THAT(outcome.err, !Contains("bug of ours"));
}

/// The last line of stdout, as an event.
nlohmann::json last_event(const std::string& out) {
    REQUIRE(!out.empty());
    const std::size_t before = out.find_last_of('\n', out.size() - 2);
    return nlohmann::json::parse(out.substr(before == std::string::npos ? 0 : before + 1));
}

}  // namespace

TEST_CASE("Unknown verbs, steps and options are answered with the nearest known one") {
    refused("slcie model.obj", 2, "did you mean 'slice'?");
    refused("laminate serch", 2, "did you mean 'search'?");
    refused("calibrate phtoo", 2, "did you mean 'photo'?");
    refused("cows", 2, "there are slice, tray, read, estimate, merge, predict, proof");
    refused("slice model.obj --sise 10mm -o out", 2, "did you mean '--size'?");
    refused("slice model.obj --sise=10mm -o out", 2, "did you mean '--size'?");
    refused("predict out --ouptut x.png", 2, "--ouptut: `voxtone predict` has no such option");
    refused("laminate search --materiels W,K", 2, "did you mean '--materials'?");
    refused("predict a b -o x.png", 2, "'b' is one word too many");
    refused("verify", 2, "stack is required: output folder");
    refused("list cows", 2, "what: 'cows' is none of printers, resins; `voxtone list --help`");
    refused("slice model.obj", 2, "name the output folder");
    refused("laminate", 2, "wants a verb: dataset");
    refused("", 2, "wants a verb: slice");
}

TEST_CASE("The parser's own sentences are told in ours, whatever kind of error it is") {
    struct Case {
        const char *arguments, *told;
    };
    const std::vector<Case> cases{
        {"slice a.obj -o out --size 5mm --size 6mm", "--size is given 2 times (5mm, 6mm), and only one can count"},
        {"slice a.obj -o out --read-size 1 --read-size 2", "--read-size is given 2 times (1, 2)"},
        {"slice a.obj -o", "--out: its value is missing"},
        {"slice a.obj -o out --size", "--size: its value is missing"},
        {"slice a.obj -o out --report=maybe", "--report is on or off: it takes no value but"},
        {"predict out -o x.png --threads two", "--threads: 'two' is not a whole number"},
        {"batch plan.csv -o x --memory -2GiB", "--memory: -2 is not 0 to 1000000"},
        {"batch plan.csv -o x --memory 2G", "--memory: '2G': unknown unit 'G'"},
        {"slice cow.obj -o x --read-time 2m", "--read-time: '2m': unknown unit 'm'"},
        {"predict out -o x.png --threads 9999", "--threads: 9999 is not 0 to 1024"},
        {"predict out -o x.png --seed x", "--seed: 'x' is not a whole number"},
        {"predict out -o x.png --spp 1 --error x", "--error: 'x' is not a number"},
        {"slice a.obj -o out --json --progress openjd", "--json does not go with --progress: leave one of them out"},
        {"calibrate photo a.tif --target t.json -o p.csv --corners 1,2,3", "--corners wants 8 values"},
        {"calibrate edge fit p.csv --setup s.json -o r.json --chart-angle 3", "has no such option"},
        {"calibrate edge fit p.csv --setup s.json -o r.json --base black", "only goes with --chart: give both"},
        {"predict out", "--out is required: "},
        {"list cows", "what: 'cows' is none of printers, resins"}};
    for (const auto& [arguments, told] : cases) {
        refused(arguments, 2, told);
        const std::string err = run_program(arguments).err;
        for (const char* own : {"At Most", "At Least", "At least", "required but", "Could not convert", "excludes",
                                " requires ", "Value ", "not in {", "Expected", "disallowed", "allowed value"})
            CHECK_THAT(err, !Contains(own));
    }
}

TEST_CASE("A file whose name begins as an option does is pointed at its own spelling") {
    for (const char* word : {"-dash/x.obj", "-x.obj", "--cow.glb"})
        refused(fmt::format("slice {} -o out", word), 2,
                fmt::format("if it is a file, write ./{}, or put it behind --", word));
    refused("slice a.obj -o out --frob", 2, "has no such option");
    CHECK_THAT(run_program("slice a.obj -o out --frob").err, !Contains("if it is a file"));
}

TEST_CASE("What was called --model is pointed at --show") {
    refused("slice --model layered-profile -o out", 2, "what --show says");
}

TEST_CASE("A quality stands for other options, and what is said beside it wins") {
    const Folder folder("quality");
    folder.write("marker.obj", marker_obj());
    const auto dumped = [&](const std::string& options) {
        return nlohmann::json::parse(run_program("slice a.obj -o out --dump-default " + options).out);
    };
    const nlohmann::json draft = dumped("--quality draft"), best = dumped("--quality best");
    CHECK(draft["iterations"] == "0");
    CHECK(draft["predict"] == "none");
    CHECK(best["iterations"] == "long");
    CHECK(best["predict"] == "transport");
    CHECK(dumped("--quality good") == dumped(""));
    // In whatever order.
    CHECK(dumped("--quality draft --iterations 3")["iterations"] == "3");
    CHECK(dumped("--iterations 3 --quality draft")["iterations"] == "3");
    CHECK(dumped("--iterations 3 --quality draft")["predict"] == "none");
    refused("slice a.obj -o out --quality draft --intent contrast", 2, "--quality draft means too");
    refused("slice a.obj -o out --quality superb", 2, "none of draft, good, best");
    // The same job, whichever way it is said.
    const std::string slice = "slice --no-report --layers 0-5 " + (folder / "marker.obj") + " -o " + (folder / "out");
    CHECK(run_program(slice + " --iterations 0 --predict none").exit_code == 0);
    CHECK_THAT(run_program(slice + " --quality draft").out, Contains("nothing was done"));
}

TEST_CASE("list alone lists both") {
    const Outcome both = run_program("list");
    CHECK(both.exit_code == 0);
    CHECK_THAT(both.out, Contains("stratasys-j750-hm") && Contains("vero-opaque"));
    const nlohmann::json json = nlohmann::json::parse(run_program("list --json").out);
    CHECK(json["printers"] == nlohmann::json::parse(run_program("list printers --json").out));
    CHECK(json["resins"] == nlohmann::json::parse(run_program("list resins --json").out));
}

TEST_CASE("help is a verb, -o= is -o, and an option is no value of another") {
    const Outcome help = run_program("help slice");
    CHECK(help.exit_code == 0);
    CHECK(help.out == run_program("slice --help").out);
    CHECK(run_program("help calibrate photo").out == run_program("calibrate photo --help").out);
    CHECK(run_program("help").exit_code == 0);
    refused("help cows", 2, "'cows' is no verb");
    refused("slice model.obj -o --json", 2, "-o: its value is missing, for '--json' is an option");
    const Folder folder("short");
    folder.write("marker.obj", marker_obj());
    CHECK(
        run_program("slice --quiet --iterations 0 --no-report " + (folder / "marker.obj") + " -o=" + (folder / "-out"))
            .exit_code == 0);
    CHECK(std::filesystem::exists(folder / "-out/manifest.json"));
}

TEST_CASE("A decimal comma and a missing unit are explained") {
    refused("slice model.obj -o out --size 10,5mm", 2, "write 10.5mm");
    refused("slice model.obj -o out --scale 0,5", 2, "decimals stand behind a point: 0.5");
    refused("predict out -o x.png --cell 0,2mm", 2, "write 0.2mm");
    refused("laminate print 'W 0,5' -o out", 2, "decimals stand behind a point");
    refused("predict out -o x.png --error 0,1", 2, "decimals stand behind a point: 0.1");
    refused("predict layers -o x.png --pitch 42.33,84.67,27", 2, "add um");
    // "12 mm" is two words, and the second would be a model.
    refused("slice spot.obj --size 12 mm -o out", 2, "'mm' is a unit and no model");
    refused("slice spot.obj out", 2, "there is no model 'out'; if it is the folder for the print, write -o out");
    refused("slice spot.obj --matte -o out", 2, "is set at the printer");
}

TEST_CASE("Sizes beyond every printer and below every voxel are refused in a sentence") {
    const Folder folder("sizes");
    folder.write("marker.obj", marker_obj());
    const std::string mesh = "slice --quiet " + (folder / "marker.obj") + " -o " + (folder / "out");
    for (const char* size : {"--size 200m", "--size 1e30", "--scale 1e30", "--size 1e9mm", "--unit m --scale 1e9"})
        refused(fmt::format("{} {}", mesh, size), 3, "too large along x");
    for (const char* size : {"--size 0.01mm", "--scale 1e-30", "--size 1um"})
        refused(fmt::format("{} {}", mesh, size), 3, "less than one voxel");
    refused(mesh + " --scale 1e300 --unit m", 3, "the model is");
    const std::string picture =
        "slice --quiet " + source_dir() + "/examples/models/spot/spot_texture.png -o " + (folder / "out");
    refused(picture + " --width 1e7mm", 3, "Give another --width");
    refused(picture + " --width 0.01mm", 3, "less than one voxel");
    CHECK_FALSE(std::filesystem::exists(folder / "out"));
    // A few voxels have no surface of cells to draw, and no other fault.
    folder.write("lenient.json", lenient_printer());
    CHECK(run_program(mesh + " --printer " + (folder / "lenient.json") + " --size 0.1mm").exit_code == 0);
}

TEST_CASE("An option that would be ignored is refused") {
    const Folder folder("scope");
    folder.write("marker.obj", marker_obj());
    const std::string mesh = "slice " + (folder / "marker.obj") + " -o " + (folder / "out") + " ";
    for (const char* option : {"--width 10mm", "--thickness 4mm", "--backing black"})
        refused(mesh + option, 2, "would be ignored: ");
    // What a file is counts before what an option would do to it.
    for (const char* verb : {"slice model.dae -o out", "estimate model.dae"})
        for (const char* options : {"", " --size 10mm", " --width 10mm", " --unit cm"})
            refused(verb + std::string(options), 3, "model.dae is a Collada scene");
    refused("slice model.unheard -o out --size 10mm", 3, "model.unheard has no name of a model (.obj, .ply");
    refused("slice photo.png -o out --unit cm", 2, "--unit cm would be ignored");
    refused(mesh + "--size 10mm --scale 2", 2, "--scale 2 would be ignored");
    refused(mesh + "--laminate-steps 64", 2, "only goes with --show layered-profile");
    refused(mesh + "--iterations 0 --intent relative", 2, "--intent relative would be ignored");
    refused(mesh + "--no-report --predict transport", 2, "--predict transport would be ignored");
    refused(mesh + "--iterations 0 --predict none --predict-cell 1mm", 2, "neither a loop nor a prediction");
    refused(mesh + "--show layered-profile --profiles x.json --depth 1mm", 2, "only goes with --show colour");
    refused("predict out -o x.png --predict monte-carlo --sweeps 3", 2, "only goes with --predict transport");
    refused("predict out -o x.png --spp 64", 2, "only goes with --predict monte-carlo");
    CHECK_FALSE(std::filesystem::exists(folder / "out"));
    // A job file is looked at likewise, unless the command line changes what its options are for.
    folder.write("job.json", R"({"format": "voxtone-job", "version": 1, "model": "marker.obj", "iterations": "0",
        "intent": "contrast", "report": false})");
    refused("slice --job " + (folder / "job.json") + " -o " + (folder / "out"), 2, "--intent contrast");
    CHECK(run_program("slice --quiet --iterations 0 --job " + (folder / "job.json") + " -o " + (folder / "out"))
              .exit_code == 0);
}

TEST_CASE("With --json every failure is an event that carries the exit code") {
    const Folder folder("events");
    folder.write("empty.obj", "");
    folder.write("job.json", "{");
    for (const std::string& arguments :
         {std::string("slcie --json"), std::string("slice --json --sise 3"), std::string("predict --json"),
          std::string("slice --json x.obj -o out --size 1,5mm"), std::string("list --json cows"),
          "slice --json " + (folder / "nothing.obj") + " -o " + (folder / "out"),
          "slice --json " + (folder / "empty.obj") + " -o " + (folder / "out"),
          "slice --json --job " + (folder / "job.json"), "verify --json " + (folder / "nothing"),
          std::string("predict --json nothing -o x.png --cell 9mm"), std::string("calibrate --json"),
          std::string("calibrate photo --json"), std::string("laminate print --json --depth")}) {
        INFO(arguments);
        const Outcome outcome = run_program(arguments);
        CHECK(outcome.exit_code > 1);
        const auto event = last_event(outcome.out);
        CHECK(event.at("event") == "error");
        CHECK(event.at("exit_code") == outcome.exit_code);
        CHECK(outcome.err == "voxtone: " + event.at("message").get<std::string>() + "\n");
    }
    CHECK(run_program("slice --sise 3").out.empty());
}

TEST_CASE("A stdout that takes nothing is noticed") {
    const Folder folder("full");
    const auto run_into_full = [&](const std::string& arguments) {
        return run_shell(program() + " " + arguments + " >/dev/full 2>'" + (folder / "err") + "'");
    };
    if (!std::filesystem::exists("/dev/full")) {
        skip("/dev/full is not here");
        return;
    }
    for (const char* arguments :
         {"list printers", "list resins --json", "slice --dump-default", "slice --help-all", "--version"}) {
        INFO(arguments);
        CHECK(run_into_full(arguments) == 75);
        CHECK_THAT(read_file(folder / "err"), Contains("stdout could not be written"));
    }
    CHECK(run_into_full("slcie --json") == 2);
}

TEST_CASE("A print does not depend on who reads what is said of it") {
    const Folder folder("pipe");
    const std::string out = folder / "out", model = folder / "cube.obj";
    std::ofstream(model) << "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
                            "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    // The reader is gone before the first word.
    run_shell(fmt::format(
        "{{ sleep 0.2; '{}' slice --json --quality draft --no-report '{}' -o '{}' 2>'{}'; echo $? >'{}'; }} | true",
        program(), model, out, folder / "err", folder / "code"));
    CHECK(read_file(folder / "code") == "75\n");
    CHECK_THAT(read_file(folder / "err"), Contains("stdout could not be written"));
    CHECK(run_program("verify --quiet '" + out + "'").exit_code == 0);
}

TEST_CASE("Bytes of the user move no cursor") {
    for (const char* arguments :
         {"slice \"$(printf 'a\\033[31m.obj')\" -o out", "\"$(printf 's\\033[2Jlice')\"",
          "slice --printer \"$(printf 'p\\033[31m')\" a.obj -o out", "verify \"$(printf '\\033]0;x')\""}) {
        const Outcome outcome = run_program(arguments);
        INFO(outcome.err);
        CHECK(outcome.exit_code > 1);
        CHECK_THAT(outcome.err, Contains("?") && !Contains("\033"));
    }
}

TEST_CASE("What is in files is told in the time of reading them, all of them whatever is wrong with one") {
    const Folder folder("read");
    folder.write("marker.obj", marker_obj());
    folder.write("empty.obj", "");
    const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png",
                      cow = source_dir() + "/examples/models/spot/spot.obj";
    const Outcome told = run_program(
        fmt::format("read --json {} {} {} {} --width 30mm", folder / "marker.obj", picture, folder / "empty.obj", cow));
    INFO(told.out << told.err);
    CHECK(told.exit_code == 3);
    const nlohmann::json contents = last_event(told.out).at("result");
    CHECK(voxtone::io::schema_faults("contents", contents.dump()) == std::vector<std::string>{});
    const nlohmann::json& files = contents.at("files");
    REQUIRE(files.size() == 4);
    CHECK(files[0]["format"] == "OBJ");
    CHECK(files[0]["unit"]["is"] == "assumed");
    CHECK(files[0]["parts"] == 2);  // boxes that do not touch
    CHECK(files[1]["format"] == "picture");
    CHECK(files[1]["size_mm"][0] == 30);
    CHECK(files[1]["colour"] == nlohmann::json({"picture"}));
    CHECK_THAT(files[2]["error"].get<std::string>(), Contains("empty.obj"));
    CHECK(files[3]["triangles"] == 5856);
    CHECK(files[3]["textures"].size() == 1);
    CHECK(files[3]["materials"].size() == 1);
    CHECK(files[3]["beside"].size() == 2);
    // What slice would say and refuse, and as text.
    const Outcome text = run_program("read " + cow + " --size 3m");
    CHECK(text.exit_code == 0);
    CHECK_THAT(text.out, Contains("OBJ") && Contains("5856 triangles") && Contains("texture 1024 x 1024 px") &&
                             Contains("would be refused: ") && Contains("stands on its y axis"));
    CHECK_THAT(run_program("read --quiet " + cow + " --size 1mm").out, Contains("[tiny]"));
    CHECK_THAT(run_program("read " + picture).out, Contains("1024 x 1024 px of 72 dpi"));
    CHECK_THAT(run_program("read " + picture + " --height 12mm").out, Contains("12 x 12 x 4 mm"));
    refused("read", 2, "model");
    // Walls are looked for in the repaired body.
    folder.write("plate.obj", ramp_box_obj(12, 0.4, 10));
    const auto told_of_plate = [&](const std::string& options) {
        const Outcome outcome = run_program("estimate --quick " + options + (folder / "plate.obj"));
        CHECK(outcome.exit_code == 0);
        return outcome.out + outcome.err;
    };
    CHECK_THAT(told_of_plate(""), Contains("0.4 mm over") && Contains("[fragile]"));
    CHECK_THAT(told_of_plate("--printer generic "), !Contains("[fragile]"));
    refused("read " + (folder / "nothing.obj"), 4, "");
}

TEST_CASE("A model is seen before anything is done with it") {
    const Folder folder("seen");
    const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png",
                      cow = source_dir() + "/examples/models/spot/spot.obj";
    struct Seen {
        double width_px, height_px, share;
    };
    const auto drawn = [&](const std::string& arguments) {
        const Outcome outcome = run_program("read --quiet " + arguments + " --picture " + (folder / "seen.png"));
        INFO(outcome.err);
        CHECK(outcome.exit_code == 0);
        const auto texels = voxtone::io::read_picture_with_alpha(folder / "seen.png").texels;
        double covered = 0;
        for (std::size_t at = 3; at < texels.srgb8.size(); at += 4) covered += texels.srgb8[at] / 255.0;
        return Seen{double(texels.width_px), double(texels.height_px), covered / double(texels.pixels())};
    };
    const Seen body = drawn(cow);  // from three sides
    CHECK(body.width_px <= 720);
    CHECK(body.width_px > 2 * body.height_px);
    CHECK(body.share > 0.3);
    CHECK(body.share < 0.7);
    const std::string again = fmt::format("read {} --picture {}", cow, folder / "seen.png");
    CHECK_THAT(run_program(again).err, Contains("--overwrite"));
    const Seen slab = drawn(picture + " --overwrite --picture-width 200");
    CHECK(slab.width_px <= 200);
    CHECK(slab.width_px > 195);
    CHECK(slab.share > 0.85);
    refused(fmt::format("read {} {} --picture {}", cow, picture, folder / "two.png"), 2, "one file");
    refused(fmt::format("read {} --picture {}", cow, folder / "seen.jpg"), 2, "PNG");
    folder.write("empty.obj", "");
    CHECK(run_program(fmt::format("read {} --picture {}", folder / "empty.obj", folder / "none.png")).exit_code == 3);
    CHECK(!std::filesystem::exists(folder / "none.png"));
}

TEST_CASE("A quiet job that is done says nothing, and leaves a typed report and a page for the customer") {
    const Folder folder("quiet");
    folder.write("marker.obj", marker_obj());
    folder.write("ramp.obj", ramp_box_obj(4, 4, 4));
    const std::string slice = "slice --quiet --quality draft " + (folder / "ramp.obj") + " -o ";
    const auto is_silent = [](const std::string& words) {
        const Outcome outcome = run_program(words);
        INFO(words << "\n" << outcome.out << outcome.err);
        return outcome.exit_code == 0 && outcome.out.empty() && outcome.err.empty();
    };
    CHECK(is_silent(slice + (folder / "out")));
    CHECK(is_silent(slice + (folder / "out")));  // done before
    CHECK(is_silent("verify --quiet " + (folder / "out")));
    const Outcome lost = run_program("verify --quiet " + (folder / "none"));
    CHECK((lost.exit_code != 0 && lost.out.empty() && !lost.err.empty()));
    CHECK_THAT(run_program("estimate --quiet --quick " + (folder / "marker.obj")).out, Contains("ml"));
    // The report has the job's options as its job file has them.
    const auto report = nlohmann::json::parse(read_file(folder / "out/report.json")).at("job");
    CHECK(report.at("overwrite") == false);
    CHECK(report.at("threads") == 0);
    CHECK(report.at("depth") == "1mm");
    CHECK(report.at("load").is_array());
    // What is for the customer shows a draft for what it is, and holds no scripts or voxels.
    const std::string page = read_file(folder / "out/for-customer.html");
    CHECK_THAT(page, Contains("ramp.obj") && Contains("As you asked for it") && Contains("colours that are in reach"));
    CHECK_THAT(page, !Contains("As the print will look") && !Contains("<script"));
    const auto dump = nlohmann::json::parse(run_program("tray --dump-default --gap 3mm").out);
    CHECK(dump.at("gap") == "3mm");
    CHECK(dump.at("format") == "voxtone-job");
}
