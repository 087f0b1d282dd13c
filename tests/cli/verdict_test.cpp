// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <tuple>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/lettering/make_code.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/colour.h"
#include "run_program.h"
#include "tests/io/files/schema.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

nlohmann::json report_in(const Folder& folder) {
    return nlohmann::json::parse(read_file(folder.path() / "out/report.json"));
}

std::string white_box() { return std::regex_replace(ramp_box_obj(5, 4, 4), std::regex("(0 0.5 0|0.6 0 0)\n"), "\n"); }

std::string pale_box() {
    return std::regex_replace(std::regex_replace(ramp_box_obj(6, 4, 5), std::regex("0.6 0 0\n"), "0.92 0.89 0.88\n"),
                              std::regex("0 0.5 0\n"), "0.88 0.9 0.92\n");
}

bool has_stage(const nlohmann::json& report, const std::string& name) {
    return std::any_of(report["stages"].begin(), report["stages"].end(),
                       [&](const auto& s) { return s["name"] == name; });
}

}  // namespace

TEST_CASE("White everywhere needs no loop and no prediction, and looks as asked") {
    const Folder folder("white");
    folder.write("white.obj", white_box());
    const std::string slice = "slice --overwrite " + folder / "white.obj" + " -o " + folder / "out";
    const Outcome quick = run_program(slice);
    REQUIRE(quick.exit_code == 0);
    CHECK_THAT(quick.out, Contains("nothing to rearrange and nothing to predict"));
    const auto report = report_in(folder);
    CHECK(report["verdict"]["level"] == "good");
    CHECK_FALSE(report.contains("loop"));
    CHECK_FALSE(has_stage(report, "predict"));
    CHECK_THAT(read_file(folder.path() / "out/report.html"), Contains("Will it look as asked?"));
    CHECK_THAT(read_file(folder.path() / "out/for-customer.html"),
               Contains("<p class=\"verdict good\">It will look as asked: white everywhere</p>"));
    // What is asked for is done all the same.
    REQUIRE(run_program(slice + " --iterations 1 --predict transport").exit_code == 0);
    const auto asked = report_in(folder);
    CHECK(asked["loop"]["iterations"].size() == 2);
    CHECK(has_stage(asked, "predict"));
    CHECK(asked["verdict"]["level"] == "good");
    CHECK(double(asked["verdict"]["seen_de2000"]["mean"]) < 0.1);
}

TEST_CASE("A model that lost its colours is never said to look as asked") {
    const Folder folder("lost");
    folder.write("box.obj", "mtllib gone.mtl\nusemtl painted\n" + white_box());
    const std::string slice = "slice --overwrite " + folder / "box.obj" + " -o " + folder / "out";
    const Outcome printed = run_program(slice);
    REQUIRE(printed.exit_code == 0);
    CHECK_THAT(printed.out, Contains("It will not look as asked. The material library 'gone.mtl'"));
    const auto verdict = report_in(folder)["verdict"];
    CHECK(verdict["level"] == "bad");
    CHECK(verdict["headline"] == "It will not look as asked");
    CHECK_THAT(verdict["worst"].get<std::string>(), Contains("gone.mtl"));  // that a tray's table says, too
    CHECK(run_program(slice + " --strict").exit_code == 3);
}

TEST_CASE("A thin wall gets its word, limits are the user's, and --strict makes them count") {
    const Folder folder("thin");
    folder.write("plate.obj", ramp_box_obj(6, 0.5, 5));
    const std::string slice = "slice --overwrite --iterations 0 " + folder / "plate.obj" + " -o " + folder / "out ";
    const Outcome plain = run_program(slice);
    REQUIRE(plain.exit_code == 0);
    const auto verdict = report_in(folder)["verdict"];
    INFO(verdict.dump(1));
    CHECK(verdict["level"] == "bad");
    CHECK(io::schema_faults("report", read_file(folder.path() / "out/report.json")).empty());
    CHECK(verdict["causes"][0]["cause"] == "thin walls");
    const std::string sentence = verdict["sentence"];
    CHECK_THAT(sentence, Contains("will not look as asked") && Contains("thin walls (0.5 mm)") && Contains("Try: "));
    CHECK_THAT(plain.out, Contains(sentence));
    std::string page = read_file(folder.path() / "out/report.html");
    CHECK_THAT(page, Contains("thin walls"));
    CHECK_THAT(read_file(folder.path() / "out/printer/HOW-TO-PRINT.html"),
               Contains("<b>Wash with care.</b> plate.obj: walls under 0.6 mm"));
    // The stack is there and whole.
    CHECK(run_program(slice + "--strict").exit_code == 6);
    CHECK(run_program("verify " + folder / "out").exit_code == 0);
    // Nor does who asks again have to guess why.
    const Outcome again =
        run_program("slice --iterations 0 --strict " + folder / "plate.obj" + " -o " + folder / "out");
    CHECK(again.exit_code == 6);
    CHECK_THAT(again.out, Contains("nothing was done") && Contains(sentence));
    CHECK(run_program(slice + "--strict --verdict-bad 90").exit_code == 0);
    CHECK(report_in(folder)["verdict"]["level"] == "fair");
    CHECK(run_program(slice + "--strict --verdict-good 80 --verdict-bad 90").exit_code == 0);
    CHECK(run_program(slice + "--verdict-good 6").exit_code == 2);
}

