// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/manifest.h"

#include <catch2/catch.hpp>
#include <string>

#include "base/error.h"
#include "io/files/sha256.h"
#include "io/layers/layer_stack_writer.h"
#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;

namespace {

StackDescription sample() {
    StackDescription stack;
    stack.printer = "stratasys-j750-hm";
    stack.pitch_um = {42.333333, 84.666667, 27.0};
    stack.size_px = {1418, 388};
    stack.layers = 3920;
    stack.size_mm = stack_size_mm(stack);
    stack.origin_mm = {-1.5, 0.25, 0};
    stack.resins = {{"VeroWhite", "W", {220, 222, 216}, 123, 0.1}, {"Vero\"Cyan\"\n", "C", {0, 174, 239}, 5, 1e-9}};
    stack.orientation.flip_y = true;
    stack.content_sha256 = sha256({});
    return stack;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a manifest survives writing and reading", "[manifest]") {
    const auto stack = sample();
    CHECK(parse_manifest(manifest_text(stack), "m") == stack);
    CHECK(manifest_text(parse_manifest(manifest_text(stack), "m")) == manifest_text(stack));
    CHECK(stack.layer_path(7) == "layers/slice_00007.png");
    CHECK(stack_size_mm(stack)[0] == Approx(60.03).margin(0.005));
    CHECK(stack_size_mm(stack)[2] == Approx(105.84));
}

TEST_CASE("a manifest names the bodies of a print of many, and is sealed with them", "[manifest]") {
    const auto alone = manifest_text(sample());
    CHECK(alone.find("members") == std::string::npos);
    auto stack = sample();
    stack.members = {{"cow", {{0, 0, 0, 10, 20, 30}, {12.5, 0, 0, 22.5, 20, 30}}, 1.25, "good"},
                     {"a \"card\"", {}, 0, ""}};
    const auto text = manifest_text(stack);
    CHECK(parse_manifest(text, "m") == stack);
    CHECK(schema_faults("manifest", text).empty());
    CHECK(seal_of_manifest_text(text, "m") == ManifestSeal::whole);
    CHECK(seal_of_manifest_text(replaced(text, "\"good\"", "\"fair\""), "m") == ManifestSeal::broken);
    const auto fault = [&](const std::string& from, const std::string& to) {
        try {
            (void)parse_manifest(replaced(text, from, to), "FILE");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(fault("a \\\"card\\\"", "cow"), Contains("members[1].name"));
    CHECK_THAT(fault("\"cow\"", "\"\""), Contains("members[0]"));
    CHECK_THAT(fault("\"ml\": 1.25", "\"ml\": -1"), Contains("ml"));
    CHECK_THAT(fault("12.5,", "32.5,"), Contains("ends before it begins"));
    CHECK_THAT(fault("12.5,", ""), Contains("boxes_mm"));
}

TEST_CASE("a manifest says what resin is in bitmaps of single resins", "[manifest]") {
    CHECK(manifest_text(sample()).find("resin_pixels") == std::string::npos);
    for (const ResinPixels pixels : {ResinPixels::white, ResinPixels::black}) {
        auto stack = sample();
        stack.resin_pixels = pixels;
        const auto text = manifest_text(stack);
        CHECK(parse_manifest(text, "m") == stack);
        CHECK(schema_faults("manifest", text).empty());
        CHECK_THROWS_WITH(parse_manifest(replaced(text, name_of(pixels).data(), "grey"), "FILE"),
                          Contains("resin_pixels") && Contains("black"));
    }
}

TEST_CASE("a manifest says how far resin runs, where that is known", "[manifest]") {
    CHECK(manifest_text(sample()).find("spread_mm") == std::string::npos);
    auto stack = sample();
    stack.spread_mm = {0.05, 0.08};
    const auto text = manifest_text(stack);
    CHECK(parse_manifest(text, "m") == stack);
    CHECK(schema_faults("manifest", text).empty());
    CHECK_THROWS_WITH(parse_manifest(replaced(text, "0.08", "0.8"), "FILE"), Contains("spread_mm"));
    stack.orientation.swap_xy = true;
    CHECK(as_written(stack).spread_mm == std::array{0.08, 0.05});
}

TEST_CASE("a cube of 10 mm is a millilitre", "[manifest]") {
    CHECK(millilitres(1000, {1000, 1000, 1000}) == Approx(1.0));
    CHECK(millilitres(std::uint64_t{236} * 118 * 370, {42.333333, 84.666667, 27}) == Approx(0.997).margin(0.001));
}

TEST_CASE("a fault in a manifest is told by key and rule", "[manifest]") {
    const auto good = manifest_text(sample());
    auto fault = [&](const std::string& from, const std::string& to) {
        try {
            (void)parse_manifest(replaced(good, from, to), "FILE");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(fault("\"pitch_um\"", "\"pich_um\""), Contains("pich_um") && Contains("'pitch_um'"));
    CHECK_THAT(fault("\"voxels\"", "\"voxel\""), Contains("resins[0]") && Contains("'voxels'"));
    CHECK_THAT(fault("voxtone-layers", "voxtone-resins"), Contains("format"));
    CHECK_THAT(fault("\"version\": 1", "\"version\": 2"), Contains("version"));
    CHECK_THAT(fault("1418", "0"), Contains("size_px") && Contains("1 to 65535"));
    CHECK_THAT(fault("1418", "1400"), Contains("size_mm"));
    CHECK_THAT(fault("1418", "-3"), Contains("size_px"));
    CHECK_THAT(fault("1418", "1418.5"), Contains("size_px"));
    CHECK_THAT(fault("3920", "\"many\""), Contains("layers"));
    CHECK_THAT(fault("27", "-27"), Contains("pitch_um"));
    CHECK_THAT(fault("[220, 222, 216]", "[0, 0, 0]"), Contains("resins[0].rgb") && Contains("background"));
    CHECK_THAT(fault("[220, 222, 216]", "[0, 174, 239]"), Contains("one colour means one resin"));
    CHECK_THAT(fault("[220, 222, 216]", "[220, 222, 256]"), Contains("rgb"));
    CHECK_THAT(fault("\"role\": \"W\"", "\"role\": \"C\""), Contains("roles are unique"));
    CHECK_THAT(fault("%05d", "%03d"), Contains("pattern") && Contains("too few"));
    CHECK_THAT(fault("\"content_sha256\": \"", "\"content_sha256\": \"x"), Contains("hexadecimal"));
    for (const auto* pattern : {"../slice_%05d.png", "/tmp/slice_%05d.png", "layers/slice_%05d%s.png", "slice_%n.png",
                                "a/b/c_%05d.png", "slice.png"})
        CHECK_THAT(fault("layers/slice_%05d.png", pattern), Contains("pattern"));
}

TEST_CASE("a manifest cut anywhere is an error, never a crash", "[manifest][fuzz]") {
    const auto good = manifest_text(sample());
    for (std::size_t n = 0; n + 2 < good.size(); ++n)
        CHECK_THROWS_AS(parse_manifest(good.substr(0, n), "m"), InputError);
    // Any one byte changed: an error or a manifest, nothing else.
    for (std::size_t i = 0; i < good.size(); ++i)
        for (const char c : {'\0', '"', '9', '{', '\xff'}) {
            auto text = good;
            text[i] = c;
            try {
                (void)parse_manifest(text, "m");
            } catch (const InputError&) {
            }
        }
    CHECK_THROWS_AS(parse_manifest(std::string(1000000, '['), "m"), InputError);
    CHECK_THROWS_AS(parse_manifest("{\"format\":" + std::string(100000, '[') + std::string(100000, ']') + "}", "m"),
                    InputError);
}
