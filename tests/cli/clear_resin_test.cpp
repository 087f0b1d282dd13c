// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/pictures/picture_writer.h"
#include "run_program.h"
#include "tests/places.h"

using namespace voxtone::test;

namespace {

const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png";
const std::string with_clear = " --resins vero-opaque-clear --load C,M,Y,K,W,T --quiet ";

nlohmann::json json_of(const std::string& file) { return nlohmann::json::parse(read_file(file)); }

/// Of the resin, in the layers' bitmaps.
std::array<std::uint8_t, 3> colour_of(const nlohmann::json& manifest, const std::string& role) {
    for (const auto& resin : manifest.at("resins"))
        if (resin.at("role") == role) return resin.at("rgb").get<std::array<std::uint8_t, 3>>();
    return {};
}

/// Share of the middle row of a layer that is of this colour.
double share_of(const std::string& layer, const std::array<std::uint8_t, 3>& colour) {
    const Bitmap bitmap = read_png(layer);
    int found = 0;
    for (int x = 0; x < bitmap.width; ++x) {
        const auto p = bitmap.at(x, bitmap.height / 2);
        found += p[0] == colour[0] && p[1] == colour[1] && p[2] == colour[2];
    }
    return double(found) / bitmap.width;
}

}  // namespace

TEST_CASE("What takes clear resin loads it where a slot is free, and says how to where none is") {
    const Folder folder("no-clear");
    for (const std::string option :
         {"--coat 1mm", "--enclose 0.5mm", "--view through", "--core T", "--alpha translucency"}) {
        CAPTURE(option);
        const std::string slice =
            fmt::format("slice {} --width 3mm {} --quality draft --no-report --quiet --overwrite -o {} ", picture,
                        option, folder / "out");
        REQUIRE(run_program(slice).exit_code == 0);
        CHECK(json_of(folder / "out/manifest.json").at("resins").size() == 6);
        CHECK(json_of(folder / "out/job.json").dump().find("j750-vivid-clear") != std::string::npos);
        const auto refused = [&](const std::string& said, const std::string& remedy) {
            const Outcome outcome = run_program(slice + said);
            CHECK(outcome.exit_code == 3);
            CHECK(outcome.err.find(remedy) != std::string::npos);
        };
        refused("--resins j750-vivid", "give --resins j750-vivid-clear --load C,M,Y,K,W,T");
        refused("--resins vero-opaque", "give --resins vero-opaque-clear --load C,M,Y,K,W,T");
        refused("--load C,M,Y,K,W", "give --load C,M,Y,K,W,T");
        refused("--printer stratasys-j55", "give --load C,M,Y,W,T");
    }
    const Outcome both = run_program(
        fmt::format("slice {} --width 3mm --coat 1mm --enclose 1mm{}-o {}", picture, with_clear, folder / "out"));
    CHECK(both.exit_code == 2);
}

TEST_CASE("A coat and what encloses a picture are layers of clear resin, over and under it") {
    const Folder folder("clear");
    for (const std::string loop : {"0", "1"}) {
        CAPTURE(loop);
        const std::string out = folder / ("out" + loop);
        REQUIRE(run_program(fmt::format("slice {} --width 2.4mm --thickness 0.54mm --enclose 0.27mm --iterations {} "
                                        "--predict none{}-o {}",
                                        picture, loop, with_clear, out))
                    .exit_code == 0);
        const nlohmann::json manifest = json_of(out + "/manifest.json");
        REQUIRE(manifest.at("layers") == 40);
        const auto clear = colour_of(manifest, "T");
        for (int k = 0; k < 40; ++k) {
            CAPTURE(k);
            const double share = share_of(fmt::format("{}/layers/slice_{:05}.png", out, k), clear);
            if (k < 10 || k >= 30) CHECK(share == 1);
            if (k >= 10 && k < 30) CHECK(share < 0.9);
        }
    }
}

TEST_CASE("What clear resin cannot do is refused in a sentence: a dark lithophane, a sheet of another shape") {
    const Folder folder("refused-clear");
    const auto refused = [&](const std::string& words, int code, const std::string& said) {
        const Outcome outcome =
            run_program(fmt::format("slice {} --width 3mm {} --quiet -o {}", picture, words, folder / "out"));
        CAPTURE(words, outcome.err);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Catch::Matchers::Contains(said));
    };
    refused("--view through --core W --thickness 10mm", 3, "9 mm of W below the colours let 0.55 % of the light");
    voxtone::io::Picture8 wide{4, 2, 3, std::vector<std::uint8_t>(24, 90)};
    const auto bytes = voxtone::io::png_bytes(wide);
    folder.write("wide.png", std::string(bytes.begin(), bytes.end()));
    refused("--backing " + folder / "wide.png", 3, "4 x 2 px are 2.000 times as wide as high");
    refused("--coat 11mm", 2, "must be 0 to 10 mm");
}

