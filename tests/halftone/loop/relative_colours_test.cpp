// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/relative_colours.h"

#include <catch2/catch.hpp>

#include "base/random.h"
#include "tests/optics/colour/split_channels.h"

using namespace voxtone;
using namespace voxtone::halftone;
using namespace voxtone::optics::testing;

namespace {

constexpr std::size_t cells = 50;

std::vector<float> draw(std::size_t channels, std::uint64_t seed, double least, double most) {
    std::vector<float> values;
    RandomStream random(seed, channels);
    for (std::size_t i = 0; i < cells * channels; ++i)
        values.push_back(static_cast<float>(least + (most - least) * random.uniform()));
    return values;
}

/// The same values in split channels.
std::vector<float> split(const std::vector<float>& rgb, const Parts& parts) {
    std::vector<float> values;
    for (std::size_t i = 0; i < cells; ++i)
        for (const std::size_t part : parts) values.push_back(rgb[3 * i + part]);
    return values;
}

}  // namespace

TEST_CASE("R, G, B are relative channel by channel, to the last bit, and split channels show the same") {
    const std::vector<float> value = draw(3, 1, -0.01, 1.1), white = draw(3, 2, 0.5, 1);
    const RelativeColours rgb(optics::Channels{}, white);
    const auto seen = rgb.colours({3, value, {}, {}});
    for (std::size_t i = 0; i < cells; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            REQUIRE(seen[i][static_cast<Eigen::Index>(k)] == value[3 * i + k] / white[3 * i + k]);

    const std::vector<float> of_own = split(white, green_twice);
    const RelativeColours own(split_channels(green_twice), of_own);
    const auto shown = own.colours({4, split(value, green_twice), {}, {}});
    for (std::size_t i = 0; i < cells; ++i) REQUIRE((shown[i] - seen[i]).norm() < 2e-6f);

    // What the two halves of green say together is what green says.
    const std::vector<Eigen::Vector3f> by_colour(cells, Eigen::Vector3f(0.3f, -0.8f, 0.5f));
    const std::vector<float> by_rgb = rgb.adjoint(by_colour), by_own = own.adjoint(by_colour);
    for (std::size_t i = 0; i < cells; ++i)
        REQUIRE(by_own[4 * i + 1] + by_own[4 * i + 2] == Approx(by_rgb[3 * i + 1]).epsilon(1e-5));
}

TEST_CASE("Derivatives by the light of four channels are those of colours") {
    const std::vector<float> value = draw(4, 3, 0, 1), white = draw(4, 4, 0.5, 1), none;
    for (const std::vector<float>* of : {&white, &none}) {
        const RelativeColours colours(overlapping_channels(), *of);
        std::vector<Eigen::Vector3f> by_colour;
        for (std::size_t i = 0; i < cells; ++i)
            by_colour.emplace_back(0.1f * float(i % 7) - 0.3f, 0.2f, 0.05f * float(i % 11));
        const std::vector<float> by_light = colours.adjoint(by_colour);
        // Linear in the light: a step may be as long as one likes.
        for (std::size_t at = 0; at < value.size(); at += 3) {
            std::vector<float> moved = value;
            moved[at] += 0.5f;
            const std::size_t i = at / 4;
            const Eigen::Vector3f change =
                colours.colours({4, moved, {}, {}})[i] - colours.colours({4, value, {}, {}})[i];
            REQUIRE(change.dot(by_colour[i]) == Approx(0.5f * by_light[at]).epsilon(1e-3).margin(1e-5));
        }
    }
}

TEST_CASE("Where white shows no light there is no colour, and nothing to gain") {
    const std::vector<float> value(4, 0.2f), white(4, 0.0f);
    const RelativeColours colours(overlapping_channels(), white);
    CHECK(colours.colours({4, value, {}, {}})[0] == Eigen::Vector3f::Zero());
    const std::vector<Eigen::Vector3f> by_colour{{1, 1, 1}};
    CHECK(colours.adjoint(by_colour) == std::vector<float>(4, 0.0f));
}