TEST_CASE("Whoever lacks a resin is told which, and what it would bring, whoever has all is not sent for more") {
    const Folder folder("reach");
    io::Picture8 red{30, 30, 3, {}};
    for (int i = 0; i < 30 * 30; ++i) red.codes.insert(red.codes.end(), {255, 0, 0});
    const std::vector<std::uint8_t> png = io::png_bytes(red);
    folder.write("red.png", std::string(png.begin(), png.end()));
    for (const auto& [load, helps] : {std::pair("W,M", true), std::pair("C,M,Y,K,W", false)}) {
        CAPTURE(load);
        REQUIRE(run_program("slice --quiet --overwrite --iterations 0 --predict transport " + folder / "red.png" +
                            " --width 3mm --thickness 2mm --resins vero-opaque --load " + load + " -o " +
                            folder / "out")
                    .exit_code == 0);
        const auto advice = report_in(folder)["verdict"]["advice"];
        INFO(advice.dump(1));
        const bool loads =
            std::any_of(advice.begin(), advice.end(), [](const auto& a) { return a["options"] == "--load W,M,Y"; });
        CHECK(loads == helps);
        CHECK_THAT(read_file(folder.path() / "out/report.html"), !Contains("load more resins"));
    }
}

TEST_CASE("Of a white sheet it is said that its red is orange and that its fine type cannot be read") {
    const Folder folder("sheet");
    // 10 x 6 mm at 0.1 mm: a red square of 2 mm in a corner, and lines of 0.1 mm, 0.2 mm apart.
    io::Picture8 sheet{100, 60, 3, {}};
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 100; ++x) {
            const bool red = x >= 70 && x < 90 && y >= 10 && y < 30,
                       ink = x >= 10 && x < 50 && y >= 20 && y < 50 && x % 3 < 1;
            for (int c = 0; c < 3; ++c) sheet.codes.push_back(ink || (red && c > 0) ? 0 : 255);
        }
    const std::vector<std::uint8_t> png = io::png_bytes(sheet);
    folder.write("sheet.png", std::string(png.begin(), png.end()));
    REQUIRE(run_program("slice --quiet --overwrite --iterations 1 " + folder / "sheet.png" +
                        " --width 10mm --thickness 2mm --resins vero-opaque -o " + folder / "out")
                .exit_code == 0);
    const auto verdict = report_in(folder)["verdict"];
    INFO(verdict.dump(1));
    CHECK(verdict["seen_de2000"]["mean"] < 5);
    CHECK(verdict["level"] == "fair");
    CHECK(io::schema_faults("report", read_file(folder.path() / "out/report.json")).empty());
    const auto& regions = verdict["regions"];
    const auto of = [&](const std::string& kind) {
        return *std::find_if(regions.begin(), regions.end(), [&](const auto& r) { return r["kind"] == kind; });
    };
    CHECK(of("solid")["asked"] == "red (255, 0, 0)");
    CHECK_FALSE(of("solid")["good"].get<bool>());
    CHECK(of("paper")["asked"] == "white (255, 255, 255)");
    // Lines of 0.1 mm are no letters of 3 mm, but are lost as much.
    CHECK_THAT(of("fine detail")["why"].get<std::string>(), Contains("runs together"));
    CHECK_FALSE(of("fine detail")["good"].get<bool>());
    CHECK(double(of("fine detail")["contrast"]) < 0.6);
    // A figure that a kind is not judged by is none, and not 0.
    CHECK((of("solid").contains("de2000") && of("solid").contains("rim")));
    CHECK_FALSE(of("paper").contains("rim"));
    CHECK(double(of("paper")["unevenness"]) < 2);
    CHECK_THAT(read_file(folder.path() / "out/report.html"), Contains("<td>–</td>"));
    // "White is printed as white, 7 off" was said of paper with a tint that is brighter than white.
    for (const auto& region : regions)
        if (region.contains("de2000") && double(region["de2000"]) > 5) CHECK(region["printed"] != region["asked"]);
    const std::string sentence = verdict["sentence"];
    CHECK_THAT(sentence, Contains(regions[0]["why"].get<std::string>()));
    CHECK_THAT(read_file(folder.path() / "out/report.html"), Contains("Solids, type, texture and paper"));
    CHECK_THAT(read_file(folder.path() / "out/report.html"), Contains("show me</button>"));
}

namespace {

void write_sheet(const Folder& folder, const std::string& name, int width, int height,
                 const std::function<std::array<int, 3>(int x, int y)>& paint) {
    io::Picture8 sheet{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 3, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int code : paint(x, y)) sheet.codes.push_back(static_cast<std::uint8_t>(code));
    const std::vector<std::uint8_t> png = io::png_bytes(sheet);
    folder.write(name, std::string(png.begin(), png.end()));
}

/// Each time anew: files of the same name may have changed.
nlohmann::json verdict_of(const Folder& folder, const std::string& arguments) {
    const Outcome outcome = run_program("slice --quiet --overwrite " + arguments + " -o " + folder / "out");
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return report_in(folder);
}

/// The advice with these words in its options; null where there is none.
nlohmann::json advised(const nlohmann::json& report, const std::string& options) {
    for (const auto& advice : report["verdict"]["advice"])
        if (advice["options"].get<std::string>().find(options) != std::string::npos) return advice;
    return {};
}

double seen(const nlohmann::json& report) { return report["verdict"]["seen_de2000"]["mean"]; }

}  // namespace

