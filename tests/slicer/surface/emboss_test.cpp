// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/emboss.h"

#include <cmath>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "slicer/layers/block_fill.h"
#include "slicer/options/mark_words.h"
#include "slicer/printer/placement.h"
#include "slicer/solid/solid.h"
#include "slicer/surface/lay_marks.h"
#include "slicer/surface/surface_shell.h"
#include "tests/slicer/mesh/shapes.h"
#include "tests/slicer/surface/seen_marks.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

const Eigen::Vector3d pitch_mm(0.05, 0.1, 0.03);

struct Embossed {
    test::Body body;
    LaidMarks laid;
    VoxelGrid grid;
    std::vector<std::int64_t> more;  ///< voxels of each layer, against the body without the mark
    double ink_mm2 = 0;
};

Embossed emboss(const SolidMesh& mesh, const std::string& label) {
    Embossed made{test::body_of(mesh, Eigen::Vector3f::Ones()), {}, {}, {}, 0};
    made.laid =
        lay_marks({parse_mark(MarkFamily::label, label)}, {made.body.mesh, made.body.solid, made.body.surface}, {});
    Eigen::AlignedBox3d box = box_of_raised(made.laid.embossed, pitch_mm);
    for (const Eigen::Vector3d& p : mesh.positions_mm) box.extend(p);
    made.grid = grid_around(box.min(), box.max(), pitch_mm);
    const int layers = made.grid.size[2];
    const SpanSlab plain = Solid(mesh, made.grid).slab(0, layers),
                   marked = Solid(mesh, made.grid, relief_of(made.laid.embossed, made.grid, 1)).slab(0, layers);
    for (int k = 0; k < layers; ++k)
        made.more.push_back(std::int64_t(marked.voxels_of_layer(k)) - std::int64_t(plain.voxels_of_layer(k)));
    const io::Coverage& ink = made.laid.embossed.at(0).ink;
    for (const std::uint8_t share : ink.ink) made.ink_mm2 += share / 255.0 * ink.pixel_mm * ink.pixel_mm;
    return made;
}

}  // namespace

TEST_CASE("A raised label adds so many layers of its ink above a face, an engraved one takes as many below it") {
    const SolidMesh box = shapes::box(Eigen::Vector3d::Zero(), {12, 8, 3});
    const Embossed raised = emboss(box, "HO8; size=5mm; place=top; raise=4");
    const std::size_t layers = raised.more.size();
    const double voxel_mm2 = pitch_mm.x() * pitch_mm.y();
    REQUIRE(layers == 104);
    for (std::size_t k = 0; k < layers; ++k) {
        INFO("layer " << k);
        if (k < layers - 4) CHECK(raised.more[k] == 0);
        // The staircase of a letter's outline: within 3 % of its area.
        if (k >= layers - 4) CHECK(double(raised.more[k]) * voxel_mm2 == Approx(raised.ink_mm2).epsilon(0.03));
    }
    const Embossed engraved = emboss(box, "HO8; size=5mm; place=top; engrave=4; colour=none");
    REQUIRE(engraved.more.size() == 100);
    for (std::size_t k = 0; k < 100; ++k) {
        INFO("layer " << k);
        if (k < 96) CHECK(engraved.more[k] == 0);
        if (k >= 96) CHECK(double(engraved.more[k]) * voxel_mm2 == Approx(-engraved.ink_mm2).epsilon(0.03));
    }
}

TEST_CASE("A raised label stands straight on a slanting face") {
    SolidMesh slanting = shapes::box(Eigen::Vector3d::Zero(), {12, 12, 12});
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix();
    for (Eigen::Vector3d& p : slanting.positions_mm) p = turn * p;
    const Embossed raised = emboss(slanting, "HO8; size=5mm; raise=8");
    const double high_mm = 8 * voxel_mm_along(pitch_mm, raised.laid.embossed[0].frame.axes.out);
    double volume = 0;
    for (const std::int64_t more : raised.more) {
        CHECK(more >= 0);
        volume += double(more) * raised.grid.voxel_volume_mm3();
    }
    CHECK(volume == Approx(raised.ink_mm2 * high_mm).epsilon(0.03));
}

TEST_CASE("A relief changes rows that it names and leaves others as they are") {
    SpanSlab body;
    body.reset(2, 4, 2);
    for (int row = 0; row < 4; ++row) {
        body.push(0, 10);
        body.push(20, 30);
        body.end_row();
    }
    const SpanSlab before = body;
    Relief({{7, 0, 0, 5, true}}).apply(body);
    CHECK(body == before);
    Relief({{3, 1, 5, 25, false}, {3, 1, 7, 9, true}, {2, 0, 10, 20, true}}).apply(body);
    const auto row = [&](int j, int k) { return std::vector<Span>(body.row(j, k).begin(), body.row(j, k).end()); };
    CHECK(row(1, 3) == std::vector<Span>{{0, 5}, {7, 9}, {25, 30}});
    CHECK(row(0, 2) == std::vector<Span>{{0, 30}});
    CHECK(row(1, 2) == std::vector<Span>{{0, 10}, {20, 30}});
    CHECK(row(0, 3) == std::vector<Span>{{0, 10}, {20, 30}});
}

TEST_CASE("Depths below a raised or engraved letter are counted from where the body begins there") {
    const Eigen::Vector3d size(12, 8, 3);
    for (const int voxels : {5, -5}) {
        INFO(voxels << " voxels");
        const Embossed made = emboss(shapes::box(Eigen::Vector3d::Zero(), size),
                                     fmt::format("HO8; size=5mm; place=top; {}=5", voxels > 0 ? "raise" : "engrave"));
        const Relief relief = relief_of(made.laid.embossed, made.grid, 1);
        const Solid solid(*made.body.solid, made.grid, relief);
        const SurfaceShell shell(made.body.surface, made.grid, 1, &relief);
        const SpanSlab body = solid.slab(0, made.grid.size[2]);
        const double top = voxels > 0 ? size.z() + 5 * pitch_mm.z() : size.z() - 5 * pitch_mm.z();
        const int last_layer = int(std::floor((size.z() - 0.5 - made.grid.origin_mm.z()) / pitch_mm.z()));
        std::size_t below_ink = 0, wrong = 0;
        for (int bk = 0; bk < shell.block_layers(); ++bk)
            for (int bj = 0; bj < shell.block_rows(); ++bj)
                shell.for_each_block(bj, bk, body, [&](const ShellBlock& block) {
                    for_each_shell_voxel(block, [&](int row, int lane) {
                        const int i = block.origin[0] + lane, j = block.origin[1] + row % block.size[1],
                                  k = block.origin[2] + row / block.size[1];
                        const Eigen::Vector3d centre = made.grid.centre(i, j, k);
                        // Clear of other sides: half a millimetre from the top, more than that from the rest.
                        if (k < last_layer || centre.x() < 1 || centre.x() > 11 || centre.y() < 1 || centre.y() > 7)
                            return;
                        const int highest = made.grid.size[2] - 1;
                        const bool ink = voxels > 0 ? body.contains(i, j, highest) : !body.contains(i, j, highest);
                        const double depth = (ink ? top : size.z()) - centre.z();
                        below_ink += ink;
                        wrong += std::abs(double(block.distance_mm[row * ShellBlock::width + lane]) - depth) > 1e-4;
                    });
                });
        CHECK(below_ink > 1000);
        CHECK(wrong == 0);
    }
}
