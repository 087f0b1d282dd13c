// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/component.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/look/composed_surface.h"
#include "slicer/plate/component_surface.h"
#include "slicer/plate/tray_parts.h"
#include "tests/said_progress.h"
#include "tests/slicer/plate/common_job.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

TrayPart part_of(ComponentKind kind, const std::array<double, 3>& mm, std::vector<ResinShare> mixture) {
    TrayPart part;
    part.name = "part";
    part.component = TrayComponent{kind, mm, std::move(mixture), {}};
    return part;
}

std::array<double, 3> at(const io::ViewerSurface& surface, std::size_t vertex) {
    std::array<double, 3> mm{};
    for (std::size_t a = 0; a < 3; ++a)
        mm[a] =
            surface.low_mm[a] + surface.positions[3 * vertex + a] / 65535.0 * (surface.high_mm[a] - surface.low_mm[a]);
    return mm;
}

}  // namespace

TEST_CASE("A cylinder stands where its size says, its resins in their shares") {
    Progress progress;
    const OpenedJob common = common_of();
    const ReadyComponent made = prepare_component(
        part_of(ComponentKind::cylinder, {6, 6, 2}, {{"verowhite", 1}, {"c", 2}, {"VeroCyanV", 1}}), common, progress);
    const double voxel_mm3 = made.layers->grid().voxel_volume_mm3(), mm3 = std::acos(-1) * 9 * 2;
    CHECK(double(made.all_voxels()) * voxel_mm3 == Approx(mm3).epsilon(0.005));
    CHECK(double(made.voxels[0]) * voxel_mm3 == Approx(0.75 * mm3).epsilon(0.005));
    CHECK(double(made.voxels[4]) * voxel_mm3 == Approx(0.25 * mm3).epsilon(0.005));
    // The outline is of cells of half a millimetre: the corners of its box are free, a cell more or less is rounding.
    CHECK_FALSE(made.outline.at(0, 0));
    CHECK(made.outline.at(6, 6));
    CHECK(double(made.outline.area()) * 0.25 == Approx(std::acos(-1) * 9).epsilon(0.25));
}

TEST_CASE("What a component's size is in whole voxels is told where that is another") {
    const OpenedJob common = common_of();
    const Eigen::Vector3d pitch = common.printer.sliced_pitch_mm();
    const auto notes = [&](const std::array<int, 3>& voxels, double off_mm) {
        SaidProgress said;
        const std::array<double, 3> mm{voxels[0] * pitch.x() + off_mm, voxels[1] * pitch.y(), voxels[2] * pitch.z()};
        (void)prepare_component(part_of(ComponentKind::box, mm, {{"W", 1}}), common, said);
        return said.notes();
    };
    CHECK_THAT(notes({60, 30, 40}, 0), !Contains("in whole voxels"));
    CHECK_THAT(notes({60, 30, 40}, 0.01),
               Contains("part: is 2.540 x 2.540 x 1.080 mm, in whole voxels of 42.33 x 84.67"));
}

TEST_CASE("Mirrors are of models alone, and refused where boxes would stay as they are") {
    TrayPlan plan;
    plan.file = common_of().options.raw.model;
    plan.common.out = "unused";
    plan.parts.push_back(part_of(ComponentKind::box, {6, 6, 2}, {{"W", 1}}));
    CHECK(common_job(plan));
    for (bool SliceOptions::*const flip : {&SliceOptions::flip_x, &SliceOptions::flip_y, &SliceOptions::swap_xy}) {
        TrayPlan mirrored = plan;
        mirrored.common.*flip = true;
        CHECK_THROWS_WITH(common_job(mirrored), Contains("none of its boxes") && Contains("printer's profile"));
        mirrored.parts.clear();
        CHECK_FALSE(common_job(mirrored));
    }
}

