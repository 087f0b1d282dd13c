// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures by light paths: what must be kept, what is known exactly, and a tracer that shares nothing with them.
#include "optics/camera/camera_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "optics/camera/lit_scene.h"
#include "optics/camera/pixel_filter.h"
#include "optics/camera/tile_paths.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/numerics/quadrature.h"
#include "optics/scene/fresnel.h"
#include "tests/optics/colour/split_channels.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

ResinSet one_resin(const std::array<double, 3>& sigma_t, const std::array<double, 3>& albedo) {
    ResinSet set;
    set.name = "one";
    set.resins = {{"Resin", "W", {sigma_t.begin(), sigma_t.end()}, {albedo.begin(), albedo.end()}}};
    return set;
}

ResinVolume full(const std::array<int, 3>& size, double pitch) {
    ResinVolumeBuilder builder(size, {pitch, pitch, pitch});
    const std::vector<Material> layer(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]), 1);
    for (int z = 0; z < size[2]; ++z) builder.add_layer(layer);
    return builder.finish();
}

/// A ball of 3.2 mm in a box of 4 mm.
struct Ball {
    explicit Ball(ResinSet set, int voxels = 40)
        : resins(std::move(set)), volume(full({voxels, voxels, voxels}, 4.0 / voxels)) {
        scene = {.volume = &volume, .resins = &resins};
    }
    static constexpr double radius = 1.6;
    static constexpr Point centre{2, 2, 2};
    [[nodiscard]] CameraScene before(const CameraView& view, const Sky& sky,
                                     const SurfaceFinish* finish = nullptr) const {
        CameraScene out;
        out.view = view;
        out.sky = &sky;
        out.prints.push_back({&scene, &sphere, finish, {0, 0, 0}});
        return out;
    }
    ResinSet resins;
    ResinVolume volume;
    Scene scene;
    Sphere sphere{centre, radius};
};

CameraView view_of_ball(int width, int height) {
    CameraView view;
    view.position = {2, -98, 2};
    view.target = Ball::centre;
    view.focal_mm = film_width_mm / 3.6 * 100;  // 3.6 mm fill the width
    view.width_px = width;
    view.height_px = height;
    return view;
}

CameraPicture take(const CameraScene& scene, std::uint32_t samples, std::uint64_t seed = 1, double filter_px = 0) {
    Progress progress;
    return take_picture(scene, {.samples = samples, .max_samples = 1u << 20, .seed = seed, .filter_px = filter_px},
                        progress);
}

/// What a path comes to: a part of the sky, and how often it was scattered on the way. Of a medium of any albedo it
/// brings light times albedo^scatterings.
struct PathEnd {
    double light = 0;
    int scatterings = 0;
};

// The tracer that shares nothing: one ball of one medium, path by path.
class BruteForce {
public:
    BruteForce(double sigma_t, double g, double eta, const Sky& sky, std::size_t channel)
        : sigma_t_(sigma_t), g_(g), eta_(eta), sky_(sky), channel_(channel) {}

