// SPDX-License-Identifier: GPL-3.0-or-later
//
// Against directional.json, whose values are converged to 1e-9: by adding-doubling with exact views, and by modes.
#include "optics/layered/directional.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include <catch2/catch.hpp>

#include "optics/layered/layered_appearance.h"
#include "tests/optics/layered/slab.h"
#include "tests/optics/reference.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;
using Eigen::MatrixXd;

namespace {

const double cos_45 = std::numbers::sqrt2 / 2;

// A laminate, top first, over a half-space or (sigma_t 0) over a black base of the same index.
struct Stack {
    std::vector<LayerOf> layers;
    Medium base;
};

// Adding-doubling with views of weight zero, and modes; `below` + `above` directions and two for the views.
class Solvers {
public:
    Solvers(int below, int above)
        : grid_(angular_grid(1.5, below, above, std::array{cos_45, 1.0})),
          solver_(grid_, 0.4, 2 * (below + above)),
          plan_(directional_plan(0.4, 1.5, below, above)) {}

    double by_adding_doubling(const Stack& stack) const { return rho(stack)(grid_.find(1.0), grid_.find(cos_45)); }

    double hemispherical(const Stack& stack) const {
        return hemispherical_reflectance(grid_, rho(stack))[grid_.find(cos_45)];
    }

    double by_modes(const Stack& stack) const {
        const bool deep = stack.base.sigma_t() > 0;
        return reflectance_45_0(plan_, stack.layers, deep ? half_space(plan_, stack.base) : Admittance::black(plan_));
    }

    // Remembers the worst error of both methods.
    void compare(const Stack& stack, double reference) {
        exact = std::max(exact, std::abs(by_adding_doubling(stack) - reference));
        modes = std::max(modes, std::abs(by_modes(stack) - reference));
    }

    double exact = 0, modes = 0;

private:
    MatrixXd rho(const Stack& stack) const {
        MatrixXd R = stack.base.sigma_t() > 0 ? solver_.half_space(stack.base)
                                              : MatrixXd(MatrixXd::Zero(grid_.size(), grid_.size()));
        for (auto layer = stack.layers.rbegin(); layer != stack.layers.rend(); ++layer) {
            R = solver_.over(solver_.layer(layer->medium, layer->thickness_mm), R);
        }
        return reflectance_factors(grid_, R);
    }

    AngularGrid grid_;
    AddingDoubling solver_;
    OrdinatePlan plan_;
};

// "K10W90" or "C" as fractions of the start set.
std::vector<double> mixture(const ResinSet& set, const std::string& name) {
    std::vector<double> fractions(set.resins.size(), 0.0);
    std::istringstream in(name);
    char role = 0;
    while (in >> role) {
        double percent = 100;
        if (std::isdigit(in.peek())) in >> percent;
        fractions[static_cast<std::size_t>(set.find(std::string(1, role)))] = percent / 100;
    }
    return fractions;
}

}  // namespace

TEST_CASE("The patches of the calibration target reflect as in the reference") {
    const auto& values = reference("directional.json").at("values");
    const ResinSet set = vero_opaque();
    Solvers solvers(7, 6);
    int patches = 0;
    for (const auto& [name, entry] : values.items()) {
        const bool endless = name.rfind("inf:", 0) == 0;
        const std::size_t slash = name.find('/');
        for (std::size_t c = 0; c < 3; ++c) {
            Stack stack;
            if (endless) {
                stack.base = set.mix(mixture(set, name.substr(4)), c);
            } else {
                stack.layers = {{set.mix(mixture(set, name.substr(0, slash)), c), 0.675}};
                stack.base = set.mix(mixture(set, name.substr(slash + 1)), c);
            }
            solvers.compare(stack, entry.at("rho_ref")[c]);
            CHECK(solvers.hemispherical(stack) ==
                  Approx(entry.at("diffuse_hemispherical_R_45_ref")[c].get<double>()).margin(1e-6));
        }
        ++patches;
    }
    CHECK(patches == 25);
    INFO("adding-doubling " << solvers.exact << ", modes " << solvers.modes);
    CHECK(solvers.exact < 1e-6);
    CHECK(solvers.modes < 1e-6);
}

