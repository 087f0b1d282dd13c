// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/error.h"
#include "base/warning.h"
#include "calibration/edge/wavelet_gradient.h"
#include "calibration/resins/resin_coordinates.h"

namespace voxtone::calibration {
namespace {

constexpr double paper_pitch_mm = 0.0276, most_stretch = 0.15;
constexpr double step_v = 0.004, step_ln = 0.02;  // of derivatives: wider than the grain of the dictionary's noise
constexpr double thicker_by = 0.01;               // of the slab whose profile says what thickness does
constexpr int most_steps = 40, net_v = 14, net_sigma = 14, refined_starts = 3;

// Standard deviation of what changes from sample to sample, by second differences.
double estimated_noise(const Eigen::VectorXd& value) {
    double sum = 0;
    for (Eigen::Index k = 1; k + 1 < value.size(); ++k) {
        const double second = value[k - 1] - 2 * value[k] + value[k + 1];
        sum += second * second;
    }
    return std::sqrt(sum / (6 * static_cast<double>(value.size() - 2)));
}

double even_pitch(const EdgeProfile& slab) {
    const double pitch = (slab.x_mm.back() - slab.x_mm.front()) / static_cast<double>(slab.x_mm.size() - 1);
    for (std::size_t k = 1; k < slab.x_mm.size(); ++k)
        if (std::abs(slab.x_mm[k] - slab.x_mm[k - 1] - pitch) > 0.02 * pitch)
            throw InputError(
                fmt::format("{} of {} mm: x_mm steps from {} to {}, but {} mm elsewhere; gradients need evenly spaced "
                            "samples. Give "
                            "all samples of a profile, or resample them evenly.",
                            slab.resin, slab.thickness_mm, slab.x_mm[k - 1], slab.x_mm[k], pitch));
    return pitch;
}

std::size_t nearest_thickness(const EdgeProfile& slab, const EdgeGrid& grid) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < grid.thickness_mm.size(); ++k)
        if (std::abs(std::log(slab.thickness_mm / grid.thickness_mm[k])) <
            std::abs(std::log(slab.thickness_mm / grid.thickness_mm[nearest])))
            nearest = k;
    if (std::abs(slab.thickness_mm / grid.thickness_mm[nearest] - 1) > most_stretch)
        throw InputError(fmt::format(
            "{}: a slab of {} mm, but the nearest in the dictionary is {} mm, more than {:.0f} % away. Correct "
            "thickness_mm, or make a dictionary with that thickness (--thickness).",
            slab.resin, slab.thickness_mm, grid.thickness_mm[nearest], 100 * most_stretch));
    return nearest;
}

EdgeObservation observation(const EdgeProfile& slab, std::size_t channel, const EdgeProfileTable& table,
                            const EdgeMetric& metric) {
    const EdgeSetup& setup = table.setup();
    EdgeObservation seen;
    seen.thickness = nearest_thickness(slab, table.grid());
    seen.stretch = slab.thickness_mm / table.grid().thickness_mm[seen.thickness];
    const double pitch = even_pitch(slab);
    std::vector<double> x;
    std::vector<std::size_t> used;
    for (std::size_t k = 0; k < slab.x_mm.size(); ++k)
        if (std::abs(slab.x_mm[k]) <= setup.width_mm / 2) x.push_back(slab.x_mm[k]), used.push_back(k);
    const auto n = static_cast<Eigen::Index>(x.size());
    seen.x = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
    seen.value.resize(n);
    for (Eigen::Index k = 0; k < n; ++k) seen.value[k] = slab.value[channel][used[static_cast<std::size_t>(k)]];
    seen.error = Eigen::VectorXd::Constant(n, estimated_noise(seen.value));
    if (!slab.error[channel].empty())
        for (Eigen::Index k = 0; k < n; ++k) seen.error[k] = slab.error[channel][used[static_cast<std::size_t>(k)]];
    const optics::PixelView view{pitch, setup.blur_mm, seen.stretch};
    optics::PixelView softer = view;
    softer.blur_mm = std::hypot(view.blur_mm, setup.gel_error_mm);
    optics::PixelView thicker = view;
    thicker.stretch *= 1 + thicker_by;
    seen.sampling = optics::pixels_from_cells(table.geometry(), x, view);
    seen.see_softer = optics::pixels_from_cells(table.geometry(), x, softer);
    seen.see_thicker = optics::pixels_from_cells(table.geometry(), x, thicker);
    const Eigen::MatrixXd gradient = wavelet_gradient_map(n, metric.wavelet_level) * (paper_pitch_mm / pitch);
    seen.sampling_gradient = gradient * seen.sampling;
    seen.gradient = (gradient * seen.value).cwiseAbs();
    return seen;
}

}  // namespace

EdgeMedium edge_medium(const EdgePoint& p, double g) { return {std::exp(p[1]), albedo_of_v(p[0], g), g}; }