    PathEnd trace(Point p, Point d, std::mt19937_64& engine) const {
        std::uniform_real_distribution<double> u(0, 1);
        const Point r = minus(p, Ball::centre);
        const double way = inner(r, d), root = way * way - inner(r, r) + Ball::radius * Ball::radius;
        if (root <= 0) return {sky_.radiance(d)[channel_]};
        p = plus(p, d, -way - std::sqrt(root));
        Point n = outward(p);
        if (u(engine) < schlick_free_fresnel(-inner(d, n), eta_)) return {sky_.radiance(mirrored(d, n))[channel_]};
        d = bent(d, n, 1 / eta_);
        int scatterings = 0;
        for (int event = 0; event < 100000; ++event) {
            const Point from_centre = minus(p, Ball::centre);
            const double b = inner(from_centre, d);
            const double to_side =
                -b + std::sqrt(std::max(0.0, b * b - inner(from_centre, from_centre) + Ball::radius * Ball::radius));
            const double free = -std::log(1 - u(engine)) / sigma_t_;
            if (free < to_side) {
                p = plus(p, d, free);
                ++scatterings;
                d = scattered(d, u(engine), u(engine));
                continue;
            }
            p = plus(p, d, to_side);
            n = outward(p);
            const double cosine = inner(d, n), sine2 = eta_ * eta_ * (1 - cosine * cosine);
            const double reflected = sine2 >= 1 ? 1 : schlick_free_fresnel(std::sqrt(1 - sine2), eta_);
            if (u(engine) >= reflected)
                return {sky_.radiance(bent(d, {-n[0], -n[1], -n[2]}, eta_))[channel_], scatterings};
            d = mirrored(d, n);
        }
        return {};
    }

private:
    static double inner(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    static Point plus(const Point& a, const Point& b, double s) {
        return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
    }
    static Point outward(const Point& p) {
        Point n = minus(p, Ball::centre);
        const double length = std::sqrt(inner(n, n));
        for (double& x : n) x /= length;
        return n;
    }
    static Point mirrored(const Point& d, const Point& n) { return plus(d, n, -2 * inner(d, n)); }
    // n against d; ratio = index before / index behind.
    static Point bent(const Point& d, const Point& n, double ratio) {
        const double cosine = -inner(d, n);
        const double behind = std::sqrt(std::max(0.0, 1 - ratio * ratio * (1 - cosine * cosine)));
        Point out{};
        for (std::size_t a = 0; a < 3; ++a) out[a] = ratio * d[a] + (ratio * cosine - behind) * n[a];
        const double length = std::sqrt(inner(out, out));
        for (double& x : out) x /= length;
        return out;
    }
    // From air with cosine mu: the exact equations in their other form, by angles.
    static double schlick_free_fresnel(double mu, double eta) {
        const double a = std::acos(std::min(1.0, mu)), b = std::asin(std::sin(a) / eta);
        if (a < 1e-6) return std::pow((eta - 1) / (eta + 1), 2);
        const double s = std::sin(a - b) / std::sin(a + b), p = std::tan(a - b) / std::tan(a + b);
        return 0.5 * (s * s + p * p);
    }
    Point scattered(const Point& d, double u, double v) const {
        const double k = (1 - g_ * g_) / (1 - g_ + 2 * g_ * u), cosine = (1 + g_ * g_ - k * k) / (2 * g_);
        const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), phi = 2 * std::numbers::pi * v;
        const Point other = std::abs(d[0]) < 0.5 ? Point{1, 0, 0} : Point{0, 1, 0};
        Point e{d[1] * other[2] - d[2] * other[1], d[2] * other[0] - d[0] * other[2],
                d[0] * other[1] - d[1] * other[0]};
        const double length = std::sqrt(inner(e, e));
        for (double& x : e) x /= length;
        const Point f{d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]};
        Point out{};
        for (std::size_t a = 0; a < 3; ++a)
            out[a] = cosine * d[a] + sine * (std::cos(phi) * e[a] + std::sin(phi) * f[a]);
        return out;
    }
    double sigma_t_, g_, eta_;
    const Sky& sky_;
    std::size_t channel_;
};

