// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/printer.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Contains;

namespace {

/// A complete profile with one line more, and one less where `without` starts a line.
std::string profile_with(const std::string& more, const std::string& without = "#") {
    std::string text = "{\n\"format\": \"voxtone-printer\"";
    for (const char* line : {"\"version\": 1", "\"name\": \"Mine\"", "\"pitch_um\": [40, 50, 20]"})
        if (!std::string(line).starts_with(without)) text += std::string(",\n") + line;
    return text + (more.empty() ? "" : ",\n" + more) + "\n}";
}
PrinterProfile parse(const std::string& text) { return parse_printer(text, "mine", "mine.json"); }

}  // namespace

TEST_CASE("The J750's pitch is the exact fraction of an inch") {
    const PrinterProfile printer = find_printer("stratasys-j750-hm");
    CHECK(printer.pitch_um.x() == 25400.0 / 600);
    CHECK(printer.pitch_um.y() == 25400.0 / 300);
    CHECK(printer.pitch_um.z() == 27);
    CHECK(printer.pitch_um.y() == 2 * printer.pitch_um.x());
    CHECK(std::abs(printer.sliced_pitch_mm().x() * 600 - 25.4) < 1e-14);
    CHECK(printer.tray_mm == Eigen::Vector3d(490, 390, 200));
    CHECK(printer.max_colours == 6);
    CHECK(printer.min_layers == 30);
    CHECK(printer.confirmed("dpi"));
    CHECK(find_printer("stratasys-j750-hq").pitch_um.z() == 14);
    CHECK(find_printer("stratasys-j750-hs").max_colours == 3);
    CHECK(find_printer("stratasys-j750-hs").default_roles.size() == 3);
}

TEST_CASE("Every profile in the tree is in the program, and the other way round") {
    std::set<std::string> in_tree, in_program;
    for (const auto& entry : std::filesystem::directory_iterator(test::source_dir() + "/data/printers"))
        if (entry.path().extension() == ".json") in_tree.insert(entry.path().stem().string());
    for (const PrinterProfile& printer : list_printers()) in_program.insert(printer.id);
    CHECK(in_tree == in_program);
    CHECK(in_tree.contains("mimaki-3duj-553"));
}

TEST_CASE("Every profile's colours can be printed") {
    for (const PrinterProfile& printer : list_printers()) {
        INFO(printer.id);
        const std::vector<io::Rgb> colours = printer.display_colours(printer.default_roles);
        CHECK(std::set<io::Rgb>(colours.begin(), colours.end()).size() == printer.default_roles.size());
        CHECK(std::find(colours.begin(), colours.end(), printer.background_rgb) == colours.end());
        CHECK(printer.default_roles.size() <= std::size_t(printer.max_resins));
        CHECK(printer.default_roles.size() <= std::size_t(printer.max_colours));
        CHECK(printer.warnings().size() == printer.unconfirmed.size());
    }
    CHECK_FALSE(find_printer("stratasys-j55").confirmed("dpi"));
    CHECK_FALSE(find_printer("mimaki-3duj-553").confirmed("layer_um"));
}

TEST_CASE("Roles without a colour get a free one") {
    const PrinterProfile printer =
        parse(profile_with(R"("colours": {"C": [30, 30, 30]}, "background_rgb": [230, 110, 20])"));
    const std::vector<std::string> roles{"K", "C", "varnish", "primer", "W"};  // K's usual colour is taken by C
    const std::vector<io::Rgb> colours = printer.display_colours(roles);
    CHECK(colours[1] == io::Rgb{30, 30, 30});
    CHECK(std::set<io::Rgb>(colours.begin(), colours.end()).size() == roles.size());
    CHECK(std::find(colours.begin(), colours.end(), printer.background_rgb) == colours.end());
    std::vector<std::string> many;
    for (int i = 0; i < 20; ++i) many.push_back("role" + std::to_string(i));
    CHECK_THROWS_AS(printer.display_colours(many), InputError);
}