namespace {

/// Made once for each command, of files that stay as they are.
const nlohmann::json& kept_verdict_of(const Folder& folder, const std::string& arguments) {
    static std::map<std::string, nlohmann::json> kept;
    const std::string key = std::regex_replace(arguments, std::regex(" +"), " ");
    const auto [at, is_new] = kept.try_emplace(key);
    if (is_new) at->second = verdict_of(folder, arguments);
    return at->second;
}

/// A command with options in it, each once: `more` in the place of those of the same name.
std::string with_options(std::string command, const std::string& more) {
    const std::string name = more.substr(0, more.find(' '));
    if (const std::size_t at = command.find(name + " "); at != std::string::npos)
        command.erase(at, command.find(' ', at + name.size() + 1) - at);
    return command + " " + more;
}

/// Does what each advice says and looks whether it comes to what was said. How many there were.
int follow(const Folder& folder, const std::string& command) {
    const auto report = kept_verdict_of(folder, command);
    int followed = 0;
    for (const auto& advice : report["verdict"]["advice"]) {
        const std::string options = advice["options"], text = advice["text"];
        const double now = advice["now"], then = advice["then"];
        if (advice["figure"] == "module_mm") {
            CHECK(then >= 0.4);
            CHECK_THAT(text, Contains("scanners read"));
            continue;
        }
        if (advice["figure"] == "type_mm") {
            CHECK(then >= 1.5);
            CHECK_THAT(text, Contains("can be read"));
            continue;
        }
        CHECK(then < now);
        CHECK_THAT(text, Contains(fmt::format("{:.1f}", then)));
        if (options.empty()) continue;
        const auto after = kept_verdict_of(folder, with_options(command + " ", options));
        const double came_to = advice["figure"] == "gamut" ? double(after["gamut"]["de2000"]["mean"]) : seen(after);
        INFO(command << "\n" << advice.dump() << "\ncame to " << came_to);
        CHECK(came_to < now);
        if (text.find("or less") != std::string::npos)
            CHECK(came_to <= then);
        else if (text.find("at best") != std::string::npos)
            CHECK(came_to >= then);
        else if (const auto to = text.find(" to ", text.find("then ")); to != std::string::npos) {
            CHECK(came_to >= then - 0.05);
            CHECK(came_to <= std::stod(text.substr(to + 4)) + 0.05);
        } else
            CHECK(came_to == Approx(then).margin(std::max(0.5, 0.15 * then)));
        ++followed;
    }
    return followed;
}

/// A block of 6 x 5 x 3 mm with a fin of this thickness on it, of soft colours, which all sets reach.
std::string finned_obj(double fin_mm) {
    std::string text;
    for (const auto& [y, z] : {std::pair{std::array{0.0, 5.0}, std::array{0.0, 3.0}},
                               std::pair{std::array{2.5 - fin_mm / 2, 2.5 + fin_mm / 2}, std::array{2.5, 7.0}}})
        for (std::size_t c = 0; c < 8; ++c)
            text += fmt::format("v {} {} {} {}\n", c & 1 ? 6 : 0, y[c >> 1 & 1], z[c >> 2],
                                c & 1 ? "0.3 0.45 0.35" : "0.6 0.35 0.35");
    for (const int first : {1, 9})
        for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                              std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
            text += fmt::format("f {} {} {} {}\n", f[0] + first, f[1] + first, f[2] + first, f[3] + first);
    return text;
}

}  // namespace

TEST_CASE("Paper between heavy letters is told as the tint that it has, and not as white") {
    const Folder folder("tint");
    // Bars of 0.8 mm, 0.4 mm apart, in the open loop: their blue halo is all over the paper between.
    write_sheet(folder, "bars.png", 100, 60, [](int x, int y) {
        const int code = x >= 16 && x < 88 && y >= 4 && y < 56 && x % 12 < 8 ? 0 : 255;
        return std::array{code, code, code};
    });
    const auto report = verdict_of(folder, folder / "bars.png" + " --width 10mm --thickness 2mm --iterations 0");
    INFO(report["verdict"]["regions"].dump(1));
    for (const auto& region : report["verdict"]["regions"])
        if (region["kind"] == "paper") {
            REQUIRE(double(region["de2000"]) > 5);
            CHECK_THAT(region["printed"].get<std::string>(), !Contains("(255, 255, 255)"));
        }
}

TEST_CASE("The colours that a row names differ by about what it says that they do") {
    const Folder folder("rows");
    // Bars of blue, of which the eye makes a lighter blue at their size.
    write_sheet(folder, "bars.png", 100, 60, [](int x, int y) {
        const bool ink = x >= 16 && x < 88 && y >= 4 && y < 56 && x % 15 < 5;
        return ink ? std::array{20, 60, 140} : std::array{255, 255, 255};
    });
    const auto report = verdict_of(folder, folder / "bars.png" + " --width 10mm --thickness 2mm --iterations 0");
    INFO(report["verdict"]["regions"].dump(1));
    const auto lab = [](const std::string& colour) {
        std::smatch code;
        REQUIRE(std::regex_search(colour, code, std::regex(R"(\((\d+), (\d+), (\d+)\))")));
        Eigen::Vector3d rgb;
        for (int c = 0; c < 3; ++c) rgb[c] = optics::srgb_decode(std::stoi(code[std::size_t(c) + 1]) / 255.0);
        return optics::lab_from_linear_srgb(rgb);
    };
    int mixed = 0;
    for (const auto& region : report["verdict"]["regions"]) {
        if (region["kind"] != "solid") continue;
        const bool mixes = region.contains("asked_seen");
        const double off = optics::ciede2000(lab(region[mixes ? "asked_seen" : "asked"]), lab(region["printed"]));
        CHECK(off == Approx(double(region["de2000"])).margin(mixes ? 1 : 5));
        mixed += mixes;
    }
    CHECK(mixed == 1);
}

TEST_CASE("Windows that can be told from the wall and are of another colour are told as that") {
    const Folder folder("windows");
    write_sheet(folder, "night.png", 100, 60, [](int x, int y) {
        return x % 20 >= 8 && x % 20 < 14 && y % 20 >= 8 && y % 20 < 14 ? std::array{255, 210, 90}
                                                                        : std::array{12, 12, 20};
    });
    const auto regions =
        verdict_of(folder, folder / "night.png" + " --width 10mm --thickness 2mm --iterations 0")["verdict"]["regions"];
    INFO(regions.dump(1));
    const auto windows = std::ranges::find_if(
        regions, [](const auto& region) { return region["asked"].template get<std::string>().starts_with("yellow"); });
    REQUIRE(windows != regions.end());
    CHECK((*windows)["kind"] == "type and lines");
    CHECK((*windows)["contrast"] > 0.5);
    CHECK_FALSE((*windows)["good"].get<bool>());
    CHECK_THAT((*windows)["why"].get<std::string>(), Contains("printed as"));
}