struct Mean {
    double value = 0, error = 0;
};
Mean mean_of(const std::vector<PathEnd>& paths, double albedo) {
    double sum = 0, squares = 0;
    for (const PathEnd& path : paths) {
        const double x = path.light * std::pow(albedo, path.scatterings);
        sum += x, squares += x * x;
    }
    const double n = static_cast<double>(paths.size()), mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

const std::array<double, 3> profile_sigma{8, 20, 3}, profile_albedo{0.98, 0.9, 0.6};

/// Largest |z| between a strip across the ball and the brute-force tracer, of the ball's albedo and of one that is
/// wrong by this factor. The same paths tell both.
std::pair<double, double> largest_z(const CameraPicture& picture, const Camera& camera, const Sky& sky, double wrong,
                                    const std::array<double, 3>& sigma = profile_sigma,
                                    const std::array<double, 3>& albedo = profile_albedo) {
    double largest = 0, largest_of_wrong = 0;
    std::mt19937_64 engine(7);
    std::uniform_real_distribution<double> u(0, 1);
    for (std::size_t c = 0; c < 3; ++c) {
        const BruteForce brute(sigma[c], 0.4, 1.5, sky, c);
        for (int x = 0; x < picture.width_px; ++x) {
            std::vector<PathEnd> paths(3000);
            for (PathEnd& path : paths) {
                const double dx = u(engine), dy = u(engine);
                path = brute.trace(camera.position(), camera.direction(x + dx, dy), engine);
            }
            const std::size_t i = static_cast<std::size_t>(x) * 3 + c;
            const auto z = [&](double of_albedo) {
                const Mean wanted = mean_of(paths, of_albedo);
                const double off = static_cast<double>(picture.value[i]) - wanted.value;
                const double error = std::hypot(static_cast<double>(picture.standard_error[i]), wanted.error);
                return std::abs(off) / std::max(error, 1e-9);
            };
            largest = std::max(largest, z(albedo[c]));
            largest_of_wrong = std::max(largest_of_wrong, z(wrong * albedo[c]));
        }
    }
    return {largest, largest_of_wrong};
}

/// The same, but the index and g that count are the resin's, not the set's.
ResinSet by_its_own(ResinSet set) {
    set.resins[0].eta = set.eta, set.resins[0].g = set.g;
    set.eta = 1.2, set.g = -0.3;
    set.relate();
    return set;
}

}  // namespace

TEST_CASE("in a furnace nothing is seen, smooth or rough") {
    const Ball ball(by_its_own(one_resin({8, 20, 3}, {1, 1, 1})));
    const Sky sky = even_sky();
    for (const double roughness : {0.0, 0.1, 0.5})
        for (const double filter_px : {0.0, 0.5}) {
            const EvenFinish finish(roughness);
            const CameraPicture picture = take(ball.before(view_of_ball(20, 20), sky, &finish), 16, 1, filter_px);
            for (const float value : picture.value) CHECK(value == Approx(1).margin(1e-5));
        }
}

TEST_CASE("the profile of a ball from its middle to its limb is that of a tracer path by path") {
    const Ball ball(by_its_own(one_resin(profile_sigma, profile_albedo)));
    const Sky sky = overcast_sky();
    const CameraView view = view_of_ball(24, 1);
    const CameraPicture picture = take(ball.before(view, sky), 3000);
    // 72 values: |z| above 4.4 in one of them comes by chance once in 1,300 runs.
    const auto [largest, of_wrong] = largest_z(picture, Camera(view), sky, 0.97);
    CHECK(largest < 4.4);
    CHECK(of_wrong > 6);
}

TEST_CASE("a ball of optical radius 64 through which paths step in spheres looks as it does path by path") {
    const std::array<double, 3> sigma{40, 30, 20}, albedo{0.999, 0.998, 0.99};
    const Ball ball(by_its_own(one_resin(sigma, albedo)), 200);
    const Sky sky = overcast_sky();
    const CameraView view = view_of_ball(6, 1);
    const CameraScene scene = ball.before(view, sky);
    const PathVolume volume(ball.scene, &ball.sphere);
    const ClearSpheres spheres(ball.scene, volume);
    REQUIRE(*std::max_element(spheres.fitting().begin(), spheres.fitting().end()) >= 5);
    const CameraPicture picture = take(scene, 8000);
    // 18 values: |z| above 4 in one of them comes by chance once in 900 runs.
    const auto [largest, of_wrong] = largest_z(picture, Camera(view), sky, 0.998, sigma, albedo);
    CHECK(largest < 4);
    CHECK(of_wrong > 6);
    const Ball white(one_resin(sigma, {1, 1, 1}), 200);
    const Sky even = even_sky();
    for (const float value : take(white.before(view_of_ball(8, 8), even), 16).value)
        CHECK(value == Approx(1).margin(1e-5));
}

