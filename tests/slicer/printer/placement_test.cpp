// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/placement.h"

#include <cmath>
#include <functional>

#include <fmt/core.h>
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "base/units.h"
#include "slicer/printer/up_axis.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Contains;

namespace {

/// A corner with legs 1, 2, 3 along x, y, z: asymmetric, so that every mirror and exchange shows.
io::ModelFile marker() {
    io::ModelFile model;
    model.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    model.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    model.mesh.material_of_triangle.assign(4, 0);
    model.mesh.materials.emplace_back();
    return model;
}

/// The marker with a colour and a place in a texture of its own at every corner of every triangle.
io::ModelFile coloured_marker() {
    io::ModelFile model = marker();
    for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
        auto& uv = model.mesh.corner_uv.emplace_back();
        auto& rgb = model.mesh.corner_rgb.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            RandomStream random(17, 3 * t + c);
            uv[c] = {float(random.uniform()), float(random.uniform())};
            rgb[c] = {float(random.uniform()), float(random.uniform()), float(random.uniform())};
        }
    }
    return model;
}

/// What a mesh shows at a place of its surface: texture coordinates and colour.
struct Shown {
    Eigen::Vector2f uv;
    Eigen::Vector3f rgb;
};

/// Of the triangle that the place lies in, wherever its corners are listed.
Shown shown_at(const io::TexturedMesh& mesh, const Eigen::Vector3d& place) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Eigen::Matrix<double, 4, 3> corners;  // positions, and a row that makes the weights sum to 1
        for (int c = 0; c < 3; ++c) corners.col(c) << mesh.positions[mesh.triangles[t][static_cast<std::size_t>(c)]], 1;
        const Eigen::Vector4d wanted(place.x(), place.y(), place.z(), 1);
        const Eigen::Vector3d weight = corners.colPivHouseholderQr().solve(wanted);
        if ((corners * weight - wanted).norm() > 1e-9 || weight.minCoeff() < 0) continue;
        Shown shown{Eigen::Vector2f::Zero(), Eigen::Vector3f::Zero()};
        for (int c = 0; c < 3; ++c) {
            shown.uv += float(weight[c]) * mesh.corner_uv[t][static_cast<std::size_t>(c)];
            shown.rgb += float(weight[c]) * mesh.corner_rgb[t][static_cast<std::size_t>(c)];
        }
        return shown;
    }
    FAIL("no triangle holds the place");
    return {};
}

double signed_volume(const io::TexturedMesh& mesh) {
    double six_volumes = 0;
    for (const auto& t : mesh.triangles)
        six_volumes += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]]));
    return six_volumes / 6;
}

Placement placed(
    io::ModelFile& model, const std::function<void(PlacementOptions&)>& change = [](PlacementOptions&) {}) {
    PlacementOptions options;
    change(options);
    return place(model, options, "marker");
}

}  // namespace

TEST_CASE("Units: the user's, the file's, else millimetres said to be assumed") {
    io::ModelFile unknown = marker();
    const Placement assumed = placed(unknown);
    CHECK(assumed.unit_assumed);
    CHECK(assumed.extent_mm == Eigen::Vector3d(1, 2, 3));

    io::ModelFile metres = marker();
    metres.mm_per_file_unit = 1000;
    CHECK(placed(metres).extent_mm == Eigen::Vector3d(1000, 2000, 3000));

    io::ModelFile overruled = marker();
    overruled.mm_per_file_unit = 1000;
    const Placement inches = placed(overruled, [](PlacementOptions& o) {
        o.unit = FileUnit{"in", mm_per_inch}, o.scale = 2;
    });
    CHECK_FALSE(inches.unit_assumed);
    CHECK(inches.extent_mm.isApprox(Eigen::Vector3d(50.8, 101.6, 152.4)));
}

TEST_CASE("A size makes the largest extent so long and moves the model to the origin") {
    io::ModelFile model = marker();
    for (auto& p : model.mesh.positions) p += Eigen::Vector3d(10, -20, 30);
    CHECK(placed(model, [](PlacementOptions& o) { o.size_mm = 60; }).extent_mm.isApprox(Eigen::Vector3d(20, 40, 60)));
    CHECK(model.mesh.positions[0].norm() < 1e-12);
    CHECK(model.mesh.positions[3].isApprox(Eigen::Vector3d(0, 0, 60)));
}

