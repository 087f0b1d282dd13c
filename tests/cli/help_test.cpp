// SPDX-License-Identifier: GPL-3.0-or-later
//
// --help, the manual and the shells' completion are made from one table of options.
#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

/// The program itself and families of verbs, which show one of theirs, included.
const std::vector<std::string> every_command{"",
                                             "slice",
                                             "tray",
                                             "estimate",
                                             "batch",
                                             "status",
                                             "serve",
                                             "task",
                                             "predict",
                                             "proof",
                                             "compare",
                                             "verify",
                                             "target",
                                             "target marker",
                                             "list",
                                             "laminate",
                                             "laminate dataset",
                                             "laminate factor",
                                             "laminate predict",
                                             "laminate print",
                                             "laminate search",
                                             "laminate targets",
                                             "calibrate",
                                             "calibrate chart",
                                             "calibrate check",
                                             "calibrate edge",
                                             "calibrate edge chart",
                                             "calibrate edge dictionary",
                                             "calibrate edge fit",
                                             "calibrate edge photo",
                                             "calibrate edge samples",
                                             "calibrate edge simulate",
                                             "calibrate fit",
                                             "calibrate icc",
                                             "calibrate photo",
                                             "calibrate profile",
                                             "calibrate simulate",
                                             "calibrate simulate-profile",
                                             "calibrate target"};

/// "--size" and so on, as they begin the lines of a help text.
std::vector<std::string> option_words(const std::string& help) {
    std::vector<std::string> words;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("  -")) {
            const std::size_t begin = line.find("--");
            words.push_back(line.substr(begin, line.find_first_of(", \n", begin) - begin));
        }
    return words;
}

std::string without_roff(std::string text) {
    for (std::size_t i = text.find("\\-"); i != std::string::npos; i = text.find("\\-", i)) text.erase(i, 1);
    return text;
}

}  // namespace

TEST_CASE("Every help says in words what its options are, and ends with a command line that parses") {
    const Folder empty("example");
    for (const std::string& command : every_command) {
        INFO(command);
        const std::string help = run_program(command + " --help").out;
        for (const char* raw : {"{false}", "{true}", "REQUIRED", "INT", "UINT", ":FILE"})
            CHECK_THAT(help, !Contains(raw));
        const std::string mark = "Example:\n  voxtone ";
        const std::size_t begin = help.find(mark);
        REQUIRE(begin != std::string::npos);
        const std::string line =
            help.substr(begin + mark.size(), help.find('\n', begin + mark.size()) - begin - mark.size());
        CHECK(line.starts_with(command.empty() ? "slice " : command + " "));
        if (command == "list" || command == "serve" || command.starts_with("laminate dataset") ||
            command == "calibrate simulate-profile" || command == "calibrate edge samples" ||
            command == "calibrate edge chart" || command == "calibrate target" || command == "calibrate chart" ||
            command == "laminate predict" || command == "laminate targets" || command == "laminate print" ||
            command.starts_with("target"))
            continue;  // these would do their work
        const int code =
            run_shell("cd '" + empty.path().string() + "' && " + program() + " " + line + " >/dev/null 2>&1");
        CHECK(code != 2);
        CHECK(code > 0);  // the files are not there
    }
}

TEST_CASE("Options that few need are behind --help-all") {
    const std::string help = run_program("slice --help").out, all = run_program("slice --help-all").out;
    CHECK_THAT(help, !Contains("--laminate-blocks") && Contains("slice --help-all") && Contains("Layered profiles"));
    CHECK_THAT(all, Contains("--laminate-blocks") && Contains("--size"));
    CHECK_THAT(run_program("--help-all").out, Contains("voxtone laminate search") && Contains("--max-blocks"));
}

TEST_CASE("The options as JSON are all that --help-all tells of") {
    const std::string text = run_program("--help-json").out;
    CHECK(voxtone::io::schema_faults("options", text) == std::vector<std::string>{});
    const auto told = nlohmann::json::parse(text);
    const auto named = [](const nlohmann::json& list, const std::string& name) {
        for (const auto& entry : list)
            if (entry.at("name") == name) return entry;
        return nlohmann::json();
    };
    for (const std::string& command : every_command) {
        if (command.empty()) continue;
        INFO(command);
        std::istringstream words(command);
        nlohmann::json verb{{"steps", told.at("verbs")}};
        for (std::string word; words >> word;) verb = named(verb.at("steps"), word);
        REQUIRE(verb.is_object());
        if (!verb.at("steps").empty()) continue;
        std::vector<std::string> lacking;
        for (const std::string& option : option_words(run_program(command + " --help-all").out))
            if (option != "--help" && option != "--help-all" &&
                !named(verb.at("options"), option.substr(2)).is_object())
                lacking.push_back(option);
        CHECK(lacking == std::vector<std::string>{});
    }
    const nlohmann::json slice = named(told.at("verbs"), "slice").at("options");
    CHECK(named(slice, "report").at("can_be_turned_off") == true);
    CHECK(named(slice, "quality").at("choices") == nlohmann::json({"draft", "good", "best"}));
    CHECK(named(slice, "size").at("value") == "LENGTH");
    CHECK(named(slice, "size").at("flag") == false);
}

