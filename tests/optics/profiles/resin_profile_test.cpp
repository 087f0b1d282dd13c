// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/resin_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <catch2/catch.hpp>

#include "base/contracts.h"
#include "base/parallel.h"
#include "benchmarks/optics/profiles/laminates.h"
#include "optics/layered/layered_appearance.h"
#include "optics/numerics/quadrature.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

// A thousandth of all runs with other seeds may fail: some 40 z-tests here.
constexpr double largest_z = 4.2;

Medium medium(double sigma_t, double albedo) { return {sigma_t * (1 - albedo), sigma_t * albedo}; }

const std::vector<LayerScene>& matched_scenes() {
    static const std::vector<LayerScene> scenes{
        {{{medium(8, 1), 0.5}}, 0.4, 1, 1},
        {{{medium(20, 0.97), 0.2}}, 0.4, 1, 1},
        {{{medium(2, 0.6), 0.4}}, 0.4, 1, 1},
        {{{medium(5, 0.9), 0.5}}, -0.3, 1, 1},
        {{{medium(10, 0.95), 0.1}, {medium(1, 0.3), 0.3}, {medium(25, 0.99), 0.1}}, 0.4, 1, 1},
        {{{medium(0, 1), 0.3}, {medium(30, 0.9), 1.0}}, 0.4, 1, 1},
    };
    return scenes;
}

}  // namespace

TEST_CASE("Traced totals are those of adding-doubling") {
    const HankelGrid grid(10, 32);
    for (const LayerScene& scene : matched_scenes()) {
        const TracedProfile traced = trace_layers(scene, grid, {1 << 17, 11});
        const DiffuseTotals exact = diffuse_totals(scene);
        LayerScene wrong = scene;  // each layer with 4 % less scattering
        for (PlainLayer& layer : wrong.layers) layer.medium.sigma_s *= 0.96;
        const DiffuseTotals other = diffuse_totals(wrong);
        double worst_of_wrong = 0;
        const auto check = [&](const RingLight& light, double right, double not_right) {
            const double error = std::hypot(light.standard_error, 1e-6);
            INFO(light.total << " +- " << error << ", exact " << right);
            CHECK(std::abs(light.total - right) < largest_z * error);
            worst_of_wrong = std::max(worst_of_wrong, std::abs(light.total - not_right) / error);
            double sum = 0;
            for (const double ring : light.light) sum += ring;
            CHECK(sum == Approx(light.total).margin(1e-12));
        };
        check(traced.R, exact.R, other.R);
        check(traced.T, exact.T - exact.T_direct, other.T - other.T_direct);
        check(traced.T_direct, exact.T_direct, other.T_direct);
        CHECK(worst_of_wrong > largest_z);
    }
}

TEST_CASE("Under refractive surfaces, traced reflection is the appearance of the slab") {
    const HankelGrid grid(10, 32);
    for (const double sigma_t : {4.0, 20.0}) {
        const LayerScene scene{{{medium(sigma_t, 0.95), 0.3}, {medium(3, 0.5), 0.2}}, 0.4, 1.5, 1.5};
        const OrdinatePlan plan = appearance_plan(0.4, 1.5, 10, 10);
        const auto exact = [&](double scattering) {
            std::vector<LayerOf> layers;
            for (const PlainLayer& layer : scene.layers)
                layers.push_back({{layer.medium.sigma_a, layer.medium.sigma_s * scattering}, layer.thickness_mm});
            return layered_appearance(plan, layers, Admittance::air(plan, false));
        };
        const TracedProfile traced = trace_layers(scene, grid, {1 << 18, 12});
        INFO(traced.R.total << " +- " << traced.R.standard_error << ", exact " << exact(1));
        CHECK(std::abs(traced.R.total - exact(1)) < largest_z * traced.R.standard_error);
        CHECK(std::abs(traced.R.total - exact(0.93)) > largest_z * traced.R.standard_error);
    }
}