TEST_CASE("a flat slab seen from all sides is as bright as what leaves it") {
    const ResinSet resins = one_resin({6, 12, 4}, {0.99, 0.97, 0.95});
    const ResinVolume volume = full({60, 60, 30}, 0.1);
    const Scene scene{.volume = &volume, .resins = &resins};
    const FlatSides box(
        {{{1, 0, 0}, 6}, {{-1, 0, 0}, 0}, {{0, 1, 0}, 6}, {{0, -1, 0}, 0}, {{0, 0, 1}, 3}, {{0, 0, -1}, 0}});
    const Sky sky = even_sky();

    const Surface surface = find_surface(scene, {4, 4, 30}, SurfacePart::top);
    const Appearance seen = MonteCarlo({.paths = 160000, .seed = 3}).predict(scene, part_of(surface, std::array{112u}));
    REQUIRE(surface.cells.size() == 225);

    // Flux = integral of L over d(mu^2); the mirrored part is known.
    const Rule rule = gauss_legendre(6, 0, 1);
    std::array<double, 3> sum{}, variance{};
    double entered = 0;
    for (std::size_t k = 0; k < 6; ++k) {
        const double mu = std::sqrt(rule.x[k]), sine = std::sqrt(1 - rule.x[k]);
        CameraScene before;
        before.view.position = {3 + 100 * sine, 3, 3 + 100 * mu};
        before.view.target = {3, 3, 3};
        before.view.focal_mm = film_width_mm / (0.3 * mu) * 100;  // 0.3 mm of the slab, whatever the tilt
        before.view.width_px = before.view.height_px = 1;
        before.sky = &sky;
        before.prints.push_back({&scene, &box, nullptr, {0, 0, 0}});
        const CameraPicture picture = take(before, 40000, k + 1);
        const double mirrored = fresnel_reflectance(mu, resins.eta);
        entered += rule.w[k] * (1 - mirrored);
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += rule.w[k] * (static_cast<double>(picture.value[c]) - mirrored);
            variance[c] += std::pow(rule.w[k] * static_cast<double>(picture.standard_error[c]), 2);
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const double a = static_cast<double>(seen.value[c]);
        const double error = std::hypot(static_cast<double>(seen.standard_error[c]), std::sqrt(variance[c]) / entered);
        INFO("channel " << c << ": " << sum[c] / entered << " for " << a << " +- " << error);
        CHECK(std::abs(sum[c] / entered - a) < 4 * error);
        CHECK(std::abs(1.03 * sum[c] / entered - a) > 4 * error);
    }
}

