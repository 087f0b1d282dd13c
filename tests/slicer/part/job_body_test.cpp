// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body before it is printed: what is said of it, refused of it, and where it lies.
#include "slicer/part/job_body.h"

#include <array>
#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/mesh/box.h"
#include "slicer/part/opened_job.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

struct BodyDesk {
    /// Boxes from a corner to the other, red, each with eight corners of its own; `colour` of them.
    void boxes(const std::vector<std::array<double, 6>>& all, const std::string& colour = "0.5 0.1 0.1") {
        std::ofstream out(options.model);
        int first = 1;
        for (const auto& [x0, y0, z0, x1, y1, z1] : all) {
            for (int c = 0; c < 8; ++c)
                out << fmt::format("v {} {} {} {}\n", c & 1 ? x1 : x0, c & 2 ? y1 : y0, c & 4 ? z1 : z0, colour);
            for (const auto& [a, b, c, d] :
                 {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
                out << fmt::format("f {} {} {} {}\n", first + a, first + b, first + c, first + d);
            first += 8;
        }
    }
    BodyDesk() {
        options.model = (folder.path() / "model.obj").string();
        options.out = "unused";
        options.unit = "mm";
    }
    [[nodiscard]] JobBody body() const {
        const OpenedJob job = open_job(options);
        Progress progress;
        return prepare_body(job.options, job.printer, progress);
    }
    [[nodiscard]] std::string warnings() const {
        std::string all;
        for (const std::string& one : body().warnings) all += one + "\n";
        return all;
    }
    [[nodiscard]] std::string notes() const {
        std::string all;
        for (const std::string& one : body().notes) all += one + "\n";
        return all;
    }

    io::TemporaryFolder folder;
    SliceOptions options;
};

}  // namespace

TEST_CASE("Thin walls are told with their thickness and place, the first four by name") {
    BodyDesk desk;
    desk.boxes({{0, 0, 0, 6, 6, 3}});
    CHECK(desk.warnings().empty());
    // A wall of 0.3 mm on the right, another on the left.
    desk.boxes({{0, 0, 0, 12, 6, 3}, {10, 0, 3, 10.3, 6, 8}});
    CHECK_THAT(desk.warnings(), Contains("[fragile]") && Contains("walls under 0.6 mm") && Contains("0.3 mm over") &&
                                    Contains("right") && !Contains("left") && !Contains("; and"));
    CHECK_THAT(desk.warnings(), Contains("thickened in a mesh editor"));
    std::vector<std::array<double, 6>> many{{0, 0, 0, 20, 6, 3}};
    for (int n = 0; n < 6; ++n) many.push_back({1 + 3.0 * n, 0, 3, 1.3 + 3.0 * n, 6, 8});
    desk.boxes(many);
    CHECK_THAT(desk.warnings(), Contains("; and 2 more"));
    desk.options.scale = 3;
    CHECK_THAT(desk.warnings(), !Contains("[fragile]"));
}

TEST_CASE("Where a thin wall is, is said in words by the thirds of the body's box, and in figures") {
    BodyDesk desk;
    // Beside a block of 12 x 9 x 3 mm: upright in front on the left, and in the middle behind.
    desk.boxes({{0, 0, 0, 12, 9, 3}, {0.5, 0.5, 2, 0.8, 3.5, 8}});
    CHECK_THAT(desk.warnings(), Contains("left, front, above (0.7, 2.0, 5."));
    desk.boxes({{0, 0, 0, 12, 9, 3}, {5, 8.2, 2, 7, 8.5, 8}});
    CHECK_THAT(desk.warnings(), Contains("back, above (6.0, 8.3, 5.") && !Contains("left") && !Contains("right"));
    CHECK_THAT(desk.warnings(), Contains("2 times as large, or "));
    desk.options.printer = "generic";  // which says nothing of walls
    CHECK_THAT(desk.warnings(), !Contains("[fragile]"));
}

TEST_CASE("Pieces that meet in an edge alone are said to come apart, and where") {
    BodyDesk desk;
    desk.boxes({{0, 0, 0, 4, 4, 4}, {4, 4, 0, 8, 8, 4}});
    CHECK_THAT(desk.warnings(), Contains("[fragile]") && Contains("two pieces meet in a point or an edge alone, in the "
                                                                  "middle (4.0, 4.0, 2.0 mm)"));
    desk.boxes({{0, 0, 0, 4, 4, 4}, {4, 4, 0, 8, 8, 4}, {8, 8, 0, 12, 12, 4}});
    CHECK_THAT(desk.warnings(), Contains("2 pairs of pieces meet"));
    desk.boxes({{0, 0, 0, 4, 4, 4}, {3, 3, 0, 8, 8, 4}});
    CHECK_THAT(desk.warnings(), !Contains("pieces meet"));
}

TEST_CASE("A void within a body is told of, kept or filled as is asked for") {
    BodyDesk desk;
    {
        // A block of 12 mm whose inside, of 6 mm, is turned outside in.
        std::ofstream out(desk.options.model);
        for (const auto& [low, high] : {std::pair(0.0, 12.0), {3.0, 9.0}})
            for (int c = 0; c < 8; ++c)
                out << fmt::format("v {} {} {} 0.5 0.1 0.1\n", c & 1 ? high : low, c & 2 ? high : low,
                                   c & 4 ? high : low);
        for (const auto& [a, b, c, d] :
             {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}})
            out << fmt::format("f {} {} {} {}\nf {} {} {} {}\n", a, b, c, d, d + 8, c + 8, b + 8, a + 8);
    }
    for (const bool filled : {false, true}) {
        desk.options.cavities = filled ? "fill" : "keep";
        const JobBody body = desk.body();
        REQUIRE(body.repair.voids.size() == 1);
        CHECK(body.repair.voids[0].filled == filled);
        CHECK(body.repair.voids[0].volume_mm3 == Approx(216).epsilon(0.05));
        CHECK_THAT(desk.warnings(), Contains("[cavity]"));
        CHECK(body.solid->triangles.size() == (filled ? 12 : 24));
    }
}