TEST_CASE("A profile of one's own is read from its path") {
    const io::TemporaryFolder folder;
    const std::string path = (folder.path() / "voxtone_printer_test_mine.json").string();
    std::ofstream(path) << profile_with(R"("flip_y": true, "material_names": {"W": "White 1"})");
    const PrinterProfile printer = find_printer(path);
    std::remove(path.c_str());
    CHECK(printer.id == "voxtone_printer_test_mine");
    CHECK(printer.pitch_um == Eigen::Vector3d(40, 50, 20));
    CHECK(printer.orientation.flip_y);
    CHECK_FALSE(printer.orientation.flip_x);
    CHECK(printer.material_names.at("W") == "White 1");
    CHECK(std::isinf(printer.tray_mm.x()));
    CHECK(printer.formats == std::vector{io::LayerFormat::png});
    CHECK(printer.min_layers == 1);
    CHECK(printer.min_wall_mm == 0);
    const PrinterProfile careful =
        parse(profile_with(R"("min_wall_mm": 0.7, "min_wall_source": "its maker", "min_layers": 12)"));
    CHECK(careful.min_wall_mm == 0.7);
    CHECK(careful.min_wall_source == "its maker");
    CHECK(careful.min_layers == 12);
    CHECK_THROWS_AS(find_printer(path), FileError);
}

TEST_CASE("A printer's resins are named as those of the cartridges that the set is of, and others are warned of") {
    PrinterProfile printer = find_printer("stratasys-j750-hm");
    CHECK(printer.material_names.at("M") == "VeroMGT-V");
    const std::vector<std::string> before = printer.warnings();
    printer.load("old", "Vero opaque");
    CHECK(printer.material_names.at("M") == "VeroMgnt");
    printer.load("mine.json", "");  // a set that does not say: nothing changes
    CHECK(printer.material_names.at("M") == "VeroMgnt");
    CHECK(printer.warnings() == before);
    printer.load("foreign", "Mimaki");
    CHECK(printer.material_names.empty());
    REQUIRE(printer.warnings().size() == before.size() + 1);
    CHECK_THAT(printer.warnings()[0], Contains("--resins foreign") && Contains("Mimaki") &&
                                          Contains("takes Vero Vivid, Vero opaque") && Contains("[cartridges]"));
    printer.load("new", "Vero Vivid");
    CHECK(printer.material_names.at("M") == "VeroMGT-V");
    CHECK(printer.warnings() == before);
    // Nobody said which it takes.
    PrinterProfile own = parse(profile_with(R"("material_names": {"W": "White 1"})"));
    own.load("foreign", "Mimaki");
    CHECK(own.material_names.at("W") == "White 1");
    CHECK(own.warnings().empty());
}

TEST_CASE("An unknown printer names the nearest one") {
    CHECK_THROWS_WITH(find_printer("stratasys-j750-hn"), Contains("did you mean 'stratasys-j750-h"));
    CHECK_THROWS_WITH(find_printer("Stratasys J750"), Contains("'stratasys-j750-hm', 'stratasys-j750-hq', "
                                                               "'stratasys-j750-hs'?") &&
                                                          !Contains("mean 'stratasys-j55"));
    CHECK_THROWS_WITH(find_printer("stratasys j55x"), Contains("did you mean 'stratasys-j55'"));
    for (const char* other : {"stratasys-j850", "stratasys-j35", "Stratasys J826", "mimaki-3duj-2207"})
        CHECK_THROWS_WITH(find_printer(other), !Contains("did you mean"));
    CHECK_THROWS_WITH(find_printer("laser"), Contains("known are generic, mimaki-3duj-553") && Contains(".json"));
    CHECK_THROWS_AS(find_printer("laser"), InputError);
}