TEST_CASE("the lamp's mirror image stands where the half vector says, as bright as Fresnel says") {
    const Ball ball(one_resin({50, 50, 50}, {0, 0, 0}));
    const Point lamp{-0.6, -0.48, 0.64};
    const Sky sky = sky_of([&](const Point& d) {
        const double light = dot(d, lamp) > std::cos(0.15) ? 1.0 : 0.0;
        return Light{light, light, light};
    });
    const CameraView view = view_of_ball(120, 120);
    const Camera camera(view);
    Point n{lamp[0], lamp[1] - 1, lamp[2]};
    const double length = std::sqrt(dot(n, n));
    for (double& x : n) x /= length;
    const auto at = camera.picture_of(along(Ball::centre, n, Ball::radius));
    const auto x = static_cast<int>(at[0]), y = static_cast<int>(at[1]);
    CHECK(x < 60);  // the lamp is on the left and above
    CHECK(y < 60);

    const EvenFinish matt(0.3);
    const CameraPicture sharp = take(ball.before(view, sky), 8), soft = take(ball.before(view, sky, &matt), 64);
    const auto value = [&](const CameraPicture& p, int px, int py) {
        return static_cast<double>(p.value[3 * (static_cast<std::size_t>(py) * 120 + static_cast<std::size_t>(px))]);
    };
    CHECK(value(sharp, x, y) == Approx(fresnel_reflectance(-n[1], 1.5)).epsilon(0.02));
    double brightest = 0, column = 0, row = 0, all = 0, outside = 0;
    for (int py = 0; py < 120; ++py)
        for (int px = 0; px < 120; ++px) {
            const double v = sharp.sees[static_cast<std::size_t>(py) * 120 + static_cast<std::size_t>(px)] == 2
                                 ? value(sharp, px, py)
                                 : 0;
            const double r = std::hypot(px - 60, py - 60);
            if (r > 45) continue;  // the rim mirrors all that is behind the ball
            all += v, column += v * (px + 0.5), row += v * (py + 0.5);
            brightest = std::max(brightest, v);
            if (std::hypot(px - x, py - y) > 8) outside += v;
        }
    CHECK(column / all == Approx(at[0]).margin(1));
    CHECK(row / all == Approx(at[1]).margin(1));
    CHECK(outside == 0);
    // A rough surface spreads the image: of as much light in all, little is where it was.
    double soft_all = 0, soft_near = 0;
    for (int py = 0; py < 120; ++py)
        for (int px = 0; px < 120; ++px) {
            if (std::hypot(px - 60, py - 60) > 45) continue;
            soft_all += value(soft, px, py);
            if (std::hypot(px - x, py - y) <= 8) soft_near += value(soft, px, py);
        }
    CAPTURE(all, soft_all, soft_near);
    CHECK(soft_all == Approx(all).epsilon(0.2));
    CHECK(soft_near < 0.5 * soft_all);
    CHECK(soft_near > 0.02 * soft_all);
}

TEST_CASE("a ground that lies in the open shows its reflectance under every sky") {
    for (const Sky& sky : {overcast_sky(), studio_sky()}) {
        CameraScene scene;
        scene.view.position = {0, -10, 30};
        scene.view.width_px = scene.view.height_px = 8;
        scene.sky = &sky;
        scene.ground = Ground{};
        const CameraPicture picture = take(scene, 400);
        double sum = 0, variance = 0;
        for (std::size_t i = 0; i < picture.value.size(); ++i) {
            sum += static_cast<double>(picture.value[i]);
            variance += std::pow(static_cast<double>(picture.standard_error[i]), 2);
        }
        const double n = double(picture.value.size()), error = std::sqrt(variance) / n;
        INFO(sum / n << " +- " << error);
        CHECK(std::abs(sum / n - 0.5) < 4 * error);
        CHECK(error < 0.004);
    }
}

namespace {

/// A ball that is a diffuser below a coat, where the print would be.
struct CoatedBall : DiffuseBody {
    double reflectance = 1;
    Coat over;
    [[nodiscard]] bool meets(const Point& from, const Point& way, double& distance, BoundaryNormals& normals,
                             Light& light) const override {
        light = {reflectance, reflectance, reflectance};
        return Sphere(Ball::centre, Ball::radius).meets(from, way, distance, normals);
    }
    [[nodiscard]] Coat coat(const Point&, const Point&) const override { return over; }
};

/// Mean of what is seen of the ball, and its standard error.
Mean seen_of(const CameraPicture& picture) {
    double sum = 0, variance = 0, count = 0;
    for (std::size_t i = 0; i < picture.value.size(); ++i) {
        if (picture.sees[i / 3] != 3) continue;
        sum += double(picture.value[i]);
        variance += std::pow(double(picture.standard_error[i]), 2);
        ++count;
    }
    REQUIRE(count > 300);
    return {sum / count, std::sqrt(variance) / count};
}

}  // namespace

