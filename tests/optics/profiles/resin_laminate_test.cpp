// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/resin_laminate.h"
#include "optics/profiles/wave_laminates.h"

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

TEST_CASE("Index-matched laminates of resins have the totals of all directions, computed and traced") {
    const ResinSet set = vero_opaque();
    const std::vector<ResinLayer> layers{{resin(set, "W"), 0.3}, {resin(set, "K"), 0.1}};
    const LaminateLight model = layered_light(set, layers, {}, grid()),
                        traced = traced_light(set, layers, {}, grid(), few);
    for (std::size_t c = 0; c < 3; ++c) {
        const Medium W = set.resins[layers[0].resin].medium(c), K = set.resins[layers[1].resin].medium(c);
        const DiffuseTotals all = diffuse_totals({{{W, 0.3}, {K, 0.1}}, set.g, 1, 1});
        CHECK(model.R[c][0] == Approx(all.R).margin(1e-4));
        CHECK(model.T[c][0] == Approx(all.T).margin(1e-4));
        CHECK(std::abs(traced.R[c][0] - all.R) < 4.5 * traced.R_error[c]);
        CHECK(std::abs(traced.T[c][0] - all.T) < 4.5 * traced.T_error[c]);
    }
}

TEST_CASE("Both ways agree on surfaces, sheets and what one unit is, and on how far light spreads", "[slow]") {
    const ResinSet set = vero_opaque();
    const std::vector<ResinLayer> layers{{resin(set, "W"), 0.6}, {resin(set, "Y"), 0.5}};
    for (const LaminateEnds& ends : {LaminateEnds{1.5, 1, 0}, LaminateEnds{1.5, 1.5, 0}, LaminateEnds{1, 1.5, 0},
                                     LaminateEnds{1.5, 1, 0.7}, LaminateEnds{1, 1, 1}}) {
        const LaminateLight model = layered_light(set, layers, ends, grid()),
                            traced = traced_light(set, layers, ends, grid(), few);
        for (std::size_t c = 0; c < 3; ++c) {
            INFO(ends.eta_top << " " << ends.eta_bottom << " " << ends.sheet << " channel " << c);
            // A coefficient is a mean of J0, at most 1: its error is no larger than the total's.
            for (std::size_t i = 0; i < grid().size(); ++i) {
                CHECK(std::abs(model.R[c][i] - traced.R[c][i]) < 0.003 + 4.5 * traced.R_error[c]);
                CHECK(std::abs(model.T[c][i] - traced.T[c][i]) < 0.003 + 4.5 * traced.T_error[c]);
            }
        }
    }
}

TEST_CASE("A sheet that sends back everything keeps nothing, and nothing is lost without absorption") {
    ResinSet set = vero_opaque();
    for (Resin& of : set.resins) of.albedo.assign(3, 1.0);
    const std::vector<ResinLayer> layers{{resin(set, "W"), 0.2}};
    const LaminateLight model = layered_light(set, layers, {1.5, 1, 1}, grid()),
                        traced = traced_light(set, layers, {1.5, 1, 1}, grid(), few);
    CHECK(model.R[1][0] == Approx(1).margin(1e-4));
    CHECK(model.T[1][0] == Approx(0).margin(1e-12));
    CHECK(traced.R[1][0] == Approx(1).margin(1e-6));
    CHECK(traced.T[1][0] == 0);
}

TEST_CASE("The radius of a share of the light is where the light within is that share") {
    const LaminateLight light = layered_light(vero_opaque(), std::vector<ResinLayer>{{4, 1.0}}, {}, grid());
    for (const double share : {0.5, 0.8}) {
        const double r = radius_of_share(grid(), light.R[1], share);
        CHECK(grid().light_within(light.R[1], r) == Approx(share * light.R[1][0]).margin(1e-6));
    }
    CHECK(radius_of_share(grid(), light.R[1], 0.5) < radius_of_share(grid(), light.R[1], 0.8));
}