TEST_CASE("Light scattered once lands where the integral over the layer says") {
    // Isotropic scattering, weak: R^(k) = sigma_s integral over z of (2 / mu)(mu) J0 e^(-sigma_t z / mu) times the same
    // from the point of scattering back, each over the cosines mu; scattering again adds below 2 %.
    const double sigma_t = 3, sigma_s = 0.06, thickness = 0.5;
    const HankelGrid grid(3, 24);
    const auto once = [&](double k) {
        const Rule depth = gauss_legendre(40, 0, 1), cosine = gauss_legendre(200, 0, 1);
        double sum = 0;
        for (std::size_t i = 0; i < depth.x.size(); ++i) {
            const double z = thickness * depth.x[i] * depth.x[i];
            double to = 0;
            for (std::size_t j = 0; j < cosine.x.size(); ++j) {
                const double mu = cosine.x[j], tangent = std::sqrt(1 - mu * mu) / mu;
                to += cosine.w[j] * std::exp(-sigma_t * z / mu) * ::j0(2 * std::numbers::pi * k * z * tangent);
            }
            sum += 2 * thickness * depth.x[i] * depth.w[i] * 2 * to * 0.5 * to;
        }
        return sigma_s * sum;
    };
    const std::uint32_t paths = 1 << 20;
    const LayerScene scene{{{{sigma_t - sigma_s, sigma_s}, thickness}}, 0, 1, 1};
    const TracedProfile traced = trace_layers(scene, grid, {paths, 13});
    const std::vector<double> found = grid.from_rings(traced.edges_mm, traced.R.light);
    double worst_of_wider = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const double exact = once(grid.k()[i]),
                     error = std::hypot(traced.R.standard_error, traced.R.total / std::sqrt(paths));
        INFO("k " << grid.k()[i] << ": " << found[i] << ", once scattered " << exact << " +- " << error);
        CHECK(std::abs(found[i] - 1.01 * exact) < largest_z * error + 0.01 * exact);
        worst_of_wider =
            std::max(worst_of_wider, (std::abs(found[i] - 1.01 * once(grid.k()[i] * 1.15)) - 0.01 * exact) / error);
    }
    CHECK(worst_of_wider > largest_z);
}

TEST_CASE("A layer that only absorbs lets light through as the closed form says, at any distance") {
    const HankelGrid grid(4, 32);
    const ResinProfile black = resin_profile({1.5, 0}, 0.4, 0.3, grid, {1 << 17, 14});
    const std::vector<double> traced = grid.from_rings(black.traced.edges_mm, black.traced.T_direct.light);
    const double error = std::sqrt(traced[0] / (1 << 17));
    CHECK(black.T[0] == Approx(black.traced.T_direct.total).margin(largest_z * error));
    for (std::size_t i = 0; i < grid.size(); ++i) {
        CHECK(black.R[i] == 0);
        CHECK(black.T[i] == Approx(traced[i]).margin(largest_z * error));
    }
    // The same layer, thicker by a tenth, is another.
    const ResinProfile thicker = resin_profile({1.5, 0}, 0.4, 0.33, grid, {2, 14});
    CHECK(std::abs(thicker.T[4] - traced[4]) > largest_z * error);
}

TEST_CASE("A resin's profile has exact totals, can be made a layer, and nothing of it is above the total") {
    const HankelGrid grid(8, 64);
    const ResinProfile white = resin_profile(medium(12, 1), 0.4, 0.4, grid, {1 << 15, 15});
    CHECK(white.T[0] + white.R[0] == Approx(1).epsilon(1e-6));
    const HomogeneousLayer layer = white.layer();
    for (std::size_t i = 0; i < grid.size(); ++i) {
        CHECK(white.T[i] <= white.T[0]);
        CHECK(white.R[i] <= white.R[0]);
    }
    CHECK(layer.of_thickness(0.4).R_top[0] == Approx(white.R[0]).epsilon(1e-6));
    CHECK(layer.of_thickness(0.4).R_top[5] == Approx(white.R[5]).epsilon(1e-6));
    // Light spreads wider through the thicker layer: its coefficients fall faster.
    const ResinProfile thick = resin_profile(medium(12, 1), 0.4, 0.8, grid, {1 << 15, 15});
    CHECK(thick.T[8] / thick.T[0] < white.T[8] / white.T[0]);
}

