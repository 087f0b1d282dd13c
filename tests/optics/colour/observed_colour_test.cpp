// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/observed_colour.h"

#include <array>

#include <catch2/catch.hpp>

#include "tests/optics/colour/split_channels.h"

namespace voxtone::optics {
namespace {

using testing::green_twice;
using testing::overlapping_channels;
using testing::split_channels;

}  // namespace

TEST_CASE("Relative colours of R, G, B are value over white, channel by channel, to the last bit") {
    const ObservedColour<float> observed{Channels{}};
    const std::array<float, 3> value{0.123456f, -0.02f, 1.7f}, white{0.83f, 0.91f, 0.77f};
    const Eigen::Vector3f rgb = observed.relative(value.data(), white.data());
    for (std::size_t k = 0; k < 3; ++k) CHECK(rgb[static_cast<Eigen::Index>(k)] == value[k] / white[k]);
    CHECK(observed.absolute(value.data()) == Eigen::Vector3f(value[0], value[1], value[2]));
}

TEST_CASE("Halves of a primary show what the primary shows") {
    const ObservedColour<double> rgb{Channels{}}, own{split_channels(green_twice)};
    const std::array<double, 3> value{0.2, 0.5, 0.9}, white{0.8, 0.9, 0.7};
    const std::array<double, 4> values{0.2, 0.5, 0.5, 0.9}, whites{0.8, 0.9, 0.9, 0.7};
    CHECK((own.absolute(values.data()) - rgb.absolute(value.data())).norm() < 1e-12);
    CHECK((own.relative(values.data(), whites.data()) - rgb.relative(value.data(), white.data())).norm() < 1e-12);
}

TEST_CASE("Relative colours are those of the two colours, not of the channels") {
    const Channels channels = overlapping_channels();
    const ObservedColour<double> observed(channels);
    const std::array<double, 4> value{0.2, 0.5, 0.4, 0.9}, white{0.8, 0.9, 0.7, 0.95};
    const Eigen::Matrix3Xd M = linear_srgb_weights(channels);
    const Eigen::Vector3d of_value = M * Eigen::Map<const Eigen::Vector4d>(value.data()),
                          of_white = M * Eigen::Map<const Eigen::Vector4d>(white.data());
    const Eigen::Vector3d rgb = observed.relative(value.data(), white.data());
    CHECK((rgb - of_value.cwiseQuotient(of_white)).norm() < 1e-12);
    CHECK((observed.relative_weights(white.data()) * Eigen::Map<const Eigen::Vector4d>(value.data()) - rgb).norm() <
          1e-12);
    CHECK((observed.relative(white.data(), white.data()) - Eigen::Vector3d::Ones()).norm() < 1e-12);
    // Divided by channel first it would be another colour.
    Eigen::Vector4d divided;
    for (Eigen::Index c = 0; c < 4; ++c)
        divided[c] = value[static_cast<std::size_t>(c)] / white[static_cast<std::size_t>(c)];
    CHECK((M * divided - rgb).norm() > 0.01);
}

TEST_CASE("A place without light is black, and has no derivative") {
    const ObservedColour<float> observed(overlapping_channels());
    const std::array<float, 4> value{0.1f, 0.1f, 0.1f, 0.1f}, dark{};
    CHECK(observed.relative(value.data(), dark.data()) == Eigen::Vector3f::Zero());
    std::array<float, 4> by_value{1, 1, 1, 1};
    observed.adjoint({1, 2, 3}, dark.data(), by_value.data());
    CHECK(by_value == std::array<float, 4>{});
}

TEST_CASE("The adjoint of four channels agrees with differences") {
    const ObservedColour<double> observed(overlapping_channels());
    const std::array<double, 4> value{0.2, 0.5, 0.4, 0.9}, white{0.8, 0.9, 0.7, 0.95};
    const Eigen::Vector3d by_colour(0.7, -1.1, 0.4);
    for (const double* of : {static_cast<const double*>(nullptr), white.data()}) {
        std::array<double, 4> by_value{};
        observed.adjoint(by_colour, of, by_value.data());
        for (std::size_t c = 0; c < 4; ++c) {
            const auto F = [&](double step) {
                std::array<double, 4> moved = value;
                moved[c] += step;
                return by_colour.dot(of ? observed.relative(moved.data(), of) : observed.absolute(moved.data()));
            };
            CHECK(by_value[c] == Approx((F(1e-4) - F(-1e-4)) / 2e-4).epsilon(1e-8));
        }
    }
}

}  // namespace voxtone::optics
