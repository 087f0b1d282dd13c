// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/resin_hint.h"
#include "optics/numerics/median.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace voxtone::calibration {

namespace {

// Chosen on prints by light paths (tests/cli/compare_test.cpp, examples/18-compare.sh), of which none was off, or one.
constexpr double least_explained = 0.15, least_change = 0.04, least_errors = 5, least_lead = 2;
constexpr std::size_t least_samples = 12;

constexpr Eigen::Index unknowns = 3 + light_terms;
using Terms = Eigen::Matrix<double, unknowns, 1>;

/// Gains of red, green, blue and uneven light.
Terms nuisances_of(const ResinSample& sample, Eigen::Index channel) {
    Terms all = Terms::Zero();
    all[channel] = 1;
    all.tail<light_terms>() = light_at(sample.place);
    return all;
}

/// Less what gains of red, green, blue and uneven light make of them, by weighted least squares.
class Levelled {
public:
    explicit Levelled(std::span<const ResinSample> samples) : samples_(samples) {
        Eigen::Matrix<double, unknowns, unknowns> normal = 1e-9 * decltype(normal)::Identity();
        for (const ResinSample& sample : samples)
            for (Eigen::Index k = 0; k < 3; ++k)
                normal += sample.weight * nuisances_of(sample, k) * nuisances_of(sample, k).transpose();
        factor_.compute(normal);
    }
    [[nodiscard]] std::vector<Eigen::Vector3d> operator()(std::vector<Eigen::Vector3d> values) const {
        Terms right = Terms::Zero();
        for (std::size_t i = 0; i < values.size(); ++i)
            for (Eigen::Index k = 0; k < 3; ++k)
                right += samples_[i].weight * values[i][k] * nuisances_of(samples_[i], k);
        const Terms found = factor_.solve(right);
        for (std::size_t i = 0; i < values.size(); ++i)
            for (Eigen::Index k = 0; k < 3; ++k) values[i][k] -= found.dot(nuisances_of(samples_[i], k));
        return values;
    }

private:
    std::span<const ResinSample> samples_;
    Eigen::LDLT<Eigen::Matrix<double, unknowns, unknowns>> factor_;
};

/// Regions weigh by how well all resins together explain them (Tukey's biweight): places that are off in the
/// photograph, scratches and shadows, are no resin's.
std::vector<ResinSample> without_outliers(std::span<const ResinSample> all, std::size_t resins) {
    constexpr double tukey = 4.685, to_deviation = 1.4826, ridge = 1e-4;
    constexpr int rounds = 6;
    const Eigen::Index n = unknowns + Eigen::Index(resins);
    const auto row_of = [&](const ResinSample& sample, Eigen::Index channel) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
        row.head(unknowns) = nuisances_of(sample, channel);
        for (std::size_t r = 0; r < resins; ++r) row[unknowns + Eigen::Index(r)] = sample.by_extinction[r][channel];
        return row;
    };
    std::vector<double> trust(all.size(), 1.0);
    for (int round = 0; round < rounds; ++round) {
        Eigen::MatrixXd normal = ridge * Eigen::MatrixXd::Identity(n, n);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
        for (std::size_t i = 0; i < all.size(); ++i)
            for (Eigen::Index k = 0; k < 3; ++k) {
                const Eigen::VectorXd row = row_of(all[i], k);
                normal.noalias() += trust[i] * all[i].weight * row * row.transpose();
                right += trust[i] * all[i].weight * all[i].log_ratio[k] * row;
            }
        const Eigen::VectorXd found = normal.ldlt().solve(right);
        std::vector<double> off(all.size(), 0.0);
        for (std::size_t i = 0; i < all.size(); ++i)
            for (Eigen::Index k = 0; k < 3; ++k)
                off[i] = std::max(
                    off[i], std::sqrt(all[i].weight) * std::abs(all[i].log_ratio[k] - row_of(all[i], k).dot(found)));
        const double least = 1e-6, scale = std::max(to_deviation * optics::median(off), least);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double u = off[i] / (tukey * scale);
            trust[i] = u < 1 ? std::pow(1 - u * u, 2) : 0;
        }
    }
    std::vector<ResinSample> trusted(all.begin(), all.end());
    for (std::size_t i = 0; i < all.size(); ++i) trusted[i].weight *= trust[i];
    std::erase_if(trusted, [](const ResinSample& sample) { return sample.weight == 0; });
    return trusted;
}

}  // namespace

ResinHints hint_at_resins(std::span<const ResinSample> all_samples, std::size_t resins) {
    ResinHints hints;
    hints.resins.resize(resins);
    if (all_samples.size() < least_samples || resins == 0) return hints;
    const std::vector<ResinSample> samples = without_outliers(all_samples, resins);
    std::vector<Eigen::Vector3d> y;
    for (const ResinSample& sample : samples) y.push_back(sample.log_ratio);
    const Levelled levelled(samples);
    y = levelled(std::move(y));
    double all = 0;
    for (std::size_t i = 0; i < y.size(); ++i) all += samples[i].weight * y[i].squaredNorm();
    for (std::size_t r = 0; r < resins; ++r) {
        std::vector<Eigen::Vector3d> s;
        for (const ResinSample& sample : samples) s.push_back(sample.by_extinction[r]);
        s = levelled(std::move(s));
        double sy = 0, ss = 0;
        for (std::size_t i = 0; i < y.size(); ++i) {
            sy += samples[i].weight * s[i].dot(y[i]);
            ss += samples[i].weight * s[i].squaredNorm();
        }
        if (!(ss > 1e-9) || !(all > 0)) continue;
        ResinHint& hint = hints.resins[r];
        hint.change = sy / ss;
        hint.explained = sy * sy / (ss * all);
        hint.error =
            std::sqrt(std::max(all - sy * sy / ss, 0.0) / (3.0 * double(y.size()) - double(unknowns) - 1) / ss);
    }
    std::size_t best = 0;
    double second = 0;
    for (std::size_t r = 1; r < resins; ++r)
        if (hints.resins[r].explained > hints.resins[best].explained) best = r;
    for (std::size_t r = 0; r < resins; ++r)
        if (r != best) second = std::max(second, hints.resins[r].explained);
    const ResinHint& hint = hints.resins[best];
    // Twice what another does, or half of what another leaves.
    const bool leads = hint.explained >= least_lead * second || 1 - second >= least_lead * (1 - hint.explained);
    if (hint.explained >= least_explained && leads && std::abs(hint.change) >= least_change &&
        std::abs(hint.change) >= least_errors * hint.error)
        hints.named = best;
    return hints;
}

}  // namespace voxtone::calibration
