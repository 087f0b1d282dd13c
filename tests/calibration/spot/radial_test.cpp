// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rings about a point, and the point itself, in pictures that are known.
#include <cmath>
#include <functional>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "calibration/spot/radial_average.h"
#include "calibration/spot/radial_centre.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

double normal(RandomStream& random) {
    const double u = 1 - random.uniform(), v = random.uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

// f(x, y) about the centre, px, with noise of standard deviation `noise` that is said to be `said`.
MergedPicture picture_of(std::uint32_t size, const Eigen::Vector2d& centre, double noise, double said,
                         std::uint64_t seed, const std::function<double(double, double)>& f) {
    MergedPicture picture{size, size, {}, {}, {}, {1}, {}};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            RandomStream random(seed, picture.index(x, y));
            Eigen::Vector3f light;
            for (float& value : light)
                value = static_cast<float>(f(x + 0.5 - centre.x(), y + 0.5 - centre.y()) + noise * normal(random));
            picture.light.push_back(light);
        }
    picture.weight.assign(picture.light.size(), Eigen::Vector3f::Constant(static_cast<float>(1 / (said * said))));
    picture.exposures.assign(picture.light.size(), 1);
    return picture;
}

MergedPicture round_picture(std::uint32_t size, const Eigen::Vector2d& centre, double noise, std::uint64_t seed,
                            const std::function<double(double)>& f) {
    return picture_of(size, centre, noise, noise > 0 ? noise : 1e-3, seed,
                      [&](double x, double y) { return f(std::hypot(x, y)); });
}

