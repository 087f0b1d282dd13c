// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/channel_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <ceres/ceres.h>
#include <Eigen/Eigenvalues>

namespace voxtone::calibration {

using optics::Medium;

namespace {

// No measurement is better than the model's own error.
constexpr double model_error = 2e-6;
constexpr int net_v = 16, net_sigma_t = 20;  // of the brute force
constexpr std::size_t net_starts = 4;

constexpr double told_mm = 2;         // thinner clear is known to 0.004 mm^-1 by a noise of 0.005, as much as it has
constexpr double usual_clear = 0.01;  // mm^-1, where its fit begins

}  // namespace

bool clear_is_told(const PatchTable& table, const std::string& role) {
    return std::ranges::any_of(table.patches, [&](const Patch& patch) {
        return patch.top.size() == 1 && patch.top.front().role == role && patch.thickness_mm >= told_mm;
    });
}

Medium ChannelFitter::medium_at(std::size_t role, const ResinPoint& point) const {
    if (!roles_.is_clear(role)) return medium_of(point, options_.g);
    return {fitted_[role] ? std::exp(point.ln_sigma_t) : 0, 0};
}

ResinBounds ChannelFitter::bounds_of(std::size_t role) const { return roles_.is_clear(role) ? clear_bounds : bounds_; }

// Residuals / noise of a part of the target as a function of some resins' coordinates.
class ChannelFitter::Residuals : public ceres::CostFunction {
public:
    Residuals(const ChannelFitter& fitter, const Part& part, std::size_t channel, std::vector<std::size_t> free,
              bool bases_move, const std::vector<ResinPoint>& resins, int& evaluations)
        : fitter_(fitter),
          part_(part),
          free_(std::move(free)),
          evaluations_(evaluations),
          bases_move_(bases_move),
          channel_(channel),
          points_(resins),
          rho_(part.patches.size()) {
        for (const std::size_t p : part.patches) {
            const Patch& patch = fitter.table_->patches[p];
            measured_.push_back(patch.rho[channel]);
            weight_.push_back(1 / std::max(patch.error.empty() ? fitter.noise_ : patch.error[channel], model_error));
        }
        for (std::size_t k = 0; k < free_.size(); ++k) {
            const PriorValue known = fitter.prior(free_[k], channel);
            if (known.known() == 0) continue;
            known_.push_back(
                {k, known.at, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(known.precision).operatorSqrt()});
        }
        media_.resize(points_.size());
        refresh();
        if (!bases_move_) bases_ = part_.model->bases(media_, false, channel_);
        set_num_residuals(rows());
        mutable_parameter_block_sizes()->assign(2 * free_.size(), 1);
    }

    // One block per coordinate, v and ln sigma_t of each resin in turn.
    bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
        for (std::size_t k = 0; k < free_.size(); ++k) points_[free_[k]] = {*parameters[2 * k], *parameters[2 * k + 1]};
        refresh();
        if (bases_move_) bases_ = part_.model->bases(media_, jacobians != nullptr, channel_);
        if (jacobians)
            part_.model->evaluate(media_, bases_, rho_, by_resin_);
        else
            part_.model->evaluate(media_, bases_, rho_);
        ++evaluations_;
        for (std::size_t p = 0; p < rho_.size(); ++p) residuals[p] = weight_[p] * (rho_[p] - measured_[p]);
        compare_with_prior(residuals, jacobians);
        if (!jacobians) return true;
        const double g = fitter_.options_.g;
        for (std::size_t p = 0; p < rho_.size(); ++p)
            for (std::size_t k = 0; k < free_.size(); ++k) {
                const std::size_t r = free_[k];
                const double by_absorption = by_resin_(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(2 * r));
                const double by_scattering =
                    by_resin_(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(2 * r + 1));
                const Medium& m = media_[r];
                if (jacobians[2 * k] && fitter_.roles_.is_clear(r))
                    jacobians[2 * k][p] = 0;
                else if (jacobians[2 * k])
                    jacobians[2 * k][p] =
                        weight_[p] * (by_scattering - by_absorption) * m.sigma_t() * albedo_by_v(points_[r].v, g);
                if (jacobians[2 * k + 1])
                    jacobians[2 * k + 1][p] = weight_[p] * (by_absorption * m.sigma_a + by_scattering * m.sigma_s);
            }
        return true;
    }

