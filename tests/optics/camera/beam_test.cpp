// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light whose border crosses a body: what is known exactly, and a slab traced by code that shares nothing with it.
#include "optics/camera/beam.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include "optics/camera/camera_paths.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr double pi = std::numbers::pi;
constexpr BeamShape shapes[] = {BeamShape::edge, BeamShape::slit, BeamShape::spot};

/// Whether a place of the plane z = 2 is lit by a beam 0.6 mm wide at (3, 3, 2) along y: an edge lights what lies at
/// smaller x.
bool lit(BeamShape shape, double x, double y) {
    switch (shape) {
        case BeamShape::edge:
            return x < 3;
        case BeamShape::slit:
            return std::abs(x - 3) < 0.3;
        case BeamShape::spot:
            return std::hypot(x - 3, y - 3) < 0.3;
    }
    return false;
}

Beam beam_on_top(BeamShape shape) { return {{.shape = shape, .width_mm = 0.6}, {{{3, 3, 2}, {0, 0, 1}, {0, 1, 0}}}}; }

/// 24 pixels of 0.1 mm along x across the place, from so far above that all look straight down.
CameraView across_place() {
    CameraView view;
    view.position = {3, 3, 1002};
    view.target = {3, 3, 2};
    view.up = {0, 1, 0};
    view.focal_mm = film_width_mm / 2.4 * 1000;
    view.width_px = 24;
    view.height_px = 1;
    return view;
}

CameraPicture take(const CameraScene& scene, std::uint32_t samples) {
    Progress progress;
    return take_picture(scene, {.samples = samples, .max_samples = samples, .seed = 3, .filter_px = 0}, progress);
}

class WhitePlate : public DiffuseBody {
public:
    [[nodiscard]] bool meets(const Point& from, const Point& way, double& distance, BoundaryNormals& normals,
                             Light& reflectance) const override {
        distance = (2 - from[2]) / way[2];
        normals = {{0, 0, 1}, {0, 0, 1}};
        reflectance = {1, 1, 1};
        return distance > off_the_start_mm && way[2] < 0;
    }
};

/// 6 x 6 x 2 mm of one resin, whose green is looked at.
struct Slab {
    static constexpr double eta = 1.5, g = 0.4;
    explicit Slab(double sigma_t, double albedo) {
        resins.name = "one";
        resins.eta = eta;
        resins.g = g;
        resins.resins = {{"Resin", "W", {sigma_t, sigma_t, sigma_t}, {0, albedo, 0}}};
        volume = make_resin_volume({60, 60, 20}, {0.1, 0.1, 0.1}, [](int, int, int) { return 1; });
        scene = {.volume = &volume, .resins = &resins};
    }
    ResinSet resins;
    ResinVolume volume;
    Scene scene;
    FlatSides sides{
        {{{1, 0, 0}, 6}, {{-1, 0, 0}, 0}, {{0, 1, 0}, 6}, {{0, -1, 0}, 0}, {{0, 0, 1}, 2}, {{0, 0, -1}, 0}}};
};

// The other tracer: an endless slab between z = 0 and 2, entered straight down. What comes out counts where its way
// leads into the lamp (45 degrees over +y, 30 degrees to its rim) and it left a lit place.
class OtherTracer {
public:
    explicit OtherTracer(double sigma_t) : sigma_t_(sigma_t) {}

