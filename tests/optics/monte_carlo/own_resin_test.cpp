// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins that name an index and a g of their own, by light paths.
#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

#include "optics/monte_carlo/monte_carlo.h"
#include "optics/profiles/resin_laminate.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

ResinSet two_resins(double eta_a, double eta_b, double g_a, double g_b) {
    ResinSet set;
    set.name = "two";
    set.resins = {{"a", "A", {6, 12, 2}, {0.97, 0.6, 0.995}}, {"b", "B", {3, 5, 20}, {0.9, 0.98, 0.5}}};
    set.resins[0].eta = eta_a, set.resins[1].eta = eta_b;
    set.resins[0].g = g_a, set.resins[1].g = g_b;
    set.relate();
    return set;
}

/// Of cubes of 0.1 mm, of all channels together: how far the mean of the top is from what it should be, in standard
/// errors of the farthest channel.
double farthest_z(const ResinSet& set, PathTracer tracer, const std::array<double, 3>& truth,
                  const std::array<double, 3>& of_truth) {
    const ResinVolume volume = make_resin_volume({8, 8, 16}, {0.05, 0.05, 0.05},
                                                 [](int x, int y, int z) { return 1 + (x / 2 + y / 2 + z / 2) % 2; });
    const Scene scene{&volume, &set, Backing::none, Sides::mirrored};
    const Surface surface = find_surface(scene, {8, 8, 16}, SurfacePart::top);
    REQUIRE(surface.cells.size() == 1);
    const Appearance seen = MonteCarlo({.paths = 60000, .tracer = tracer}).predict(scene, surface);
    double most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double sigma = std::hypot(static_cast<double>(seen.standard_error[c]), of_truth[c]);
        most = std::max(most, std::abs(static_cast<double>(seen.value[c]) - truth[c]) / sigma);
    }
    return most;
}

}  // namespace

TEST_CASE("resins of their own index and g look as a tracer has them that shares no line with this one") {
    // index_tracer (benchmarks/optics/monte_carlo), straight, of the same cubes: 2e6 paths a channel.
    const std::array<double, 3> truth{0.50909, 0.08306, 0.02842}, of_truth{2.1e-4, 1.3e-4, 1e-4};
    for (const PathTracer tracer : {PathTracer::packets, PathTracer::scalar}) {
        CHECK(farthest_z(two_resins(1.3, 1.8, 0, 0.7), tracer, truth, of_truth) < 4);
        // Means for all, indices that changed places, one g: each is found out.
        CHECK(farthest_z(two_resins(1.55, 1.55, 0, 0.7), tracer, truth, of_truth) > 4);
        CHECK(farthest_z(two_resins(1.8, 1.3, 0, 0.7), tracer, truth, of_truth) > 4);
        CHECK(farthest_z(two_resins(1.3, 1.8, 0.35, 0.35), tracer, truth, of_truth) > 4);
    }
}

TEST_CASE("a resin's own index and g are as if the set had them") {
    ResinSet own = vero_opaque(), of_set = own;
    of_set.eta = 1.53, of_set.g = 0.6;
    for (Resin& resin : own.resins) resin.eta = 1.53, resin.g = 0.6;
    own.relate();
    const std::vector<SlabLayer> layers{{1, 4}, {5, 20}};
    const ResinVolume volume = slab_volume(layers);
    const auto seen = [&](const ResinSet& set, PathTracer tracer) {
        const Scene scene{&volume, &set, Backing::white, Sides::mirrored};
        const Surface surface = find_surface(scene, {3, 2, 24}, SurfacePart::top);
        return MonteCarlo({.paths = 400, .tracer = tracer}).predict(scene, surface).value;
    };
    ResinSet index_of_set = own;  // packets draw once more where a resin refracts otherwise than the set
    index_of_set.eta = 1.53;
    CHECK(seen(index_of_set, PathTracer::packets) == seen(of_set, PathTracer::packets));
    CHECK(seen(index_of_set, PathTracer::scalar) == seen(of_set, PathTracer::scalar));
    CHECK(seen(own, PathTracer::packets) != seen(vero_opaque(), PathTracer::packets));
}

TEST_CASE("from 45 degrees to the normal a resin's own index and g are as if the set had them") {
    ResinSet own = vero_opaque(), of_set = own;
    of_set.eta = 1.48, of_set.g = 0.2;
    for (Resin& resin : own.resins) resin.eta = 1.48, resin.g = 0.2;
    own.relate();
    const std::vector<SlabLayer> layers{{3, 4}, {5, 20}};
    const ResinVolume volume = slab_volume(layers);
    const auto seen = [&](const ResinSet& set) {
        const Scene scene{&volume, &set, Backing::white, Sides::mirrored};
        const Surface surface = find_surface(scene, {3, 2, 24}, SurfacePart::top);
        MonteCarloSummary summary;
        return MonteCarlo({.paths = 300}).reflectance_45_0(scene, surface, summary).value;
    };
    CHECK(seen(own) == seen(of_set));
    CHECK(seen(own) != seen(vero_opaque()));
}

TEST_CASE("layers of their own index and g refract at their flat borders as a tracer has it that shares no line") {
    ResinSet set = vero_opaque();
    set.resins.resize(2);
    set.resins[0].sigma_t_per_mm = {6, 12, 2}, set.resins[0].albedo = {0.97, 0.6, 0.995};
    set.resins[1].sigma_t_per_mm = {3, 5, 20}, set.resins[1].albedo = {0.9, 0.98, 0.5};
    set.resins[0].eta = 1.3, set.resins[0].g = 0, set.resins[1].eta = 1.8, set.resins[1].g = 0.7;
    set.relate();
    const std::vector<ResinLayer> layers{{1, 0.2}, {0, 0.3}};
    const auto farthest = [&] {
        // What leaves on both sides, index_tracer (benchmarks/optics/monte_carlo), faces: 1.2e6 paths a channel.
        constexpr std::array<double, 3> truth{0.60066, 0.18285, 0.03484}, of_truth{2.8e-4, 2.7e-4, 1.2e-4};
        const LaminateLight traced = traced_light(set, layers, {1.5, 1.5, 0}, HankelGrid(8, 4), {1 << 17, 5});
        double most = 0;
        for (std::size_t c = 0; c < 3; ++c)
            most = std::max(most, std::abs(traced.R[c][0] + traced.T[c][0] - truth[c]) /
                                      std::hypot(of_truth[c], traced.R_error[c], traced.T_error[c]));
        return most;
    };
    CHECK(farthest() < 4);
    set.resins[1].g = 0.4;
    CHECK(farthest() > 4);
    set.resins[1].g = 0.7, set.resins[0].eta = 1.8;
    CHECK(farthest() > 4);
}
