// SPDX-License-Identifier: GPL-3.0-or-later
//
// A layer upon a base against the layer modes themselves, directional.json and adding-doubling; derivatives against
// differences.
#include "optics/layered/layer_on_base.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

#include <catch2/catch.hpp>

#include "optics/layered/adding_doubling.h"
#include "optics/layered/directional.h"
#include "optics/layered/layered_appearance.h"
#include "tests/optics/reference.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

Medium medium(double sigma_t, double albedo) { return {sigma_t * (1 - albedo), sigma_t * albedo}; }

// Everything that a resin can be, and more.
const std::array<double, 6> albedos{0.0, 0.1, 0.7, 0.99, 0.9997, 0.9999999};
const std::array<double, 5> extinctions{0.02, 0.5, 5, 24, 120};

double rho(const OrdinatePlan& plan, const Medium& layer, double thickness, const Medium& base, double base_thickness) {
    const OrdinateBase below = base_thickness > 0
                                   ? OrdinateBase(plan, base, base_thickness, Admittance::black(plan), false)
                                   : OrdinateBase(plan, base, false);
    return OrdinateLayer(plan, layer, thickness, false).upon(below).rho;
}

}  // namespace

TEST_CASE("A layer upon a base reflects as its modes say, whatever both are made of") {
    const OrdinatePlan plan = directional_plan(0.4, 1.5);
    double worst = 0;
    for (const double a : albedos)
        for (const double s : extinctions)
            for (const double b : albedos)
                for (const double base_mm : {0.0, 5.0}) {
                    const LayerOf layer{medium(s, a), 0.675}, base{medium(5, b), base_mm};
                    const Admittance law = base_mm > 0
                                               ? layered_admittance(plan, std::span(&base, 1), Admittance::black(plan))
                                               : half_space(plan, base.medium);
                    const double expected = reflectance_45_0(plan, std::span(&layer, 1), law);
                    worst = std::max(worst, std::abs(rho(plan, layer.medium, 0.675, base.medium, base_mm) - expected));
                }
    INFO(worst);
    CHECK(worst < 1e-8);
}

TEST_CASE("Two-layer patches and finite slabs have the reference's reflectance") {
    const auto& table = reference("directional.json");
    const OrdinatePlan plan = directional_plan(0.4, 1.5, 10, 10);
    double worst = 0;
    for (const auto& entry : table.at("rho_two_layer_grid"))
        for (std::size_t t = 0; t < entry.at("tau_top").size(); ++t) {
            const double found = rho(plan, medium(1, entry.at("alpha_top")), entry.at("tau_top")[t],
                                     medium(1, entry.at("alpha_bottom")), 0);
            worst = std::max(worst, std::abs(found - entry.at("rho")[t].get<double>()));
        }
    const ResinSet set = vero_opaque();
    for (const auto& row : table.at("finite_slab_over_index_matched_black").at("rows")) {
        const auto channel = std::string("RGB").find(row.at("channel").get<std::string>());
        const Medium resin =
            set.resins[static_cast<std::size_t>(set.find(row.at("resin").get<std::string>()))].medium(channel);
        for (std::size_t t = 0; t < row.at("thickness_mm").size(); ++t) {
            const double mm = row.at("thickness_mm")[t];  // cut in two anywhere
            worst = std::max(
                worst, std::abs(rho(plan, resin, 0.3 * mm, resin, 0.7 * mm) - row.at("rho_45_0")[t].get<double>()));
        }
    }
    INFO(worst);
    CHECK(worst < 1e-6);
}

TEST_CASE("A layer upon a base agrees with adding-doubling for another phase function and index") {
    for (const double g : {-0.3, 0.0, 0.7}) {
        const double eta = 1.4;
        const std::array look{std::numbers::sqrt2 / 2, 1.0};
        const AngularGrid grid = angular_grid(eta, 7, 6, look);
        const AddingDoubling solver(grid, g, 2 * 13);
        const OrdinatePlan plan = directional_plan(g, eta);
        const Medium top = medium(4, 0.97), base = medium(6, 0.999);
        const auto R = reflectance_factors(grid, solver.over(solver.layer(top, 0.3), solver.half_space(base)));
        CHECK(rho(plan, top, 0.3, base, 0) == Approx(R(grid.find(1.0), grid.find(look[0]))).margin(1e-6));
    }
}

TEST_CASE("The derivatives of a patch are those of its reflectance, by layer and by base") {
    // Of 0.9 a good part counts as not scattered.
    const double g = GENERATE(0.4, 0.9);
    const OrdinatePlan plan = directional_plan(g, 1.5);
    double worst = 0;
    for (const double base_mm : {0.0, 5.0, 0.4})
        for (const double a : {0.02, 0.1, 0.7, 0.99, 0.9997})
            for (const double s : extinctions)
                for (const double b : {0.35, 0.9, 0.9991}) {
                    const Medium top = medium(s, a), base = medium(6, b);
                    const OrdinateBase below = base_mm > 0
                                                   ? OrdinateBase(plan, base, base_mm, Admittance::black(plan), true)
                                                   : OrdinateBase(plan, base, true);
                    const LayerReflectance r = OrdinateLayer(plan, top, 0.675, true).upon(below);
                    // Differences of fourth order, by the logarithms of absorption and scattering.
                    const auto difference = [&](const Medium& of, const std::function<double(const Medium&)>& f,
                                                bool absorption) {
                        const double size = absorption ? of.sigma_a : of.sigma_s, h = 0.02 * size;
                        const auto at = [&](double d) {
                            return f(absorption ? Medium{of.sigma_a + d, of.sigma_s}
                                                : Medium{of.sigma_a, of.sigma_s + d});
                        };
                        return (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h) * size;
                    };
                    const auto by_top = [&](const Medium& m) { return rho(plan, m, 0.675, base, base_mm); };
                    const auto by_base = [&](const Medium& m) { return rho(plan, top, 0.675, m, base_mm); };
                    const std::array errors{r.by_layer.sigma_a * top.sigma_a - difference(top, by_top, true),
                                            r.by_layer.sigma_s * top.sigma_s - difference(top, by_top, false),
                                            r.by_base.sigma_a * base.sigma_a - difference(base, by_base, true),
                                            r.by_base.sigma_s * base.sigma_s - difference(base, by_base, false)};
                    for (const double error : errors) {
                        if (std::abs(error) > 1e-7)
                            UNSCOPED_INFO("albedo " << a << " extinction " << s << " base " << b << ", " << base_mm
                                                    << " mm: " << error);
                        worst = std::max(worst, std::abs(error));
                    }
                }
    CHECK(worst < 1e-7);
}

TEST_CASE("A clear layer is not seen") {
    const OrdinatePlan plan = directional_plan(0.4, 1.5);
    const Medium base = medium(6, 0.999);
    const Admittance law = half_space(plan, base);
    CHECK(rho(plan, {0, 0}, 0.675, base, 0) ==
          Approx(reflectance_factor(plan, law, std::numbers::sqrt2 / 2, 1)).margin(1e-7));
}
