// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/resin_volumes.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using voxtone::test::body_of;

namespace {

/// Three resins of a box whose surface is asked along x: of its shell of `shell_mm`, the first by the place's x of
/// `length_mm`, the second the rest; above `deep_mm` nothing but the third, which the core is of too.
constexpr double shell_mm = 0.3, deep_mm = 0.16;

VolumeQuery query_of(const JobBody& body, double length_mm) {
    VolumeQuery query;
    query.layers = {0, body.grid.size[2] - 1};
    query.keep_thin = false;
    query.shell_mm = shell_mm;
    query.resins = 3;
    query.core = 2;
    query.mixture = [&body, length_mm](std::uint32_t triangle, const Eigen::Vector2f& uv, double depth_mm,
                                       double weight, std::span<double> sum) {
        const auto& corners = body.model.mesh.triangles[triangle];
        const auto& at = body.model.mesh.positions;
        const Vector3d place = at[corners[0]] + double(uv.x()) * (at[corners[1]] - at[corners[0]]) +
                               double(uv.y()) * (at[corners[2]] - at[corners[0]]);
        if (depth_mm > deep_mm) {
            sum[2] += weight;
            return;
        }
        sum[0] += weight * place.x() / length_mm;
        sum[1] += weight * (1 - place.x() / length_mm);
    };
    return query;
}

/// The same by looking at every voxel of the box, whose nearest surface point is on the nearest of six faces.
ResinVolumes counted(const JobBody& body, const Vector3d& size_mm, const LayerRange& range) {
    std::array<double, 3> voxels{};
    double shell = 0;
    for (int k = range.first; k <= range.last; ++k)
        for (int j = 0; j < body.grid.size[1]; ++j)
            for (int i = 0; i < body.grid.size[0]; ++i) {
                const Vector3d p = body.grid.centre(i, j, k);
                double least = 1e9, x = 0;
                for (int axis = 0; axis < 3; ++axis)
                    for (const double face : {0.0, size_mm[axis]}) {
                        if (std::abs(p[axis] - face) >= least) continue;
                        least = std::abs(p[axis] - face);
                        x = axis == 0 ? face : p.x();
                    }
                shell += least <= shell_mm;
                if (least > deep_mm)
                    voxels[2] += 1;
                else
                    voxels[0] += x / size_mm.x(), voxels[1] += 1 - x / size_mm.x();
            }
    const double ml = body.grid.voxel_volume_mm3() * 1e-3;
    return {(voxels[0] + voxels[1] + voxels[2]) * ml, shell * ml, {voxels[0] * ml, voxels[1] * ml, voxels[2] * ml}};
}

}  // namespace

TEST_CASE("A small body's resins are counted voxel by voxel, each at its nearest surface point") {
    // Pitches at which no two faces are equally near to a centre.
    const Vector3d pitch(0.1, 0.07, 0.113), size = pitch.cwiseProduct(Vector3d(25, 30, 17));
    const JobBody body = body_of(shapes::box(Vector3d::Zero(), size), pitch);
    REQUIRE(body.grid.size == std::array{25, 30, 17});
    for (const LayerRange range : {LayerRange{0, 16}, LayerRange{3, 9}}) {
        CAPTURE(range.first);
        VolumeQuery query = query_of(body, size.x());
        query.layers = range;
        const ResinVolumes volumes = resin_volumes(body, query, Progress());
        const ResinVolumes wanted = counted(body, size, range);
        CHECK(volumes.body_ml == Approx(size.x() * size.y() * pitch.z() * range.layers() * 1e-3));
        CHECK(volumes.body_ml == Approx(wanted.body_ml));
        CHECK(volumes.shell_ml == Approx(wanted.shell_ml));
        REQUIRE(volumes.ml.size() == 3);
        for (std::size_t r = 0; r < 3; ++r) CHECK(volumes.ml[r] == Approx(wanted.ml[r]).epsilon(1e-5));  // float uv
        CHECK(volumes.ml[0] + volumes.ml[1] + volumes.ml[2] == Approx(volumes.body_ml));
    }
    VolumeQuery without = query_of(body, size.x());
    without.mixture = nullptr;
    const ResinVolumes core = resin_volumes(body, without, Progress());
    CHECK(core.ml[2] == core.body_ml);
    CHECK(core.shell_ml == 0);
}

TEST_CASE("Of a large body a sample is asked, and its resins are within the error that is told") {
    const Vector3d pitch(0.1, 0.07, 0.113), size = pitch.cwiseProduct(Vector3d(110, 90, 80));
    const JobBody body = body_of(shapes::box(Vector3d::Zero(), size), pitch);
    const ResinVolumes volumes = resin_volumes(body, query_of(body, size.x()), Progress());
    const ResinVolumes wanted = counted(body, size, {0, 79});
    CHECK(volumes.body_ml == Approx(wanted.body_ml));  // that is counted
    for (std::size_t r = 0; r < 3; ++r) {
        CAPTURE(r);
        const double share = wanted.ml[r] / wanted.body_ml, error = std::sqrt(share / 25'000) * wanted.body_ml;
        CHECK(std::abs(volumes.ml[r] - wanted.ml[r]) < 4 * error);
        // All of them were not asked: the figures differ.
        CHECK(volumes.ml[r] != Approx(wanted.ml[r]).epsilon(1e-9));
    }
}

TEST_CASE("Of a tall body one layer in each stretch is counted: a pyramid has the third of its box") {
    // 1000 layers, of which 400 are looked at; what a layer says of its stretch is off by 0.1 % in all.
    SolidMesh pyramid;
    pyramid.positions_mm = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 10}};
    pyramid.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    const JobBody body = body_of(shapes::with_sources(pyramid), {0.02, 0.02, 0.01});
    REQUIRE(body.grid.size[2] == 1000);
    VolumeQuery query;
    query.keep_thin = false;
    query.layers = {0, 999};
    CHECK(resin_volumes(body, query, Progress()).body_ml == Approx(4 * 4 * 10 / 3.0 * 1e-3).epsilon(0.004));
    // The same where its resins are asked for: each sample stands for its stretch of layers.
    query.resins = 2;
    query.core = 1;
    query.shell_mm = 0.3;
    query.mixture = [](std::uint32_t, const Eigen::Vector2f&, double, double weight, std::span<double> sum) {
        sum[0] += weight;
    };
    const ResinVolumes coloured = resin_volumes(body, query, Progress());
    CHECK(coloured.ml[0] + coloured.ml[1] == Approx(coloured.body_ml).epsilon(1e-9));
    CHECK(coloured.ml[0] == Approx(coloured.shell_ml).epsilon(1e-9));
    CHECK(coloured.body_ml == Approx(4 * 4 * 10 / 3.0 * 1e-3).epsilon(0.004));
    // What is deeper is a pyramid again, whose inscribed sphere is so much smaller: 3 V = r A.
    const double slant = std::hypot(10, 2), radius = 4 * 4 * 10 / (4 * 4 + 4 * 4 * slant / 2);
    CHECK(coloured.ml[1] == Approx(std::pow(1 - 0.3 / radius, 3) * 4 * 4 * 10 / 3 * 1e-3).epsilon(0.02));
    query.mixture = nullptr;
    query.layers = {500, 999};  // the upper half is an eighth
    CHECK(resin_volumes(body, query, Progress()).body_ml == Approx(4 * 4 * 10 / 24.0 * 1e-3).epsilon(0.008));
}