std::vector<EdgeObservation> edge_observations(const std::vector<const EdgeProfile*>& slabs, std::size_t channel,
                                               const EdgeProfileTable& table, const EdgeMetric& metric,
                                               std::vector<std::string>& why) {
    std::vector<EdgeObservation> seen;
    for (const EdgeProfile* slab : slabs) {
        const auto unknown = std::ranges::count_if(slab->value[channel], [](double v) { return std::isnan(v); });
        if (unknown > 0)
            why.push_back(named_warning(
                "cut-profile",
                fmt::format("{} of {} mm, {}: {} samples are not known (clipped or left out); the slab is not "
                            "used in this channel",
                            slab->resin, slab->thickness_mm, "RGB"[channel], unknown)));
        else
            seen.push_back(observation(*slab, channel, table, metric));
    }
    return seen;
}

// What is left of a slab: values and gradients, with their slopes by v and ln sigma_t.
struct EdgeObjective::Residual {
    Eigen::VectorXd r;
    Eigen::Matrix<double, Eigen::Dynamic, 2> slopes;
    double weight = 1;
    [[nodiscard]] double norm() const { return std::sqrt(r.squaredNorm() / static_cast<double>(r.size())); }
};

EdgeObjective::EdgeObjective(std::vector<EdgeObservation> slabs, std::size_t channel, const EdgeProfileTable& table,
                             const EdgeMetric& metric)
    : slabs_(std::move(slabs)), channel_(channel), table_(&table), metric_(metric) {
    double from = 0, to = std::numeric_limits<double>::infinity();
    for (const EdgeObservation& slab : slabs_) {  // every slab's optical depth must be in the grid
        from = std::max(from, table.grid().sigma_t.front() / slab.stretch);
        to = std::min(to, table.grid().sigma_t.back() / slab.stretch);
    }
    least_ = {0.02, std::log(from)};
    most_ = {1, std::log(to)};
}

Eigen::VectorXd EdgeObjective::cells(const EdgeObservation& slab, const EdgePoint& p, double g) const {
    EdgeMedium medium = edge_medium(p, g);
    medium.sigma_t *= slab.stretch;
    return table_->cells(slab.thickness, channel_, medium);
}

Eigen::VectorXd EdgeObjective::simulated(const EdgeObservation& slab, const EdgePoint& p, double g) const {
    return slab.sampling * cells(slab, p, g);
}

Eigen::VectorXd EdgeObjective::simulated_gradient(const EdgeObservation& slab, const EdgePoint& p, double g) const {
    return (slab.sampling_gradient * cells(slab, p, g)).cwiseAbs();
}

std::vector<EdgeObjective::Residual> EdgeObjective::residuals(const EdgePoint& p, double g, double mu,
                                                              bool with_slopes) const {
    std::vector<Residual> all;
    for (const EdgeObservation& slab : slabs_) {
        const Eigen::VectorXd c = cells(slab, p, g), gradient = slab.sampling_gradient * c;
        Residual value, steep;
        value.r = slab.sampling * c - mu * slab.value;
        steep.r = gradient.cwiseAbs() - mu * slab.gradient;
        steep.weight = metric_.lambda;
        if (with_slopes) {
            Eigen::MatrixXd dc(c.size(), 2);
            for (int k = 0; k < 2; ++k) {
                EdgePoint a = p, b = p;
                const double step = k == 0 ? step_v : step_ln;
                a[k] = std::max(least_[k], p[k] - step);
                b[k] = std::min(most_[k], p[k] + step);
                dc.col(k) = (cells(slab, b, g) - cells(slab, a, g)) / (b[k] - a[k]);
            }
            value.slopes = slab.sampling * dc;
            steep.slopes = gradient.cwiseSign().asDiagonal() * (slab.sampling_gradient * dc);
        }
        all.push_back(std::move(value));
        all.push_back(std::move(steep));
    }
    return all;
}

double EdgeObjective::operator()(const EdgePoint& p, double g, double mu) const {
    double sum = 0;
    for (const Residual& one : residuals(p, g, mu, false)) sum += one.weight * one.norm();
    return sum;
}

EdgeObjective::Minimum EdgeObjective::minimum_from(const EdgePoint& start, double g, double mu) const {
    Minimum best{inside(start), 0};
    best.distance = (*this)(best.at, g, mu);
    double damping = 1e-3;
    for (int step = 0; step < most_steps; ++step) {
        Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
        EdgePoint gradient = EdgePoint::Zero();
        for (const Residual& one : residuals(best.at, g, mu, true)) {
            const double scale = one.weight / (std::max(one.norm(), 1e-9) * static_cast<double>(one.r.size()));
            H += scale * one.slopes.transpose() * one.slopes;
            gradient += scale * one.slopes.transpose() * one.r;
        }
        bool moved = false;
        while (damping < 1e6 && !moved) {
            Eigen::Matrix2d damped = H;
            damped.diagonal() += damping * H.diagonal() + EdgePoint::Constant(1e-12);
            EdgePoint move = -damped.inverse() * gradient;
            move = move.cwiseMax(EdgePoint(-0.15, -0.7)).cwiseMin(EdgePoint(0.15, 0.7));
            const EdgePoint next = inside(best.at + move);
            const double distance = (*this)(next, g, mu);
            moved = distance < best.distance;
            if (!moved) {
                damping = std::max(damping * 8, 1e-4);
                continue;
            }
            const bool done = best.distance - distance < 1e-6 * best.distance;
            best = {next, distance};
            damping = std::max(damping / 8, 1e-6);
            if (done) return best;
        }
        if (!moved) break;
    }
    return best;
}

