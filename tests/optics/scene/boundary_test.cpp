// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/boundary.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <utility>
#include <vector>

#include "optics/monte_carlo/monte_carlo.h"
#include "tests/optics/transport/slab_scene.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

constexpr double radius = 1.2, centre = 1.35;

ResinVolume ball(int materials) {
    const auto steps = [&](std::size_t a) { return static_cast<int>(std::ceil(2 * centre / slab_pitch_mm[a])); };
    return make_resin_volume({steps(0), steps(1), steps(2)}, slab_pitch_mm, [&](int x, int y, int z) {
        const double r = std::hypot((x + 0.5) * slab_pitch_mm[0] - centre, (y + 0.5) * slab_pitch_mm[1] - centre,
                                    (z + 0.5) * slab_pitch_mm[2] - centre);
        return r < radius ? 1 + (x + y + z) % materials : 0;
    });
}

ResinSet three_media(double albedo) {
    ResinSet set;
    set.name = "test";
    set.channels.wavelengths_nm = {550};
    set.resins = {{"a", "A", {6}, {albedo}}, {"b", "B", {1}, {albedo}}, {"c", "C", {0}, {1}}};
    return set;
}

/// A sphere whose shading normals are anything within some 40 degrees of the true ones.
class Crumpled : public BodyBoundary {
public:
    [[nodiscard]] bool leaves(const Point& from, const Point& direction, double reach, double& distance,
                              BoundaryNormals& normals) const override {
        if (!sphere_.leaves(from, direction, reach, distance, normals)) return false;
        crumple(normals);
        return true;
    }
    [[nodiscard]] Point nearest(const Point& p, BoundaryNormals& normals) const override {
        const Point on = sphere_.nearest(p, normals);
        crumple(normals);
        return on;
    }
    [[nodiscard]] bool comes_within(const Point& p, double radius_mm) const override {
        return sphere_.comes_within(p, radius_mm);
    }

private:
    static void crumple(BoundaryNormals& normals) {
        Point& n = normals.shading;
        for (std::size_t a = 0; a < 3; ++a) n[a] += 0.5 * std::sin(40 * normals.geometric[(a + 1) % 3]);
        const double length = std::hypot(n[0], n[1], n[2]);
        for (double& x : n) x /= length;
    }
    Sphere sphere_{{centre, centre, centre}, radius};
};

/// All below z = top but for a ball: a pit, open where the ball reaches above.
class SphericalPit : public BodyBoundary {
public:
    SphericalPit(const Point& middle, double r, double top) : middle_(middle), r_(r), top_(top) {}

    [[nodiscard]] bool leaves(const Point& from, const Point& direction, double reach, double& distance,
                              BoundaryNormals& normals) const override {
        double first = reach;
        bool found = false;
        const auto take = [&](double t, const BoundaryNormals& n) {
            if (t > first) return;
            first = t;
            normals = n;
            found = true;
        };
        if (direction[2] > 0) {
            const double t = std::max(0.0, (top_ - from[2]) / direction[2]);
            if (away(at(from, direction, t)) >= r_) take(t, {{0, 0, 1}, {0, 0, 1}});
        }
        const auto [along, inside] = chord(from, direction);
        if (inside > 0 && along > 0) {
            const double t = std::max(0.0, along - std::sqrt(inside));
            if (const Point q = at(from, direction, t); q[2] <= top_) take(t, wall(q));
        }
        distance = first;
        return found;
    }
    [[nodiscard]] bool meets(const Point& from, const Point& direction, double& distance,
                             BoundaryNormals& normals) const override {
        const auto [along, inside] = chord(from, direction);
        if (!(inside > 0)) return false;
        distance = along + std::sqrt(inside);
        const Point q = at(from, direction, distance);
        if (distance < 1e-6 || q[2] > top_) return false;
        normals = wall(q);
        return true;
    }
    [[nodiscard]] Point nearest(const Point& p, BoundaryNormals& normals) const override {
        Point q{};
        for (std::size_t a = 0; a < 3; ++a) q[a] = middle_[a] + (p[a] - middle_[a]) * r_ / away(p);
        normals = wall(q);
        return q;
    }
    [[nodiscard]] bool comes_within(const Point& p, double radius_mm) const override {
        return std::abs(away(p) - r_) <= radius_mm || std::abs(p[2] - top_) <= radius_mm;
    }

private:
    static Point at(const Point& p, const Point& d, double t) {
        return {p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]};
    }
    [[nodiscard]] double away(const Point& p) const {
        return std::hypot(p[0] - middle_[0], p[1] - middle_[1], p[2] - middle_[2]);
    }
    /// Way to the point of a ray nearest to the middle, and the square of half the chord.
    [[nodiscard]] std::pair<double, double> chord(const Point& p, const Point& d) const {
        double along = 0;
        for (std::size_t a = 0; a < 3; ++a) along += d[a] * (middle_[a] - p[a]);
        return {along, r_ * r_ - std::pow(away(p), 2) + along * along};
    }
    [[nodiscard]] BoundaryNormals wall(const Point& q) const {
        Point n{};
        for (std::size_t a = 0; a < 3; ++a) n[a] = (middle_[a] - q[a]) / r_;
        return {n, n};
    }
    Point middle_;
    double r_, top_;
};