TEST_CASE("What light goes through keeps its look in a body of another size than its file's, where that has a unit") {
    const auto of_lengths = [](double mm_per_file_unit) {
        io::ModelFile model = marker();
        model.mm_per_file_unit = mm_per_file_unit;
        model.mesh.materials.emplace_back().alpha_of_lengths = true;
        return model;
    };
    const std::string said = "keeps its look at ";
    io::ModelFile metres = of_lengths(1000), as_mm = metres, same = metres, no_unit = of_lengths(0);
    CHECK_THAT(placed(metres, [](PlacementOptions& o) { o.size_mm = 60, o.scale = 5; }).summary,
               Contains(said + "0.02 times"));
    CHECK(metres.mesh.materials.back().times_as_large == Catch::Detail::Approx(0.02));
    CHECK(metres.mesh.materials.front().times_as_large == 1);
    placed(as_mm, [](PlacementOptions& o) { o.unit = FileUnit{"mm", 1}, o.scale = 2; });
    CHECK(as_mm.mesh.materials.back().times_as_large == Catch::Detail::Approx(0.002));
    CHECK_THAT(placed(same).summary, !Contains(said));
    placed(no_unit, [](PlacementOptions& o) { o.size_mm = 60; });
    CHECK((same.mesh.materials.back().times_as_large == 1 && no_unit.mesh.materials.back().times_as_large == 1));
}

TEST_CASE("Mirrors move the marker's legs and keep the body right side out") {
    const auto corner_of_right_angle = [](const std::function<void(PlacementOptions&)>& change) {
        io::ModelFile model = marker();
        placed(model, change);
        CHECK(signed_volume(model.mesh) == Catch::Detail::Approx(1));
        return model.mesh.positions[0];
    };
    CHECK(corner_of_right_angle([](PlacementOptions&) {}) == Eigen::Vector3d(0, 0, 0));
    CHECK(corner_of_right_angle([](PlacementOptions& o) { o.flip_x = true; }) == Eigen::Vector3d(1, 0, 0));
    CHECK(corner_of_right_angle([](PlacementOptions& o) { o.flip_y = true; }) == Eigen::Vector3d(0, 2, 0));
    CHECK(corner_of_right_angle([](PlacementOptions& o) { o.flip_x = o.flip_y = true; }) == Eigen::Vector3d(1, 2, 0));
    io::ModelFile swapped = marker();
    CHECK(placed(swapped, [](PlacementOptions& o) { o.swap_xy = true; }).extent_mm == Eigen::Vector3d(2, 1, 3));
    CHECK(signed_volume(swapped.mesh) == Catch::Detail::Approx(1));
}

TEST_CASE("However the marker is turned and mirrored, each place keeps its texture and its colour") {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    for (int bits = 0; bits < 16; ++bits) {
        CAPTURE(bits);
        // x and y are exchanged first, then mirrored: p_mm = flips * swap * rotations * p_file.
        Eigen::Matrix3d map = bits & 8 ? turn : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
        if (bits & 4) map = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, 1).finished() * map;
        if (bits & 1) map = Eigen::Vector3d(-1, 1, 1).asDiagonal() * map;
        if (bits & 2) map = Eigen::Vector3d(1, -1, 1).asDiagonal() * map;
        const io::ModelFile file = coloured_marker();
        io::ModelFile model = file;
        placed(model, [&](PlacementOptions& o) {
            o.flip_x = bits & 1, o.flip_y = bits & 2, o.swap_xy = bits & 4;
            if (bits & 8) o.rotation = turn;
        });
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d& p : file.mesh.positions) box.extend(map * p);
        for (std::size_t v = 0; v < file.mesh.positions.size(); ++v)
            CHECK((model.mesh.positions[v] - (map * file.mesh.positions[v] - box.min())).norm() < 1e-12);
        CHECK(signed_volume(model.mesh) == Catch::Detail::Approx(1));
        for (const auto& triangle : model.mesh.triangles)
            for (const Eigen::Vector3d& weight :
                 {Eigen::Vector3d(0.6, 0.3, 0.1), Eigen::Vector3d(0.1, 0.2, 0.7), Eigen::Vector3d(0.2, 0.7, 0.1)}) {
                Eigen::Vector3d place = Eigen::Vector3d::Zero();
                for (int c = 0; c < 3; ++c)
                    place += weight[c] * model.mesh.positions[triangle[static_cast<std::size_t>(c)]];
                const Shown now = shown_at(model.mesh, place),
                            before = shown_at(file.mesh, map.inverse() * (place + box.min()));
                CHECK((now.uv - before.uv).norm() < 1e-5f);
                CHECK((now.rgb - before.rgb).norm() < 1e-5f);
            }
    }
}

