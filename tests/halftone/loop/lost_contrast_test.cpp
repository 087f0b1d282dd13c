// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/random.h"
#include "flat_surface.h"
#include "halftone/loop/lost_contrast.h"
#include "halftone/loop/misfit.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int n = 120;
using Colours = std::vector<Eigen::Vector3f>;

/// Oklab's lightness of greys.
Colours greys(const std::function<double(int x, int y)>& lightness) {
    Colours rgb;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            rgb.push_back(Eigen::Vector3f::Constant(static_cast<float>(std::pow(lightness(x, y), 3))));
    return rgb;
}

double stripe(int x) { return x / 2 % 2 ? 0.1 : -0.1; }

}  // namespace

TEST_CASE("What of the target's contrast is not there is lost, levels and noise are not contrast", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, 0.085);
    const EyeFilter wide(surface, 300 * wider, EyeSurround::none);
    const auto in_the_middle = [&](const Colours& target, const Colours& print) {
        return lost_contrast(target, print, wide)[n * (n / 2) + n / 2];
    };
    const Colours target = greys([](int x, int) { return 0.6 + stripe(x); });
    CHECK(in_the_middle(target, target) == Approx(0).margin(1e-6));
    CHECK(in_the_middle(target, greys([](int x, int) { return 0.7 + stripe(x); })) == Approx(0).margin(1e-3));
    CHECK(in_the_middle(target, greys([](int x, int) { return 0.6 + 2 * stripe(x); })) == 0);
    CHECK(in_the_middle(target, greys([](int x, int) { return 0.7 + 0.5 * stripe(x); })) == Approx(0.05).epsilon(0.02));
    CHECK(in_the_middle(target, greys([](int, int) { return 0.6; })) == Approx(0.1).epsilon(0.02));
    // A flat target has none to lose.
    CHECK(in_the_middle(greys([](int, int) { return 0.6; }), target) < 1e-3f);
    CHECK(in_the_middle(target, greys([](int x, int y) {
                            return 0.6 + stripe(x) +
                                   0.1 * (RandomStream(1, static_cast<std::uint64_t>(y * n + x)).uniform() - 0.5);
                        })) < 0.004f);
}

TEST_CASE("Of fine contrast it is told how much was wanted and which share is there, all of it where none was",
          "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, 0.085);
    const EyeFilter wide(surface, 300 * wider, EyeSurround::none);
    const auto in_the_middle = [&](const Colours& target, const Colours& print) {
        return fine_contrast(target, print, wide)[n * (n / 2) + n / 2];
    };
    const auto striped = [](double times) { return greys([=](int x, int) { return 0.6 + times * stripe(x); }); };
    const Colours target = striped(1), flat = greys([](int, int) { return 0.6; });
    CHECK(in_the_middle(target, flat).wanted == Approx(0.1).epsilon(0.02));
    for (const double share : {0.0, 0.5, 1.0, 2.0, -1.0}) {
        CAPTURE(share);
        CHECK(in_the_middle(target, striped(share)).kept == Approx(share).margin(0.01));
    }
    for (const Colours& print : {flat, target}) {
        const FineContrast none = in_the_middle(flat, print);
        CHECK(none.wanted < 1e-3f);
        CHECK(none.kept == 1);
    }
}

TEST_CASE("Levels give way where contrast is lost, up to the most that is allowed and some millimetres around",
          "[loop]") {
    const std::vector<float> part = contrast_parts({0, 0.01f, 0.03f, 0.1f, 1}, 0.6f);
    CHECK(part[0] == 0);
    CHECK(part[1] == Approx(0.06f).epsilon(0.01));
    CHECK(part[2] == Approx(0.3f));
    CHECK(part[3] == Approx(0.55f).epsilon(0.01));
    CHECK(part[4] < 0.6f);

    // A stroke on paper that is lost altogether.
    const optics::Surface surface = test::flat_surface(n, n, 0.085);
    const EyeFilter wide(surface, 300 * wider, EyeSurround::none);
    const Colours target = greys([](int x, int) { return x >= 58 && x < 62 ? 0.2 : 0.95; }),
                  paper = greys([](int, int) { return 0.95; });
    const auto lost = test::same_for_threads([&] { return lost_contrast(target, paper, wide); });
    const auto at = [&](int x) { return contrast_parts(lost, 0.6f)[std::size_t(n / 2 * n + x)]; };
    CHECK(at(60) > 0.5f);
    CHECK(at(48) > 0.3f);  // 1 mm away
    CHECK(at(5) < 0.05f);  // 5 mm away
    CHECK(std::is_sorted(&lost[n / 2 * n + 5], &lost[n / 2 * n + 58]));
}