TEST_CASE("The licences that are printed name every library that is linked") {
    if (!is_here("readelf")) {
        skip("readelf is not here");
        return;
    }
    const auto table = nlohmann::json::parse(read_file(source_dir() + "/data/licences.json"));
    const std::string text = run_program("--licences").out;
    std::vector<std::string> sonames;
    for (const auto& library : table.at("libraries")) {
        CHECK_THAT(text, Contains(library.at("name").get<std::string>()) &&
                             Contains(library.at("licence").get<std::string>()));
        for (const std::string& soname : library.value("sonames", std::vector<std::string>{}))
            sonames.push_back(soname);
    }
    const Folder folder("linked");
    REQUIRE(run_shell("for file in '" + build_dir() +
                      "'/bin/voxtone*; do readelf -d \"$file\"; done | "
                      "sed -n 's/.*NEEDED.*\\[\\(.*\\.so\\).*\\]/\\1/p' | sort -u >'" +
                      (folder / "list") + "'") == 0);
    std::istringstream linked(read_file(folder / "list"));
    std::size_t count = 0;
    for (std::string library; std::getline(linked, library); ++count) {
        INFO(library << " stands in no entry of data/licences.json");
        CHECK((std::ranges::find(sonames, library) != sonames.end() || library.find("san.so") != std::string::npos));
    }
    CHECK(count > 20);
}

TEST_CASE("list printers shows what refuses jobs") {
    const std::string text = run_program("list printers").out;
    CHECK_THAT(text, Contains("tray 490 x 390 x 200 mm") && Contains("no fewer than 30 layers") &&
                         Contains("6 resins at once") && Contains("3 resins at once"));
}

TEST_CASE("list shows which sets are of the cartridges that a printer takes") {
    CHECK_THAT(run_program("list printers").out,
               Contains("takes Vero Vivid cartridges: resin sets j750-vivid, j750-vivid-clear\n") &&
                   Contains("takes Vero opaque cartridges: resin sets j750-opaque, vero-opaque, vero-opaque-clear\n"));
    CHECK_THAT(run_program("list resins").out,
               Contains("Vero Vivid cartridges, which stratasys-j55, stratasys-j750-hm") &&
                   Contains("C   VeroCyanV, cartridge VeroCY-V\n") && Contains("K   VeroBlack\n"));
    CHECK_THAT(run_program("list resins --json").out,
               Contains("\"family\":\"Vero Vivid\"") || Contains("\"family\": \"Vero Vivid\""));
}

TEST_CASE("Roles are understood in any case") {
    const Folder folder("roles");
    folder.write("marker.obj", marker_obj());
    const auto slice = [&](const std::string& options, const std::string& out) {
        const Outcome outcome = run_program("slice --quiet --no-report --iterations 0 --layers 0-9 " +
                                            (folder / "marker.obj") + " " + options + " -o " + (folder / out));
        INFO(outcome.err);
        CHECK(outcome.exit_code == 0);
    };
    slice("--load C,M,Y,K,W --core W", "upper");
    slice("--load c,m,y,k,w --core w", "lower");
    CHECK(read_tree(std::filesystem::path(folder / "upper") / "layers") ==
          read_tree(std::filesystem::path(folder / "lower") / "layers"));
    CHECK(read_file(folder / "upper/manifest.json") == read_file(folder / "lower/manifest.json"));
    CHECK(run_program("slice --load c,C " + (folder / "marker.obj") + " -o " + (folder / "twice")).exit_code == 3);
}

TEST_CASE("The summary names the report and the time of the whole job") {
    const Folder folder("summary");
    folder.write("marker.obj", marker_obj());
    const Outcome outcome =
        run_program("slice --iterations 0 --predict none " + (folder / "marker.obj") + " -o " + (folder / "out"));
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(outcome.out, Contains("report: " + (folder / "out/report.html")) && Contains("done in "));
}