    /// Where it came out, with what light if that place is lit.
    struct End {
        double x = 0, y = 0, light = 0;
        int scatterings = 0;
    };
    End trace(double x, double y, std::mt19937_64& engine) const {
        std::uniform_real_distribution<double> u(0, 1);
        double z = 2, a = 0, b = 0, c = -1;  // the way
        if (u(engine) < 0.04) return {};     // ((1.5 - 1) / (1.5 + 1))^2, mirrored straight up
        End end;
        for (int steps = 0; steps < 20000; ++steps) {
            const double free = -std::log(1 - u(engine)) / sigma_t_, to_face = (c > 0 ? 2 - z : -z) / c;
            const double step = std::min(free, to_face);
            x += step * a, y += step * b, z += step * c;
            if (free < to_face) {
                ++end.scatterings;
                turn(a, b, c, u(engine), 2 * pi * u(engine));
                continue;
            }
            const double inside = std::acos(std::abs(c)), sine = Slab::eta * std::sin(inside);
            if (sine < 1 && u(engine) >= mirrored(inside, std::asin(sine))) {
                if (c < 0) return {};
                const double along_lamp = (Slab::eta * b + std::sqrt(1 - sine * sine)) / std::sqrt(2.0);
                end.x = x, end.y = y;
                end.light = along_lamp > std::cos(pi / 6) ? 1 / (0.25 * std::sqrt(0.5)) : 0;
                return end;
            }
            c = -c;
        }
        return {};
    }

private:
    // Fresnel by tangents and sines of both angles.
    static double mirrored(double one, double other) {
        if (one < 1e-6) return 0.04;
        const double s = std::sin(one - other) / std::sin(one + other),
                     p = std::tan(one - other) / std::tan(one + other);
        return 0.5 * (s * s + p * p);
    }
    static void turn(double& a, double& b, double& c, double u, double phi) {  // Henyey-Greenstein
        const double k = (1 - Slab::g * Slab::g) / (1 - Slab::g + 2 * Slab::g * u);
        const double mu = (1 + Slab::g * Slab::g - k * k) / (2 * Slab::g), sine = std::sqrt(std::max(0.0, 1 - mu * mu));
        const double r = std::hypot(a, b);
        double e[3] = {1, 0, 0};
        if (r > 1e-9) e[0] = -b / r, e[1] = a / r;
        const double f[3] = {b * e[2] - c * e[1], c * e[0] - a * e[2], a * e[1] - b * e[0]};
        double d[3] = {a, b, c}, length = 0;
        for (int i = 0; i < 3; ++i) {
            d[i] = mu * d[i] + sine * (std::cos(phi) * e[i] + std::sin(phi) * f[i]);
            length += d[i] * d[i];
        }
        length = std::sqrt(length);
        a = d[0] / length, b = d[1] / length, c = d[2] / length;
    }
    double sigma_t_;
};

}  // namespace

TEST_CASE("a white diffuser in the plane of a beam has 1 where it is lit and nothing elsewhere") {
    const WhitePlate plate;
    for (const BeamShape shape : shapes) {
        const Beam beam = beam_on_top(shape);
        CameraScene scene;
        scene.view = across_place();
        scene.beam = &beam;
        scene.diffusers.push_back(&plate);
        const CameraPicture picture = take(scene, 512);
        for (int x = 0; x < 24; ++x) {
            CAPTURE(int(shape), x);
            const double at = 3 + 0.1 * (x - 11.5);
            // Seen by two ways of drawing, of which one always finds the lamp: the weights of the balance heuristic
            // leave each sample below 2.
            CHECK(
                picture.value[std::size_t(x) * 3 + 1] ==
                Approx(lit(shape, at, 3) ? 1 : 0).margin(1e-6 + 4.4 * picture.standard_error[std::size_t(x) * 3 + 1]));
            CHECK(picture.standard_error[std::size_t(x) * 3 + 1] < 0.03);
        }
    }
}

TEST_CASE("directions drawn into the lamps of a beam have the density that it says") {
    // Two lamps that overlap.
    const Beam beam({.shape = BeamShape::spot, .width_mm = 1},
                    {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {{5, 0, 0}, {0, 0.6, 0.8}, {1, 0, 0}}});
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> u(0, 1);
    // The mean of 1 / density over draws is the solid angle of all lamps, found by even directions besides.
    double drawn = 0, squares = 0;
    constexpr int count = 200'000;
    for (int i = 0; i < count; ++i) {
        const double inverse = 1 / beam.density(beam.draw(u(engine), u(engine), u(engine)));
        drawn += inverse / count, squares += inverse * inverse / count;
    }
    double even = 0;
    for (int i = 0; i < count; ++i) {
        const double z = 2 * u(engine) - 1, phi = 2 * pi * u(engine), r = std::sqrt(1 - z * z);
        if (beam.density({r * std::cos(phi), r * std::sin(phi), z}) > 0) even += 4 * pi / count;
    }
    const double share = even / (4 * pi),
                 error = std::sqrt((squares - drawn * drawn) / count + 16 * pi * pi * share * (1 - share) / count);
    CHECK(std::abs(drawn - even) < 4 * error);
    CHECK(std::abs(drawn - 1.1 * even) > 4 * error);
}