TEST_CASE("Of a page lines that are lost come before a larger patch that is off") {
    const Folder folder("order");
    write_sheet(folder, "page.png", 100, 60, [](int x, int y) {
        if (x >= 40 && x < 95 && y >= 5 && y < 55) return std::array{255, 0, 0};
        const int code = x >= 8 && x < 30 && y >= 20 && y < 35 && x % 3 < 1 ? 0 : 255;
        return std::array{code, code, code};
    });
    const auto regions = verdict_of(folder, folder / "page.png" +
                                                " --width 10mm --thickness 2mm --resins vero-opaque "
                                                "--iterations 0")["verdict"]["regions"];
    INFO(regions.dump(1));
    CHECK(regions[0]["kind"] == "fine detail");
    CHECK(regions[1]["asked"] == "red (255, 0, 0)");
    CHECK_FALSE(regions[1]["good"].get<bool>());
}

namespace {

/// A QR code of 21 x 21 modules in its quiet zone, 29 x 29.
void write_code(const Folder& folder, const char* name) {
    constexpr int px = 10, quiet = 4;
    const io::CodeSymbol code = io::make_code(io::CodeKind::qr, "VOXTONE 1");
    write_sheet(folder, name, px * (code.columns + 2 * quiet), px * (code.rows + 2 * quiet), [&](int x, int y) {
        const int column = x / px - quiet, row = y / px - quiet;
        const bool is_dark = column >= 0 && row >= 0 && column < code.columns && row < code.rows &&
                             code.dark[std::size_t(row * code.columns + column)];
        return is_dark ? std::array{0, 0, 0} : std::array{255, 255, 255};
    });
}

}  // namespace

TEST_CASE("A code that no scanner reads makes a picture bad, and printed larger it is read and no longer bad") {
    const Folder folder("code");
    write_code(folder, "code.png");
    const auto code_row = [](const nlohmann::json& verdict) {
        return std::ranges::any_of(verdict["regions"], [](const auto& region) { return region["kind"] == "code"; });
    };
    const std::string how = folder / "code.png" + " --thickness 2mm --iterations 0 --width ";
    const auto small = verdict_of(folder, how + "5mm")["verdict"];
    INFO(small.dump(1));
    CHECK(small["level"] == "bad");
    CHECK(small["regions"][0]["kind"] == "code");
    CHECK_THAT(small["regions"][0]["asked"].get<std::string>(), Contains("QR code of 3.6 x 3.6 mm"));
    CHECK_THAT(small["headline"].get<std::string>(), Contains("a scanner cannot read its code"));
    // Too small to be a code even in the target's cells.
    const auto smear = verdict_of(folder, how + "2.5mm");
    INFO(smear["verdict"].dump(1));
    CHECK(smear["verdict"]["level"] == "bad");
    CHECK(code_row(smear["verdict"]));
    // However much larger that is.
    const auto readable = advised(smear, "--width");
    REQUIRE_FALSE(readable.is_null());
    CHECK(readable["figure"] == "module_mm");
    CHECK(double(readable["then"]) > 4 * double(readable["now"]));
    const auto large = verdict_of(folder, how + "15mm")["verdict"];
    REQUIRE(code_row(large));
    for (const auto& region : large["regions"])
        if (region["kind"] == "code") CHECK((region["good"].get<bool>() && region["printed"] == "read"));
    // Its colours are 10.5 off, open loop: it does what it is there for all the same.
    CHECK(large["level"] == "fair");
    CHECK_THAT(large["headline"].get<std::string>(), Contains("a scanner reads its code"));
}

TEST_CASE("Six letters of one colour are one row, and a seventh of another is its own") {
    const Folder folder("word");
    write_sheet(folder, "word.png", 160, 40, [](int x, int y) {
        if (y < 10 || y >= 30 || x % 22 < 6 || x >= 154) return std::array{255, 255, 255};
        return x < 132 ? std::array{180, 30, 40} : std::array{20, 60, 150};
    });
    const auto regions =
        verdict_of(folder, folder / "word.png" + " --width 16mm --thickness 2mm --iterations 0")["verdict"]["regions"];
    INFO(regions.dump(1));
    std::multiset<int> pieces;
    for (const auto& region : regions)
        if (region["kind"] == "solid") pieces.insert(region.value("pieces", 1));
    CHECK(pieces == std::multiset<int>{1, 6});
}

TEST_CASE("The edges of wide stripes are no fine detail") {
    const Folder folder("flag");
    write_sheet(folder, "flag.png", 90, 54, [](int, int y) {
        return y < 18 ? std::array{0, 0, 0} : y < 36 ? std::array{221, 0, 0} : std::array{255, 206, 0};
    });
    const auto verdict =
        verdict_of(folder, folder / "flag.png" + " --width 9mm --thickness 2mm --iterations 0")["verdict"];
    INFO(verdict.dump(1));
    for (const auto& region : verdict["regions"]) CHECK(region["kind"] != "fine detail");
}