TEST_CASE("Profiles know no units but lengths, and have the same bits for any number of threads") {
    const HankelGrid grid(8, 32), doubled(16, 32);
    const ResinProfile one = resin_profile({0.5, 10}, 0.4, 0.25, grid, {20000, 16});
    const ResinProfile twice = resin_profile({0.25, 5}, 0.4, 0.5, doubled, {20000, 16});
    for (std::size_t i = 0; i < grid.size(); ++i) {
        CHECK(one.T[i] == Approx(twice.T[i]).margin(1e-9));
        CHECK(one.R[i] == Approx(twice.R[i]).margin(1e-9));
    }
    const ThreadLimit single(1);
    const ResinProfile again = resin_profile({0.5, 10}, 0.4, 0.25, grid, {20000, 16});
    CHECK(again.T == one.T);
    CHECK(again.R == one.R);
    CHECK(resin_profile({0.5, 10}, 0.4, 0.25, grid, {20000, 17}).R != one.R);
}

TEST_CASE("A smooth surface turns light back as Fresnel says") {
    // The figure for diffuse light inside n = 1.5 that Saunderson's correction is known by: 0.596.
    const LayerProfile surface = smooth_surface(1.5, 3);
    CHECK(surface.R_bottom[0] == Approx(0.5963).margin(4e-4));
    CHECK(surface.R_bottom[2] == surface.R_bottom[0]);
    CHECK(surface.R_top[0] == 0);
    CHECK(smooth_surface(1.0, 3).R_bottom[0] == Approx(0).margin(1e-12));
    // All light that was let into a body that absorbs nothing comes out of it; a black one keeps it.
    LayerProfile white = no_layer(3);
    white.T = {0, 0, 0};
    white.R_top = white.R_bottom = {1, 0.5, 0};
    const LayerProfile seen = laminate(surface, white);
    CHECK(seen.R_top[0] == Approx(1).epsilon(1e-12));
    CHECK(seen.R_top[1] == Approx((1 - 0.5963) * 0.5 / (1 - 0.5963 * 0.5)).epsilon(1e-3));
    CHECK(seen.R_top[2] == 0);
}

TEST_CASE("A layer under its surface has the totals that are traced, in and out", "[slow]") {
    const HankelGrid grid(10, 32);
    const LayerPathOptions options{1 << 18, 21};
    for (const auto& [of, mm] : {std::pair{medium(10, 0.97), 0.3}, {medium(4, 0.5), 0.2}, {medium(6, 1), 1.0}}) {
        const BoundedTotals layer = bounded_totals(of, 0.4, 1.5, mm);
        const TracedProfile above = trace_layers({{{of, mm}}, 0.4, 1.5, 1}, grid, options);
        const TracedProfile below = trace_layers({{{of, mm}}, 0.4, 1, 1.5}, grid, options);
        const double T_down = above.T.total + above.T_direct.total, T_up = below.T.total + below.T_direct.total;
        const double T_error = std::hypot(above.T.standard_error, above.T_direct.standard_error);
        INFO(mm << " mm");
        CHECK(std::abs(layer.R_top - above.R.total) < largest_z * above.R.standard_error);
        CHECK(std::abs(layer.R_bottom - below.R.total) < largest_z * below.R.standard_error);
        CHECK(std::abs(layer.T_down - T_down) < largest_z * T_error);
        CHECK(std::abs(layer.T_up - T_up) < largest_z * T_error * 2);
        // Reciprocity: the way out is the way in times what the surface lets out of diffuse light.
        CHECK(layer.T_up == Approx((1 - smooth_surface(1.5, 1).R_bottom[0]) * layer.T_down).epsilon(1e-4));
        // A layer under a surface of index 1.4 is another.
        const BoundedTotals other = bounded_totals(of, 0.4, 1.4, mm);
        CHECK(std::abs(other.R_bottom - below.R.total) > largest_z * below.R.standard_error);
    }
    // Without refraction it is the resin's own.
    const BoundedTotals plain = bounded_totals(medium(10, 0.97), 0.4, 1.0, 0.3);
    const DiffuseTotals own = diffuse_totals({{{medium(10, 0.97), 0.3}}, 0.4, 1, 1});
    CHECK(plain.R_top == Approx(own.R).margin(1e-9));
    CHECK(plain.R_bottom == Approx(own.R).margin(1e-9));
    CHECK(plain.T_down == Approx(own.T).margin(1e-5));
}

