// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/resin_hint.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace voxtone::calibration {

namespace {

// A print by light paths of the very resins that were predicted errs as 28 % more yellow would, by the fast predictor's
// own errors, and that explains 0.40 of what is left (tests/cli/compare_test.cpp, j750-opaque): less than half names
// nothing.
constexpr double least_explained = 0.5, least_change = 0.03, least_errors = 5, least_lead = 0.05;
constexpr std::size_t least_samples = 12;

/// Less their weighted means, channel by channel.
std::vector<Eigen::Vector3d> about_means(std::vector<Eigen::Vector3d> values, std::span<const ResinSample> samples) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += samples[i].weight * values[i], weight += samples[i].weight;
    for (Eigen::Vector3d& value : values) value -= sum / weight;
    return values;
}

}  // namespace

ResinHints hint_at_resins(std::span<const ResinSample> samples, std::size_t resins) {
    ResinHints hints;
    hints.resins.resize(resins);
    if (samples.size() < least_samples || resins == 0) return hints;
    std::vector<Eigen::Vector3d> y;
    for (const ResinSample& sample : samples) y.push_back(sample.log_ratio);
    y = about_means(std::move(y), samples);
    double all = 0;
    for (std::size_t i = 0; i < y.size(); ++i) all += samples[i].weight * y[i].squaredNorm();
    for (std::size_t r = 0; r < resins; ++r) {
        std::vector<Eigen::Vector3d> s;
        for (const ResinSample& sample : samples) s.push_back(sample.by_extinction[r]);
        s = about_means(std::move(s), samples);
        double sy = 0, ss = 0;
        for (std::size_t i = 0; i < y.size(); ++i) {
            sy += samples[i].weight * s[i].dot(y[i]);
            ss += samples[i].weight * s[i].squaredNorm();
        }
        if (!(ss > 1e-9) || !(all > 0)) continue;
        ResinHint& hint = hints.resins[r];
        hint.change = sy / ss;
        hint.explained = sy * sy / (ss * all);
        hint.error = std::sqrt(std::max(all - sy * sy / ss, 0.0) / (3.0 * double(y.size()) - 4) / ss);
    }
    std::size_t best = 0;
    double second = 0;
    for (std::size_t r = 1; r < resins; ++r)
        if (hints.resins[r].explained > hints.resins[best].explained) best = r;
    for (std::size_t r = 0; r < resins; ++r)
        if (r != best) second = std::max(second, hints.resins[r].explained);
    const ResinHint& hint = hints.resins[best];
    if (hint.explained >= least_explained && std::abs(hint.change) >= least_change &&
        std::abs(hint.change) >= least_errors * hint.error && hint.explained >= second + least_lead)
        hints.named = best;
    return hints;
}

}  // namespace voxtone::calibration