/// One cell: the upper face of one voxel.
Surface one_face(const std::array<int, 3>& voxel, const std::array<float, 3>& normal) {
    Surface surface;
    surface.cell_voxels = {1, 1, 1};
    SurfaceCell cell;
    cell.faces = 1;
    cell.normal = normal;
    surface.cells = {cell};
    SurfaceFace face{{}, Facing::plus_z, true};
    for (std::size_t a = 0; a < 3; ++a) face.voxel[a] = static_cast<std::uint16_t>(voxel[a]);
    surface.faces = {face};
    surface.slope = {normal};
    return surface;
}

}  // namespace

TEST_CASE("White furnace under a boundary: no shading normal loses light or makes any") {
    const ResinVolume volume = ball(3);
    ResinSet set = three_media(1);
    set.resins[1].eta = 1.8, set.resins[2].eta = 1.1;
    const Crumpled crumpled;
    const Sphere sphere({centre, centre, centre}, radius);
    for (const Backing backing : {Backing::none, Backing::white}) {
        const Scene scene{&volume, &set, backing, Sides::open};
        const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::all);
        for (const BodyBoundary* boundary :
             {static_cast<const BodyBoundary*>(&crumpled), static_cast<const BodyBoundary*>(&sphere)}) {
            const Appearance seen = MonteCarlo({.paths = 30, .boundary = boundary}).predict(scene, surface);
            for (const float value : seen.value) REQUIRE(value == 1.0f);
        }
    }
}

TEST_CASE("A sphere is one colour all around") {
    const ResinVolume volume = ball(1);
    const ResinSet set = three_media(0.98);
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::all);
    const Sphere sphere({centre, centre, centre}, radius);
    const auto spread = [&](const BodyBoundary* boundary) {
        const Appearance seen = MonteCarlo({.paths = 1500, .boundary = boundary}).predict(scene, surface);
        double sum = 0, weights = 0, chi_squared = 0;
        for (std::size_t i = 0; i < seen.value.size(); ++i) {
            const double w = 1 / std::pow(seen.standard_error[i], 2);
            sum += w * seen.value[i];
            weights += w;
        }
        for (std::size_t i = 0; i < seen.value.size(); ++i)
            chi_squared += std::pow((seen.value[i] - sum / weights) / seen.standard_error[i], 2);
        const double freedom = static_cast<double>(seen.value.size()) - 1;
        return (chi_squared - freedom) / std::sqrt(2 * freedom);
    };
    CHECK(std::abs(spread(&sphere)) < 4);
    // The staircase of voxels is not: its terraces are seen.
    CHECK(spread(nullptr) > 10);
    // The same bits for any number of threads.
    const auto drawn = test::same_for_threads(
        [&] { return MonteCarlo({.paths = 30, .boundary = &sphere}).predict(scene, surface).value; }, {2});
    CHECK(drawn.size() == surface.cells.size() * set.channels.size());
}

TEST_CASE("Light that leaves the wall of a pit and meets it again is followed where that is asked for") {
    // In a ball-shaped pit of a diffuse reflector every place sees the same: with a share f of the ball open, rho of
    // the wall alone, the wall appears as rho f / (1 - rho (1 - f)).
    constexpr double r = 1, open = 0.2, top = 110 * slab_pitch_mm[2];
    const Point middle{40 * slab_pitch_mm[0], 20 * slab_pitch_mm[1], top - r + 2 * r * open};
    const SphericalPit pit(middle, r, top);
    const auto inside = [&](int x, int y, int z) {
        return std::hypot((x + 0.5) * slab_pitch_mm[0] - middle[0], (y + 0.5) * slab_pitch_mm[1] - middle[1],
                          (z + 0.5) * slab_pitch_mm[2] - middle[2]) < r;
    };
    const ResinVolume block =
        make_resin_volume({80, 40, 110}, slab_pitch_mm, [&](int x, int y, int z) { return inside(x, y, z) ? 0 : 1; });
    const int bottom = static_cast<int>((middle[2] - r) / slab_pitch_mm[2]);
    const Surface surface = one_face({40, 20, bottom}, {0, 0, 1});
    for (const double albedo : {1.0, 0.995, 0.9}) {
        // Light spreads over some hundredths of a millimetre, and the surface neither refracts nor reflects.
        ResinSet set = three_media(albedo);
        set.eta = 1;
        set.g = 0;
        set.resins[0].sigma_t_per_mm = {120};
        const Scene scene{&block, &set, Backing::none, Sides::open};
        const Appearance seen =
            MonteCarlo({.paths = 20000, .boundary = &pit, .follow_outside = true}).predict(scene, surface);
        const OrdinatePlan plan = appearance_plan(set.g, set.eta);
        const double rho = appearance(plan, half_space(plan, {1 - albedo, albedo})),
                     expected = rho * open / (1 - rho * (1 - open));
        INFO("rho " << rho << ": " << seen.value[0] << " +- " << seen.standard_error[0] << ", expected " << expected);
        const Appearance alone = MonteCarlo({.paths = 20000, .boundary = &pit}).predict(scene, surface);
        CHECK(std::abs(alone.value[0] - rho) <= 4 * alone.standard_error[0] + 0.03 * std::abs(1 - rho) + 1e-5);
        // A half-space does not send light out quite alike in all directions.
        CHECK(std::abs(seen.value[0] - expected) <=
              4 * seen.standard_error[0] + 0.03 * std::abs(1 - expected) * expected + 1e-5);
    }
}

