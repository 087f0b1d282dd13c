// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport_medium.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/layered_appearance.h"

namespace voxtone::optics {
namespace {

using Matrix4 = Eigen::Matrix4d;
using Matrix8 = Eigen::Matrix<double, 8, 8>;

// Nodes of the table, even in u = ln(1 + (1 - alpha) / u_0): dense near albedo 1, where appearance runs steeply.
constexpr std::size_t albedos = 49;
constexpr double u_0 = 1e-4;
double u_of(double loss) { return std::log1p(loss / u_0); }
const double u_step = u_of(1) / (albedos - 1);
double loss_at(std::size_t i) { return u_0 * std::expm1(u_step * static_cast<double>(i)); }

struct CellResponse {
    Matrix4 R, T;
};

/// One cell between two planes: diamond differences, eight streams.
CellResponse one_cell(const DirectionSet& set, double albedo, double depth) {
    const double scatter = albedo * (1 - set.forward_peak), extinction = 1 - albedo * set.forward_peak;
    Matrix8 system = Matrix8::Zero(), inflow = Matrix8::Zero();
    for (int i = 0; i < 8; ++i) {
        const auto ki = static_cast<std::size_t>(i % 4);
        const double nu_i = i < 4 ? set.nu[ki] : -set.nu[ki];
        const double stream = 2 * set.nu[ki] / depth;
        for (int j = 0; j < 8; ++j) {
            const auto kj = static_cast<std::size_t>(j % 4);
            const double nu_j = j < 4 ? set.nu[kj] : -set.nu[kj];
            system(i, j) -= scatter * 0.5 * set.nu_weight[kj] * (1 + 3 * set.linear * nu_i * nu_j);
        }
        system(i, i) += extinction + stream;
        inflow(i, i) = stream;
    }
    const Matrix8 out = 2 * system.partialPivLu().solve(inflow) - Matrix8::Identity();
    return {out.block<4, 4>(4, 0), out.block<4, 4>(0, 0)};
}

Matrix4 doubled_half_space(CellResponse layer) {
    for (int k = 0; k < 60; ++k) {
        const Matrix4 inner = (Matrix4::Identity() - layer.R * layer.R).partialPivLu().solve(layer.R * layer.T);
        const Matrix4 reflected = layer.R + layer.T * inner;
        const Matrix4 through =
            layer.T * (Matrix4::Identity() - layer.R * layer.R).partialPivLu().solve(layer.T);
        const double change = (reflected - layer.R).cwiseAbs().maxCoeff();
        layer = {reflected, through};
        if (change < 1e-13) break;
    }
    return layer.R;
}

}  // namespace

double TransportMedia::discrete_half_space(double albedo, double depth) const {
    VOXTONE_EXPECT(depth > 0);
    if (albedo >= 1) return 1;
    const Matrix4 R = doubled_half_space(one_cell(set_, albedo, depth));
    Eigen::Vector4d t, flux;
    for (int k = 0; k < 4; ++k) {
        const auto i = static_cast<std::size_t>(k);
        t[k] = set_.nu_transmittance[i];
        flux[k] = set_.nu[i] * set_.nu_weight[i] * t[k];
    }
    // down = t + (1 - t) up, up = R down
    const Matrix4 system = Matrix4::Identity() - R * (1 - t.array()).matrix().asDiagonal();
    const Eigen::Vector4d up = system.partialPivLu().solve(R * t);
    return flux.dot(up) / flux.sum();
}

TransportMedia::TransportMedia(const DirectionSet& set) : set_(set), ratio_(albedos, 1.0) {
    const OrdinatePlan plan = appearance_plan(set.g, set.eta);
    parallel_for(1, albedos, 1, [&](std::size_t i) {
        const double loss = loss_at(i), exact = appearance(plan, half_space(plan, {loss, 1 - loss}));
        double low = 1e-3 * loss, high = std::min(1.0, 4 * loss);
        for (int step = 0; step < 44; ++step) {
            const double middle = 0.5 * (low + high);
            (discrete_half_space(1 - middle) > exact ? low : high) = middle;
        }
        ratio_[i] = 0.5 * (low + high) / loss;
    });
    ratio_[0] = ratio_[1];
}

double TransportMedia::loss(double albedo) const {
    const double loss = 1 - albedo, u = u_of(loss) / u_step;
    const auto i = std::min(static_cast<std::size_t>(u), albedos - 2);
    const double a = u - static_cast<double>(i);
    return std::min(1.0, ((1 - a) * ratio_[i] + a * ratio_[i + 1]) * loss);
}

std::array<double, 2> TransportMedia::exact(const Medium& medium) const {
    constexpr double least = 1e-6;  // mm^-1: nothing is seen of it, and fields can be divided by it
    const double sigma_t = std::max(medium.sigma_t(), least);
    const double sigma_s = std::max(sigma_t * (1 - loss(medium.albedo())), least);
    return {sigma_t - set_.forward_peak * sigma_s, sigma_s * (1 - set_.forward_peak)};
}

TransportMedium TransportMedia::operator()(const Medium& medium) const {
    const auto [sigma_t, sigma_s] = exact(medium);
    return {static_cast<float>(sigma_t), static_cast<float>(sigma_s)};
}

}  // namespace voxtone::optics