std::string fault(const std::function<void()>& work) {
    try {
        work();
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("A profile of straight lines comes back, scaled to its total") {
    const std::vector<double> knots{5, 3, 2.5, 1, 0.2, 0.1, 0};
    const double mm_per_px = 0.02, spacing = 0.05;
    const RadialPlan plan{{33.3, 31.9}, mm_per_px, spacing, knots.size()};
    const auto picture = round_picture(64, plan.centre_px, 0, 1, [&](double r) {
        const double at = r * mm_per_px / spacing;
        const auto i = static_cast<std::size_t>(at);
        return i + 1 < knots.size() ? knots[i] + (at - std::floor(at)) * (knots[i + 1] - knots[i]) : 0;
    });
    const std::vector<double> light = fit_rings(picture, 1, plan);
    for (std::size_t i = 0; i < knots.size(); ++i) CHECK(light[i] == Approx(knots[i]).margin(1e-5));
    const RadialProfile profile = average_rings(picture, 1, plan, 0.25);
    double total = 0;  // of straight lines over the plane: 2 pi integral of f r dr
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const double a = static_cast<double>(i) * spacing, b = a + spacing;
        total += 2 * std::numbers::pi *
                 (profile.light[i] * (b - a) * (2 * a + b) / 6 + profile.light[i + 1] * (b - a) * (a + 2 * b) / 6);
    }
    CHECK(total == Approx(0.25).epsilon(1e-12));
    CHECK(profile.light[1] / profile.light[2] == Approx(knots[1] / knots[2]).epsilon(1e-5));
    CHECK(profile.asymmetry < 1e-6);
    CHECK(profile.missing == 0);
}

TEST_CASE("Errors are those of the noise that is there, whatever is said of it") {
    const RadialPlan plan{{50.2, 49.7}, 0.03, 0.05, 25};
    const auto f = [](double r) { return std::exp(-r / 12); };
    for (const double said : {0.01, 0.05}) {
        const double true_noise = 0.02;
        std::vector<double> sum(plan.samples), sum2(plan.samples), error2(plan.samples);
        double noise = 0;
        constexpr int pictures = 60;
        for (int seed = 1; seed <= pictures; ++seed) {
            const auto picture = picture_of(100, plan.centre_px, true_noise, said, static_cast<std::uint64_t>(seed),
                                            [&](double x, double y) { return f(std::hypot(x, y)); });
            const RadialProfile profile = average_rings(picture, 0, plan, 1);
            noise += profile.noise / pictures;
            for (std::size_t i = 0; i < plan.samples; ++i) {
                sum[i] += profile.light[i], sum2[i] += profile.light[i] * profile.light[i];
                error2[i] += profile.error[i] * profile.error[i];
            }
        }
        CHECK(noise == Approx(true_noise / said).epsilon(0.02));
        double ratio = 0;  // of the variance seen to the one stated
        for (std::size_t i = 0; i < plan.samples; ++i)
            ratio += (sum2[i] - sum[i] * sum[i] / pictures) / (pictures - 1) / (error2[i] / pictures) /
                     static_cast<double>(plan.samples);
        // 25 samples of 59 degrees of freedom each: standard error sqrt(2 / (25 * 59)) = 0.037, and neighbours are
        // related.
        CHECK(std::abs(ratio - 1) < 4 * 0.037 * 1.2);
    }
}

TEST_CASE("The centre is found to a small part of a pixel, and its error is known") {
    double chi2 = 0;
    constexpr int pictures = 20;
    for (int seed = 1; seed <= pictures; ++seed) {
        RandomStream random(7, static_cast<std::uint64_t>(seed));
        const Eigen::Vector2d truth(45 + 10 * random.uniform(), 45 + 10 * random.uniform());
        const auto picture = round_picture(100, truth, 0.02, static_cast<std::uint64_t>(seed),
                                           [](double r) { return std::exp(-r * r / 72); });
        const RadialCentre centre = find_radial_centre(picture, 2, 1e9);
        CHECK((centre.px - truth).norm() < 0.1);
        CHECK(centre.error_px.maxCoeff() < 0.03);
        chi2 += (centre.px - truth).cwiseQuotient(centre.error_px).squaredNorm();
    }
    // Chi-square of 40 degrees of freedom: 40 +- 4 sqrt(80).
    CHECK(std::abs(chi2 - 40) < 4 * std::sqrt(80.0));
}

TEST_CASE("What has no centre is refused, and why") {
    const auto spot = [](double r) { return std::exp(-r * r / 72); };
    const Eigen::Vector2d middle(50, 50);
    CHECK_THAT(
        fault([&] { (void)find_radial_centre(round_picture(100, middle, 0.01, 1, [](double) { return 0; }), 2, 1e9); }),
        Contains("no light") && Contains("dark"));
    CHECK_THAT(fault([&] {
                   (void)find_radial_centre(round_picture(100, {20, 50}, 0.01, 1, spot), 2, 1e9);
               }),
               Contains("from the border") && Contains("20 px"));
    MergedPicture saturated = round_picture(100, middle, 0.01, 1, spot);
    for (std::size_t i = 0; i < saturated.light.size(); ++i)
        if (saturated.light[i][0] > 0.8f) saturated.weight[i].setZero();
    CHECK_THAT(fault([&] { (void)find_radial_centre(saturated, 2, 1e9); }),
               Contains("saturated") && Contains("shorter"));
    // A few dead pixels do no harm.
    MergedPicture dead = round_picture(100, middle, 0.01, 1, spot);
    for (const auto& [x, y] : {std::pair{50u, 51u}, {47u, 50u}, {70u, 20u}}) {
        dead.weight[dead.index(x, y)].setZero();
        dead.light[dead.index(x, y)].setZero();
    }
    CHECK((find_radial_centre(dead, 2, 1e9).px - middle).norm() < 0.05);
    CHECK(average_rings(dead, 0, {middle, 1, 2, 20}, 1).missing == 3);
}

TEST_CASE("A spot that is not round has its asymmetry said") {
    const RadialPlan plan{{50, 50}, 1, 2, 20};
    const auto ellipse = picture_of(100, plan.centre_px, 0.01, 0.01, 1,
                                    [](double x, double y) { return std::exp(-(x * x / 1.3 + y * y * 1.3) / 72); });
    const auto two = picture_of(100, plan.centre_px, 0.01, 0.01, 1, [](double x, double y) {
        return std::exp(-(x * x + y * y) / 72) + 0.5 * std::exp(-((x - 20) * (x - 20) + y * y) / 72);
    });
    const auto round = round_picture(100, plan.centre_px, 0.01, 1, [](double r) { return std::exp(-r * r / 72); });
    CHECK(average_rings(round, 0, plan, 1).asymmetry < 0.01);
    CHECK(average_rings(ellipse, 0, plan, 1).asymmetry > 0.1);
    CHECK(average_rings(two, 0, plan, 1).asymmetry > 0.2);
    CHECK(average_rings(ellipse, 0, plan, 1).noise > 2);
}