TEST_CASE("off its plane a beam is as blurred as its lamp is wide, on it sharp") {
    const Beam beam({.shape = BeamShape::edge}, {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}});
    const auto towards = [](double off_deg) {  // from the middle of the lamp, square to the edge
        const double lamp = std::sqrt(0.5) * std::cos(off_deg * pi / 180);
        return Point{lamp, std::sin(off_deg * pi / 180), lamp};
    };
    for (const double off : {-29.0, -10.0, 10.0, 29.0}) {
        CHECK(beam.radiance({7, 0.01, 0}, towards(off))[0] > 0);
        CHECK(beam.radiance({7, -0.01, 0}, towards(off))[0] == 0);
        // 1 mm above, the line that comes from the +y side crosses the plane at smaller y.
        CHECK((beam.radiance({7, 0, 1}, towards(off))[0] > 0) == (off < 0));
    }
    CHECK(beam.radiance({7, 1, 0}, towards(31))[0] == 0);
    CHECK(beam.outside_mm(beam.planes()[0], {3, 2, 9}) == Approx(-2));
}

TEST_CASE("across a beam's border a slab looks as a tracer path by path has it") {
    constexpr double sigma_t = 12, albedo = 0.98;
    const Slab slab(sigma_t, albedo);
    const OtherTracer other(sigma_t);
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> u(0, 1);
    double of_wrong = 0, of_shifted = 0;
    for (const BeamShape shape : shapes) {
        const Beam beam = beam_on_top(shape);
        CameraScene scene;
        scene.view = across_place();
        scene.beam = &beam;
        scene.prints.push_back({&slab.scene, &slab.sides, nullptr, {0, 0, 0}});
        const CameraPicture picture = take(scene, 4000);
        double in_the_dark = 0;
        for (int x = 0; x < 24; ++x) {
            constexpr int paths = 12'000;
            double sum[3] = {}, squares[3] = {};  // as it is, of another albedo, of a beam elsewhere
            for (int i = 0; i < paths; ++i) {
                const double at = 3 + 0.1 * (x - 12 + u(engine)), aside = 3 + 0.1 * (u(engine) - 0.5);
                const auto end = other.trace(at, aside, engine);
                const double here = lit(shape, end.x, end.y) ? end.light : 0,
                             moved = lit(shape, end.x + 0.1, end.y) ? end.light : 0;
                const double light[3] = {here * std::pow(albedo, end.scatterings),
                                         here * std::pow(0.97 * albedo, end.scatterings),
                                         moved * std::pow(albedo, end.scatterings)};
                for (int k = 0; k < 3; ++k) sum[k] += light[k] / paths, squares[k] += light[k] * light[k] / paths;
            }
            double z[3];
            for (int k = 0; k < 3; ++k) {
                const double error = std::hypot(std::sqrt((squares[k] - sum[k] * sum[k]) / paths),
                                                double(picture.standard_error[std::size_t(x) * 3 + 1]));
                z[k] = std::abs(double(picture.value[std::size_t(x) * 3 + 1]) - sum[k]) / std::max(error, 1e-9);
            }
            CAPTURE(int(shape), x, sum[0], picture.value[std::size_t(x) * 3 + 1]);
            CHECK(z[0] < 4.2);  // of 72 values one is above by chance once in 500 runs
            of_wrong = std::max(of_wrong, z[1]);
            of_shifted = std::max(of_shifted, z[2]);
            if (!lit(shape, 3 + 0.1 * (x - 11.5), 3)) in_the_dark += sum[0];
        }
        CHECK(in_the_dark > 0.2);  // there is something to see beyond the border
    }
    CHECK(of_wrong > 6);
    CHECK(of_shifted > 6);
}
