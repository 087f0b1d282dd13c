// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/resin_hint.h"
#include "optics/numerics/dense.h"
#include "optics/numerics/median.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace voxtone::calibration {

namespace {

constexpr std::size_t least_samples = 12;
constexpr double usual_change = 0.025;  // by which an extinction is off without being to blame, relative
constexpr double blamed_change = 0.12;  // by which one is that is: what refit.h knows of a resin
constexpr double least_change = 0.04;
const double least_lead = std::log(10.0);  // strong evidence (Jeffreys 1961)

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
        const Eigen::VectorXd found = optics::symmetric_preimage(normal, right);
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

struct Evidence {
    double log_likelihood = 0;  ///< but for what is the same for all deviations
    Eigen::VectorXd change;
    Eigen::MatrixXd covariance;
};

/// Of changes whose deviations are these, all together: `gram` and `right` of the normal equations, over the noise.
Evidence evidence_of(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, const Eigen::VectorXd& deviation) {
    const Eigen::MatrixXd scaled = deviation.asDiagonal() * gram * deviation.asDiagonal();
    const Eigen::MatrixXd sum = scaled + Eigen::MatrixXd::Identity(gram.rows(), gram.rows());
    const Eigen::LLT<Eigen::MatrixXd> factor(sum);
    const Eigen::VectorXd scaled_right = deviation.cwiseProduct(right), change = factor.solve(scaled_right);
    Evidence evidence;
    evidence.log_likelihood = 0.5 * scaled_right.dot(change);
    for (Eigen::Index k = 0; k < sum.rows(); ++k) evidence.log_likelihood -= std::log(factor.matrixL()(k, k));
    evidence.change = deviation.cwiseProduct(change);
    evidence.covariance = deviation.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(sum.rows(), sum.rows())) *
                          deviation.asDiagonal();
    return evidence;
}

}  // namespace

ResinHints hint_at_resins(std::span<const ResinSample> all_samples, std::size_t resins) {
    ResinHints hints;
    hints.resins.resize(resins);
    if (all_samples.size() < least_samples || resins == 0) return hints;
    const std::vector<ResinSample> samples = without_outliers(all_samples, resins);
    const Levelled levelled(samples);
    const auto levelled_of = [&](const auto& of) {
        std::vector<Eigen::Vector3d> values;
        for (const ResinSample& sample : samples) values.push_back(of(sample));
        return levelled(std::move(values));
    };
    const std::vector<Eigen::Vector3d> y = levelled_of([](const ResinSample& sample) { return sample.log_ratio; });
    std::vector<std::vector<Eigen::Vector3d>> by;
    for (std::size_t r = 0; r < resins; ++r)
        by.push_back(levelled_of([r](const ResinSample& sample) { return sample.by_extinction[r]; }));
    const auto dot = [&](const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += samples[i].weight * a[i].dot(b[i]);
        return sum;
    };
    const auto n = Eigen::Index(resins);
    Eigen::MatrixXd gram(n, n);
    Eigen::VectorXd right(n);
    for (Eigen::Index r = 0; r < n; ++r) {
        right[r] = dot(by[std::size_t(r)], y);
        for (Eigen::Index q = 0; q < n; ++q) gram(r, q) = dot(by[std::size_t(r)], by[std::size_t(q)]);
    }
    const double all = dot(y, y);
    if (!(all > 0)) return hints;
    // Noise: what all resins together leave.
    constexpr double ridge = 1e-9;
    const Eigen::VectorXd together =
        optics::symmetric_preimage(Eigen::MatrixXd(gram + ridge * Eigen::MatrixXd::Identity(n, n)), right);
    const double freedom = 3.0 * double(y.size()) - double(unknowns) - double(resins);
    const double noise2 = std::max(all - together.dot(right), 1e-12 * all) / std::max(freedom, 1.0);

    const auto usually = [&](std::size_t to_blame) {
        Eigen::VectorXd deviation = Eigen::VectorXd::Constant(n, usual_change);
        if (to_blame < resins) deviation[Eigen::Index(to_blame)] = blamed_change;
        return deviation;
    };
    const Evidence none = evidence_of(gram / noise2, right / noise2, usually(resins));
    std::vector<double> lead(resins, 0.0);
    for (std::size_t r = 0; r < resins; ++r) {
        const auto k = Eigen::Index(r);
        if (!(gram(k, k) > 1e-9)) continue;
        const Evidence evidence = evidence_of(gram / noise2, right / noise2, usually(r));
        hints.resins[r] = {.change = evidence.change[k],
                           .error = std::sqrt(evidence.covariance(k, k)),
                           .explained = right[k] * right[k] / (gram(k, k) * all)};
        lead[r] = evidence.log_likelihood - none.log_likelihood;
    }
    const auto best = std::size_t(std::ranges::max_element(lead) - lead.begin());
    double second = 0;
    for (std::size_t r = 0; r < resins; ++r)
        if (r != best) second = std::max(second, lead[r]);
    if (lead[best] - second >= least_lead && std::abs(hints.resins[best].change) >= least_change) hints.named = best;
    return hints;
}

}  // namespace voxtone::calibration