TEST_CASE("Composites of single layers have the totals of the composite within 2 % of the light, films have not") {
    // Totals alone, exact on both sides: the first coefficients, without noise.
    const auto single = [](const PlainLayer& of) {
        const DiffuseTotals totals = diffuse_totals({{of}, 0.4, 1, 1});
        return LayerProfile{{totals.T}, {totals.R}, {totals.R}};
    };
    const auto predicted = [&](const LayerScene& scene) {
        LayerProfile all = no_layer(1);
        for (const PlainLayer& of : scene.layers) all = laminate(all, single(of));
        return all;
    };
    const std::vector<profile_laminates::Laminate> laminates = profile_laminates::thick_laminates();
    CHECK(laminates.size() >= 12);
    int upside_down_fails = 0, asymmetric = 0;
    for (const profile_laminates::Laminate& of : laminates) {
        LayerScene scene = profile_laminates::scene_of(of);
        const DiffuseTotals exact = diffuse_totals(scene);
        const LayerProfile model = predicted(scene);
        INFO(profile_laminates::name_of(of)
             << ": R " << model.R_top[0] << " for " << exact.R << ", T " << model.T[0] << " for " << exact.T);
        CHECK(std::abs(model.R_top[0] - exact.R) < 0.02);
        CHECK(std::abs(model.T[0] - exact.T) < 0.02);
        CHECK(model.T[0] <=
              exact.T);  // the side on which the model errs: light between layers is not diffuse but runs down
        std::reverse(scene.layers.begin(), scene.layers.end());
        const double other = diffuse_totals(scene).R;
        if (std::abs(other - exact.R) < 0.05) continue;
        ++asymmetric;
        upside_down_fails += std::abs(model.R_top[0] - other) > 0.02;
    }
    CHECK(asymmetric >= 8);
    CHECK(upside_down_fails == asymmetric);
    double worst = 0;
    for (const profile_laminates::Laminate& of : profile_laminates::film_laminates()) {
        const LayerScene scene = profile_laminates::scene_of(of);
        worst = std::max(worst, std::abs(predicted(scene).R_top[0] - diffuse_totals(scene).R));
    }
    CHECK(worst > 0.02);
}

TEST_CASE("Layers that cannot be are refused") {
    const HankelGrid grid(8, 8);
    CHECK_THROWS_AS(trace_layers({{}, 0.4, 1, 1}, grid), ContractViolation);
    CHECK_THROWS_AS(trace_layers({{{{1, 1}, 0}}, 0.4, 1, 1}, grid), ContractViolation);
    CHECK_THROWS_AS(trace_layers({{{{1, 1}, 1}}, 1.0, 1, 1}, grid), ContractViolation);
    CHECK_THROWS_AS(diffuse_totals({{{{1, 1}, 1}}, 0.4, 1.5, 1}), ContractViolation);
}

TEST_CASE("A layer under a surface: nothing is lost without absorption, and the ways in and out are reciprocal") {
    const double s = smooth_surface(1.5, 1).R_bottom[0];
    for (const Medium& medium : {Medium{0, 3}, Medium{0.5, 3}, Medium{4, 0.5}})
        for (const double mm : {0.05, 0.5, 2.0}) {
            INFO(medium.sigma_a << " " << medium.sigma_s << " " << mm);
            const BoundedTotals at = bounded_totals(medium, 0.4, 1.5, mm);
            CHECK(at.T_up == Approx((1 - s) * at.T_down).margin(2e-4));
            const double down = at.R_top + at.T_down, up = at.R_bottom + at.T_up;
            if (medium.sigma_a == 0) {
                CHECK(down == Approx(1).margin(1e-5));
                CHECK(up == Approx(1).margin(1e-5));
            } else {
                CHECK(down < 1);
                CHECK(up < 1);
            }
            const BoundedTotals fewer = bounded_totals(medium, 0.4, 1.5, mm, 16);
            CHECK(fewer.R_top == Approx(at.R_top).margin(2e-4));
        }
}
