// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

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
    for (const std::string option : {"--coat 1mm", "--enclose 0.5mm", "--view through", "--core T"}) {
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