EdgeObjective::Minimum EdgeObjective::minimum(double g, double mu) const {
    std::vector<Minimum> net;
    for (int i = 0; i < net_v; ++i)
        for (int k = 0; k < net_sigma; ++k) {
            const EdgePoint p(least_[0] + (most_[0] - least_[0]) * (i + 0.5) / net_v,
                              least_[1] + (most_[1] - least_[1]) * (k + 0.5) / net_sigma);
            net.push_back({p, (*this)(p, g, mu)});
        }
    std::ranges::stable_sort(net, {}, &Minimum::distance);
    Minimum best{net.front().at, std::numeric_limits<double>::infinity()};
    std::vector<EdgePoint> starts;
    for (const Minimum& candidate : net) {
        const bool near = std::ranges::any_of(
            starts, [&](const EdgePoint& s) { return (s - candidate.at).cwiseQuotient(most_ - least_).norm() < 0.15; });
        if (near) continue;
        starts.push_back(candidate.at);
        const Minimum refined = minimum_from(candidate.at, g, mu);
        if (refined.distance < best.distance) best = refined;
        if (starts.size() == refined_starts) break;
    }
    return best;
}

Eigen::Matrix2d EdgeObjective::covariance(const Minimum& minimum, double g, double mu, double mu_error) const {
    const std::vector<Residual> all = residuals(minimum.at, g, mu, true);
    // How the minimum moves with the data: H^-1 J^T (1 - r r^T / r^2) / norm.
    std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic>> pull;
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    for (const Residual& one : all) {
        const double scale = one.weight / (std::max(one.norm(), 1e-9) * static_cast<double>(one.r.size()));
        const Eigen::VectorXd unit = one.r / std::max(one.r.norm(), 1e-300);
        const Eigen::Matrix<double, Eigen::Dynamic, 2> free = one.slopes - unit * (unit.transpose() * one.slopes);
        pull.push_back(scale * free.transpose());
        H += pull.back() * one.slopes;
    }
    H.diagonal() += EdgePoint::Constant(1e-9);
    const Eigen::Matrix2d inverse = H.inverse();
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    const auto add = [&](const EdgePoint& moved) { sum += moved * moved.transpose(); };
    EdgePoint by_mu = EdgePoint::Zero();
    Eigen::Matrix2d disagree = Eigen::Matrix2d::Zero();
    for (std::size_t s = 0; s < slabs_.size(); ++s) {
        const EdgeObservation& slab = slabs_[s];
        const Eigen::Matrix<double, 2, Eigen::Dynamic>&value = pull[2 * s], &steep = pull[2 * s + 1];
        const Eigen::VectorXd c = cells(slab, minimum.at, g), sign = (slab.sampling_gradient * c).cwiseSign();
        const Eigen::MatrixXd gradient =
            wavelet_gradient_map(slab.x.size(), metric_.wavelet_level) * (paper_pitch_mm / (slab.x[1] - slab.x[0]));
        const Eigen::Matrix<double, 2, Eigen::Dynamic> both = value + steep * sign.asDiagonal() * gradient;
        const auto moved = [&](const Eigen::VectorXd& change) { return EdgePoint(inverse * (both * change)); };
        const Eigen::Matrix<double, 2, Eigen::Dynamic> noisy = inverse * both * (mu * slab.error).asDiagonal();
        sum += noisy * noisy.transpose();
        const double grain = table_->noise(slab.thickness, edge_medium(minimum.at, g));
        add(moved(Eigen::VectorXd::Constant(slab.x.size(), grain)));
        add(moved(grain * slab.x.cwiseSign()));
        EdgeObservation thicker = slab;
        thicker.stretch *= 1 + thicker_by;
        const Eigen::VectorXd by_thickness = (slab.see_thicker * cells(thicker, minimum.at, g) - slab.sampling * c) *
                                             (table_->setup().thickness_error / thicker_by);
        add(moved(by_thickness));
        add(moved((slab.see_softer - slab.sampling) * c));
        by_mu += moved(slab.value * mu_error);
        add(moved(slab.value * (mu * table_->setup().level_error)));
        EdgePoint pulled = EdgePoint::Zero();  // by this slab alone; at the minimum all pulls together are nothing
        for (std::size_t k = 2 * s; k < 2 * s + 2; ++k)
            pulled +=
                inverse * (all[k].weight / (std::max(all[k].norm(), 1e-9) * static_cast<double>(all[k].r.size())) *
                           (all[k].slopes.transpose() * all[k].r));
        disagree += pulled * pulled.transpose();
    }
    add(by_mu);
    const auto count = static_cast<double>(slabs_.size());
    sum += disagree / count;  // as far as one of them pulls: of one alone, which pulls nowhere at its minimum, nothing
    return sum;
}

}  // namespace voxtone::calibration
