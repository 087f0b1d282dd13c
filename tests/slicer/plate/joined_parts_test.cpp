// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/joined_body.h"

#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "slicer/part/opened_job.h"
#include "slicer/solid/solid.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// A box as a PLY file with one colour, in a folder of this process.
std::string box_file(const std::string& name, const Eigen::Vector3d& size, const std::string& rgb) {
    static const io::TemporaryFolder folder;
    std::ofstream out(folder.path() / name);
    out << "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 12\n"
           "property list uchar int vertex_indices\nend_header\n";
    for (int c = 0; c < 8; ++c)
        out << fmt::format("{} {} {} {}\n", c & 1 ? size.x() : 0, c & 2 ? size.y() : 0, c & 4 ? size.z() : 0, rgb);
    out << "3 0 2 3\n3 0 3 1\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 6 7\n3 2 7 3\n3 0 4 6\n3 0 6 2\n3 1 3 7\n3 1 7 "
           "5\n";
    return (folder.path() / name).string();
}

JobBody body_of(const std::string& model) {
    SliceOptions options;
    options.model = model;
    options.out = "unused";
    const OpenedJob job = open_job(options);
    Progress progress;
    return prepare_body(job.options, job.printer, progress);
}

std::vector<bool> voxels_of(const JobBody& body) {
    const VoxelGrid& grid = body.grid;
    const Solid solid(*body.solid, grid);
    std::vector<bool> filled(std::size_t(grid.size[0]) * std::size_t(grid.size[1]) * std::size_t(grid.size[2]));
    SpanSlab spans;
    solid.slab(0, grid.size[2], spans);
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (const Span& span : spans.row(j, k))
                for (int i = span.begin; i < span.end; ++i)
                    filled[(std::size_t(k) * std::size_t(grid.size[1]) + std::size_t(j)) * std::size_t(grid.size[0]) +
                           std::size_t(i)] = true;
    return filled;
}

}  // namespace

TEST_CASE("Joined bodies have the voxels of both, in their places", "[tray]") {
    const JobBody a = body_of(box_file("a.ply", {3, 2, 1.5}, "255 255 255")),
                  b = body_of(box_file("b.ply", {1, 2.5, 2}, "10 20 30"));
    const int beside = GENERATE(0, 40, 71, 75);  // b's columns from a's: within it, across its end, touching, apart
    CAPTURE(beside);
    Progress progress;
    const std::array bodies{BodyAt{&a, {0, 3, 0}}, BodyAt{&b, {beside, 0, 5}}};
    const JobBody whole = join_bodies(bodies, progress);
    const std::vector<bool> joined = voxels_of(whole);
    std::vector<bool> wanted(joined.size());
    for (const BodyAt& one : bodies) {
        const std::vector<bool> own = voxels_of(*one.body);
        const auto& size = one.body->grid.size;
        std::size_t at = 0;
        for (int k = 0; k < size[2]; ++k)
            for (int j = 0; j < size[1]; ++j)
                for (int i = 0; i < size[0]; ++i)
                    if (own[at++])
                        wanted[(std::size_t(k + one.at[2]) * std::size_t(whole.grid.size[1]) +
                                std::size_t(j + one.at[1])) *
                                   std::size_t(whole.grid.size[0]) +
                               std::size_t(i + one.at[0])] = true;
    }
    CHECK(joined == wanted);
}

TEST_CASE("What was mended of joined bodies is added up", "[tray]") {
    const std::string box = box_file("a.ply", {3, 2, 1.5}, "255 255 255");
    JobBody a = body_of(box), b = body_of(box);
    std::size_t n = 1;
    for (RepairReport* one : {&a.repair, &b.repair}) {
        for (std::size_t* count : {&one->welded_vertices, &one->dropped_faces, &one->turned_faces, &one->turned_shells,
                                   &one->cavities, &one->filled_holes, &one->wrapped_faces})
            *count = n++;
        one->filled_area_mm2 = double(n++), one->wrap_alpha_mm = double(n++), one->wrap_offset_mm = double(n++);
    }
    Progress progress;
    const RepairReport sum =
        join_bodies(std::array{BodyAt{&a, {0, 0, 0}}, BodyAt{&b, {a.grid.size[0] + 3, 0, 0}}}, progress).repair;
    CHECK(sum.welded_vertices == 1 + 11);
    CHECK(sum.dropped_faces == 2 + 12);
    CHECK(sum.turned_faces == 3 + 13);
    CHECK(sum.turned_shells == 4 + 14);
    CHECK(sum.cavities == 5 + 15);
    CHECK(sum.filled_holes == 6 + 16);
    CHECK(sum.wrapped_faces == 7 + 17);
    CHECK(sum.filled_area_mm2 == 8 + 18);
    CHECK(sum.wrap_alpha_mm == 19);
    CHECK(sum.wrap_offset_mm == 20);
}

TEST_CASE("What of joined bodies lies in the other, or touches it, is not coloured", "[tray]") {
    const JobBody a = body_of(box_file("a.ply", {3, 2, 1.5}, "255 255 255")),
                  b = body_of(box_file("b.ply", {1, 2, 1.5}, "10 20 30"));
    const double a_area = 2 * (3 * 2 + 3 * 1.5 + 2 * 1.5), b_area = 2 * (1 * 2 + 1 * 1.5 + 2 * 1.5);
    Progress progress;
    const auto coloured = [&](int columns) {
        const std::array bodies{BodyAt{&a, {0, 0, 0}}, BodyAt{&b, {columns, 0, 0}}};
        return coloured_area_mm2(*join_bodies(bodies, progress).surface);
    };
    const int touching = a.grid.size[0];
    CHECK(coloured(touching) == Approx(a_area + b_area - 2 * 2 * 1.5).margin(0.1 * 7));
    CHECK(coloured(touching + 3) == Approx(a_area + b_area));  // 0.127 mm of air
    // Every colour is that of its own body.
    const std::array bodies{BodyAt{&a, {0, 0, 0}}, BodyAt{&b, {touching + 3, 0, 0}}};
    const JobBody whole = join_bodies(bodies, progress);
    for (std::size_t t = 0; t < whole.surface->triangles.size(); ++t) {
        const std::uint32_t source = whole.surface->source_triangle[t];
        const double x = whole.surface->positions_mm[whole.surface->triangles[t][0]].x();
        CHECK((source < 12) == (x < 3.05));
    }
}