TEST_CASE("A grid is as large as its box to the nearest voxel, centred, and holds every centre in it") {
    const Eigen::Vector3d pitch(25.4 / 600, 25.4 / 300, 0.027);
    const VoxelGrid grid = grid_around({0, 0, 0}, {25.4, 25.4, 0.027 * 100}, pitch);
    CHECK(grid.size == std::array<int, 3>{600, 300, 100});
    CHECK(grid.origin_mm.norm() < 1e-9);
    const VoxelGrid flat = grid_around({1, 1, 1}, {1, 2, 2}, pitch);
    CHECK(flat.size[0] == 1);
    CHECK(flat.centre(0, 0, 0).x() == Catch::Detail::Approx(1));
    double longer_mm = 0;
    RandomStream random(7, 0);
    for (int n = 0; n < 1000; ++n) {
        const Eigen::Vector3d low(random.uniform(), random.uniform(), random.uniform());
        const Eigen::Vector3d high = low + Eigen::Vector3d(10 * random.uniform() + 0.1, 3, 10 * random.uniform() + 0.1);
        const VoxelGrid around = grid_around(low, high, pitch);
        for (int axis = 0; axis < 3; ++axis) {
            const double more_mm = around.size[std::size_t(axis)] * pitch[axis] - (high - low)[axis];
            CHECK(std::abs(more_mm) <= pitch[axis] / 2 + 1e-6);
            CHECK(around.origin_mm[axis] == Catch::Detail::Approx(low[axis] - more_mm / 2).margin(1e-9));
            // The centres next to the grid.
            CHECK(around.origin_mm[axis] - pitch[axis] / 2 < low[axis]);
            CHECK(around.origin_mm[axis] + (around.size[std::size_t(axis)] + 0.5) * pitch[axis] > high[axis]);
        }
        longer_mm += (around.size[0] * pitch[0] - (high - low)[0]) / 1000;
    }
    // Even in +-pitch / 2: four times the error of the mean of a thousand.
    CHECK(std::abs(longer_mm) < 4 * pitch[0] / std::sqrt(12.0 * 1000));
}

TEST_CASE("Sizes that no voxel or no tray holds are refused before they are worked with") {
    const Eigen::Vector3d pitch(0.04, 0.08, 0.03), tray(490, 390, 200), endless = Eigen::Vector3d::Constant(INFINITY);
    const auto refused = [&](double mm, const Eigen::Vector3d& room, bool is_picture) {
        Placement placement;
        placement.extent_mm = Eigen::Vector3d(mm, mm / 2, mm / 4);
        placement.is_picture = is_picture;
        try {
            check_extent(placement, pitch, room);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(refused(10, tray, false).empty());
    CHECK(refused(0.09, tray, false).empty());
    CHECK(refused(490, tray, false).empty());
    CHECK_THAT(refused(0.01, tray, false), Catch::Contains("less than one voxel") && Catch::Contains("--size"));
    CHECK_THAT(refused(1e30, tray, false), Catch::Contains("too large along x") && Catch::Contains("--unit"));
    CHECK_THAT(refused(1e30, endless, false), Catch::Contains("too large along x"));
    CHECK_THAT(refused(1e5, tray, false), Catch::Contains("x, y and z by over 1 m") && !Catch::Contains("--rotate"));
    // A rod that lies along the short side may be turned.
    CHECK_THAT(refused(480, {200, 390, 490}, false), Catch::Contains("along x by 280 mm. Turn it with --rotate"));
    CHECK_THAT(refused(1e5, tray, true),
               Catch::Contains("--width") && !Catch::Contains("--size") && !Catch::Contains("--rotate"));
}

TEST_CASE("What is as long as the tray fits it, and what is longer is told by how much") {
    const Eigen::Vector3d tray(490, 390, 200);
    // Of a J750, of a Mimaki, of one with voxels of 0.1 mm: whole numbers of voxels, and not.
    for (const Eigen::Vector3d& pitch :
         {Eigen::Vector3d(25.4 / 600, 25.4 / 300, 0.027), Eigen::Vector3d(0.0423, 0.0423, 0.022),
          Eigen::Vector3d(0.1, 0.1, 0.1), Eigen::Vector3d(0.07, 0.3, 0.014)})
        for (int axis = 0; axis < 3; ++axis) {
            CAPTURE(pitch.transpose(), axis);
            const auto refused = [&](double mm) {
                Placement placement;
                placement.extent_mm = Eigen::Vector3d::Constant(5);
                placement.extent_mm[axis] = mm;
                try {
                    check_extent(placement, pitch, tray);
                    check_tray(grid_around(Eigen::Vector3d::Zero(), placement.extent_mm, pitch), tray, placement);
                } catch (const InputError& error) {
                    return std::string(error.what());
                }
                return std::string();
            };
            CHECK(refused(tray[axis]).empty());
            CHECK(refused(double(std::nextafter(float(tray[axis]), 1e9f))).empty());
            CHECK(refused(tray[axis] - 0.01).empty());
            CHECK_THAT(refused(tray[axis] + 0.01),
                       Contains(fmt::format("{:g}.01 ", tray[axis])) && Contains("by 10 um"));
            CHECK_THAT(refused(tray[axis] + 12.5), Contains("by 12.5 mm"));
        }
    // Raised letters are voxels of their own.
    VoxelGrid grid = grid_around({0, 0, 0}, {490, 5, 5}, {25.4 / 600, 25.4 / 300, 0.027});
    CHECK_NOTHROW(check_tray(grid, tray, {}));
    ++grid.size[0];
    CHECK_THROWS_AS(check_tray(grid, tray, {}), InputError);
}

TEST_CASE("A model too large for the tray is refused with what to try") {
    const VoxelGrid grid = grid_around({0, 0, 0}, {600, 10, 10}, {0.1, 0.1, 0.1});
    CHECK_NOTHROW(check_tray(grid, {600.0001, 390, 200}, {}));
    try {
        check_tray(grid, {490, 390, 200}, {});
        FAIL("accepted");
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), Catch::Matchers::Contains("--size"));
    }
    CHECK_THROWS_AS(grid_around({0, 0, 0}, {1e12, 1, 1}, {0.1, 0.1, 0.1}), InputError);
}