TEST_CASE("Whoever follows an advice comes to what it says") {
    const Folder folder("advice");
    // Squares of 0.6 mm at 4.8 mm, of colours that the resins have.
    write_sheet(folder, "squares.png", 48, 36, [](int x, int y) {
        return (x / 6 + y / 6) % 2 ? std::array{205, 190, 120} : std::array{90, 120, 140};
    });
    folder.write("plate.obj", ramp_box_obj(6, 0.5, 5));
    folder.write("ramp.obj", ramp_box_obj(6, 5, 4));      // red to green
    folder.write("small.obj", ramp_box_obj(3, 3, 2.25));  // the size advised is one that is predicted unasked
    const std::string squares = folder / "squares.png" + " --thickness 2mm --resins vero-opaque --width 4.8mm ";
    CHECK(follow(folder, squares + "--iterations 0") >= 2);
    CHECK(follow(folder, folder / "plate.obj" + " --iterations 0 --size 6mm") >= 1);
    CHECK(follow(folder, folder / "ramp.obj" + " --iterations 0 --size 4mm --load C,M,K,W") >= 1);
    CHECK(follow(folder, folder / "small.obj" + " --iterations 0 --core K") >= 1);
    // Who lets it run until it stops is not told to; of another size after a loop that was cut short nothing is known.
    CHECK(advised(kept_verdict_of(folder, squares + "--iterations auto"), "--iterations").is_null());
    CHECK(advised(verdict_of(folder, squares + "--iterations 1"), "--width").is_null());
    // Who said how high it is is told how high.
    const auto high = verdict_of(folder, folder / "squares.png" +
                                             " --thickness 2mm --resins vero-opaque --height "
                                             "3.6mm --iterations 0");
    CHECK_FALSE(advised(high, "--height").is_null());
    // Thicker walls are another model.
    for (const double fin_mm : {0.6, 2.0}) folder.write(fmt::format("fin{}.obj", fin_mm), finned_obj(fin_mm));
    const auto thin = verdict_of(folder, folder / "fin0.6.obj" + " --unit mm --iterations 0"),
               thick = verdict_of(folder, folder / "fin2.obj" + " --unit mm --iterations 0");
    const auto& told = thin["verdict"]["advice"];
    const auto walls = std::find_if(told.begin(), told.end(), [](const auto& advice) {
        return advice["text"].template get<std::string>().starts_with("make walls");
    });
    REQUIRE(walls != told.end());
    CHECK(seen(thick) == Approx(double((*walls)["then"])).epsilon(0.15));
}

TEST_CASE("Over a dark core the advice is a white one, and nothing else first") {
    const Folder folder("core");
    const std::string cow = source_dir() + "/examples/models/spot/spot.obj --size 12mm";
    const auto draft = verdict_of(folder, cow + " --quality draft --core K");
    INFO(draft["verdict"].dump(1));
    REQUIRE_FALSE(draft["verdict"]["advice"].empty());
    CHECK(draft["verdict"]["advice"][0]["options"] == "--core W");
}

TEST_CASE("A draft tells of colours in reach, not of the print, and has no verdict on looks") {
    const Folder folder("draft");
    folder.write("ramp.obj", ramp_box_obj(6, 5, 4));
    const auto report = verdict_of(folder, folder / "ramp.obj" + " --quality draft --load M,K,W");
    CHECK(report["verdict"]["level"] == "unknown");
    const std::string sentence = report["verdict"]["sentence"];
    CHECK_THAT(sentence, Contains("Colours in reach: ") && !Contains("will not look"));
    CHECK_THAT(sentence, !Contains("cannot show 0 %"));
    const std::string page = read_file(folder.path() / "out/report.html");
    CHECK_THAT(page, Contains("\"name\": \"colours in reach\"") && !Contains("\"name\": \"print\""));
    CHECK(run_program("slice --quiet --overwrite --strict --quality draft " + folder / "ramp.obj" +
                      " --load M,K,W -o " + folder / "out")
              .exit_code == 0);
}

namespace {

/// A photograph of nothing: waves of many lengths, as light as they are long.
std::array<int, 3> clouds(int x, int y) {
    double light = 0;
    for (int n = 0; n < 24; ++n) {
        const double length = 2.5 * std::pow(1.22, n), angle = 2.4 * n;
        light +=
            0.09 * std::pow(length, 0.35) * std::sin(6.283 * (x * std::cos(angle) + y * std::sin(angle)) / length + n);
    }
    const auto code = [&](double middle) { return int(std::clamp(middle + 55 * light, 0.0, 255.0)); };
    return {code(150), code(130), code(110)};
}

}  // namespace

TEST_CASE("A print's verdict does not get worse printed larger, with more resins, or when the loop goes on") {
    const Folder folder("larger");
    write_sheet(folder, "squares.png", 48, 36, [](int x, int y) {
        return (x / 6 + y / 6) % 2 ? std::array{205, 190, 120} : std::array{90, 120, 140};
    });
    write_sheet(folder, "clouds.png", 120, 90, [](int x, int y) { return clouds(x, y); });
    folder.write("ramp.obj", ramp_box_obj(6, 4, 5));
    folder.write("pale.obj", pale_box());
    const auto rank = [](const nlohmann::json& report) {
        const std::string level = report["verdict"]["level"];
        return level == "good" ? 2 : level == "fair" ? 1 : 0;
    };
    const std::string squares = folder / "squares.png" + " --thickness 2mm --resins vero-opaque ",
                      photograph = folder / "clouds.png" + " --thickness 2mm --iterations 0",
                      ramp = folder / "ramp.obj" + " --iterations 0", pale = folder / "pale.obj" + " --iterations 0",
                      cow = source_dir() + "/examples/models/spot/spot.obj --iterations 0";
    std::set<int> seen_ranks;
    for (const auto& [command, how, steps] :
         {std::tuple{squares + "--iterations 0", "--width", std::array{"4mm", "7mm"}},
          std::tuple{photograph, "--width", std::array{"5mm", "9mm"}},
          std::tuple{pale, "--size", std::array{"2mm", "5mm"}}, std::tuple{ramp, "--size", std::array{"4mm", "6mm"}},
          std::tuple{cow, "--size", std::array{"6mm", "9mm"}},
          std::tuple{ramp + " --size 4mm --resins vero-opaque", "--load", std::array{"K,W", "C,M,Y,K,W"}},
          std::tuple{squares + "--width 4mm", "--iterations", std::array{"0", "2"}}}) {
        int before = 0;
        double mean_before = 100;
        for (const char* step : steps) {
            const auto& report = kept_verdict_of(folder, with_options(command, how + (" " + std::string(step))));
            CAPTURE(command, how, step, report["verdict"]["sentence"].get<std::string>());
            CHECK(rank(report) >= before);
            CHECK(seen(report) <= mean_before + 0.05);
            before = rank(report), mean_before = seen(report);
            seen_ranks.insert(before);
        }
    }
    CHECK(seen_ranks.size() == 3);  // all levels are among them
}