TEST_CASE("A wrong profile names file, key and rule") {
    const auto fault = [](const std::string& text) -> std::string {
        try {
            (void)parse(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(fault(profile_with("")).empty());
    CHECK_THAT(fault(profile_with("\"max_resin\": 3")),
               Contains("mine.json: line 6: unknown key 'max_resin'; did you mean 'max_resins'?"));
    CHECK_THAT(fault(profile_with("", "\"name")), Contains("mine.json: key `name`: is missing"));
    CHECK_THAT(fault(profile_with("", "\"pitch")), Contains("key `pitch_um`: is missing"));
    CHECK_THAT(fault(profile_with("\"dpi\": [600, 300]")), Contains("not both"));
    CHECK_THAT(fault(profile_with("\"dpi\": [600, 300]", "\"pitch")), Contains("key `layer_um`: is missing"));
    CHECK_THAT(fault(profile_with("\"pitch_um\": [0.042, 0.084, 27]", "\"pitch")),
               Contains("0.042, expected numbers from 1 to 1000"));
    CHECK_THAT(fault(profile_with("\"pitch_um\": [40, 50]", "\"pitch")),
               Contains("key `pitch_um`: has 2 entries, expected 3"));
    CHECK_THAT(fault(profile_with(R"("cartridges": [{"family": "A"}], "material_names": {"W": "White 1"})")),
               Contains("key `cartridges`") && Contains("not both"));
    CHECK_THAT(fault(profile_with(R"("cartridges": [{"family": "A"}, {"family": "A"}])")), Contains("named twice"));
    CHECK_THAT(fault(profile_with(R"("cartridges": [])")), Contains("key `cartridges`: is empty"));
    CHECK_THAT(fault(profile_with("\"max_resins\": 99")), Contains("99, expected a whole number from 1 to 8"));
    CHECK_THAT(fault(profile_with("\"max_resins\": 2.5")), Contains("2.5, expected a whole number"));
    CHECK_THAT(fault(profile_with("\"max_resins\": 3")), Contains("key `default_roles`: 5 roles, but 1 to 3"));
    CHECK_THAT(fault(profile_with("\"default_roles\": [\"C\", \"C\"]")), Contains("'C' is empty or named twice"));
    CHECK_THAT(fault(profile_with("\"colours\": {\"K\": [0, 0, 0]}")),
               Contains("'K' has the colour of the background"));
    CHECK_THAT(fault(profile_with("\"colours\": {\"K\": [1, 2, 3], \"W\": [1, 2, 3]}")),
               Contains("'K' and 'W' share a colour"));
    CHECK_THAT(fault(profile_with("\"colours\": {\"K\": [0, 0, 256]}")),
               Contains("key `colours.K`") && Contains("256"));
    CHECK_THAT(fault(profile_with("\"formats\": [\"bmp\"]")), Contains("'bmp' is none of png, gcvf"));
    CHECK_THAT(fault(profile_with("\"unconfirmed\": {\"pitch\": \"who knows\"}")),
               Contains("did you mean 'pitch_um'?"));
    CHECK_THAT(fault(profile_with("\"spread_mm\": [0.05, 0.4]")), Contains("0.4 mm is wider than 0.3 mm"));
    CHECK_THAT(fault(profile_with("\"spread_mm\": [-0.1, 0]")), Contains("spread_mm"));
    CHECK_THAT(fault(profile_with("\"pass_axis\": \"x\"")), Contains("without pass_width_mm"));
    CHECK_THAT(fault(profile_with("\"pass_width_mm\": 50")), Contains("key `pass_source`: is missing"));
    CHECK_THAT(fault(profile_with("\"pass_width_mm\": 50, \"pass_source\": \"a guide\", \"pass_axis\": \"z\"")),
               Contains("'z' is none of x, y"));
    CHECK_THAT(fault(profile_with("\"flip_x\": 1")), Contains("expected true or false"));
    CHECK_THAT(fault(profile_with("\"tray_mm\": [1e999, 1, 1]")), Contains("mine.json"));
    CHECK_THAT(fault("{\n\"format\": \"voxtone-printer\",\n\"version\" 1}"), Contains("line 3: this is no valid JSON"));
    CHECK_THAT(fault("{}"), Contains("not a printer profile"));
    CHECK_THAT(fault(R"({"format": "voxtone-printer", "version": 2})"), Contains("version 1"));
}

TEST_CASE("A profile cut short at any byte is refused") {
    const std::string whole = profile_with("\"colours\": {\"K\": [1, 2, 3]}, \"notes\": [\"n\"]");
    CHECK_NOTHROW(parse(whole));
    for (std::size_t length = 0; length < whole.size(); ++length)
        CHECK_THROWS_AS(parse(whole.substr(0, length)), InputError);
}