TEST_CASE("Manual pages hold every option, and man finds nothing wrong with them") {
    const Folder folder("manual");
    REQUIRE(run_program("manual " + folder.path().string()).exit_code == 0);
    CHECK(read_tree(folder.path()).size() == 18);
    for (const std::string verb : {"slice", "tray", "estimate", "merge", "batch", "status", "serve", "task", "predict",
                                   "proof", "compare", "verify", "target", "list", "laminate", "calibrate"}) {
        const std::string page = without_roff(read_file(folder / ("voxtone-" + verb + ".1")));
        const std::vector<std::string> options = option_words(run_program(verb + " --help-all").out);
        CHECK(options.size() >= (verb == "status" ? 2u : 3u));
        for (const std::string& option : options) CHECK_THAT(page, Contains(option));
    }
    if (!is_here("man")) {
        skip("man is not here");
        return;
    }
    for (const auto& [name, text] : read_tree(folder.path())) {
        INFO(name);
        const std::string page = folder / name, told = folder / "told";
        CHECK(run_shell("LC_ALL=C.UTF-8 MANROFFSEQ= man --warnings -E UTF-8 -l -Tutf8 -Z '" + page +
                        "' >/dev/null 2>'" + told + "'") == 0);
        CHECK(read_file(told).empty());
    }
}

TEST_CASE("The program says what may stand next") {
    const auto words = [](const std::string& line) { return run_program("complete " + line).out; };
    CHECK(words("sl") == "slice\n");
    CHECK(words("laminate se") == "search\n");
    CHECK(words("calibrate phot") == "photo\n");
    CHECK(words("slice --thr") == "--threads\n");
    CHECK(words("slice --intent ''") == "relative\nabsolute\ncontrast\n");
    CHECK(words("slice --printer stratasys-j5") == "stratasys-j55\n");
    CHECK(words("slice --intent=con") == "contrast\n");
    CHECK(words("slice --intent=") == words("slice --intent ''"));
    CHECK(words("slice --intent = con") == "contrast\n");
    CHECK(words("slice --intent =") == words("slice --intent ''"));
    CHECK(words("slice --texture=sp").empty());
    CHECK(words("slice --no-report=").empty());
    CHECK_THAT(words("predict --resins ''"), Contains("vero-opaque\n"));
    CHECK(words("list ''") == "printers\nresins\n");
    CHECK(words("slice co").empty());  // files
    CHECK(words("slice --size ''").empty());
}

TEST_CASE("bash completes with it") {
    if (!is_here("bash")) {
        skip("bash is not here");
        return;
    }
    const std::string script = source_dir() + "/data/completion/voxtone.bash";
    CHECK(run_shell("bash -n '" + script + "'") == 0);
    const Folder folder("bash");
    folder.write("try.sh", "source '" + script + "'\nCOMP_WORDS=('" + program() +
                               "' slice --pri)\nCOMP_CWORD=2\n_voxtone\n"
                               "echo \"${COMPREPLY[*]}\"\ncomplete -p voxtone\n");
    REQUIRE(run_shell("bash '" + (folder / "try.sh") + "' >'" + (folder / "out") + "'") == 0);
    CHECK_THAT(read_file(folder / "out"), Contains("--printer\n") && Contains("-F _voxtone voxtone"));
}

TEST_CASE("zsh completes verbs, options, values and files with it") {
    if (!is_here("zsh")) {
        skip("zsh is not here");
        return;
    }
    const Folder folder("zsh");
    folder.write("spot.obj", "");
    folder.write("my model.obj", "");
    const std::vector<std::array<const char*, 2>> lines{
        {"voxtone sl", "voxtone slice "},
        {"voxtone calibrate phot", "voxtone calibrate photo "},
        {"voxtone slice --pri", "voxtone slice --printer "},
        {"voxtone slice --printer stratasys-j5", "voxtone slice --printer stratasys-j55 "},
        {"voxtone slice --intent con", "voxtone slice --intent contrast "},
        {"voxtone slice --intent=con", "voxtone slice --intent=contrast "},
        {"voxtone list pri", "voxtone list printers "},
        {"voxtone slice sp", "voxtone slice spot.obj "},
        {"voxtone slice my", "voxtone slice my\\ model.obj "},
        {"voxtone slice a.glb --texture=sp", "voxtone slice a.glb --texture=spot.obj "},
        {"voxtone slice --nothing-like-it", "voxtone slice --nothing-like-it"}};
    std::string command = "cd '" + folder.path().string() + "' && timeout 60 zsh '" + source_dir() +
                          "/tests/cli/complete.zsh' '" + source_dir() + "/data/completion' '" +
                          std::filesystem::path(program()).parent_path().string() + "'";
    std::string wanted;
    for (const auto& [typed, completed] : lines) {
        command += std::string(" '") + typed + "'";
        wanted += std::string(completed) + "\n";
    }
    REQUIRE(run_shell(command + " >out") == 0);
    CHECK(read_file(folder / "out") == wanted);
}
