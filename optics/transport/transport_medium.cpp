// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/transport_medium.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include <Eigen/Dense>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/layered/layered_appearance.h"
#include "optics/numerics/quadrature.h"

namespace voxtone::optics {
namespace {

constexpr int in_quadrant = 8;  // directions of one hemisphere in one quadrant of azimuths: the others are alike
using Matrix = Eigen::Matrix<double, in_quadrant, in_quadrant>;
using PairMatrix = Eigen::Matrix<double, 2 * in_quadrant, 2 * in_quadrant>;

// Nodes of the table, even in u = ln(1 + (1 - alpha) / u_0): dense near albedo 1, where appearance runs steeply.
constexpr std::size_t albedos = 33;
constexpr double u_0 = 1e-4;
double u_of(double loss) { return std::log1p(loss / u_0); }
const double u_step = u_of(1) / (albedos - 1);
double loss_at(std::size_t i) { return u_0 * std::expm1(u_step * static_cast<double>(i)); }

// Extinctions, mm^-1. The departure from thin cells grows as their square at first.
constexpr std::array<double, 7> extinctions{1e-3, 5, 10, 20, 35, 60, 100};

struct CellResponse {
    Matrix R, T;
};

CellResponse doubled(const CellResponse& layer) {
    const Eigen::PartialPivLU<Matrix> between(Matrix::Identity() - layer.R * layer.R);
    return {layer.R + layer.T * between.solve(layer.R * layer.T), layer.T * between.solve(layer.T)};
}

}  // namespace

double anti_diffusive_linear(const DirectionSet& set, const std::array<double, 3>& edge_mm, double theta,
                             double sigma_t, double sigma_s) {
    constexpr double least_linear = -1.0 / 3, diffuse = 10;
    const double h = (edge_mm[0] + edge_mm[1] + edge_mm[2]) / 3, artificial = h * (1 - theta) / (4 * (1 + theta));
    const double transport = sigma_t - set.linear * sigma_s, r = 3 * transport * artificial;
    if (!(r > 0)) return set.linear;
    if (r >= 1) return least_linear;
    return std::max(set.linear - std::pow(sigma_s / sigma_t, diffuse) * transport / sigma_t * r / (1 - r),
                    std::min(least_linear, set.linear));
}

double cell_fit(double sigma_a, double way, double theta) {
    const double tau = sigma_a * way;
    if (theta != 1) return tau < 1e-6 ? 1 : -(1 + theta) * std::expm1(-tau) / ((theta + std::exp(-tau)) * tau);
    return tau < 0.02 ? 1 - tau * tau / 12 : 2 * std::tanh(tau / 2) / tau;
}

double mean_in_box(double sigma_a, const std::array<double, 3>& ways) {
    static const Rule rule = gauss_legendre(12, 0, 1);
    const double to = std::min({ways[0], ways[1], ways[2], 16 / std::max(sigma_a, 1e-9)});
    double lost = 0;  // 1 - mean = sigma_a times the integral over t of exp(-sigma_a t) and the share of s > t
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
        const double t = to * rule.x[i];
        lost += rule.w[i] * std::exp(-sigma_a * t) * (1 - t / ways[0]) * (1 - t / ways[1]) * (1 - t / ways[2]);
    }
    return 1 - sigma_a * to * lost;
}

double lump_fit(double sigma_a, const std::array<double, 3>& ways, double theta, double apart) {
    const double way = 1 / (1 / ways[0] + 1 / ways[1] + 1 / ways[2]), tau = sigma_a * way;
    if (!(apart > 0) || tau < 1e-6) return cell_fit(sigma_a, way, theta);
    const double mean = (1 - apart) * -std::expm1(-tau) / tau + apart * mean_in_box(sigma_a, ways);
    return (1 + theta) * mean / (1 + theta - tau * mean);
}

