// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/random.h"
#include "flat_surface.h"
#include "halftone/loop/misfit.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int n = 120;
constexpr float contrast_part = 0.7f;

std::vector<Eigen::Vector3f> colours(std::uint64_t seed) {
    std::vector<Eigen::Vector3f> rgb;
    for (std::uint64_t i = 0; i < n * n; ++i) {
        RandomStream random(seed, i);
        rgb.emplace_back(0.1 + 0.8 * random.uniform(), 0.1 + 0.8 * random.uniform(), 0.1 + 0.8 * random.uniform());
    }
    return rgb;
}

/// Of a fifth of the cells in blocks, of the others none.
std::vector<float> here_and_there() {
    std::vector<float> k(n * n);
    for (std::size_t i = 0; i < k.size(); ++i) k[i] = i % n / 5 % 5 == i / n / 5 % 5 ? contrast_part : 0;
    return k;
}

}  // namespace

TEST_CASE("The misfit counts every cell alike: the first, the last and those between", "[loop]") {
    constexpr int small = 24;
    const optics::Surface surface = test::flat_surface(small, small, 0.085);
    const EyeFilter eye(surface, 300, EyeSurround::none), wide(surface, 300 * wider, EyeSurround::none);
    const std::vector<Eigen::Vector3f> target(small * small, Eigen::Vector3f(0.4f, 0.5f, 0.3f));
    const std::vector<float> weight(small * small, 1.0f), k(small * small, contrast_part);
    const MisfitFunction plain(surface, eye, target, weight, nullptr, {}),
        levelled(surface, eye, target, weight, &wide, k);
    for (const MisfitFunction* misfit : {&plain, &levelled}) {
        const auto off = [&](int x, int y) {
            auto shown = target;
            shown[std::size_t(y * small + x)] = {0.8f, 0.2f, 0.3f};
            const Misfit here = (*misfit)(shown);
            const float own = here.by_colour[std::size_t(y * small + x)].norm();
            CHECK(own > 0);
            for (const Eigen::Vector3f& by : here.by_colour) CHECK(by.norm() <= 1.001f * own);
            return here.value;
        };
        const double corner = off(0, 0), side = off(small / 2, 0);
        CHECK(corner > 0);
        for (const auto& [x, y] : {std::pair{small - 1, 0}, {0, small - 1}, {small - 1, small - 1}})
            CHECK(off(x, y) == Approx(corner).epsilon(1e-3));
        for (const auto& [x, y] : {std::pair{small / 2, small - 1}, {0, small / 2}, {small - 1, small / 2}})
            CHECK(off(x, y) == Approx(side).epsilon(0.02));
    }
}

TEST_CASE("The misfit is 0 at the target, and its derivative is that of differences", "[loop][slow]") {
    const optics::Surface surface = test::flat_surface(n, n, 0.085);
    const EyeFilter eye(surface, 300, EyeSurround::none), wide(surface, 300 * wider, EyeSurround::none);
    const auto target = colours(1), shown = colours(2);
    std::vector<float> weight(n * n, 1.0f);
    for (std::size_t i = 0; i < weight.size(); i += 3) weight[i] = 0.25f;
    const std::vector<float> everywhere(n * n, contrast_part);
    for (const std::vector<float>& k : {std::vector<float>{}, everywhere, here_and_there()}) {
        const bool contrast = !k.empty();
        const MisfitFunction misfit(surface, eye, target, weight, contrast ? &wide : nullptr, k);
        CHECK(misfit(target).value == Approx(0).margin(1e-9));
        const Misfit here = misfit(shown);
        CHECK(here.value > 0);
        float largest = 0;
        for (const Eigen::Vector3f& by : here.by_colour) largest = std::max(largest, by.cwiseAbs().maxCoeff());
        // Away from the border, where the filter's sums are alike.
        // For the wide filter the border is everywhere on so small a surface.
        for (const int cell : {n * 60 + 57, n * 55 + 62}) {
            for (Eigen::Index c = 0; c < 3; ++c) {
                constexpr float step = 0.004f;
                auto up = shown, down = shown;
                up[std::size_t(cell)][c] += step;
                down[std::size_t(cell)][c] -= step;
                const double difference = (misfit(up).value - misfit(down).value) / double(2 * step);
                CHECK(double(here.by_colour[std::size_t(cell)][c]) ==
                      Approx(difference).epsilon(0.05).margin((contrast ? 0.02 : 0.002) * double(largest)));
            }
        }
        // Of many cells at once, up and down by turns and in patches: what each part of the filter gives counts.
        for (const int patch : {1, 4, 9}) {
            constexpr float step = 0.001f;
            auto up = shown, down = shown;
            double expected = 0;
            for (int y = n / 4; y < 3 * n / 4; ++y)
                for (int x = n / 4; x < 3 * n / 4; ++x) {
                    const auto cell = std::size_t(y * n + x);
                    const float way = (x / patch + y / patch) % 2 == 0 ? step : -step;
                    up[cell].array() += way, down[cell].array() -= way;
                    expected += 2 * double(way) * double(here.by_colour[cell].sum());
                }
            CAPTURE(patch);
            CHECK(misfit(up).value - misfit(down).value == Approx(expected).epsilon(0.02));
        }
    }
}

TEST_CASE("With the contrast intent an even offset counts little, a pattern as before", "[loop]") {
    const optics::Surface surface = test::flat_surface(n, n, 0.085);
    const EyeFilter eye(surface, 300, EyeSurround::none), wide(surface, 300 * wider, EyeSurround::none);
    const std::vector<Eigen::Vector3f> grey(n * n, Eigen::Vector3f::Constant(0.3f)),
        lighter(n * n, Eigen::Vector3f::Constant(0.4f));
    std::vector<Eigen::Vector3f> stripes = grey;  // of the same mean
    for (std::size_t i = 0; i < stripes.size(); ++i) stripes[i].setConstant(i % n / 4 % 2 ? 0.35f : 0.25f);
    const MisfitFunction plain(surface, eye, grey),
        contrast(surface, eye, grey, {}, &wide, std::vector<float>(n * n, contrast_part));
    const double keeps = (1 - double(contrast_part)) * (1 - double(contrast_part));
    // The small part that is taken cell by cell has no privilege.
    CHECK(contrast(lighter).value < (keeps + 0.12) * plain(lighter).value);
    CHECK(contrast(stripes).value > 0.5 * plain(stripes).value);
}
