// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/angular_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "optics/numerics/quadrature.h"
#include "optics/scene/fresnel.h"

namespace voxtone::optics {

namespace {

struct Node {
    double nu, c, mu, r;
};

// Trapped directions: Gauss nodes in s on (0, 1), nu = nu_c s^2.
void add_trapped(std::vector<Node>& nodes, int count, double eta) {
    if (eta == 1 || count == 0) return;
    const double nu_c = critical_cosine(eta);
    const Rule rule = gauss_legendre(count, 0, 1);
    for (std::size_t k = 0; k < rule.x.size(); ++k) {
        const double s = rule.x[k], nu = nu_c * s * s;
        nodes.push_back({nu, 4 * nu * nu_c * s * rule.w[k], 0, 1});
    }
}

// Escaping directions: nodes in the cosine in air.
void add_escaping(std::vector<Node>& nodes, const Rule& rule, double eta) {
    for (std::size_t k = 0; k < rule.x.size(); ++k) {
        const double mu = rule.x[k];
        nodes.push_back({cosine_in_resin(mu, eta), 2 * mu * rule.w[k] / (eta * eta), mu, fresnel_reflectance(mu, eta)});
    }
}

AngularGrid assemble(std::vector<Node> nodes, double eta) {
    std::sort(nodes.begin(), nodes.end(), [](const Node& a, const Node& b) { return a.nu < b.nu; });
    const auto n = static_cast<Eigen::Index>(nodes.size());
    AngularGrid grid;
    grid.eta = eta;
    for (Eigen::ArrayXd* values : {&grid.nu, &grid.c, &grid.mu, &grid.r}) values->resize(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Node& node = nodes[static_cast<std::size_t>(k)];
        grid.nu[k] = node.nu;
        grid.c[k] = node.c;
        grid.mu[k] = node.mu;
        grid.r[k] = node.r;
        grid.trapped += node.mu == 0;
    }
    grid.t = 1 - grid.r;
    return grid;
}

}  // namespace

int AngularGrid::find(double mu_air) const {
    for (int k = 0; k < size(); ++k) {
        if (std::abs(mu[k] - mu_air) < 1e-12) return k;
    }
    VOXTONE_EXPECT(!"the grid has a node in this direction");
    return -1;
}

AngularGrid angular_grid(double eta, int below, int above, std::span<const double> views, double view_weight) {
    VOXTONE_EXPECT(eta >= 1 && below >= 0 && above >= 1 && view_weight >= 0);
    std::vector<Node> nodes;
    if (eta == 1) above += below;
    add_trapped(nodes, below, eta);
    add_escaping(nodes, gauss_legendre(above, 0, 1), eta);
    for (const double mu : views) {
        VOXTONE_EXPECT(mu > 0 && mu <= 1);
        nodes.push_back({cosine_in_resin(mu, eta), view_weight, mu, fresnel_reflectance(mu, eta)});
    }
    return assemble(std::move(nodes), eta);
}

AngularGrid angular_grid_45_0(double eta, int below, int outer, int inner) {
    VOXTONE_EXPECT(eta >= 1 && below >= 0);
    const double cos_45 = std::numbers::sqrt2 / 2;
    std::vector<Node> nodes;
    add_trapped(nodes, below, eta);
    add_escaping(nodes, gauss_radau(outer, 0, cos_45), eta);
    add_escaping(nodes, gauss_radau(inner, cos_45, 1), eta);
    return assemble(std::move(nodes), eta);
}

}  // namespace voxtone::optics
