// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>

#include "flat_surface.h"
#include "halftone/loop/map_targets.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int across = 120;
constexpr double pitch = 0.1;

/// A print that is never darker than this.
constexpr float darkest = 0.06f;
Eigen::Vector3f lighten(const Eigen::Vector3f& rgb) { return rgb.cwiseMax(darkest); }

}  // namespace

TEST_CASE("Detail that is too dark to be printed keeps its contrast, lighter") {
    const optics::Surface surface = test::flat_surface(across, across, pitch);
    const EyeFilter wide(surface, 2400, EyeSurround::none);
    const auto is_light = [](int x) { return x / 4 % 2 == 1; };
    // Left: dark stripes of 0.4 mm. Right: the same, light enough.
    std::vector<Eigen::Vector3f> target;
    for (int y = 0; y < across; ++y)
        for (int x = 0; x < across; ++x)
            target.emplace_back(
                Eigen::Vector3f::Constant((is_light(x) ? 0.03f : 0.01f) + (x < across / 2 ? 0.0f : 0.3f)));
    const auto mapped = map_targets(target, lighten, [&]() -> const EyeFilter& { return wide; });
    float light = 0, dark = 1;
    for (int x = 20; x < 40; ++x) {
        const float value = mapped[static_cast<std::size_t>(across / 2 * across + x)][1];
        CHECK(value >= darkest - 1e-6f);
        (is_light(x) ? light : dark) = is_light(x) ? std::max(light, value) : std::min(dark, value);
    }
    CAPTURE(light, dark);
    CHECK(dark == Approx(darkest).margin(1e-5));
    // Half of the difference in Oklab's lightness is more than the mean: that much is seen again.
    const double asked = std::cbrt(0.03) - std::cbrt(0.01),
                 shown = std::cbrt(static_cast<double>(light)) - std::cbrt(static_cast<double>(dark));
    CHECK(shown > 0.35 * asked);
    CHECK(shown < 0.75 * asked);
    for (int x = across / 2; x < across; ++x) {
        const auto i = static_cast<std::size_t>(across / 2 * across + x);
        CHECK(mapped[i] == target[i]);
    }
}

TEST_CASE("Targets that can be printed are not touched, and nothing is smoothed for them") {
    const std::vector<Eigen::Vector3f> target(across * across, Eigen::Vector3f(0.2f, 0.5f, 0.9f));
    const auto never = []() -> const EyeFilter& { throw std::logic_error("asked for"); };
    CHECK(map_targets(target, lighten, never) == target);
}