namespace {

/// A tablet of 4 x 4 x 2.5 mm with what is painted on its top: by place, mm.
std::string painted_tablet(const std::function<const char*(double x, double y)>& paint) {
    constexpr int n = 81;
    std::string text;
    for (const double z : {0.0, 2.5})
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                text += fmt::format("v {:.2f} {:.2f} {} {}\n", 0.05 * x, 0.05 * y, z,
                                    z > 0 ? paint(0.05 * x, 0.05 * y) : "0.25 0.12 0.05");
    const auto at = [](int x, int y, int top) { return top * n * n + y * n + x + 1; };
    const auto quad = [&](int a, int b, int c, int d) { text += fmt::format("f {} {} {} {}\n", a, b, c, d); };
    for (int y = 0; y + 1 < n; ++y)
        for (int x = 0; x + 1 < n; ++x) {
            quad(at(x, y, 1), at(x + 1, y, 1), at(x + 1, y + 1, 1), at(x, y + 1, 1));
            quad(at(x, y, 0), at(x, y + 1, 0), at(x + 1, y + 1, 0), at(x + 1, y, 0));
        }
    for (int i = 0; i + 1 < n; ++i) {
        quad(at(i, 0, 0), at(i + 1, 0, 0), at(i + 1, 0, 1), at(i, 0, 1));
        quad(at(i + 1, n - 1, 0), at(i, n - 1, 0), at(i, n - 1, 1), at(i + 1, n - 1, 1));
        quad(at(0, i + 1, 0), at(0, i, 0), at(0, i, 1), at(0, i + 1, 1));
        quad(at(n - 1, i, 0), at(n - 1, i + 1, 0), at(n - 1, i + 1, 1), at(n - 1, i, 1));
    }
    return text;
}

}  // namespace

TEST_CASE("Eyes that fade on a model are told, however small they are") {
    const Folder folder("eyes");
    const auto told = [&](bool with_eyes) {
        folder.write("face.obj", painted_tablet([&](double x, double y) {
                         const bool eye = with_eyes && std::hypot(std::abs(x - 2) - 0.7, y - 2.4) < 0.11;
                         return eye ? "0.98 0.98 0.98" : "0.25 0.12 0.05";
                     }));
        const auto regions =
            verdict_of(folder, folder / "face.obj" + " --unit mm --iterations 0")["verdict"]["regions"];
        UNSCOPED_INFO(regions.dump(1));
        return std::ranges::any_of(regions, [](const auto& region) { return region["kind"] == "fine detail"; });
    };
    CHECK(told(true));
    CHECK_FALSE(told(false));
}

TEST_CASE("A model's narrow legs are told by their colour, and not as type that is hard to read") {
    const Folder folder("legs");
    std::string text;
    auto add_box = [&, first = 1](std::array<double, 3> low, std::array<double, 3> high, const char* rgb) mutable {
        for (int c = 0; c < 8; ++c)
            text += fmt::format("v {} {} {} {}\n", c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1],
                                c & 4 ? high[2] : low[2], rgb);
        for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                              std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
            text += fmt::format("f {} {} {} {}\n", f[0] + first, f[1] + first, f[2] + first, f[3] + first);
        first += 8;
    };
    add_box({0, 0, 2}, {5, 4, 5}, "0.95 0.95 0.95");
    add_box({0.5, 0.5, 0}, {1, 1, 2.1}, "0.2 0.1 0.05");
    add_box({4, 3, 0}, {4.5, 3.5, 2.1}, "0.2 0.1 0.05");
    folder.write("table.obj", text);
    const auto report = verdict_of(folder, folder / "table.obj" + " --iterations 0");
    const auto& regions = report["verdict"]["regions"];
    INFO(regions.dump(1));
    CHECK(std::none_of(regions.begin(), regions.end(), [](const auto& r) { return r["kind"] == "type and lines"; }));
    const auto legs = std::find_if(regions.begin(), regions.end(), [](const auto& r) {
        return r["kind"] == "solid" && r["asked"].template get<std::string>().find("white") == std::string::npos;
    });
    REQUIRE(legs != regions.end());
    CHECK(double((*legs)["de2000"]) > 5);
    CHECK_THAT((*legs)["why"].get<std::string>(), Contains("printed as"));
}

TEST_CASE("A photograph whose texture light has taken is told to be blurred, and how much of it is kept") {
    const Folder folder("clouds");
    write_sheet(folder, "clouds.png", 120, 90, [](int x, int y) { return clouds(x, y); });
    const std::string slice = folder / "clouds.png" + " --width 10mm --thickness 2mm --resins vero-opaque ";
    const auto texture = [&](const nlohmann::json& report) -> nlohmann::json {
        for (const auto& region : report["verdict"]["regions"])
            if (region["kind"] == "texture") return region;
        return {};
    };
    const auto open = verdict_of(folder, slice + "--iterations 0");
    CHECK(io::schema_faults("report", read_file(folder.path() / "out/report.json")).empty());
    const auto lost = texture(open);
    INFO(open["verdict"].dump(1));
    REQUIRE_FALSE(lost.is_null());
    CHECK_THAT(lost["why"].get<std::string>(), Contains("of its contrast over") && Contains("blurred"));
    CHECK(double(lost["contrast"]) < 0.5);
    CHECK_THAT(open["verdict"]["sentence"].get<std::string>(), Contains("texture ("));
    CHECK(double(open["verdict"]["wrong_share"]) > 0.1);
    // The loop gives contrast back.
    const auto loop = verdict_of(folder, slice + "--iterations 4");
    const auto left = texture(loop);
    INFO(loop["verdict"].dump(1));
    CHECK((left.is_null() || double(left["area_mm2"]) < 0.5 * double(lost["area_mm2"])));
}

