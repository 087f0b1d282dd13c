// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/resin_profile.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "optics/layered/adding_doubling.h"
#include "optics/layered/angular_grid.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {
namespace {

constexpr int directions = 32, terms = 48;  // of what is called exact

// The exponential integral E3 (Abramowitz and Stegun 5.1.14).
double E3(double x) {
    if (x == 0) return 0.5;
    if (x > 700) return 0;
    return 0.5 * (std::exp(-x) * (1 - x) - x * x * std::expint(-x));
}

// Light that passes a layer straight, in rings; the last ring has all that is beyond.
std::vector<double> straight_through(double tau, double thickness_mm, const std::vector<double>& edges_mm) {
    // What lands farther out than r.
    const auto beyond = [&](double r) {
        const double v2 = 1 + r * r / (thickness_mm * thickness_mm);
        return 2 * E3(tau * std::sqrt(v2)) / v2;
    };
    std::vector<double> light;
    for (std::size_t ring = 0; ring + 1 < edges_mm.size(); ++ring) {
        const bool last = ring + 2 == edges_mm.size();
        light.push_back(std::max(0.0, beyond(edges_mm[ring]) - (last ? 0.0 : beyond(edges_mm[ring + 1]))));
    }
    return light;
}

// Coefficients of traced light, scaled to its exact total.
std::vector<double> scaled(const HankelGrid& grid, const std::vector<double>& edges_mm, const RingLight& traced,
                           double total) {
    std::vector<double> coefficients = grid.from_rings(edges_mm, traced.light);
    const double sum = coefficients[0];
    // Where not one path came out nothing is known of how it spreads but that it does: the first coefficient alone.
    for (double& c : coefficients) c = sum > 0 ? c * (total / sum) : 0;
    coefficients[0] = total;
    return coefficients;
}

}  // namespace

DiffuseTotals diffuse_totals(const LayerScene& scene) {
    VOXTONE_EXPECT(scene.eta_top == 1 && scene.eta_bottom == 1 && !scene.layers.empty());
    const AddingDoubling solver(angular_grid(1.0, directions / 2, directions / 2), scene.g, terms);
    double tau = 0;
    LayerResponse all = solver.layer(scene.layers[0].medium, scene.layers[0].thickness_mm);
    for (std::size_t i = 0; i < scene.layers.size(); ++i) {
        const PlainLayer& layer = scene.layers[i];
        tau += layer.medium.sigma_t() * layer.thickness_mm;
        if (i > 0) all = solver.add(all, solver.layer(layer.medium, layer.thickness_mm));
    }
    const Eigen::VectorXd c = solver.grid().c.matrix();
    return {c.dot(image(all.R_above, c)), c.dot(image(all.D_down, c)) + c.dot(all.direct.matrix()), 2 * E3(tau)};
}

// Solved in all directions: of light that the surface let in, and of diffuse light from below.
BoundedTotals bounded_totals(const Medium& medium, double g, double eta, double thickness_mm, int of_directions) {
    const AddingDoubling solver(angular_grid(eta, of_directions / 2, of_directions / 2), g, terms);
    const LayerResponse layer = solver.layer(medium, thickness_mm);
    const AngularGrid& at = solver.grid();
    const Eigen::VectorXd c = at.c.matrix(), leaving = (at.c * at.t).matrix(), ones = Eigen::VectorXd::Ones(at.size());
    // Down below the surface: what comes in, and what the surface sends back of what the layer sent up.
    const Eigen::MatrixXd returned = scaled_rows(at.r.matrix(), scaled_columns(layer.R_above, c));
    const Eigen::MatrixXd inside = Eigen::MatrixXd::Identity(at.size(), at.size()) - returned;
    const auto scattered = [&](const Eigen::MatrixXd& R, const Eigen::VectorXd& light) {
        return image(R, c.cwiseProduct(light));
    };
    const auto through = [&](const Eigen::MatrixXd& D, const Eigen::VectorXd& light) -> Eigen::VectorXd {
        return layer.direct.matrix().cwiseProduct(light) + scattered(D, light);
    };
    const Eigen::VectorXd down = preimage(inside, at.t.matrix() / leaving.sum());
    const Eigen::VectorXd up_from_below = through(layer.D_up, ones);
    const Eigen::VectorXd sent_back = preimage(inside, (at.r * up_from_below.array()).matrix());
    return {leaving.dot(scattered(layer.R_above, down)), c.dot(through(layer.D_down, down)),
            c.dot(image(layer.R_below, c)) + c.dot(through(layer.D_down, sent_back)),
            leaving.dot(up_from_below + scattered(layer.R_above, sent_back))};
}

ResinProfile resin_profile(const Medium& medium, double g, double thickness_mm, const HankelGrid& grid,
                           const LayerPathOptions& options, const Progress* progress) {
    const LayerScene scene{{{medium, thickness_mm}}, g, 1, 1};
    const DiffuseTotals totals = diffuse_totals(scene);
    ResinProfile profile;
    profile.thickness_mm = thickness_mm;
    profile.traced = trace_layers(scene, grid, options, progress);
    const TracedProfile& traced = profile.traced;
    profile.R = scaled(grid, traced.edges_mm, traced.R, totals.R);
    profile.T = scaled(grid, traced.edges_mm, traced.T, std::max(0.0, totals.T - totals.T_direct));
    const std::vector<double> direct = grid.from_rings(
        traced.edges_mm, straight_through(medium.sigma_t() * thickness_mm, thickness_mm, traced.edges_mm));
    for (std::size_t i = 0; i < grid.size(); ++i) profile.T[i] += direct[i];
    return profile;
}

LayerProfile smooth_surface(double eta, std::size_t coefficients) {
    VOXTONE_EXPECT(eta >= 1);
    const AngularGrid grid = angular_grid(eta, 24, 24);
    const double turned_back = (grid.c * grid.r).sum();
    return {std::vector<double>(coefficients, std::sqrt(1 - turned_back)), std::vector<double>(coefficients, 0.0),
            std::vector<double>(coefficients, turned_back)};
}

}  // namespace voxtone::optics