TEST_CASE("a coat over a diffuser mirrors as a resin does and takes no light away") {
    const double eta = 1.5, mean = mean_reflectance(eta);
    CHECK(mean == Approx(0.0918).margin(1e-4));  // Duntley 1942, for 1.5
    const Sky sky = even_sky();
    CameraScene scene;
    scene.view = view_of_ball(24, 24);
    scene.sky = &sky;
    for (const double roughness : {0.0, 0.3}) {
        CoatedBall ball;
        ball.over = {eta, roughness, mean};
        scene.diffusers = {&ball};
        // With all of the light that gets through sent back nothing is seen in a furnace.
        ball.reflectance = 1 - mean;
        const Mean white = seen_of(take(scene, 256));
        CAPTURE(roughness, white.value, white.error);
        CHECK(std::abs(white.value - 1) < 4 * white.error + 2e-3);
        // A black one shows what is mirrored: of a ball, seen from afar, the mean over its disc is that over all sides.
        ball.reflectance = 0;
        const Mean black = seen_of(take(scene, 256));
        // Without its coat it shows nothing, but for the sky that the pixels of its rim see beside it.
        ball.over = {};
        const double beside = seen_of(take(scene, 256)).value;
        CAPTURE(black.value, black.error, beside);
        CHECK(beside < 0.04);
        const double mirrored = (black.value - beside) / (1 - beside);
        CHECK(mirrored > 0.05);
        if (roughness == 0) CHECK(mirrored == Approx(mean).margin(0.015));
    }
}

TEST_CASE("a print that absorbs nothing beside a ground that does not either is not seen in a furnace") {
    // Of much index, so that much of what the ground sends up is mirrored by the ball on its way to the sky.
    ResinSet resins = one_resin({8, 20, 3}, {1, 1, 1});
    resins.eta = 2.5;
    const Ball ball(resins);
    const Sky sky = even_sky();
    for (const double roughness : {0.0, 0.3}) {
        const EvenFinish finish(roughness);
        CameraScene scene = ball.before(view_of_ball(24, 24), sky, &finish);
        scene.view.position = {2, -80, 50};
        scene.ground = Ground{{0, 0, 1}, 0.35, {1, 1, 1}};
        const CameraPicture picture = take(scene, 256);
        // Of the ground and of the ball alone: what one gains the other must not hide.
        std::array<double, 2> sum{}, variance{}, count{};
        for (std::size_t i = 0; i < picture.value.size(); ++i) {
            const std::size_t what = picture.sees[i / 3] == 2;
            sum[what] += static_cast<double>(picture.value[i]);
            variance[what] += std::pow(static_cast<double>(picture.standard_error[i]), 2);
            ++count[what];
        }
        for (std::size_t what = 0; what < 2; ++what) {
            const double mean = sum[what] / count[what], error = std::sqrt(variance[what]) / count[what];
            INFO("roughness " << roughness << (what ? ", ball: " : ", ground: ") << mean << " +- " << error);
            CHECK(count[what] > 300);
            CHECK(std::abs(mean - 1) < 4 * error);
            CHECK(error < 0.0015);
        }
    }
}