TEST_CASE("Open sheets are advised a thickness, which does what is said") {
    const Folder folder("sheets");
    // A hill of soft colours without a base.
    std::string text;
    constexpr int n = 12;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x)
            text += fmt::format("v {} {} {} {} 0.4 0.45\n", 0.5 * x, 0.5 * y,
                                1.2 * std::sin(0.3 * x) * std::sin(0.3 * y), 0.3 + 0.03 * x);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int a = y * (n + 1) + x + 1;
            text += fmt::format("f {} {} {} {}\n", a, a + 1, a + n + 2, a + n + 1);
        }
    folder.write("hill.obj", text);
    const std::string hill = folder / "hill.obj" + " --unit mm --iterations 0";
    const auto report = kept_verdict_of(folder, hill);
    INFO(report["verdict"].dump(1));
    const auto advice = advised(report, "--sheet-thickness 2mm");
    REQUIRE_FALSE(advice.is_null());
    CHECK_THAT(advice["text"].get<std::string>(), Contains("print open sheets 2 mm thick"));
    CHECK(double(advice["then"]) > double(report["verdict"]["seen_de2000"]["out_of_reach"]));
    CHECK(follow(folder, hill) >= 1);
    // A flag on a block, whose thick walls tell what thick ones are like.
    folder.write("flag.obj", finned_obj(2) +
                                 "v 0 2 7 0.6 0.35 0.35\nv 6 2 7 0.3 0.45 0.35\nv 6 2 10 0.3 0.45 0.35\n"
                                 "v 0 2 10 0.6 0.35 0.35\nf 17 18 19 20\n");
    const std::string flag = folder / "flag.obj" + " --unit mm --iterations 0 ";
    const auto thin = verdict_of(folder, flag);
    INFO(thin["verdict"].dump(1));
    const auto cure = advised(thin, "--sheet-thickness 2mm");
    REQUIRE_FALSE(cure.is_null());
    const double cured = seen(verdict_of(folder, flag + "--sheet-thickness 2mm"));
    CHECK(cured < double(cure["then"]) + 0.5);
    // A closed plate as thin is no sheet: the option would do nothing.
    folder.write("plate.obj", ramp_box_obj(6, 0.3, 5));
    CHECK(advised(verdict_of(folder, folder / "plate.obj" + " --iterations 0"), "--sheet-thickness").is_null());
}

TEST_CASE("From which side a body looks best and worst is said, and how much of it no resin could avoid") {
    const Folder folder("sides");
    std::string text;
    for (int c = 0; c < 12; ++c)  // the last four are the underside's own
        text += fmt::format("v {} {} {} {}\n", c & 1 ? 6 : 0, c & 2 ? 5 : 0, c >= 4 && c < 8 ? 4 : 0,
                            c < 8 ? "0.8 0.8 0.8" : "0 0 1");
    text += "f 9 11 12 10\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    folder.write("box.obj", text);
    const auto verdict = verdict_of(folder, folder / "box.obj" + " --unit mm --iterations 0")["verdict"];
    INFO(verdict.dump(1));
    CHECK_THAT(verdict["sentence"].get<std::string>(), Contains("From ") && Contains(", from below "));
    double below = 0, top = 0;
    for (const auto& side : verdict["sides"]) {
        if (side["from"] == "bottom") below = side["mean"];
        if (side["from"] == "top") top = side["mean"];
    }
    CHECK(below > top + 2.5);
    const double reach = verdict["seen_de2000"]["out_of_reach"];
    CHECK((reach > 0 && reach < double(verdict["seen_de2000"]["mean"])));
    CHECK_THAT(verdict["sentence"].get<std::string>(),
               Contains(fmt::format("{:.1f} of it no mixture of these resins could avoid", reach)));
}

TEST_CASE("Thin walls are a region of their own, with their place and what they are printed as") {
    const Folder folder("walls");
    folder.write("plate.obj", ramp_box_obj(6, 0.5, 5));
    const auto report = verdict_of(folder, folder / "plate.obj" + " --iterations 0");
    CHECK(io::schema_faults("report", read_file(folder.path() / "out/report.json")).empty());
    const auto& regions = report["verdict"]["regions"];
    INFO(regions.dump(1));
    const auto walls =
        std::find_if(regions.begin(), regions.end(), [](const auto& r) { return r["kind"] == "thin walls"; });
    REQUIRE(walls != regions.end());
    CHECK_FALSE((*walls)["good"].get<bool>());
    CHECK_THAT((*walls)["why"].get<std::string>(), Contains("let light pass") && Contains("0.5 mm thick"));
    CHECK(double((*walls)["area_mm2"]) > 20);
    CHECK((*walls)["pieces"] == 1);
}

