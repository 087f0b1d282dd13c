// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/resin_laminate.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "optics/profiles/resin_profile.h"

using namespace voxtone::optics;

namespace {

const HankelGrid& grid() {
    static const HankelGrid hankel(8, 32);
    return hankel;
}

constexpr LayerPathOptions few{1u << 14, 3};

std::size_t resin(const ResinSet& set, const char* role) { return static_cast<std::size_t>(set.find(role)); }

}  // namespace

TEST_CASE(
    "Index-matched laminates of resins: the layered totals are those of the layers, the traced ones those of "
    "transport") {
    const ResinSet set = vero_opaque();
    const std::vector<ResinLayer> layers{{resin(set, "W"), 0.3}, {resin(set, "K"), 0.1}};
    const LaminateLight model = layered_light(set, layers, {}, grid(), few),
                        traced = traced_light(set, layers, {}, grid(), few);
    for (std::size_t c = 0; c < 3; ++c) {
        const Medium W = set.resins[layers[0].resin].medium(c), K = set.resins[layers[1].resin].medium(c);
        const DiffuseTotals upper = diffuse_totals({{{W, 0.3}}, set.g, 1, 1}),
                            lower = diffuse_totals({{{K, 0.1}}, set.g, 1, 1});
        CHECK(model.R[c][0] == Approx(upper.R + upper.T * upper.T * lower.R / (1 - upper.R * lower.R)).margin(1e-9));
        CHECK(model.T[c][0] == Approx(upper.T * lower.T / (1 - upper.R * lower.R)).margin(1e-9));
        const DiffuseTotals all = diffuse_totals({{{W, 0.3}, {K, 0.1}}, set.g, 1, 1});
        CHECK(std::abs(traced.R[c][0] - all.R) < 4.5 * traced.R_error[c]);
        CHECK(std::abs(traced.T[c][0] - all.T) < 4.5 * traced.T_error[c]);
    }
}

TEST_CASE("Both ways agree on surfaces, sheets and what one unit is", "[slow]") {
    const ResinSet set = vero_opaque();
    const std::vector<ResinLayer> layers{{resin(set, "W"), 0.6}, {resin(set, "Y"), 0.5}};
    for (const LaminateEnds& ends : {LaminateEnds{1.5, 1, 0}, LaminateEnds{1.5, 1.5, 0}, LaminateEnds{1, 1.5, 0},
                                     LaminateEnds{1.5, 1, 0.7}, LaminateEnds{1, 1, 1}}) {
        const LaminateLight model = layered_light(set, layers, ends, grid(), few),
                            traced = traced_light(set, layers, ends, grid(), few);
        for (std::size_t c = 0; c < 3; ++c) {
            INFO(ends.eta_top << " " << ends.eta_bottom << " " << ends.sheet << " channel " << c);
            // The model's own error is below 0.02 of the light (docs/profiles.md), T of it below 0.03.
            CHECK(std::abs(model.R[c][0] - traced.R[c][0]) < 0.02 + 4.5 * traced.R_error[c]);
            CHECK(std::abs(model.T[c][0] - traced.T[c][0]) < 0.03 + 4.5 * traced.T_error[c]);
        }
    }
}

TEST_CASE("A sheet that sends back everything keeps nothing, and nothing is lost without absorption") {
    ResinSet set = vero_opaque();
    for (Resin& of : set.resins) of.albedo.assign(3, 1.0);
    const std::vector<ResinLayer> layers{{resin(set, "W"), 0.2}};
    const LaminateLight model = layered_light(set, layers, {1.5, 1, 1}, grid(), few),
                        traced = traced_light(set, layers, {1.5, 1, 1}, grid(), few);
    CHECK(model.R[1][0] == Approx(1).margin(1e-4));
    CHECK(model.T[1][0] == Approx(0).margin(1e-12));
    CHECK(traced.R[1][0] == Approx(1).margin(1e-6));
    CHECK(traced.T[1][0] == 0);
}

TEST_CASE("The radius of a share of the light is where the light within is that share") {
    const LaminateLight light = layered_light(vero_opaque(), std::vector<ResinLayer>{{4, 1.0}}, {}, grid(), few);
    for (const double share : {0.5, 0.8}) {
        const double r = radius_of_share(grid(), light.R[1], share);
        CHECK(grid().light_within(light.R[1], r) == Approx(share * light.R[1][0]).margin(1e-6));
    }
    CHECK(radius_of_share(grid(), light.R[1], 0.5) < radius_of_share(grid(), light.R[1], 0.8));
}
