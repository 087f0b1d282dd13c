// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/light_field.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "calibration/photo/checker_chart.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

const Eigen::Matrix3d camera = (Eigen::Matrix3d() << 0.5, 0.2, 0.03, 0.1, 0.6, 0.1, 0.02, 0.15, 0.5).finished();

double light_at(const Vector2d& px) {
    const Vector2d u = (px - Vector2d(1200, 800)) / 1442;
    return std::exp(0.3 * u.x() - 0.2 * u.y() + 0.1 * u.x() * u.y() - 0.2 * u.squaredNorm());
}

struct Scene {
    std::vector<LitSample> chart, frame;
};

/// Values are off by a share of themselves; or those of the chart as a fit assumes them to be, by half a share of
/// themselves and a tenth of one of white.
Scene scene(double noise, std::uint64_t seed, bool as_assumed = false) {
    Scene s;
    const CheckerChart colours = find_checker("colorchecker24");
    const auto noisy = [&](Vector3d value, std::uint64_t at) {
        RandomStream random(seed, at);
        for (double& v : value) {
            double sum = -6;
            for (int k = 0; k < 12; ++k) sum += random.uniform();
            v *= 1 + noise * sum;
        }
        return value;
    };
    for (std::size_t p = 0; p < 24; ++p) {
        const Vector2d px(1600 + 100 * double(p % 6), 400 + 100 * double(p / 6));
        const Vector3d value = light_at(px) * (camera * colours.linear_srgb[p]), white = camera * Vector3d::Ones();
        Vector3d off = noisy(value, p) - value;
        if (as_assumed) off = off.cwiseProduct((0.5 * value + 0.1 * white).cwiseQuotient(value));
        s.chart.push_back({px, value + off, colours.linear_srgb[p]});
    }
    for (int k = 0; k < 40; ++k) {
        const double t = k % 10 / 9.0;
        const Vector2d px = k < 10   ? Vector2d(200 + 1000 * t, 300)
                            : k < 20 ? Vector2d(200 + 1000 * t, 1200)
                            : k < 30 ? Vector2d(200, 300 + 900 * t)
                                     : Vector2d(1200, 300 + 900 * t);
        s.frame.push_back({px, noisy(light_at(px) * (camera * Vector3d(0.8, 0.85, 0.78)), std::uint64_t(1000 + k)),
                           Vector3d::Zero()});
    }
    return s;
}

}  // namespace

TEST_CASE("light, camera and the frame's colour are found exactly where nothing disturbs") {
    const Scene s = scene(0, 1);
    const PhotoModel model = PhotoModel::fit(s.chart, s.frame, 2400, 1600, "photo");
    const Vector3d rho(0.3, 0.1, 0.6);
    for (const Vector2d& px : {Vector2d(300, 400), Vector2d(700, 800), Vector2d(1150, 1150)})
        CHECK((model.reflectance(px, light_at(px) * (camera * rho)) - rho).cwiseAbs().maxCoeff() < 3e-4);
    CHECK((model.frame_reflectance() - Vector3d(0.8, 0.85, 0.78)).cwiseAbs().maxCoeff() < 3e-4);
}

TEST_CASE("noise of a sample becomes as much of its reflectance as samples that differ by it") {
    const Scene s = scene(0, 1);
    const PhotoModel model = PhotoModel::fit(s.chart, s.frame, 2400, 1600, "photo");
    const Vector3d value(0.2, 0.25, 0.15), noise(0.003, 0.001, 0.002);
    for (const Vector2d& px : {Vector2d(300, 400), Vector2d(1900, 300)}) {  // in a dark corner, and where it is light
        Vector3d variance = Vector3d::Zero();
        for (int channel = 0; channel < 3; ++channel)
            variance +=
                (model.reflectance(px, value + noise[channel] * Vector3d::Unit(channel)) - model.reflectance(px, value))
                    .cwiseAbs2();
        CHECK((model.noise(px, noise) - variance.cwiseSqrt()).cwiseAbs().maxCoeff() < 1e-9);
    }
    CHECK(model.light({1900, 300}) > 1.3 * model.light({300, 400}));
}

TEST_CASE("standard errors of the light and colour fit are honest", "[slow]") {
    // 1000 noisy scenes; the mean square of (error / standard error) of three places and channels must be 1. The nine
    // values of a scene go together, so that scenes are counted.
    constexpr int scenes = 1000;
    const Vector3d rho(0.7, 0.5, 0.3);
    for (const bool as_assumed : {true, false}) {
        double sum = 0, squares = 0;
        for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
            const Scene s = scene(0.003, seed, as_assumed);
            const PhotoModel model = PhotoModel::fit(s.chart, s.frame, 2400, 1600, "photo");
            double of_scene = 0;
            for (const Vector2d& px : {Vector2d(300, 400), Vector2d(700, 800), Vector2d(1150, 1150)}) {
                const Vector3d value = light_at(px) * (camera * rho);
                of_scene +=
                    (model.reflectance(px, value) - rho).cwiseQuotient(model.error(px, value)).squaredNorm() / 9;
            }
            sum += of_scene, squares += of_scene * of_scene;
        }
        const double mean = sum / scenes, error = std::sqrt((squares / scenes - mean * mean) / (scenes - 1));
        INFO((as_assumed ? "as assumed: " : "shares of themselves: ") << mean << " +- " << error);
        CHECK(error < 0.06);
        if (as_assumed)
            CHECK(std::abs(mean - 1) < 4 * error);
        else  // of a chart whose dark patches are better than that, errors are told a seventh too small, not less
            CHECK(mean < std::pow(7.0 / 6, 2) + 4 * error);
    }
}

TEST_CASE("too little of chart or frame is refused by name") {
    Scene s = scene(0, 1);
    s.frame.resize(5);
    CHECK_THROWS_WITH(PhotoModel::fit(s.chart, s.frame, 2400, 1600, "p.tif"),
                      Catch::Contains("p.tif") && Catch::Contains("frame"));
    s = scene(0, 1);
    s.chart.resize(9);
    CHECK_THROWS_WITH(PhotoModel::fit(s.chart, s.frame, 2400, 1600, "p.tif"), Catch::Contains("checker"));
}
