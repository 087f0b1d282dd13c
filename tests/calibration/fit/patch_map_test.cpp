// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/patch_map.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/target/target_layout.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

Target small_target() {
    TargetOptions options;
    options.layout = TargetLayout::a;
    options.roles = {"C", "K", "W"};
    options.printer = "generic";
    options.pitch_um = {50, 50, 50};
    return lay_out_target(options);
}

/// Its squares in another order than they lie.
PatchTable table_of(const Target& target) {
    PatchTable table;
    table.source = "patches.csv";
    for (const TargetSquare& square : target.squares)
        table.patches.insert(table.patches.begin(), {square.top, square.backing, 0.675, 0, {}, {}, {}});
    return table;
}

std::size_t patch_at(const PatchMap& map, const Eigen::Vector2d& mm) {
    const auto column = std::size_t(mm.x() * map.px_per_mm),
               row = std::size_t((map.size_mm().y() - mm.y()) * map.px_per_mm);
    return map.patch_of[row * map.width_px + column];
}

}  // namespace

TEST_CASE("Patches lie on the map where their squares lie on the target, and what is between shows the same resins") {
    const Target target = small_target();
    const PatchTable table = table_of(target);
    const PatchMap map = patches_on_target(table, target, nullptr);
    CHECK(map.is_target);
    CHECK(map.size_mm().x() == Approx(target.size_mm.x()).margin(0.3));
    const std::size_t squares = target.squares.size();
    for (std::size_t s = 0; s < squares; ++s) {
        CAPTURE(s);
        const std::size_t patch = squares - s;
        CHECK((map.middles_mm[patch - 1] - target.squares[s].area.center()).norm() < 1e-9);
        const Area inside = target.squares[s].area.shrunk(0.4);
        for (const Eigen::Vector2d& mm : {inside.min_mm, inside.max_mm, inside.center()})
            CHECK(patch_at(map, mm) == patch);
    }
    const auto patch_of = [&](const char* top, const char* backing) {
        const auto found = std::ranges::find_if(
            table.patches, [&](const Patch& p) { return p.top[0].role == top && p.backing == backing; });
        return std::size_t(found - table.patches.begin()) + 1;
    };
    CHECK(patch_at(map, {1, target.size_mm.y() / 2}) == patch_of("W", "W"));
    CHECK(patch_at(map, target.dark_half.min_mm + Eigen::Vector2d::Constant(0.5)) == patch_of("K", "K"));
    // The border of a marker is dark resin, let into the light one.
    CHECK(patch_at(map, target.markers[0].area.min_mm + Eigen::Vector2d::Constant(0.5)) == patch_of("K", "W"));
}

TEST_CASE("A photograph of the target lies under the map, one of something else is refused") {
    const Target target = small_target();
    const PatchTable table = table_of(target);
    io::Photograph photo;
    photo.name = "straight.png";
    photo.width_px = 300;
    photo.height_px = std::uint32_t(std::lround(300 * target.size_mm.y() / target.size_mm.x()));
    photo.pixels.assign(std::size_t{photo.width_px} * photo.height_px, {1.0f, 0.0f, 0.0f});
    const PatchMap map = patches_on_target(table, target, &photo);
    CHECK(map.width_px == photo.width_px);
    CHECK(map.height_px == photo.height_px);
    REQUIRE(map.photograph.size() == 3 * photo.pixels.size());
    CHECK(std::vector<int>(map.photograph.begin(), map.photograph.begin() + 3) == std::vector{255, 0, 0});
    photo.width_px = photo.height_px;
    photo.pixels.resize(std::size_t{photo.width_px} * photo.height_px);
    CHECK_THROWS_WITH(patches_on_target(table, target, &photo), Contains("straight.png") && Contains("straightened"));
}

TEST_CASE("A table of another target is refused, one that lacks squares is shown") {
    const Target target = small_target();
    PatchTable other = table_of(target);
    for (Patch& patch : other.patches) patch.top = {{"M", 1}};
    CHECK_THROWS_WITH(patches_on_target(other, target, nullptr), Contains("patches.csv") && Contains("C, K, W"));
    PatchTable part = table_of(target);
    part.patches.resize(2);
    const PatchMap map = patches_on_target(part, target, nullptr);
    CHECK(std::ranges::count(map.patch_of, 0) > 0);
    CHECK(std::ranges::count(map.patch_of, 2) > 0);
}

TEST_CASE("Where no target is known patches are a chart, a row for each resin below") {
    const PatchTable table = table_of(small_target());
    const PatchMap map = chart_of_patches(table);
    CHECK_FALSE(map.is_target);
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        CHECK(patch_at(map, map.middles_mm[p]) == p + 1);
        for (std::size_t q = 0; q < p; ++q)
            CHECK((map.middles_mm[p].y() == map.middles_mm[q].y()) ==
                  (table.patches[p].backing == table.patches[q].backing));
    }
    PatchTable none;
    CHECK(chart_of_patches(none).patch_of.size() > 0);
}

TEST_CASE("What a page of patches is told is asked first") {
    PatchMapFiles files;
    CHECK_NOTHROW(files.validate(""));
    files.picture = "straight.png";
    CHECK_THROWS_WITH(files.validate("page.html"), Contains("--target"));
    files.target = "target.json";
    CHECK_NOTHROW(files.validate("page.html"));
    CHECK_THROWS_WITH(files.validate(""), Contains("no page"));
}