TEST_CASE("Models that are tiny, without colour or coated through are told or refused") {
    BodyDesk desk;
    desk.boxes({{0, 0, 0, 1.9, 1.9, 1.9}});
    CHECK_THAT(desk.warnings(), Contains("[tiny]") && Contains("1.9 mm"));
    desk.boxes({{0, 0, 0, 2, 2, 2}});
    CHECK_THAT(desk.warnings(), !Contains("[tiny]"));
    desk.boxes({{0, 0, 0, 4, 4, 3}}, "");
    CHECK_THAT(desk.warnings(), Contains("[no-colour]"));
    desk.boxes({{0, 0, 0, 4, 4, 3}});
    CHECK_THAT(desk.warnings(), !Contains("[no-colour]"));
    desk.options.coat_mm = 1.5;
    CHECK_THROWS_WITH(desk.body(), Contains("--coat 1.5mm") && Contains("less than 1.5 mm"));
    CHECK_THROWS_AS(desk.body(), InputError);
    desk.options.coat_mm = 1.4;
    CHECK_NOTHROW(desk.body());
    desk.options.coat_mm = 0;
    desk.boxes({{0, 0, 0, 500, 4, 3}});
    CHECK_THROWS_AS(desk.body(), InputError);  // no tray is as long
}

TEST_CASE("A sheet is as thick as it was asked to be, and what has no face at its size is refused") {
    BodyDesk desk;
    const auto write = [&](const std::string& text) { std::ofstream(desk.options.model) << text; };
    write("v 0 0 0 1 0 0\nv 10 0 0 1 0 0\nv 10 6 0 0 1 0\nv 0 6 0 0 1 0\nf 1 2 3 4\n");
    desk.options.sheet_thickness_mm = 2;
    const JobBody sheet = desk.body();
    CHECK(sheet.placement.extent_mm.z() == Approx(2));
    CHECK(sheet.grid.size[2] == 74);
    desk.options.sheet_thickness_mm = 11;
    CHECK_THROWS_WITH(desk.body(), Contains("--sheet-thickness 11mm") && Contains("10 mm large"));
    desk.options.sheet_thickness_mm = 0;
    CHECK_THAT(enough_layers(desk.body()), Contains("--sheet-thickness") && !Contains("larger"));
    desk.boxes({{0, 0, 0, 4, 4, 0.5}});
    CHECK_THAT(enough_layers(desk.body()), Contains("larger (--size)") && !Contains("flat"));
    desk.options.sheet_thickness_mm = 0;
    // Scaled to 8 mm its other corners are one.
    write("v 1e8 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n");
    desk.options.size_mm = 8;
    CHECK_THROWS_AS(desk.body(), InputError);
    CHECK_THROWS_WITH(desk.body(), Contains("a line or a point at this size"));
}