TEST_CASE("Thin walls in two places are two places") {
    const Folder folder("two-walls");
    folder.write("one.obj", ramp_box_obj(4, 0.5, 3));
    const std::string both = read_file(folder.path() / "one.obj");
    std::string second;
    std::istringstream lines(both);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            double x = 0, y = 0, z = 0;
            std::string colour;
            words >> x >> y >> z;
            std::getline(words, colour);
            second += fmt::format("v {} {} {}{}\n", x, y + 6, z, colour);
        } else if (word == "f") {
            second += "f";
            for (int corner = 0; words >> corner;) second += fmt::format(" {}", corner + 8);
            second += "\n";
        }
    }
    folder.write("two.obj", both + second);
    const auto report = verdict_of(folder, folder / "two.obj" + " --iterations 0");
    CHECK_THAT(report["verdict"]["sentence"].get<std::string>(), Contains("thin walls (2 places, the largest "));
}

TEST_CASE("What is thinner than a voxel is printed one voxel thick, and said, or vanishes where that is asked for") {
    const Folder folder("sheet-of-metal");
    // 0.014 mm thick, aslant: most of the voxels that it passes through have their middle outside.
    folder.write("sheet.obj",
                 "v 0 0 0\nv 2 2 0\nv 2.01 1.99 0\nv 0.01 -0.01 0\nv 0 0 2\nv 2 2 2\nv 2.01 1.99 2\n"
                 "v 0.01 -0.01 2\nf 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
    const std::string slice = "slice --quiet --overwrite --unit mm --iterations 0 --predict none " +
                              folder / "sheet.obj" + " -o " + folder / "out ";
    const auto warned = [&](const std::string& more) {
        const Outcome outcome = run_program(slice + more);
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return report_in(folder)["warnings"].dump();
    };
    CHECK_THAT(warned(""), Contains("voxels were added") && Contains("[thin-walls]"));
    CHECK_THAT(warned("--no-keep-thin"), !Contains("voxels were added"));
}

TEST_CASE("Black beside colours is as black with the loop as without") {
    const Folder folder("black");
    write_sheet(folder, "card.png", 90, 60, [](int x, int y) {
        if (y < 15 || y >= 45) return std::array{255, 255, 255};
        if (x >= 10 && x < 40) return std::array{20, 20, 20};
        if (x >= 50 && x < 80) return std::array{0, 150, 200};
        return std::array{255, 255, 255};
    });
    const std::string card = folder / "card.png" + " --width 9mm --thickness 3mm --resins vero-opaque";
    const auto black = [&](const nlohmann::json& report) {
        for (const auto& region : report["verdict"]["regions"])
            if (region["asked"].get<std::string>().starts_with("black")) return region;
        return nlohmann::json();
    };
    const auto open = black(verdict_of(folder, card + " --iterations 0")),
               loop = black(verdict_of(folder, card + " --iterations 6"));
    INFO(open.dump() << loop.dump());
    // The print's own paper is darker with the loop, which makes black a little lighter; a skin of four fifths of the
    // depth made it 3.5 worse.
    CHECK(double(loop["de2000"]) < double(open["de2000"]) + 1.5);
    CHECK(double(loop["unevenness"]) < double(open["unevenness"]) + 0.5);
}

TEST_CASE("A printer with few slots is loaded with the resins that the model needs") {
    const Folder folder("slots");
    folder.write("ramp.obj", ramp_box_obj(6, 5, 4));  // red to green: black and one hue are not enough
    const std::string slice = "slice --quiet --overwrite --iterations 0 --predict none --printer stratasys-j750-hs " +
                              folder / "ramp.obj" + " -o " + folder / "out ";
    const auto roles = [&] {
        std::string names;
        const auto report = report_in(folder);
        for (const auto& resin : report["resins"]) names += resin["role"].get<std::string>();
        return names;
    };
    REQUIRE(run_program(slice + "--load M,K,W").exit_code == 0);
    CHECK(roles() == "MKW");
    const auto usual = report_in(folder);
    CHECK_THAT(std::string(usual["verdict"]["sentence"]), Contains("cannot show"));
    REQUIRE(run_program(slice).exit_code == 0);
    const auto chosen = report_in(folder);
    CHECK(roles().size() == 3);
    CHECK(roles() != "MKW");
    CHECK(double(chosen["gamut"]["de2000"]["mean"]) < 0.8 * double(usual["gamut"]["de2000"]["mean"]));
    CHECK_THAT(chosen["sections"].dump(), Contains("show this model's colours best"));
    // Where all of the set's resins have a slot, nothing is chosen.
    REQUIRE(run_program("slice --quiet --overwrite --iterations 0 --predict none " + folder / "ramp.obj" + " -o " +
                        folder / "out")
                .exit_code == 0);
    CHECK(roles() == "CMYKW");
}

TEST_CASE("A quick look in coarse cells looks at an eighth of them, and sees the same colours") {
    const Folder folder("quick");
    folder.write("ramp.obj", ramp_box_obj(5, 4, 3));
    REQUIRE(run_program("slice --quiet --iterations 0 --no-report " + folder / "ramp.obj" + " -o " + folder / "out")
                .exit_code == 0);
    const auto predict = [&](const std::string& cell) {
        const Outcome outcome = run_program("predict --quiet --json --view body --cell " + cell + " " + folder / "out" +
                                            " -o " + folder / ("p" + cell + ".glb"));
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        const auto at = outcome.out.rfind("{\"event\":\"result\"");
        REQUIRE(at != std::string::npos);
        return nlohmann::json::parse(outcome.out.substr(at))["result"];
    };
    const auto fine = predict("0.085mm"), coarse = predict("0.34mm"), coarser = predict("0.68mm");
    CHECK(int(coarse["cells"]) * 8 < int(fine["cells"]));
    CHECK(int(coarser["cells"]) < int(coarse["cells"]));
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(double(coarse["mean_rgb"][c]) == Approx(double(fine["mean_rgb"][c])).margin(0.02));
        CHECK(double(coarser["mean_rgb"][c]) == Approx(double(coarse["mean_rgb"][c])).margin(0.005));
    }
}
