// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/lateral_transport.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "base/parallel.h"
#include "base/random.h"

using namespace voxtone::optics;

namespace {

constexpr float edge = 0.1F;
constexpr int nx = 120, ny = 40;

std::vector<SurfacePoint> plate() {
    std::vector<SurfacePoint> points;
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
            points.push_back({{(static_cast<float>(x) + 0.5F) * edge, (static_cast<float>(y) + 0.5F) * edge, 0},
                              {0, 0, 1},
                              edge * edge});
    return points;
}

GaussianWeights one(std::size_t j, float light) {
    GaussianWeights w{};
    w[j] = light;
    return w;
}

// Light of a Gaussian of width u that crosses a straight edge at a distance x from it.
double beyond(double x, double u) { return 0.5 * std::erfc(x / u); }

}  // namespace

TEST_CASE("A surface that is the same everywhere shows its total, through the surface") {
    const std::vector<SurfacePoint> points = plate();
    const GaussianWeights white{0.02F, 0.05F, 0.1F, 0.2F, 0.25F, 0.2F, 0.1F, 0.05F}, dark{0, 0.01F, 0, 0, 0, 0, 0, 0},
        none{}, all{0.5F, 0, 0, 0, 0, 0, 0, 0.5F};
    for (const double s : {0.0, 0.596}) {
        std::vector<GaussianWeights> weights;
        for (std::size_t i = 0; i < points.size(); ++i) weights.insert(weights.end(), {white, dark, none, all});
        const std::vector<float> seen = with_lateral_transport(points, weights, 4, s);
        for (std::size_t i = 0; i < points.size(); ++i) {
            CHECK(seen[4 * i] == Approx((1 - s) * 0.97 / (1 - 0.97 * s)).epsilon(1e-5));
            CHECK(seen[4 * i + 1] == Approx((1 - s) * 0.01 / (1 - 0.01 * s)).epsilon(1e-5));
            CHECK(seen[4 * i + 2] == 0);
            CHECK(seen[4 * i + 3] == Approx(1).epsilon(1e-5));
        }
    }
    CHECK(with_lateral_transport({}, {}, 3, 0.5).empty());
}

TEST_CASE("An edge is blurred as the exact sum of responses says, where filters lie on one base") {
    const std::vector<SurfacePoint> points = plate();
    // Both widths, the light of each; left all of it, right a ninth.
    for (const std::size_t j : {std::size_t{1}, std::size_t{3}, std::size_t{5}}) {
        const double u = gaussian_widths_mm()[j];
        std::vector<GaussianWeights> weights;
        for (const SurfacePoint& p : points) weights.push_back(one(j, p.at[0] < 6 ? 0.9F : 0.1F));
        const std::vector<float> seen = with_lateral_transport(points, weights, 1, 0);
        double square = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double x = static_cast<double>(points[i].at[0]) - 6, other = std::sqrt(0.09),
                         mine = x < 0 ? 0.9 : 0.1;
            if (std::abs(x) > 3) continue;
            // Cells are means: of both ends of every response. What crosses from or to anywhere in them.
            double crossing = 0;
            constexpr int parts = 10;
            for (int k = 0; k < parts; ++k)
                crossing += beyond(std::abs(x) + static_cast<double>(edge) * ((k + 0.5) / parts - 0.5), u) / parts;
            const double exact = mine + (other - mine) * crossing;
            INFO("width " << u << ", " << x << " mm from the edge");
            CHECK(seen[i] == Approx(exact).margin(0.02));
            square += (exact - mine) * (exact - mine);
        }
        CHECK(square > 1);  // sharp cells fail this test
    }
}

TEST_CASE("Light turned back by the surface goes sideways again: the solution obeys its equation") {
    // Stripes much narrower than the Gaussian: light forgets where it came up, so R d = root(w) mean(root(w) d).
    const std::vector<SurfacePoint> points = plate();
    constexpr double s = 0.596, a = 0.9, b = 0.1;
    std::vector<GaussianWeights> weights;
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) weights.push_back(one(6, static_cast<float>((x + y) % 2 == 0 ? a : b)));
    const std::vector<float> seen = with_lateral_transport(points, weights, 1, s);
    // d = 1 + s root(w) m, m = mean(root(w) d)
    const double roots = 0.5 * (std::sqrt(a) + std::sqrt(b)), m = roots / (1 - s * 0.5 * (a + b));
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
            const double w = (x + y) % 2 == 0 ? a : b;
            CHECK(seen[static_cast<std::size_t>(y * nx + x)] == Approx((1 - s) * std::sqrt(w) * m).margin(0.003));
        }
}

TEST_CASE("No place shows more light than there is, and any number of threads the same") {
    const std::vector<SurfacePoint> points = plate();
    std::vector<GaussianWeights> weights(3 * points.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
        voxtone::RandomStream random(1, i);
        const auto j = static_cast<std::size_t>(random.uniform() * profile_gaussians);
        weights[i][j] = 0.5F;
        weights[i][profile_gaussians - 1 - j] += 0.5F;
    }
    const std::vector<float> many = with_lateral_transport(points, weights, 3, 0.596);
    for (const float value : many) CHECK((value >= 0 && value <= 1));
    const voxtone::ThreadLimit limit(1);
    CHECK(with_lateral_transport(points, weights, 3, 0.596) == many);
}
