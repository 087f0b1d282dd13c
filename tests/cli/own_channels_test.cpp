// SPDX-License-Identifier: GPL-3.0-or-later
//
// A set in channels of its own, through the whole program: vero-opaque with each of its channels in two halves must
// make the prints that vero-opaque makes, and they must be seen as those.
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "io/profiles/resin_file.h"
#include "run_program.h"
#include "tests/optics/colour/split_channels.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::test;

namespace {

const std::string picture = source_dir() + "/examples/models/spot/spot_texture.png";

std::string own_set(const Folder& folder, const optics::testing::Parts& parts, const std::string& name) {
    folder.write(name, io::resin_set_text(optics::testing::split_set(optics::vero_opaque(), parts)));
    return folder / name;
}

nlohmann::json slice(const Folder& folder, const std::string& resins, const std::string& out, int iterations) {
    REQUIRE(run_program(fmt::format("slice --quiet {} --width 3mm --thickness 1mm --resins {} --iterations {} -o {}",
                                    picture, resins, iterations, folder / out))
                .exit_code == 0);
    return nlohmann::json::parse(read_file(folder / (out + "/manifest.json")));
}

std::array<double, 3> mean_seen(const Folder& folder, const std::string& stack, const std::string& resins) {
    const std::string file = folder / (stack + ".exr");
    const Outcome outcome = run_program(fmt::format(
        "predict --overwrite --json --predict transport {} --resins {} -o {}", folder / stack, resins, file));
    REQUIRE(outcome.exit_code == 0);
    const std::size_t begin = outcome.out.rfind('\n', outcome.out.size() - 2);
    const auto result = nlohmann::json::parse(outcome.out.substr(begin == std::string::npos ? 0 : begin + 1));
    return result.at("result").at("mean_rgb").get<std::array<double, 3>>();
}

void check_near(const std::array<double, 3>& a, const std::array<double, 3>& b, double margin) {
    for (std::size_t k = 0; k < 3; ++k) CHECK(a[k] == Approx(b[k]).margin(margin));
}

void check_same_resins(const nlohmann::json& a, const nlohmann::json& b, double share) {
    for (std::size_t r = 0; r < a.at("resins").size(); ++r) {
        const auto voxels = [r](const nlohmann::json& of) { return of.at("resins")[r].at("voxels").get<double>(); };
        CAPTURE(r, voxels(a), voxels(b));
        CHECK(std::abs(voxels(a) - voxels(b)) <= share * voxels(a) + 2);
    }
}

}  // namespace

TEST_CASE("A set in six channels of its own prints what the R, G, B set prints that shows the same colours") {
    const Folder folder("own-channels");
    const std::string own = own_set(folder, optics::testing::all_twice, "own.json");
    const auto as_rgb = slice(folder, "vero-opaque", "rgb", 0), as_own = slice(folder, own, "own", 0);
    check_same_resins(as_rgb, as_own, 1e-3);
    const auto seen = mean_seen(folder, "rgb", "vero-opaque");
    check_near(mean_seen(folder, "rgb", own), seen, 1e-4);  // the same print
    check_near(mean_seen(folder, "own", own), seen, 1e-3);
    // With one of its channels in halves alone the predictor's cells may be cut otherwise.
    const std::string green = own_set(folder, optics::testing::green_twice, "green.json");
    check_near(mean_seen(folder, "rgb", green), seen, 1e-3);
    CHECK_FALSE(read_file(folder / "rgb.exr").find("c4") == std::string::npos);
}

TEST_CASE("The appearance loop on channels of its own comes to where it comes in R, G, B") {
    const Folder folder("own-loop");
    const std::string own = own_set(folder, optics::testing::all_twice, "own.json");
    const auto as_rgb = slice(folder, "vero-opaque", "rgb", 3), as_own = slice(folder, own, "own", 3);
    check_same_resins(as_rgb, as_own, 0.01);
    check_near(mean_seen(folder, "own", own), mean_seen(folder, "rgb", "vero-opaque"), 3e-3);
}
