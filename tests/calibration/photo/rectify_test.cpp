// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/rectify.h"

#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Eigen::Vector2d;

namespace {

/// A target of 80 mm seen aslant: y runs up in its plane and down in the picture.
const Eigen::Matrix3d aslant = (Eigen::Matrix3d() << 31, 4, 200, 3, -27, 2400, 1.5e-3, -2.5e-3, 1).finished();

std::vector<Vector2d> lattice() {
    std::vector<Vector2d> points;
    for (int x = 0; x <= 80; x += 8)
        for (int y = 0; y <= 80; y += 8) points.emplace_back(x, y);
    return points;
}

std::vector<Vector2d> seen(const Eigen::Matrix3d& camera, double noise_px) {
    std::vector<Vector2d> px;
    RandomStream random(1, 0);
    for (const Vector2d& p : lattice()) {
        Vector2d off = Vector2d::Constant(-6);  // a sum of twelve: about normal, of variance 1
        for (int k = 0; k < 12; ++k) off += Vector2d(random.uniform(), random.uniform());
        px.push_back((camera * p.homogeneous()).hnormalized() + noise_px * off);
    }
    return px;
}

}  // namespace

TEST_CASE("A photographed plane is found from its points, and back") {
    const auto points = lattice(), px = seen(aslant, 0);
    double residual = -1;
    const Rectification place = Rectification::fit(points, px, &residual);
    // OpenCV's least squares end at some 1e-5 px; corners are known to a few hundredths.
    constexpr double exact_px = 1e-4, px_per_mm = 20;
    CHECK(residual < exact_px);
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK((place.to_px(points[i]) - px[i]).norm() < exact_px);
        CHECK((place.from_px(px[i]) - points[i]).norm() < exact_px / px_per_mm);
    }
    // det of the homography / w^3 is the change of area.
    const Vector2d p(20, 60);
    const double w = aslant.row(2) * p.homogeneous();
    CHECK(place.px_per_unit(p) == Approx(std::sqrt(std::abs(aslant.determinant()) / std::pow(w, 3))).epsilon(1e-5));
}

TEST_CASE("The residual of a rectified plane is the noise of its points") {
    const auto points = lattice();
    double residual = 0;
    const Rectification place = Rectification::fit(points, seen(aslant, 0.2), &residual);
    // Of 242 coordinates eight are used up by the homography; a root mean square over points has two of them.
    CHECK(residual == Approx(0.2 * std::sqrt(2 * (242 - 8) / 242.0)).epsilon(0.15));
    for (const Vector2d& p : points) CHECK((place.to_px(p) - (aslant * p.homogeneous()).hnormalized()).norm() < 0.25);
}

TEST_CASE("A plane that is seen from its back is told from one that lies turned") {
    const auto points = lattice();
    const Eigen::Matrix3d mirror = Eigen::Vector3d(-1, 1, 1).asDiagonal(),
                          half_turn = Eigen::Vector3d(-1, -1, 1).asDiagonal();
    for (const Vector2d& p : points) {
        CHECK_FALSE(Rectification(aslant).seen_from_back(p));
        CHECK_FALSE(Rectification(half_turn * aslant).seen_from_back(p));
        CHECK(Rectification(mirror * aslant).seen_from_back(p));
    }
}
