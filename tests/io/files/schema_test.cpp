// SPDX-License-Identifier: GPL-3.0-or-later
//
// The schemas in data/schema say what the program writes and what data/ holds, and refuse what its readers refuse.
#include "tests/io/files/schema.h"

#include <filesystem>

#include <catch2/catch.hpp>

#include "io/profiles/layer_sequence_file.h"
#include "io/profiles/profile_file.h"
#include "io/profiles/profile_map.h"
#include "io/profiles/resin_file.h"
#include "io/report/report_json.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/io/layers/stack_samples.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::io;

namespace {

using Faults = std::vector<std::string>;

/// The same text where one part is another.
std::string changed(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

/// Whether the schema refuses the text with this change.
bool refused(const std::string& schema, const std::string& text, const std::string& from, const std::string& to) {
    return !schema_faults(schema, changed(text, from, to)).empty();
}

optics::RadialSamples samples(double scale) { return {0.1, {4 * scale, 3, 2, 1}, 0.5, {0.1, 0.1, 0.1, 0.1}}; }

Report report() {
    Report report;
    report.title = "spot.obj";
    report.resins = {{"VeroCyan", "C", "", {0, 150, 200}, 34567, 3.4}};
    report.stages = {{"Layers", 37.5}};
    report.warnings = {"one"};
    report.gamut = ReportGamut{0.125, 0.84, 3.21, 9.87};
    report.translucency = ReportTranslucency{0.6, 0.5, 0.1, 0.3, 0.25};
    report.prediction.emplace().histogram = {{0, 0.75}, {1, 0.25}};
    report.loop.emplace().iterations.resize(2);
    report.loop->best = 1;
    report.prediction_note = "n";
    report.sections = {{"s", {"p"}, {{"t", {"a", "b"}, {{"1", "2"}}}}, {}, {}}};
    report.job = {{"printer", "generic"}};
    return report;
}

}  // namespace

TEST_CASE("A manifest is what its schema says", "[schema]") {
    const TemporaryFolder folder;
    (void)write_sample_stack(folder.path() / "s", 3);
    const std::string text = text_of(folder.path() / "s" / "manifest.json");
    CHECK(schema_faults("manifest", text) == Faults{});
    CHECK(refused("manifest", text, "\"printer\"", "\"printr\""));
    CHECK(refused("manifest", text, "\"layers\": 3", "\"layers\": 0"));
    CHECK(refused("manifest", text, "%05d", "%s"));
    CHECK(refused("manifest", text, "[0, 174, 239]", "[0, 174, 256]"));
    CHECK(refused("manifest", text, "\"content_sha256\": \"", "\"content_sha256\": \"x"));
}

TEST_CASE("Resin sets are what their schema says", "[schema]") {
    for (const auto& entry : std::filesystem::directory_iterator(test::source_dir() + "/data/resins"))
        if (entry.path().extension() == ".json") CHECK(schema_faults("resins", text_of(entry.path())) == Faults{});
    auto set = optics::vero_opaque();
    const std::string text = resin_set_text(set);
    CHECK(schema_faults("resins", text) == Faults{});
    set.channels.wavelengths_nm = {450, 550.5, 650};
    CHECK(schema_faults("resins", resin_set_text(set)) == Faults{});
    set.channels = optics::colorimetric_channels(optics::Illuminant::d50);
    const std::string own = resin_set_text(set);
    CHECK(schema_faults("resins", own) == Faults{});
    CHECK(refused("resins", own, "\"own\"", "\"mine\""));
    CHECK(refused("resins", own, "\"D50\"", "\"F11\""));
    CHECK(refused("resins", own, "[0, 1, 0]", "[0, 1]"));
    CHECK(refused("resins", text, "\"albedo\"", "\"albdo\""));
    CHECK(refused("resins", text, "\"g\": 0.4", "\"g\": 1"));
    CHECK(refused("resins", text, "0.98]", "1.98]"));
}

TEST_CASE("Scattering profiles are what their schema says", "[schema]") {
    const ProfileFile layer{"white", "a test", {}, {3, {2.0, samples(1), samples(2)}}};
    const ProfileFile target{"wanted", "", {{450, 550.5}}, {2, {0, {}, samples(1)}}};
    const std::string text = profile_text(layer);
    CHECK(schema_faults("profile", text) == Faults{});
    CHECK(schema_faults("profile", profile_text(target)) == Faults{});
    const ProfileFile own{"own", "", optics::colorimetric_channels(optics::Illuminant::a), {3, {0, {}, samples(1)}}};
    CHECK(schema_faults("profile", profile_text(own)) == Faults{});
    CHECK(refused("profile", text, "\"T\": ", "\"U\": "));
    CHECK(refused("profile", text, ", \"thickness_mm\": 2", ""));
    CHECK(refused("profile", text, "\"spacing_mm\": 0.1", "\"spacing_mm\": -0.1"));
    CHECK(refused("profile", text, "[4, 3, 2, 1]", "[4, 3]"));
}

TEST_CASE("A profile map is what its schema says", "[schema]") {
    const TemporaryFolder folder;
    ProfileMap map;
    map.width_mm = map.height_mm = 1;
    map.width_px = 2, map.height_px = 1;
    map.cluster = {0, 1};
    map.target.assign(2, {3, optics::RadialSamples{0.1, {4, 3, 2, 1}, {}, {}}});
    map.channels = optics::colorimetric_channels(optics::Illuminant::d65);
    write_profile_map(map, folder.path() / "map.json");
    CHECK(schema_faults("profile-map", text_of(folder.path() / "map.json")) == Faults{});
    map.channels = {};
    write_profile_map(map, folder.path() / "map.json");
    const std::string text = text_of(folder.path() / "map.json");
    CHECK(schema_faults("profile-map", text) == Faults{});
    CHECK(refused("profile-map", text, "\"picture\"", "\"pictures\""));
    CHECK(refused("profile-map", text, "\"size_mm\": [1, 1]", "\"size_mm\": [1, 0]"));
    CHECK(refused("profile-map", text, "[4, 3, 2, 1]", "[4]"));
}

TEST_CASE("A sequence of layers is what its schema says", "[schema]") {
    LayerSequence sequence;
    sequence.name = "jade";
    sequence.layers = {{"W", 0.3}, {"K", 1.0 / 3}};
    const std::string text = layer_sequence_text(sequence);
    CHECK(schema_faults("laminate", text) == Faults{});
    sequence.resins = "vero-opaque";
    CHECK(schema_faults("laminate", layer_sequence_text(sequence)) == Faults{});
    CHECK(refused("laminate", text, "\"air\"", "\"water\""));
    CHECK(refused("laminate", text, "\"mm\": 0.3", "\"mm\": 0"));
}

TEST_CASE("A report is what its schema says", "[schema]") {
    const std::string text = report_json(report());
    CHECK(schema_faults("report", text) == Faults{});
    CHECK(schema_faults("report", report_json({})) == Faults{});
    CHECK(refused("report", text, "\"cells\"", "\"cell\""));
    CHECK(refused("report", text, "\"best\": 1", "\"best\": \"one\""));
}

TEST_CASE("Printer profiles are what their schema says", "[schema]") {
    for (const auto& entry : std::filesystem::directory_iterator(test::source_dir() + "/data/printers"))
        if (entry.path().extension() == ".json") CHECK(schema_faults("printer", text_of(entry.path())) == Faults{});
    const std::string text = text_of(test::source_dir() + "/data/printers/stratasys-j750-hm.json");
    CHECK(refused("printer", text, "\"layer_um\": 27", "\"layer_um\": 0.027"));
    CHECK(refused("printer", text, "\"layer_um\": 27", "\"pitch_um\": [42, 84, 27]"));
    CHECK(refused("printer", text, "\"min_layers\"", "\"min_layer\""));
}

TEST_CASE("Kinds of foreign files are what their schema says", "[schema]") {
    const std::string text = text_of(test::source_dir() + "/data/foreign-files.json");
    CHECK(schema_faults("foreign-files", text) == Faults{});
    CHECK(refused("foreign-files", text, "\"root\": \"x3d\"", "\"roots\": \"x3d\""));
    CHECK(refused("foreign-files", text, "\"step stp", "\".step stp"));
    CHECK(refused("foreign-files", text, "\"inside\": \"picture\"", "\"inside\": \"pixels\""));
    CHECK(refused("foreign-files", text, "{\"hex\": \"ffd8ff\"}", "{\"hex\": \"ffd8f\"}"));
    CHECK(refused("foreign-files", text, "{\"hex\": \"ffd8ff\"}", "{\"hex\": \"ffd8ff\", \"bytes\": \"BM\"}"));
    CHECK(refused("foreign-files", text, "\"at\": 128", "\"at\": -1"));
    CHECK(refused("foreign-files", text, "\"what\": \"a Rhino file\", ", ""));
}