TEST_CASE("One picture is seen by day and another by light from behind, and what the night gave up is told") {
    const Folder folder("day-and-night");
    /// Halves of two greys: left and right, or upper and lower.
    const auto halves = [&](const std::string& name, int first, int second, bool upright, int width = 40) {
        voxtone::io::Picture8 codes{std::uint32_t(width), 40, 3, {}};
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < width; ++x)
                codes.codes.insert(codes.codes.end(), 3, std::uint8_t((upright ? x : y) < 20 ? first : second));
        const auto bytes = voxtone::io::png_bytes(codes);
        folder.write(name, std::string(bytes.begin(), bytes.end()));
        return folder / name;
    };
    const std::string day = halves("day.png", 240, 205, true), night = halves("night.png", 240, 90, false);
    const std::string slice = fmt::format("slice {} --view both --width 6mm -o {} --overwrite ", day, folder / "out");
    const Outcome made = run_program(slice + "--night " + night + " --depth 0.4mm --thickness 1.6mm --iterations 0");
    INFO(made.err << made.out);
    REQUIRE(made.exit_code == 0);
    CHECK_THAT(made.out, Catch::Matchers::Contains("By light from behind"));
    /// Code of green in the middle of a quarter.
    const auto seen = [&](const std::string& file, bool right, bool lower) {
        const Bitmap picture = read_png(folder / file);
        double sum = 0;
        for (int dy = -4; dy <= 4; ++dy)
            for (int dx = -4; dx <= 4; ++dx)
                sum +=
                    picture.at((right ? 3 : 1) * picture.width / 4 + dx, (lower ? 3 : 1) * picture.height / 4 + dy)[1];
        return sum / 81;
    };
    for (const bool lower : {false, true}) {
        CHECK(seen("out/predicted.png", false, lower) - seen("out/predicted.png", true, lower) > 20);
        // The day's colours are made up for: what is left of them by night is less than they show by day.
        CHECK(std::abs(seen("out/night.png", false, lower) - seen("out/night.png", true, lower)) < 20);
    }
    for (const bool right : {false, true}) {
        CHECK(std::abs(seen("out/predicted.png", right, false) - seen("out/predicted.png", right, true)) < 12);
        CHECK(seen("out/night.png", right, false) - seen("out/night.png", right, true) > 100);
    }
    REQUIRE(run_program(fmt::format("predict {} --light behind --quiet -o {}", folder / "out", folder / "b.png"))
                .exit_code == 0);
    CHECK(seen("b.png", false, false) > 1.5 * seen("b.png", false, true));
    const auto refused = [&](const std::string& words, int code, const std::string& said) {
        const Outcome outcome = run_program(words);
        CAPTURE(words, outcome.err);
        CHECK(outcome.exit_code == code);
        CHECK_THAT(outcome.err, Catch::Matchers::Contains(said));
    };
    refused(slice, 2, "wants a second picture: --night FILE");
    refused(slice + "--night " + halves("wide.png", 0, 255, true, 60), 3, "1.500 times as wide as high");
    refused(slice + "--thickness 2mm --night " + night, 3, "nothing is left between them");
    refused(fmt::format("slice {} --night {} --width 6mm -o {}", day, night, folder / "no"), 2, "only --view both");
    refused(fmt::format("predict {} --light behind --backing white -o {}", folder / "out", folder / "c.png"), 2,
            "between the print and --light behind");
}

TEST_CASE("An estimate counts the clear resin that alpha asks for") {
    const Folder folder("estimated-alpha");
    voxtone::io::Picture8 codes{60, 20, 4, {}};
    for (int i = 0; i < 60 * 20; ++i)
        for (const int code : {200, 60, 40, i % 60 < 20 ? 255 : i % 60 < 40 ? 90 : 0})
            codes.codes.push_back(std::uint8_t(code));
    const auto bytes = voxtone::io::png_bytes(codes);
    folder.write("ramp.png", std::string(bytes.begin(), bytes.end()));
    const std::string words =
        fmt::format("{} --width 6mm --thickness 3mm --alpha translucency --quality draft", folder / "ramp.png");
    const Outcome estimate = run_program("estimate --json --quiet " + words);
    REQUIRE(estimate.exit_code == 0);
    REQUIRE(run_program(fmt::format("slice {} --quiet -o {}", words, folder / "out")).exit_code == 0);
    const nlohmann::json report = json_of(folder / "out/report.json");
    CHECK(report.at("translucency").at("asked_mean").get<double>() == Approx((1 + 90 / 255.0) / 3).margin(0.02));
    CHECK(report.at("translucency").at("given_up").at("share") < 0.03);  // pixels between opaque and not
    const std::string page = read_file(folder.path() / "out/report.html");
    for (const char* map : {"alpha asked for:", "alpha that the resins show", "alpha given up:"}) {
        const auto picture = page.find(map);  // beside the others, and a look of the viewer
        REQUIRE(picture != std::string::npos);
        CHECK(page.find(map, picture + 1) != std::string::npos);
    }
    const nlohmann::json estimated = nlohmann::json::parse(estimate.out).at("result");
    double clear = 0;
    for (const auto& resin : estimated.at("resins")) {
        double printed = 0;
        for (const auto& other : report.at("resins"))
            if (other.at("role") == resin.at("role")) printed = other.at("ml");
        CAPTURE(resin.at("role"), resin.at("ml"), printed);
        CHECK(resin.at("ml").get<double>() == Approx(printed).margin(0.0005));
        if (resin.at("role") == "T") clear = printed;
    }
    CHECK(clear > 0.012);  // a third, and some of the next
}

