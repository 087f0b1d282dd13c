// SPDX-License-Identifier: GPL-3.0-or-later
//
// What several photographs of one target say together, from values that were put there by hand.
#include <cmath>

#include <catch2/catch.hpp>

#include "calibration/photo/photo_measurement.h"
#include "optics/colour/channels.h"
#include "tests/calibration/photo/photo_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;
using Eigen::Vector3d;

namespace {

const Vector3d grey(0.3, 0.4, 0.5);

/// Every square grey, but for one.
PhotoMeasurement photo_of(const Target& target, std::size_t square, const Vector3d& rho, double error) {
    PhotoMeasurement photo;
    photo.rho.assign(target.squares.size(), grey);
    photo.error.assign(target.squares.size(), Vector3d::Constant(error));
    photo.rho[square] = rho;
    return photo;
}

std::vector<PhotoMeasurement> photos_of(const Target& target, std::size_t square, const std::vector<Vector3d>& rho,
                                        double error) {
    std::vector<PhotoMeasurement> photos;
    for (const Vector3d& one : rho) photos.push_back(photo_of(target, square, one, error));
    return photos;
}

}  // namespace

TEST_CASE("photographs that agree tell their mean better than one, photographs that differ no better than they agree") {
    const Target target = target_of(TargetLayout::b);
    constexpr double own = 0.001;
    // In red they agree, in green two lie 0.02 apart, in blue one of three is off.
    const std::vector<Vector3d> two{{0.3, 0.39, 0.5}, {0.3, 0.41, 0.5}},
        three{{0.3, 0.4, 0.5}, {0.3, 0.4, 0.5}, {0.3, 0.4, 0.56}};
    const MeasuredTable pair = average_photos(photos_of(target, 4, two, own), target),
                        trio = average_photos(photos_of(target, 4, three, own), target);
    const Patch &of_two = pair.table.patches[4], &of_three = trio.table.patches[4];
    CHECK(of_two.rho[1] == Approx(0.4));
    CHECK(of_three.rho[2] == Approx(0.52));
    CHECK(of_two.error[0] == Approx(own / std::sqrt(2.0)));
    CHECK(of_three.error[0] == Approx(own / std::sqrt(3.0)));
    // The mean of two is known to half of their distance; of three, one 0.06 away: s^2 = 0.06^2 / 3, s / sqrt(3).
    CHECK(of_two.error[1] == Approx(0.01));
    CHECK(of_three.error[2] == Approx(0.02));
    CHECK(pair.spread[4][1] == Approx(0.01 * std::sqrt(2.0)));
    CHECK(trio.spread[4][2] == Approx(0.06 / std::sqrt(3.0)));
    // The others.
    CHECK(pair.table.patches[5].error[1] == Approx(own / std::sqrt(2.0)));
    CHECK(pair.spread[5].norm() == 0);
    CHECK(pair.warnings.empty());  // 0.014 from photograph to photograph is not yet said
    REQUIRE(trio.warnings.size() == 1);
    CHECK_THAT(trio.warnings[0], Catch::Contains(square_name(target, 4)) && Catch::Contains("0.035"));
}

TEST_CASE("one photograph has its own errors and no spread") {
    const Target target = target_of(TargetLayout::b);
    const MeasuredTable one = average_photos({photo_of(target, 0, {0.1, 0.2, 0.3}, 0.002)}, target);
    CHECK(one.table.patches[0].rho == std::vector<double>{0.1, 0.2, 0.3});
    CHECK(one.table.patches[0].error == std::vector<double>{0.002, 0.002, 0.002});
    CHECK(one.spread[0] == Vector3d::Zero());
}

TEST_CASE("a channel below 0 is told by its error: by less than three it is cut, by more it is an ink") {
    const Target target = target_of(TargetLayout::b);
    constexpr double error = 0.004;
    for (const double below : {0.5, 2.9, 3.1, 20.0}) {
        const Vector3d rho(-below * error, 0.2, 0.3);
        const MeasuredTable table = average_photos({photo_of(target, 2, rho, error)}, target);
        INFO(below << " errors below 0");
        REQUIRE_FALSE(table.warnings.empty());
        CHECK_THAT(table.warnings.front(), Catch::Contains(square_name(target, 2)));
        if (below < 3) {
            CHECK(table.table.channels.is_rgb());
            CHECK(table.table.patches[2].rho[0] == 0);
            CHECK_THAT(table.warnings.front(), Catch::Contains("by less than three of its errors"));
            continue;
        }
        CHECK(table.table.channels.is_rgb());
        CHECK(table.table.patches[2].rho[0] == 0);
        CHECK_THAT(table.warnings.front(),
                   Catch::Contains("by more than three of its errors") && Catch::Contains("[beyond-rgb]"));
        // In wide channels, asked for, it is the same light, with the errors that a matrix makes of independent ones.
        const MeasuredTable wide = average_photos({photo_of(target, 2, rho, error)}, target, PhotoChannels::wide);
        CHECK(wide.table.channels == optics::wide_channels());
        const Eigen::Matrix3d back(optics::linear_srgb_weights(optics::wide_channels()));
        const Patch& patch = wide.table.patches[2];
        CHECK((back * Vector3d(patch.rho.data()) - rho).norm() < 1e-12);
        const Eigen::Matrix3d map = back.inverse();
        for (Eigen::Index k = 0; k < 3; ++k)
            CHECK(patch.error[static_cast<std::size_t>(k)] == Approx(error * map.row(k).norm()));
    }
}
