// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

struct Up {
    ProofUp up;
    Vector3d way;  ///< of the model
};
const Up ups[] = {{ProofUp::z, {0, 0, 1}},        {ProofUp::minus_z, {0, 0, -1}}, {ProofUp::y, {0, 1, 0}},
                  {ProofUp::minus_y, {0, -1, 0}}, {ProofUp::x, {1, 0, 0}},        {ProofUp::minus_x, {-1, 0, 0}}};

constexpr ProofView views[] = {ProofView::three_quarter, ProofView::front, ProofView::right, ProofView::back,
                               ProofView::left,          ProofView::top,   ProofView::bottom};

ResolvedProof proof(std::optional<ProofView> view) {
    ResolvedProof job;
    job.requested.focal_mm = 85;
    job.view = view;
    job.width_px = 640;
    job.height_px = 400;
    return job;
}

/// What stands in the room: nothing about it is alike.
const Box room{{-3, 2, 1}, {9, 7, 19}};

/// Column and row of a place of the room.
std::array<double, 2> seen(const ResolvedProof& job, const Matrix3d& axes, const Vector3d& place) {
    const optics::Camera camera(place_camera(job, room, axes, false));
    return camera.picture_of(point_of(axes.transpose() * place));
}

}  // namespace

TEST_CASE("The room stands on the side that is said, and turns counter-clockwise seen from above") {
    const Matrix3d quarter = (Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();  // x to y
    for (const Up& up : ups) {
        const Matrix3d axes = room_axes(up.up, 0);
        CHECK((axes * axes.transpose() - Matrix3d::Identity()).norm() < 1e-12);
        CHECK(axes.determinant() == Approx(1));
        CHECK((axes * up.way - Vector3d::UnitZ()).norm() < 1e-12);
        for (const int quarters : {1, 2, 3}) {
            Matrix3d wanted = axes;
            for (int n = 0; n < quarters; ++n) wanted = quarter * wanted;
            CHECK((room_axes(up.up, 90 * quarters) - wanted).norm() < 1e-12);
        }
    }
    CHECK((room_axes(ProofUp::z, 0) - Matrix3d::Identity()).norm() == 0);
}

TEST_CASE("What holds a turned box holds every corner, and each side touches one") {
    for (std::uint64_t n = 0; n < 100; ++n) {
        RandomStream random(4, n);
        const auto point = [&] { return Vector3d(random.uniform(), random.uniform(), random.uniform()); };
        const Box box{point(), point() + Vector3d::Ones()};
        const Matrix3d turn = Eigen::AngleAxisd(6 * random.uniform(), (point() - Vector3d::Constant(0.5)).normalized())
                                  .toRotationMatrix();
        Vector3d low = Vector3d::Constant(1e9), high = -low;
        for (const double x : {box.low.x(), box.high.x()})
            for (const double y : {box.low.y(), box.high.y()})
                for (const double z : {box.low.z(), box.high.z()}) {
                    low = low.cwiseMin(turn * Vector3d(x, y, z));
                    high = high.cwiseMax(turn * Vector3d(x, y, z));
                }
        const Box held = turned(turn, box);
        CHECK((held.low - low).norm() < 1e-12);
        CHECK((held.high - high).norm() < 1e-12);
    }
    std::array<Vector3d, 8> corners;
    for (int corner = 0; corner < 8; ++corner) corners[std::size_t(corner)] = corner_of(room, corner);
    CHECK(corners[0] == room.low);
    CHECK(corners[7] == room.high);
    CHECK(corners[1] == Vector3d(9, 2, 1));
    CHECK(corners[2] == Vector3d(-3, 7, 1));
    CHECK(corners[4] == Vector3d(-3, 2, 19));
}

TEST_CASE("From wherever it is seen, the whole of it is in the picture, and fills it but for a margin") {
    for (const Up& up : ups)
        for (const double turn : {0.0, 33.0})
            for (const ProofView view : views) {
                CAPTURE(up.way, turn, int(view));
                ResolvedProof job = proof(view);
                for (const auto& [width, height] : {std::pair{640, 400}, std::pair{300, 900}}) {
                    job.width_px = width, job.height_px = height;
                    double most = 0;
                    for (int corner = 0; corner < 8; ++corner) {
                        const auto [x, y] = seen(job, room_axes(up.up, turn), corner_of(room, corner));
                        most = std::max({most, std::abs(2 * x / width - 1), std::abs(2 * y / height - 1)});
                    }
                    CHECK(most < 1);
                    CHECK(most > 0.8);
                }
            }
}

TEST_CASE("Each view is from the side of its name") {
    // Which axes of the room lead to the right and up in the picture. From above and from below +y is up.
    struct Case {
        ProofView view;
        int right, up;  ///< axis + 1, negative: the other way
        Vector3d from;
    };
    const Case cases[] = {{ProofView::front, 1, 3, {0, -1, 0}}, {ProofView::back, -1, 3, {0, 1, 0}},
                          {ProofView::right, 2, 3, {1, 0, 0}},  {ProofView::left, -2, 3, {-1, 0, 0}},
                          {ProofView::top, 1, 2, {0, 0, 1}},    {ProofView::bottom, -1, 2, {0, 0, -1}}};
    const Vector3d middle = 0.5 * (room.low + room.high);
    for (const Up& up : ups)
        for (const Case& c : cases) {
            CAPTURE(up.way, int(c.view));
            const ResolvedProof job = proof(c.view);
            const Matrix3d axes = room_axes(up.up, 20);
            const auto place = [&](int axis) -> Vector3d {
                return middle + (axis > 0 ? 1.0 : -1.0) * Vector3d::Unit(std::abs(axis) - 1);
            };
            const auto [x, y] = seen(job, axes, middle);
            CHECK(x == Approx(320));
            CHECK(y == Approx(200));
            CHECK(seen(job, axes, place(c.right))[0] > 320 + 1);
            CHECK(seen(job, axes, place(c.right))[1] == Approx(200).margin(1));
            CHECK(seen(job, axes, place(c.up))[1] < 200 - 1);
            CHECK(seen(job, axes, place(c.up))[0] == Approx(320).margin(1));
            const optics::CameraView view = place_camera(job, room, axes, false);
            const Vector3d stand = (axes * vector_of(view.position) - middle).normalized();
            // Sides are seen a little from above, 9 degrees.
            CHECK(stand.dot(c.from) > std::cos(10 * std::numbers::pi / 180));
            if (c.from.z() == 0) CHECK(stand.z() > 0.1);
        }
    // The front and the right side at once, from above.
    const optics::CameraView view = place_camera(proof(ProofView::three_quarter), room, Matrix3d::Identity(), false);
    const Vector3d stand = vector_of(view.position) - middle;
    CHECK(stand.x() > 0.1 * stand.norm());
    CHECK(stand.y() < -0.1 * stand.norm());
    CHECK(stand.z() > 0.1 * stand.norm());
}

TEST_CASE("Without a view a body is seen from three quarters and a picture from above, places that are named count") {
    const Matrix3d axes = room_axes(ProofUp::y, 10);
    const auto position = [&](std::optional<ProofView> view, bool flat) {
        return place_camera(proof(view), room, axes, flat).position;
    };
    CHECK(position({}, false) == position(ProofView::three_quarter, false));
    CHECK(position({}, true) == position(ProofView::top, true));
    ResolvedProof job = proof({});
    job.camera = optics::Point{100, 20, 30};
    job.look_at = optics::Point{1, 2, 3};
    const optics::CameraView view = place_camera(job, room, axes, false);
    CHECK(view.position == *job.camera);
    CHECK(view.target == *job.look_at);
    CHECK(view.focal_mm == 85);
    CHECK(view.width_px == 640);
    CHECK(view.height_px == 400);
}

TEST_CASE("What stands beside the first stands to its right, from wherever it is seen") {
    const Box first{{-3, 2, 1}, {9, 7, 19}};
    const auto is_to_the_right = [&](const ResolvedProof& job, const Matrix3d& axes) {
        const Vector3d right = rightward(job, first, axes, false);
        CHECK(right.norm() == Approx(1));
        CHECK(right.z() == 0);
        const optics::Camera camera(place_camera(job, turned(axes, first), axes, false));
        const Vector3d middle = 0.5 * (first.low + first.high);
        return camera.picture_of(point_of(middle + axes.transpose() * right))[0] >
               camera.picture_of(point_of(middle))[0] + 1;
    };
    for (const Up& up : ups)
        for (const double turn : {0.0, 30.0, 200.0}) {
            const Matrix3d axes = room_axes(up.up, turn);
            for (const ProofView view : views) CHECK(is_to_the_right(proof(view), axes));
            for (const optics::Point& place : {optics::Point{90, 3, 4}, {-80, 30, 9}, {5, 99, -40}, {1, -60, 70}}) {
                ResolvedProof job = proof({});
                job.camera = place;
                CHECK(is_to_the_right(job, axes));
            }
        }
}