// One layer of cells between two planes, the same all over: what comes in sideways goes out sideways.
double TransportMedia::discrete_half_space(double albedo, double sigma_t) const {
    VOXTONE_EXPECT(sigma_t > 0);
    if (albedo >= 1) return 1;
    const double scatter = albedo * sigma_t * (1 - set_.forward_peak),
                 extinction = sigma_t * (1 - albedo * set_.forward_peak),
                 linear = anti_diffusive_linear(set_, edge_mm_, theta_, extinction, scatter);
    std::array<double, in_quadrant> nu{}, weight{}, fit{}, t{};
    for (std::size_t d = 0; d < in_quadrant; ++d) {
        nu[d] = set_.nu[d / 2];
        weight[d] = set_.nu_weight[d / 2] / 2;
        t[d] = set_.nu_transmittance[d / 2];
        double per_way = 0;
        for (std::size_t a = 0; a < 3; ++a) per_way += static_cast<double>(set_.cosine[a].v[d]) / edge_mm_[a];
        fit[d] = cell_fit((1 - albedo) * sigma_t, 1 / per_way, theta_);
    }
    // psi of the cell's centre from what comes in, x: stream (c - in) + fit extinction c = fit q, q = S m, and the mean
    // of the cell m = fit c + (1 - fit) q / extinction. So m = (1 - (1 - fit) S / extinction)^-1 fit c.
    PairMatrix S, mean = PairMatrix::Identity(), system = PairMatrix::Zero(), inflow = PairMatrix::Zero();
    for (int i = 0; i < 2 * in_quadrant; ++i)
        for (int j = 0; j < 2 * in_quadrant; ++j) {
            const auto ki = static_cast<std::size_t>(i % in_quadrant), kj = static_cast<std::size_t>(j % in_quadrant);
            const double nu_i = i < in_quadrant ? nu[ki] : -nu[ki], nu_j = j < in_quadrant ? nu[kj] : -nu[kj];
            S(i, j) = scatter * 0.5 * weight[kj] * (1 + 3 * linear * nu_i * nu_j);
        }
    Eigen::Matrix<double, 2 * in_quadrant, 1> fits, streams;
    for (int i = 0; i < 2 * in_quadrant; ++i) {
        const auto k = static_cast<std::size_t>(i % in_quadrant);
        fits[i] = fit[k];
        streams[i] = (1 + theta_) * nu[k] / edge_mm_[2];
    }
    mean -= ((1 - fits.array()) / extinction).matrix().asDiagonal() * S;
    const PairMatrix centre_to_mean = mean.partialPivLu().solve(PairMatrix(fits.asDiagonal()));
    system = -PairMatrix(fits.asDiagonal() * (S * centre_to_mean));
    for (int i = 0; i < 2 * in_quadrant; ++i) {
        system(i, i) += fits[i] * extinction + streams[i];
        inflow(i, i) = streams[i];
    }
    const PairMatrix out = (1 + theta_) * system.partialPivLu().solve(inflow) - theta_ * PairMatrix::Identity();
    CellResponse layer{out.block<in_quadrant, in_quadrant>(in_quadrant, 0), out.block<in_quadrant, in_quadrant>(0, 0)};
    for (int k = 0; k < 60; ++k) {
        const CellResponse next = doubled(layer);
        const double change = (next.R - layer.R).cwiseAbs().maxCoeff();
        layer = next;
        if (change < 1e-9) break;
    }
    // Under the surface: down = t + (1 - t) up, up = R down.
    Eigen::Matrix<double, in_quadrant, 1> t_, flux;
    for (int d = 0; d < in_quadrant; ++d) {
        const auto i = static_cast<std::size_t>(d);
        t_[d] = t[i];
        flux[d] = nu[i] * weight[i] * t[i];
    }
    const Matrix surface = Matrix::Identity() - layer.R * (1 - t_.array()).matrix().asDiagonal();
    return flux.dot(surface.partialPivLu().solve(layer.R * t_)) / flux.sum();
}