TEST_CASE("the errors that a picture tells are those that its seeds have") {
    const Ball ball(one_resin(profile_sigma, profile_albedo));
    const Sky sky = studio_sky();
    CameraScene scene = ball.before(view_of_ball(24, 18), sky);
    scene.view.position = {2, -80, 50};
    scene.ground = Ground{{0, 0, 1}, 0.35, {0.6, 0.5, 0.3}};
    for (const double filter_px : {0.0, 0.5}) {
        // Variances: per channel over all pixels, then of luminance over those that see the ball.
        // Some 400 pixels with 7 degrees of freedom each: the ratio is known to 3 %.
        constexpr int seeds = 8;
        std::vector<CameraPicture> pictures;
        for (int k = 0; k < seeds; ++k)
            pictures.push_back(take(scene, 16, 100 + static_cast<std::uint64_t>(k), filter_px));
        const std::size_t values = pictures[0].value.size();
        std::array<double, 4> differ{}, told{};
        for (std::size_t i = 0; i < values; i += 3) {
            std::array<double, 4> sum{}, squares{};
            for (const CameraPicture& picture : pictures) {
                const float* v = picture.value.data() + i;
                const Light light{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
                for (std::size_t c = 0; c < 4; ++c) {
                    const double x = c < 3 ? light[c] : luminance(light);
                    sum[c] += x, squares[c] += x * x;
                    if (c < 3) told[c] += std::pow(static_cast<double>(picture.standard_error[i + c]), 2) / seeds;
                }
            }
            for (std::size_t c = 0; c < 4; ++c) {
                const double variance = (squares[c] - sum[c] * sum[c] / seeds) / (seeds - 1);
                if (c < 3 || pictures[0].sees[i / 3] >= 2) differ[c] += variance;
            }
        }
        const auto bodies =
            std::count_if(pictures[0].sees.begin(), pictures[0].sees.end(), [](int s) { return s >= 2; });
        for (const CameraPicture& picture : pictures)
            told[3] += double(bodies) * std::pow(picture.rms_error, 2) / seeds;
        for (std::size_t c = 0; c < 4; ++c) {
            INFO("filter " << filter_px << ", channel " << c << ": " << differ[c] << " told " << told[c]);
            CHECK(told[c] > 0.9 * differ[c]);
            CHECK(told[c] < 1.3 * differ[c]);
        }
    }
}

TEST_CASE("a filter blurs and keeps the light, and noise falls to a third") {
    const Ball ball(one_resin(profile_sigma, profile_albedo));
    const Sky sky = even_sky();
    const CameraScene scene = ball.before(view_of_ball(48, 48), sky);
    const CameraPicture square = take(scene, 200, 1, 0), gauss = take(scene, 200, 2, 0.5);
    const auto mean_inside = [](const CameraPicture& picture) {  // of the ball's middle
        double sum = 0;
        for (std::size_t y = 16; y < 32; ++y)
            for (std::size_t x = 16; x < 32; ++x) sum += static_cast<double>(picture.value[3 * (y * 48 + x) + 1]);
        return sum / 256;
    };
    CHECK(mean_inside(gauss) == Approx(mean_inside(square)).epsilon(0.01));
    // 4 pi sigma^2 samples' worth where the Gaussian is not cut off.
    CHECK(std::pow(square.rms_error / gauss.rms_error, 2) == Approx(3.2).margin(0.4));
    // The weights of a step that lies on a pixel's edge, by error functions, cut off at 1.5 pixels.
    const PixelFilter filter(0.5);
    const auto cut = [](double x) {
        return std::erf(x / (0.5 * std::sqrt(2.0))) / std::erf(1.5 / (0.5 * std::sqrt(2.0)));
    };
    CHECK(filter.mean()[0] == Approx(0.5 * (1 - cut(0.5))));
    CHECK(filter.mean()[1] == Approx(cut(0.5)));
    CHECK(filter.mean()[0] + filter.mean()[1] + filter.mean()[2] == Approx(1));
    double mean = 0, mean_square = 0;
    for (int k = 0; k < 1000; ++k) {
        const double w = filter.weight(0.5 + (k + 0.5) / 1000);
        mean += w / 1000, mean_square += w * w / 1000;
    }
    CHECK(filter.mean()[2] == Approx(mean).epsilon(1e-4));
    CHECK(filter.mean_square()[2] == Approx(mean_square).epsilon(1e-4));
}

TEST_CASE("a printer's own channels show lamps and diffusers in the colours that were asked for") {
    const Sky sky = even_sky();
    for (const Channels& channels :
         {optics::testing::split_channels(optics::testing::green_twice), optics::testing::overlapping_channels()}) {
        ResinSet set = one_resin({8, 20, 3}, {1, 1, 1});
        set.channels = channels;
        set.resins[0].sigma_t_per_mm.assign(4, 8), set.resins[0].albedo.assign(4, 0.9);
        const Ball ball(set, 8);
        const LitScene lit(ball.before(view_of_ball(4, 4), sky));
        REQUIRE(lit.channels() == 4);
        REQUIRE(lit.derived().size() == 4);  // R, G, B and luminance
        for (std::size_t c = 0; c < 4; ++c) {
            CHECK(lit.in_channel({0.3, 0.3, 0.3}, c) == Approx(0.3));
            CHECK(lit.in_channel({1, 0, 0}, c) >= 0);
        }
        const Light cream{0.85, 0.8, 0.65};
        for (std::size_t k = 0; k < 3; ++k) {
            double seen = 0;
            for (std::size_t c = 0; c < 4; ++c) seen += lit.derived()[k][c] * lit.in_channel(cream, c);
            CHECK(seen == Approx(cream[k]).epsilon(1e-9));
        }
    }
    ResinSet set = optics::testing::split_set(one_resin({8, 20, 3}, {1, 1, 1}), optics::testing::green_twice);
    const Ball ball(set, 8);
    const LitScene lit(ball.before(view_of_ball(4, 4), sky));
    const std::array<double, 4> halves{0.9, 0.4, 0.4, 0.1};
    for (std::size_t c = 0; c < 4; ++c) CHECK(lit.in_channel({0.9, 0.4, 0.1}, c) == Approx(halves[c]).margin(1e-9));
}

TEST_CASE("channels that make little light have fewer paths") {
    CHECK(channel_periods(std::array{0.8, -0.4, 0.5, 0.1}) == std::vector<std::uint32_t>{1, 2, 1, 4});
    CHECK(channel_periods(std::array{0.2126, 0.7152, 0.0722}) == std::vector<std::uint32_t>{2, 1, 4});
    CHECK(channel_periods(std::array{0.3, 0.3, 0.1, 0.0}) == std::vector<std::uint32_t>{1, 1, 2, 4});
}

TEST_CASE("a picture has the same bits for any number of threads") {
    const Ball ball(one_resin(profile_sigma, profile_albedo));
    const Sky sky = studio_sky();
    const EvenFinish finish(0.2);
    CameraScene scene = ball.before(view_of_ball(24, 20), sky, &finish);
    scene.ground = Ground{{0, 0, 1}, 0.35, {0.5, 0.5, 0.5}};
    const auto with_threads = [&](std::size_t n) {
        const ThreadLimit threads(n);
        Progress progress;
        return take_picture(scene, {.samples = 4, .error = 0.05, .seed = 5}, progress);
    };
    const CameraPicture one = with_threads(1), two = with_threads(2);
    CHECK(one.value == two.value);
    CHECK(one.standard_error == two.standard_error);
    CHECK(one.samples == two.samples);
    CHECK(*std::max_element(one.samples.begin(), one.samples.end()) > 8);
}

TEST_CASE("a wanted error is reached, and a picture that is stopped keeps what it has") {
    const Ball ball(one_resin(profile_sigma, profile_albedo));
    const Sky sky = overcast_sky();
    const CameraScene scene = ball.before(view_of_ball(32, 32), sky);
    Progress progress;
    const CameraPicture picture = take_picture(scene, {.samples = 4, .error = 0.02}, progress);
    CHECK(picture.complete);
    CHECK(picture.rms_error < 0.025);
    CHECK(picture.rms_error > 0.01);

    class Stops : public Progress {
        void on_advance(std::uint64_t steps) override {
            if (steps >= 40) cancel();
        }
    } stops;
    const CameraPicture part = take_picture(scene, {.samples = 4, .error = 0.002}, stops);
    CHECK(!part.complete);
    CHECK(*std::min_element(part.samples.begin(), part.samples.end()) >= 4);
    Progress before;
    before.cancel();
    CHECK_THROWS_AS(take_picture(scene, {.samples = 4}, before), Cancelled);
}