    [[nodiscard]] const std::vector<double>& rho() const { return rho_; }
    [[nodiscard]] int rows() const { return static_cast<int>(rho_.size() + 2 * known_.size()); }

private:
    struct Known {
        std::size_t k;  ///< in free_
        ResinPoint at;
        Eigen::Matrix2d root;  ///< of the precision
    };
    void refresh() const {
        for (std::size_t r = 0; r < points_.size(); ++r) media_[r] = fitter_.medium_at(r, points_[r]);
    }
    // Two rows a resin, after those of the patches.
    void compare_with_prior(double* residuals, double** jacobians) const {
        if (jacobians)
            for (std::size_t i = 0; i < 2 * free_.size(); ++i)
                if (jacobians[i]) std::fill_n(jacobians[i] + rho_.size(), 2 * known_.size(), 0.0);
        std::size_t row = rho_.size();
        for (const Known& known : known_) {
            const ResinPoint& at = points_[free_[known.k]];
            const Eigen::Vector2d off =
                known.root * Eigen::Vector2d(at.v - known.at.v, at.ln_sigma_t - known.at.ln_sigma_t);
            for (int i = 0; i < 2; ++i, ++row) {
                residuals[row] = off[i];
                for (int j = 0; jacobians && j < 2; ++j)
                    if (double* column = jacobians[2 * known.k + static_cast<std::size_t>(j)])
                        column[row] = known.root(i, j);
            }
        }
    }
    const ChannelFitter& fitter_;
    const Part& part_;
    std::vector<std::size_t> free_;
    int& evaluations_;
    bool bases_move_;
    std::size_t channel_;
    std::vector<double> measured_, weight_;
    std::vector<Known> known_;
    mutable std::vector<ResinPoint> points_;
    mutable std::vector<double> rho_;
    mutable std::vector<Medium> media_;
    mutable PatchModel::Bases bases_;
    mutable Eigen::MatrixXd by_resin_;
};

ChannelFitter::Part ChannelFitter::part(std::vector<std::size_t> patches) const {
    Part result{std::move(patches), nullptr};
    std::vector<Patch> chosen;
    for (const std::size_t p : result.patches) chosen.push_back(table_->patches[p]);
    result.model = std::make_unique<PatchModel>(chosen, roles_.roles, options_, plan_);
    return result;
}

