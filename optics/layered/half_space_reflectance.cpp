// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/half_space_reflectance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::optics {

namespace {

constexpr Eigen::Index axis_samples = 193;
// Nearer to 1 the modes of a half-space lose digits; it is black within 1e-9 of the last sample there.
constexpr double darkest = 1 - 1e-9;

double reading(const OrdinatePlan& plan, const Medium& medium, MeasuringGeometry geometry) {
    const Admittance top = half_space(plan, medium);
    if (geometry == MeasuringGeometry::directional_45_0)
        return reflectance_factor(plan, top, std::numbers::sqrt2 / 2, 1.0);
    const AngularGrid& grid = plan.grid();
    double light = 0, seen = 0;
    for (Eigen::Index i = 0; i < grid.mu.size(); ++i) {
        if (!(grid.mu[i] > 0) || std::abs(grid.mu[i] - 1) < 1e-12) continue;
        light += grid.c[i];
        seen += grid.c[i] * reflectance_factor(plan, top, grid.mu[i], 1.0);
    }
    return seen / light;
}

// sqrt(1 - albedo)
double root_of_loss(const Medium& medium) {
    const double sigma_t = medium.sigma_t();
    return sigma_t > 0 ? std::sqrt(std::max(medium.sigma_a, 0.0) / sigma_t) : 0;
}

}  // namespace

HalfSpaceReflectance::HalfSpaceReflectance(double g, double eta, MeasuringGeometry geometry) {
    const OrdinatePlan plan = directional_plan(g, eta);
    Eigen::MatrixXd samples(axis_samples, 5);  // the same along the axis that is not used
    parallel_for(0, static_cast<std::size_t>(axis_samples), 4, [&](std::size_t k) {
        const double root = darkest * static_cast<double>(k) / static_cast<double>(axis_samples - 1);
        samples.row(static_cast<Eigen::Index>(k))
            .setConstant(reading(plan, Medium{root * root, 1 - root * root}, geometry));
    });
    table_ = BicubicTable(samples, darkest, 1);
}

double HalfSpaceReflectance::operator()(const Medium& medium) const { return table_(root_of_loss(medium), 0); }

HalfSpaceReflectance::Value HalfSpaceReflectance::with_gradient(const Medium& medium) const {
    const double root = root_of_loss(medium);
    const BicubicTable::Value value = table_.with_gradient(root, 0);
    const double sigma_t = medium.sigma_t();
    // d root / d sigma_a = sigma_s / (2 root sigma_t^2): endless for a medium that absorbs nothing
    const double slope = value.df_dx / (2 * std::max(root, 1e-6) * std::max(sigma_t * sigma_t, 1e-300));
    return {value.f, slope * medium.sigma_s, -slope * medium.sigma_a};
}

}  // namespace voxtone::optics