TEST_CASE("A coat lies within a model's surface, and colour below it") {
    const Folder folder("coated-body");
    folder.write("box.obj", soft_box_obj(4, 3, 2.7));
    const auto sizes = [&](const std::string& coat) {
        const std::string out = folder / ("out" + coat);
        REQUIRE(run_program(fmt::format("slice {} --coat {} --iterations 0 --predict none{}-o {}", folder / "box.obj",
                                        coat, with_clear, out))
                    .exit_code == 0);
        return json_of(out + "/manifest.json");
    };
    const nlohmann::json bare = sizes("0mm"), coated = sizes("0.5mm");
    CHECK(coated.at("size_px") == bare.at("size_px"));
    CHECK(coated.at("layers") == bare.at("layers"));
    const auto clear = colour_of(coated, "T");
    const std::string out = folder / "out0.5mm";
    CHECK(share_of(out + "/layers/slice_00005.png", clear) == 1);
    const Outcome thick =
        run_program(fmt::format("slice {} --coat 1.4mm{}-o {}", folder / "box.obj", with_clear, folder / "thick"));
    CHECK(thick.exit_code == 3);
    CHECK(thick.err.find("less than 1.35 mm") != std::string::npos);
    // Half a millimetre on either side of four.
    CHECK(share_of(out + "/layers/slice_00050.png", clear) == Approx(0.25).margin(0.03));
}

TEST_CASE("Alpha is how clear a print is: in shell and core, and nothing else where it is 1") {
    const Folder folder("alpha");
    /// Red; by thirds of the width opaque, of this alpha, and clear. `times_alpha`: as a renderer may leave it.
    const auto picture = [&](const std::string& name, int alpha, int last, bool times_alpha) {
        voxtone::io::Picture8 codes{60, 20, 4, {}};
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 60; ++x) {
                const int a = x < 20 ? 255 : x < 40 ? alpha + (times_alpha ? 8 * (x - 30) : 0) : last;
                const int scale = times_alpha ? a : 255;
                for (const int code : {200 * scale / 255, (times_alpha ? 255 : 60) * scale / 255, 40 * scale / 255, a})
                    codes.codes.push_back(std::uint8_t(code));
            }
        const auto bytes = voxtone::io::png_bytes(codes);
        folder.write(name, std::string(bytes.begin(), bytes.end()));
        return folder / name;
    };
    const auto sliced = [&](const std::string& words, const std::string& name) {
        const Outcome outcome =
            run_program(fmt::format("slice {} --width 6mm --thickness 3mm --iterations 0 --predict none --resins "
                                    "vero-opaque-clear --load C,M,Y,K,W,T --overwrite -o {}",
                                    words, folder / name));
        INFO(outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return outcome.err;
    };
    using Catch::Matchers::Contains;
    const std::string ramp = picture("ramp.png", 40, 0, false), opaque = picture("opaque.png", 255, 255, false);
    CHECK_THAT(sliced(ramp, "white"), Contains("laid over white") && Contains("--alpha translucency"));
    CHECK_THAT(sliced(ramp + " --alpha translucency", "ramp"), !Contains("[transparent]"));
    (void)sliced(opaque, "opaque"), (void)sliced(opaque + " --alpha translucency", "one");
    const auto clear = colour_of(json_of(folder / "ramp/manifest.json"), "T");
    for (const int k : {2, 55, 108}) {  // core to surface
        CAPTURE(k);
        const std::string layer = fmt::format("/layers/slice_{:05}.png", k);
        CHECK(read_file(folder.path() / ("one" + layer)) == read_file(folder.path() / ("opaque" + layer)));
        const Bitmap thinned = read_png(folder / ("ramp" + layer)), whole = read_png(folder / ("opaque" + layer));
        const auto share = [&](double from, double to) {
            int found = 0, all = 0;
            for (int y = 0; y < thinned.height; ++y)
                for (int x = int(from * thinned.width); x < int(to * thinned.width); ++x, ++all) {
                    const auto p = thinned.at(x, y);
                    found += p[0] == clear[0] && p[1] == clear[1] && p[2] == clear[2];
                }
            return double(found) / all;
        };
        // A pixel's breadth beside borders, where alpha is between.
        CHECK(share(0.7, 1) == 1);
        CHECK(share(0.37, 0.63) > 0.5);
        CHECK(share(0.37, 0.63) < 0.95);
        for (int y = 0; y < whole.height; ++y)
            for (int x = 0; x < int(0.3 * whole.width); ++x) REQUIRE(thinned.at(x, y) == whole.at(x, y));
    }
    CHECK_THAT(sliced(picture("times.png", 120, 0, true) + " --alpha translucency", "out"),
               Contains("[premultiplied]"));
    CHECK_THAT(sliced(picture("much.png", 245, 0, false) + " --alpha translucency", "out"), Contains("[alpha-range]"));
    CHECK(json_of(folder / "out/report.json").at("translucency").at("given_up").at("max") > 0.05);
}