ChannelFitter::ChannelFitter(const PatchTable& table, const TargetRoles& roles, const PatchModelOptions& options,
                             double noise, const ResinPrior& prior)
    : table_(&table),
      roles_(roles),
      options_(options),
      noise_(noise),
      prior_(prior),
      plan_(patch_plan(options)),
      bounds_(resin_bounds(options.g)),
      principles_(table, roles_, options, noise) {
    std::vector<std::size_t> all(table.patches.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    whole_ = part(all);
    for (std::size_t r = 0; r < roles_.roles.size(); ++r)
        fitted_.push_back(!roles_.is_clear(r) || clear_is_told(table, roles_.roles[r]));
    for (std::size_t r = 0; r < roles_.roles.size(); ++r) {
        std::vector<std::size_t> of;
        if (!roles_.is_base(r) && !roles_.is_clear(r))
            for (const std::size_t p : all)
                if (std::ranges::any_of(table.patches[p].top,
                                        [&](const ResinShare& s) { return s.role == roles_.roles[r]; }))
                    of.push_back(p);
        of_resin_.push_back(part(std::move(of)));
    }
}

// A coordinate that has run into its bound is held there, and let go when the residuals pull it back: within bounds
// alone Ceres creeps along them.
double ChannelFitter::solve(const Part& of, std::size_t channel, const std::vector<std::size_t>& free, bool bases_move,
                            std::vector<ResinPoint>& resins, int& evaluations,
                            const std::vector<std::size_t>& held_resins) const {
    Residuals residuals(*this, of, channel, free, bases_move, resins, evaluations);
    const std::size_t count = 2 * free.size();
    std::vector<double> x, low, high;
    for (const std::size_t r : free) {
        const ResinBounds bounds = bounds_of(r);
        const ResinPoint p = clamped(resins[r], bounds);
        x.insert(x.end(), {p.v, p.ln_sigma_t});
        low.insert(low.end(), {bounds.least_v, std::log(bounds.least_sigma_t)});
        high.insert(high.end(), {bounds.most_v, std::log(bounds.most_sigma_t)});
    }
    ceres::Problem::Options own;
    own.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(own);
    std::vector<double*> blocks;
    for (double& value : x) blocks.push_back(&value);
    problem.AddResidualBlock(&residuals, nullptr, blocks);
    for (std::size_t k = 0; k < count; ++k) {
        if (!(low[k] < high[k])) continue;  // stays as it is
        problem.SetParameterLowerBound(blocks[k], 0, low[k]);
        problem.SetParameterUpperBound(blocks[k], 0, high[k]);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 12;
    options.function_tolerance = 1e-7;
    options.parameter_tolerance = 1e-7;
    options.gradient_tolerance = 1e-9;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    double chi2 = 0;
    std::vector<bool> fixed(count, false), held(count, false);
    const auto fix = [&](std::size_t coordinate) {
        fixed[coordinate] = held[coordinate] = true;
        problem.SetParameterBlockConstant(blocks[coordinate]);
    };
    for (std::size_t k = 0; k < free.size(); ++k)
        if (roles_.is_clear(free[k])) fix(2 * k);
    for (std::size_t k = 0; k < free.size(); ++k)
        if (std::ranges::find(held_resins, free[k]) != held_resins.end()) fix(2 * k + 1);
    std::vector<double> gradient, residual(of.patches.size());
    for (int round = 0; round < 8; ++round) {
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        chi2 = 2 * summary.final_cost;
        // The gradient by all coordinates, the held ones too.
        for (std::size_t k = 0; k < count; ++k)
            if (held[k]) problem.SetParameterBlockVariable(blocks[k]);
        problem.Evaluate({}, nullptr, nullptr, &gradient, nullptr);
        bool changed = false;
        for (std::size_t k = 0; k < count; ++k) {
            const double reach = 1e-7 * (high[k] - low[k]);
            const bool out =
                fixed[k] || (x[k] <= low[k] + reach && gradient[k] > 0) || (x[k] >= high[k] - reach && gradient[k] < 0);
            changed = changed || out != held[k];
            held[k] = out;
            if (out) problem.SetParameterBlockConstant(blocks[k]);
        }
        if (!changed && summary.termination_type == ceres::CONVERGENCE) break;
        if (std::ranges::all_of(held, [](bool h) { return h; })) break;
        options.max_num_iterations = 30;
    }
    for (std::size_t k = 0; k < free.size(); ++k) resins[free[k]] = {x[2 * k], x[2 * k + 1]};
    return chi2;
}

PriorValue ChannelFitter::prior(std::size_t role, std::size_t channel) const {
    const ResinPrior::Resin* known = prior_.find(roles_.roles[role]);
    return known && !roles_.is_clear(role) ? known->channel[channel] : PriorValue{};
}

// What is known replaces what the Principles found.
void ChannelFitter::start_at_prior(std::size_t channel, ChannelStart& start) const {
    for (std::size_t r = 0; r < roles_.roles.size(); ++r) {
        const PriorValue known = prior(r, channel);
        if (known.precision(0, 0) > 0) start.resins[r].v = known.at.v;
        if (known.precision(1, 1) > 0) start.resins[r].ln_sigma_t = known.at.ln_sigma_t;
        start.resins[r] = clamped(start.resins[r], bounds_);
        if (known.known() == 2) start.alternatives[r].clear();
    }
}

// The best places of a net over all that is possible for a resin, by its patches and its prior; the others stay.
std::vector<ResinPoint> ChannelFitter::brute_force(std::size_t role, std::size_t channel,
                                                   const std::vector<ResinPoint>& resins) const {
    const Part& of = of_resin_[role];
    int evaluations = 0;
    const Residuals residuals(*this, of, channel, {role}, false, resins, evaluations);
    std::vector<double> row(static_cast<std::size_t>(residuals.rows()));
    std::vector<std::pair<double, ResinPoint>> net;
    const double from = std::log(bounds_.least_sigma_t), to = std::log(bounds_.most_sigma_t);
    for (int i = 0; i < net_v; ++i)
        for (int k = 0; k < net_sigma_t; ++k) {
            const ResinPoint p{bounds_.least_v + (bounds_.most_v - bounds_.least_v) * (i + 0.5) / net_v,
                               from + (to - from) * (k + 0.5) / net_sigma_t};
            const double* at[] = {&p.v, &p.ln_sigma_t};
            (void)residuals.Evaluate(at, row.data(), nullptr);
            net.emplace_back(std::inner_product(row.begin(), row.end(), row.begin(), 0.0), p);
        }
    std::ranges::stable_sort(net, {}, [](const auto& entry) { return entry.first; });
    std::vector<ResinPoint> starts;
    for (const auto& [chi2, p] : net) {
        const bool near = std::ranges::any_of(starts, [&](const ResinPoint& s) {
            return std::abs(s.v - p.v) < 2.5 / net_v &&
                   std::abs(s.ln_sigma_t - p.ln_sigma_t) < 2.5 * (to - from) / net_sigma_t;
        });
        if (!near) starts.push_back(p);
        if (starts.size() == net_starts) break;
    }
    return starts;
}

// Every resin by itself from each minimum of Eq. 6, the bases held.
void ChannelFitter::choose_minima(std::size_t channel, const ChannelStart& start, ChannelFit& fit) const {
    for (std::size_t r = 0; r < roles_.roles.size(); ++r) {
        const bool searched = !prior_.resins.empty() && prior(r, channel).known() < 2;
        if (of_resin_[r].patches.empty() || (start.alternatives[r].empty() && !searched)) continue;
        std::vector<ResinPoint> from{start.resins[r]};
        from.insert(from.end(), start.alternatives[r].begin(), start.alternatives[r].end());
        if (searched) {
            const std::vector<ResinPoint> net = brute_force(r, channel, fit.resins);
            from.insert(from.end(), net.begin(), net.end());
        }
        double least = std::numeric_limits<double>::infinity();
        ResinPoint best = start.resins[r];
        std::vector<std::pair<double, ResinPoint>> ends;
        for (const ResinPoint& point : from) {
            std::vector<ResinPoint> resins = fit.resins;
            resins[r] = point;
            int evaluations = 0;
            const double chi2 = solve(of_resin_[r], channel, {r}, false, resins, evaluations);
            ends.emplace_back(chi2, resins[r]);
            if (chi2 < least) least = chi2, best = resins[r];
        }
        fit.resins[r] = best;
        for (const auto& [chi2, end] : ends)
            if (chi2 < least + 2 && std::hypot((end.v - best.v) / 0.05, (end.ln_sigma_t - best.ln_sigma_t) / 0.2) > 1)
                fit.second[r] = true;
    }
}

void ChannelFitter::limit_opaque(std::size_t channel, const std::vector<std::size_t>& free, ChannelFit& fit) const {
    const double high = std::log(bounds_.most_sigma_t);
    std::vector<ResinPoint> limited = fit.resins;
    for (const std::size_t r : free) {
        const double at = fit.resins[r].ln_sigma_t;
        if (roles_.is_clear(r)) continue;
        if (fit.errors[r].ln_sigma_t < 0.5 && at < high - 1e-6) continue;
        // A colour's own patches decide with the bases held; a base's are all.
        const bool base = of_resin_[r].patches.empty();
        const Part& of = base ? whole_ : of_resin_[r];
        const std::vector<std::size_t> moving = base ? free : std::vector<std::size_t>{r};
        std::vector<ResinPoint> resins;
        const auto chi2 = [&](double ln_sigma_t) {
            resins = fit.resins;
            resins[r].ln_sigma_t = ln_sigma_t;
            return solve(of, channel, moving, base, resins, fit.evaluations, {r});
        };
        const double least = chi2(at);
        if (chi2(high) > least + 1) continue;
        double below = std::log(bounds_.least_sigma_t), above = at;
        limited[r] = fit.resins[r];
        for (int step = 0; step < 9 && above - below > 0.03; ++step) {
            const double middle = std::max(0.5 * (below + above), above - 1);
            const bool allowed = chi2(middle) <= least + 1;
            (allowed ? above : below) = middle;
            if (allowed) limited[r] = resins[r];
        }
        fit.opaque[r] = true;
    }
    if (std::ranges::find(fit.opaque, true) == fit.opaque.end()) return;
    // The others stay at the least squares: a limit must not lean on them.
    fit.resins = std::move(limited);
    errors(channel, free, fit);
}

void ChannelFitter::errors(std::size_t channel, const std::vector<std::size_t>& free, ChannelFit& fit) const {
    int evaluations = 0;
    const Residuals residuals(*this, whole_, channel, free, true, fit.resins, evaluations);
    const auto rows = static_cast<Eigen::Index>(residuals.rows()), columns = static_cast<Eigen::Index>(2 * free.size());
    Eigen::MatrixXd J(rows, columns);
    Eigen::VectorXd r(rows), x(columns);
    std::vector<const double*> at;
    std::vector<double*> into;
    for (Eigen::Index i = 0; i < columns; ++i) {
        const ResinPoint& point = fit.resins[free[static_cast<std::size_t>(i / 2)]];
        x[i] = i % 2 == 0 ? point.v : point.ln_sigma_t;
        at.push_back(&x[i]);
        into.push_back(J.col(i).data());
    }
    (void)residuals.Evaluate(at.data(), r.data(), into.data());
    fit.predicted = residuals.rho();
    fit.chi2 = r.squaredNorm();
    // What no patch tells has an eigenvalue of nothing: its error is without bound.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(J.transpose() * J);
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(1e-12);
    const Eigen::MatrixXd covariance =
        eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
    const Eigen::VectorXd step = -covariance * (J.transpose() * r);
    fit.beyond = fit.resins;
    for (std::size_t k = 0; k < free.size(); ++k) {
        const auto i = static_cast<Eigen::Index>(2 * k);
        fit.beyond[free[k]].v += step[i], fit.beyond[free[k]].ln_sigma_t += step[i + 1];
        const double v = std::sqrt(covariance(i, i)), s = std::sqrt(covariance(i + 1, i + 1));
        fit.errors[free[k]] = {v, s};
        for (std::size_t other = 0; other < free.size(); ++other)
            fit.covariance.block<2, 2>(static_cast<Eigen::Index>(2 * free[k]),
                                       static_cast<Eigen::Index>(2 * free[other])) =
                covariance.block<2, 2>(i, static_cast<Eigen::Index>(2 * other));
    }
}

// How far each resin went from what was known of it.
void ChannelFitter::compare_with_prior(std::size_t channel, ChannelFit& fit) const {
    for (std::size_t r = 0; r < roles_.roles.size(); ++r) {
        const PriorValue known = prior(r, channel);
        const Eigen::Vector2d off(fit.resins[r].v - known.at.v, fit.resins[r].ln_sigma_t - known.at.ln_sigma_t);
        fit.prior_chi2.push_back(off.dot(known.precision * off));
        fit.freedom += known.known();
    }
}

ChannelFit ChannelFitter::fit(std::size_t channel) const {
    const std::size_t count = roles_.roles.size();
    ChannelStart start = principles_.start(channel);
    start_at_prior(channel, start);
    ChannelFit fit;
    fit.resins = start.resins;
    fit.errors.assign(count, {0, 0});
    fit.covariance.setZero(static_cast<Eigen::Index>(2 * count), static_cast<Eigen::Index>(2 * count));
    fit.second.assign(count, false);
    fit.opaque.assign(count, false);
    std::vector<std::size_t> free;
    int values = 0;
    for (std::size_t r = 0; r < count; ++r) {
        if (!fitted_[r]) continue;
        free.push_back(r);
        values += roles_.is_clear(r) ? 1 : 2;
        if (roles_.is_clear(r)) fit.resins[r] = {1, std::log(usual_clear)};
    }
    choose_minima(channel, start, fit);
    solve(whole_, channel, free, true, fit.resins, fit.evaluations);
    errors(channel, free, fit);
    fit.least_chi2 = fit.chi2;
    limit_opaque(channel, free, fit);
    fit.freedom = static_cast<int>(whole_.patches.size()) - values;
    if (!prior_.resins.empty()) compare_with_prior(channel, fit);
    for (std::size_t r = 0; r < count; ++r) {
        const ResinPoint& p = fit.resins[r];
        const ResinBounds bounds = bounds_of(r);
        fit.v_low.push_back(p.v <= bounds.least_v + 1e-6);
        fit.v_high.push_back(p.v >= bounds.most_v - 1e-6);
        fit.sigma_low.push_back(p.ln_sigma_t <= std::log(bounds.least_sigma_t) + 1e-6);
        fit.sigma_high.push_back(p.ln_sigma_t >= std::log(bounds.most_sigma_t) - 1e-6);
    }
    return fit;
}

}  // namespace voxtone::calibration