TEST_CASE("A component is shown as its shape, in the colour of its mixture") {
    Progress progress;
    const OpenedJob common = common_of("vero-opaque");
    const auto surface_of = [&](std::vector<ResinShare> mixture) {
        const ReadyComponent made =
            prepare_component(part_of(ComponentKind::cylinder, {6, 6, 2}, std::move(mixture)), common, progress);
        const auto surface = component_surface(made, common, 1'000'000, progress);
        REQUIRE(surface);
        return *surface;
    };
    const io::ViewerSurface white = surface_of({{"W", 1}}), cyan = surface_of({{"C", 1}}),
                            both = surface_of({{"W", 3}, {"C", 1}});
    constexpr double cell = 0.16;
    for (std::size_t a = 0; a < 3; ++a) {
        CHECK(white.low_mm[a] == Approx(0).margin(cell));
        CHECK(white.high_mm[a] == Approx(a < 2 ? 6 : 2).margin(cell));
    }
    double furthest = 0, outside = 0, of_side = 0;  // of the mantle: how far beyond it on average
    const std::size_t vertices = white.positions.size() / 3;
    REQUIRE(vertices > 500);
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto [x, y, z] = at(white, v);
        const double to_side = std::abs(std::hypot(x - 3, y - 3) - 3), to_end = std::min(z, 2 - z);
        furthest = std::max(furthest, std::min(to_side, to_end));
        if (to_end < 2 * cell) continue;
        outside += std::hypot(x - 3, y - 3) - 3;
        ++of_side;
    }
    CHECK(furthest < cell);
    REQUIRE(of_side > 300);
    CHECK(outside / of_side == Approx(0).margin(cell / 6));
    // sRGB codes: white is bright and even, cyan resin dark in red, a mixture between them.
    const auto rgb = [](const io::ViewerSurface& surface) {
        return std::array<int, 3>{surface.looks[0].rgb[0], surface.looks[0].rgb[1], surface.looks[0].rgb[2]};
    };
    for (const int code : rgb(white)) CHECK(code > 230);
    CHECK(rgb(cyan)[0] < 100);
    CHECK(rgb(cyan)[2] > rgb(cyan)[0] + 80);
    CHECK(rgb(both)[0] > rgb(cyan)[0] + 10);
    CHECK(rgb(both)[0] < rgb(white)[0] - 10);

    // White is opaque, and clear resin is seen through.
    CHECK(white.clear == 0);
    const OpenedJob with_clear = common_of("vero-opaque-clear", {"C", "M", "Y", "K", "W", "T"});
    const ReadyComponent block =
        prepare_component(part_of(ComponentKind::box, {4, 4, 2}, {{"T", 1}}), with_clear, progress);
    const auto clear = component_surface(block, with_clear, 1'000'000, progress);
    REQUIRE(clear);
    CHECK(clear->clear == clear->triangles.size());

    // Beside a body that is shown as asked for and as expected, with differences.
    io::ViewerSurface body = cyan;
    body.looks = {{"target", "", cyan.looks[0].rgb}, {"print", "", cyan.looks[0].rgb}};
    body.seen.assign(vertices, 7);
    const io::ViewerSurface shown = with_looks_of(white, body);
    const std::vector<PlacedSurface> placed{{&body, {{0, 0, 0}}}, {&shown, {{10, 0, 0}}}};
    const io::ViewerSurface tray = compose_surfaces(placed);
    REQUIRE(tray.looks.size() == 2);
    CHECK(tray.seen.size() == body.positions.size() / 3 + vertices);
    CHECK(tray.seen.front() == 7);
    CHECK(tray.seen.back() == 0);
}

TEST_CASE("What a component cannot be of, or is too small to be") {
    Progress progress;
    const OpenedJob common = common_of();
    const auto fault = [&](ComponentKind kind, const std::array<double, 3>& mm, const char* resin) -> std::string {
        try {
            (void)prepare_component(part_of(kind, mm, {{resin, 1}}), common, progress);
            return "none";
        } catch (const InputError& error) {
            return error.what();
        }
    };
    CHECK(fault(ComponentKind::box, {1, 1, 1}, "W") == "none");
    CHECK_THAT(fault(ComponentKind::box, {1, 1, 1}, "VeroClear"),
               Contains("VeroClear, which is not loaded") && Contains("(W)") && Contains("load"));
    CHECK_THAT(fault(ComponentKind::box, {1, 1, 0.01}, "W"), Contains("along z") && Contains("half a voxel"));
    CHECK_THAT(fault(ComponentKind::box, {5000, 1, 1}, "W"), Contains("65535"));
}