TEST_CASE("Of a model that lies on its back it is said how it stands up, unless it was turned") {
    BodyDesk desk;
    // A tower along y with a broad foot.
    desk.boxes({{0, 0, 0, 6, 1, 6}, {2, 1, 2, 4, 15, 4}});
    const bool said = desk.notes().find("--rotate x90") != std::string::npos;
    CHECK(said);
    desk.options.rotate = "x90";
    CHECK_THAT(desk.notes(), !Contains("--rotate"));
    desk.options.rotate.clear();
    // It stands already.
    desk.boxes({{0, 0, 0, 6, 6, 1}, {2, 2, 1, 4, 4, 15}});
    CHECK_THAT(desk.notes(), !Contains("--rotate"));
}

TEST_CASE("Light leaves a body at its surface") {
    BodyDesk desk;
    desk.boxes({{1, 2, 3, 5, 8, 6}});
    const JobBody body = desk.body();
    const MeshBoundary boundary = boundary_of(body);
    const Eigen::AlignedBox3d box = bounding_box(body.solid->positions_mm, body.solid->triangles);
    const Eigen::Vector3d size(4, 6, 3);
    REQUIRE((box.sizes() - size).norm() < 1e-9);
    // From outside, along each axis, in the frame of the grid.
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        Eigen::Vector3d from = box.min() + Eigen::Vector3d(1, 1.3, 0.7) - body.grid.origin_mm;
        from[axis] = box.min()[axis] - body.grid.origin_mm[axis] - 2;
        optics::Point way{};
        way[std::size_t(axis)] = 1;
        double distance = 0;
        optics::BoundaryNormals normals;
        REQUIRE(boundary.meets({from.x(), from.y(), from.z()}, way, distance, normals));
        CHECK(distance == Approx(2).margin(1e-4));
        CHECK(normals.geometric[std::size_t(axis)] == Approx(-1));
        CHECK(normals.shading[std::size_t(axis)] == Approx(-1));
    }
}

TEST_CASE("Raised words make a body's grid larger, cut ones do not, and both are told of") {
    BodyDesk desk;
    desk.boxes({{0, 0, 0, 14, 14, 6}});
    const JobBody bare = desk.body();
    CHECK(bare.relief.empty());
    const auto labelled = [&](const char* words) {
        desk.options.labels = {std::string("H; size=6mm; place=top; ") + words};
        return desk.body();
    };
    const JobBody body = labelled("raise=8"), cut = labelled("engrave=8"), inked = labelled("colour=#ff0000");
    CHECK_FALSE(body.relief.empty());
    CHECK(body.grid.size[2] > bare.grid.size[2]);
    CHECK(body.grid.size[0] == bare.grid.size[0]);
    CHECK_FALSE(cut.relief.empty());
    CHECK(cut.grid.size == bare.grid.size);
    CHECK(inked.relief.empty());
    CHECK(inked.grid.size == bare.grid.size);
    CHECK(body.resin_of_decal.size() == 1);
    CHECK(bare.resin_of_decal.empty());
}