TEST_CASE("A model that stands on its y axis is told from one that stands on z, on both, or on neither",
          "[placement]") {
    using Eigen::Vector3d;
    // Four feet below a bar: a table of 4 x 3 x 2 with its legs along one axis.
    const auto table = [](int up) {
        std::vector<Vector3d> points;
        for (const double a : {0.0, 0.3, 3.7, 4.0})
            for (const double b : {0.0, 0.3, 2.7, 3.0}) points.push_back({a, b, 0});
        for (const double a : {1.8, 2.2})
            for (const double b : {1.3, 1.7}) points.push_back({a, b, 2});
        for (Vector3d& p : points)
            for (int turn = 0; turn < (up + 1) % 3; ++turn) p = Vector3d(p.z(), p.x(), p.y());
        return points;
    };
    CHECK(looks_y_up(table(1)));
    CHECK_FALSE(looks_y_up(table(2)));
    CHECK_FALSE(looks_y_up(table(0)));
    for (int up = 0; up < 3; ++up) {
        std::vector<Vector3d> turned = table(up);
        for (Vector3d& p : turned) p = Vector3d(p.x(), -p.z(), p.y());
        CHECK(looks_z_up_before(turned) == (up == 2));
    }
    std::vector<Vector3d> cube, ball;
    for (int c = 0; c < 8; ++c) cube.push_back({double(c & 1), double(c >> 1 & 1), double(c >> 2)});
    for (int i = 0; i < 2000; ++i) {
        const double z = 1 - (2 * i + 1) / 2000.0, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
        ball.push_back({r * std::cos(turn), r * std::sin(turn), z});
    }
    CHECK_FALSE(looks_y_up(cube));
    CHECK_FALSE(looks_y_up(ball));
    CHECK_FALSE(looks_y_up({}));
    CHECK_FALSE(looks_y_up(std::vector<Vector3d>{{1, 2, 3}}));
}

TEST_CASE("Sizes are told as a person writes them, whatever a file holds") {
    const Eigen::Vector3d tray(490, 390, 200), pitch(0.04, 0.08, 0.03);
    for (const double scale : {1e-30, 1e-4, 0.02, 1.0, 123456.7, 1e6, 1e30}) {
        INFO(scale);
        io::ModelFile model = marker();
        const Placement placement = placed(model, [&](PlacementOptions& o) { o.scale = scale; });
        CHECK_THAT(placement.summary, !Contains("e+") && !Contains("e-"));
        try {
            check_extent(placement, pitch, tray);
        } catch (const InputError& error) {
            CHECK_THAT(error.what(), !Contains("e+") && !Contains("e-"));
        }
    }
    io::ModelFile model = marker();
    model.mesh.positions[2].y() = 3e5;
    CHECK_THAT(placed(model).summary, Contains("1 x 300000 x 3 mm"));
}