TEST_CASE("Stacks of several layers reflect as in the reference, and their order matters") {
    const ResinSet set = vero_opaque();
    Solvers solvers(10, 10), fast(7, 6);
    std::vector<double> blue;
    for (const auto& entry : reference("directional.json").at("multi_layer")) {
        for (std::size_t c = 0; c < 3; ++c) {
            Stack stack;
            for (const auto& layer : entry.at("layers_top_first")) {
                stack.layers.push_back({set.mix(mixture(set, layer.at("resin")), c), layer.at("thickness_mm")});
            }
            stack.base = set.mix(mixture(set, entry.at("base")), c);
            solvers.compare(stack, entry.at("rho_45_0")[c]);
            fast.compare(stack, entry.at("rho_45_0")[c]);
            if (c == 2) blue.push_back(solvers.by_modes(stack));
        }
    }
    INFO("adding-doubling " << solvers.exact << ", modes " << solvers.modes << ", default " << fast.modes);
    CHECK(solvers.exact < 2e-6);
    CHECK(solvers.modes < 2e-6);
    CHECK(fast.modes < 2e-5);
    REQUIRE(blue.size() == 7);
    CHECK(blue[3] > 10 * blue[4]);                    // magenta over yellow, yellow over magenta
    CHECK(blue[5] == Approx(blue[6]).epsilon(1e-8));  // four layers of cyan, one of four times the thickness
}

TEST_CASE("Half-spaces, thin layers and finite slabs reflect as in the reference") {
    const auto& table = reference("directional.json");
    const ResinSet set = vero_opaque();
    Solvers solvers(10, 10);
    const auto& infinite = table.at("rho_inf_vs_albedo");
    for (std::size_t k = 0; k < infinite.at("albedo").size(); ++k) {
        const double albedo = infinite.at("albedo")[k];
        solvers.compare({{}, {1 - albedo, albedo}}, infinite.at("rho_45_0")[k]);
    }
    const auto& over_black = table.at("rho_vs_tau_over_black_absorber");
    for (std::size_t a = 0; a < over_black.at("albedo").size(); ++a) {
        for (std::size_t t = 0; t < over_black.at("tau").size(); ++t) {
            const double albedo = over_black.at("albedo")[a];
            solvers.compare({{{{1 - albedo, albedo}, over_black.at("tau")[t]}}, {}}, over_black.at("rho_45_0")[a][t]);
        }
    }
    for (const auto& entry : table.at("rho_two_layer_grid")) {
        const double top = entry.at("alpha_top"), bottom = entry.at("alpha_bottom");
        for (std::size_t t = 0; t < entry.at("tau_top").size(); ++t) {
            solvers.compare({{{{1 - top, top}, entry.at("tau_top")[t]}}, {1 - bottom, bottom}}, entry.at("rho")[t]);
        }
    }
    for (const auto& row : table.at("finite_slab_over_index_matched_black").at("rows")) {
        const auto channel = std::string("RGB").find(row.at("channel").get<std::string>());
        for (std::size_t t = 0; t < row.at("thickness_mm").size(); ++t) {
            const Medium medium = set.mix(mixture(set, row.at("resin")), channel);
            solvers.compare({{{medium, row.at("thickness_mm")[t]}}, {}}, row.at("rho_45_0")[t]);
        }
    }
    INFO("adding-doubling " << solvers.exact << ", modes " << solvers.modes);
    CHECK(solvers.exact < 1e-6);
    CHECK(solvers.modes < 1e-6);
}

TEST_CASE("Angular tables of half-spaces are the reference's and symmetric") {
    const auto& table = reference("directional.json").at("angular_rho_semi_infinite");
    std::vector<double> look;
    for (const double degrees : table.at("angles_deg")) look.push_back(std::cos(degrees * std::numbers::pi / 180));
    const AngularGrid grid = angular_grid(1.5, 8, 8, look);
    const AddingDoubling solver(grid, 0.4, 32);
    for (const auto& [albedo, rows] : table.at("albedo").items()) {
        const MatrixXd rho = reflectance_factors(grid, solver.half_space({1 - std::stod(albedo), std::stod(albedo)}));
        for (std::size_t i = 0; i < look.size(); ++i) {
            for (std::size_t j = 0; j < look.size(); ++j) {
                CHECK(rho(grid.find(look[i]), grid.find(look[j])) == Approx(rows[i][j].get<double>()).margin(2e-6));
            }
        }
    }
}

TEST_CASE("A rule with weight at 45 and 0 degrees gives the white patches too") {
    const ResinSet set = vero_opaque();
    const AngularGrid grid = angular_grid_45_0(1.5, 7, 5, 3);
    const AddingDoubling solver(grid, 0.4, 30);
    const auto& reference_white = reference("directional.json").at("values").at("inf:W").at("rho_ref");
    for (std::size_t c = 0; c < 3; ++c) {
        const MatrixXd rho = reflectance_factors(grid, solver.half_space(set.resins[4].medium(c)));
        CHECK(rho(grid.find(1.0), grid.find(cos_45)) == Approx(reference_white[c].get<double>()).margin(1e-5));
    }
}