TEST_CASE("A slab of flat sides looks the same at every tilt, and as the exact solution says") {
    // A block of one resin, 8 mm wide, that a slab of 0.6 mm passes through; light comes back within a millimetre.
    const ResinSet set = vero_opaque();
    const int material = 3;  // yellow: white in two channels, dark in the third
    const ResinVolume volume =
        make_resin_volume({400, 200, 620}, {0.0423333, 0.0846667, 0.027}, [&](int, int, int) { return material; });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const std::vector<SlabLayer> slab{{static_cast<Material>(material), 22}};  // 0.594 mm
    int tests = 0;
    for (const double tilt : {0.0, 0.3, 0.8, 1.3}) {
        const Point n{std::sin(tilt) * 0.8, std::sin(tilt) * 0.6, std::cos(tilt)};
        const double through = n[0] * 8.4667 + n[1] * 8.4667 + n[2] * 8.37;
        const FlatSides sides({{n, through + 0.594 / 2}, {{-n[0], -n[1], -n[2]}, -through + 0.594 / 2}});
        const Surface surface = one_face({200, 100, 310}, {0, 0, 1});
        const Appearance seen = MonteCarlo({.paths = 60000, .boundary = &sides}).predict(scene, surface);
        for (std::size_t c = 0; c < 3; ++c, ++tests) {
            const double exact = exact_appearance(set, slab, Backing::none, c);
            INFO(tilt << " " << c << ": " << seen.value[c] << " +- " << seen.standard_error[c] << ", exact " << exact);
            // 12 tests; 4 standard errors once in 1300 runs.
            CHECK(std::abs(seen.value[c] - exact) < 4 * seen.standard_error[c]);
            if (c != 2) CHECK(std::abs(1.02 * seen.value[c] - exact) > 4 * seen.standard_error[c]);
        }
    }
}

TEST_CASE("A box looks the same with the faces of its voxels and with flat sides") {
    ResinSet set = vero_opaque();
    const bool own = GENERATE(false, true);
    if (own) set.resins[1].eta = 1.2, set.resins[4].eta = 1.9, set.resins[4].g = -0.2;
    set.relate();
    const std::array<int, 3> size{24, 14, 40};
    const ResinVolume volume =
        make_resin_volume(size, slab_pitch_mm, [](int x, int y, int z) { return 1 + (x / 5 + y / 3 + z / 9) % 5; });
    std::vector<FlatSides::Plane> planes;
    for (std::size_t a = 0; a < 3; ++a) {
        Point n{};
        n[a] = 1;
        planes.push_back({n, size[a] * slab_pitch_mm[a]});
        n[a] = -1;
        planes.push_back({n, 0});
    }
    const FlatSides sides(planes);
    for (const Backing backing : {Backing::none, Backing::white, Backing::black}) {
        const Scene scene{&volume, &set, backing, Sides::open};
        const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::all);
        const Appearance faces = MonteCarlo({.paths = 500}).predict(scene, surface);
        const Appearance flat = MonteCarlo({.paths = 500, .seed = 2, .boundary = &sides}).predict(scene, surface);
        double sum = 0, variance = 0, sum_of_squares = 0;
        int n = 0;
        for (std::size_t i = 0; i < faces.value.size(); ++i) {
            const double difference = static_cast<double>(flat.value[i]) - static_cast<double>(faces.value[i]);
            const double v = std::pow(faces.standard_error[i], 2) + std::pow(flat.standard_error[i], 2);
            sum += difference;
            variance += v;
            if (faces.value[i] < 0.05f) continue;  // too few paths for a normal distribution
            sum_of_squares += difference * difference / v;
            ++n;
        }
        INFO(sum << " " << std::sqrt(variance) << ", chi squared " << sum_of_squares << " of " << n);
        CHECK(std::abs(sum) < 4 * std::sqrt(variance));
        CHECK(std::abs(sum_of_squares - n) < 5 * std::sqrt(2.0 * n));
    }
}