TransportMedia::TransportMedia(const DirectionSet& set, const std::array<double, 3>& edge_mm, double theta)
    : set_(set), edge_mm_(edge_mm), theta_(theta), ratio_(extinctions.size() * albedos, 1.0) {
    const OrdinatePlan plan = appearance_plan(set.g, set.eta);
    parallel_for(1, albedos, 1, [&](std::size_t i) {
        const double loss = loss_at(i), wanted = appearance(plan, half_space(plan, {loss, 1 - loss}));
        for (std::size_t k = 0; k < extinctions.size(); ++k) {
            // Secant steps in the logarithm of the ratio: the function is smooth and nearly straight there.
            const auto miss = [&](double log_ratio) {
                return discrete_half_space(1 - std::min(1.0, loss * std::exp(log_ratio)), extinctions[k]) - wanted;
            };
            double a = k > 0 ? std::log(ratio_[(k - 1) * albedos + i]) : 0, b = a - 0.01, fa = miss(a), fb = miss(b);
            for (int step = 0; step < 12 && std::abs(fb) > 2e-6 && fa != fb; ++step) {
                const double c = std::clamp(b - fb * (b - a) / (fb - fa), -1.0, 1.0);
                a = b;
                fa = fb;
                b = c;
                fb = miss(b);
            }
            ratio_[k * albedos + i] = std::exp(b);
        }
    });
    for (std::size_t k = 0; k < extinctions.size(); ++k) ratio_[k * albedos] = ratio_[k * albedos + 1];
}

double TransportMedia::loss(double albedo, double sigma_t) const {
    const double loss = 1 - albedo, u = u_of(loss) / u_step;
    const auto i = std::min(static_cast<std::size_t>(u), albedos - 2);
    const double a = u - static_cast<double>(i);
    std::size_t k = 0;
    while (k + 2 < extinctions.size() && extinctions[k + 1] < sigma_t) ++k;
    const double b = std::clamp((sigma_t * sigma_t - extinctions[k] * extinctions[k]) /
                                    (extinctions[k + 1] * extinctions[k + 1] - extinctions[k] * extinctions[k]),
                                0.0, 1.0);
    const auto at = [&](std::size_t row) {
        return (1 - a) * ratio_[row * albedos + i] + a * ratio_[row * albedos + i + 1];
    };
    return std::min(1.0, ((1 - b) * at(k) + b * at(k + 1)) * loss);
}

std::shared_ptr<const TransportMedia> shared_media(const DirectionSet& set, const std::array<double, 3>& edge_mm,
                                                   double theta) {
    // A prediction is asked for again and again with the same cells; the tables take a tenth of a second.
    static std::mutex guard;
    static std::map<std::array<double, 6>, std::shared_ptr<const TransportMedia>> known;
    const std::array<double, 6> key{set.g, set.eta, edge_mm[0], edge_mm[1], edge_mm[2], theta};
    {
        const std::lock_guard lock(guard);
        if (const auto found = known.find(key); found != known.end()) return found->second;
    }
    auto made =
        std::make_shared<const TransportMedia>(set, edge_mm, theta);  // outside the lock: it runs parallel loops
    const std::lock_guard lock(guard);
    if (known.size() > 64) known.clear();
    return known.try_emplace(key, std::move(made)).first->second;
}

TransportMedium similar_medium(const DirectionSet& set, const Medium& medium) {
    return {static_cast<float>(medium.sigma_t() - set.forward_peak * medium.sigma_s),
            static_cast<float>(medium.sigma_s * (1 - set.forward_peak)), static_cast<float>(set.linear)};
}

std::array<double, 3> TransportMedia::exact(const Medium& medium) const {
    constexpr double least = 1e-6;  // mm^-1: nothing is seen of it, and fields can be divided by it
    const double sigma_t = std::max(medium.sigma_t(), least);
    const double sigma_s = std::max(sigma_t * (1 - loss(medium.albedo(), sigma_t)), least);
    const double extinction = sigma_t - set_.forward_peak * sigma_s, scatter = sigma_s * (1 - set_.forward_peak);
    return {extinction, scatter, anti_diffusive_linear(set_, edge_mm_, theta_, extinction, scatter)};
}

TransportMedium TransportMedia::operator()(const Medium& medium) const {
    const auto [sigma_t, sigma_s, linear] = exact(medium);
    return {static_cast<float>(sigma_t), static_cast<float>(sigma_s), static_cast<float>(linear)};
}

}  // namespace voxtone::optics
