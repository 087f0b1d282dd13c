// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/radial_average.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>

#include "base/contracts.h"
#include "base/error.h"

namespace voxtone::calibration {
namespace {

using std::numbers::pi;
constexpr int sectors = 8;

// A symmetric matrix with one diagonal beside the main one.
struct Tridiagonal {
    std::vector<double> on, beside;
    explicit Tridiagonal(std::size_t n) : on(n), beside(n - 1) {}
    void add(const RingPixel& p, double times) {
        on[p.ring] += times * (1 - p.t) * (1 - p.t);
        on[p.ring + 1] += times * p.t * p.t;
        beside[p.ring] += times * p.t * (1 - p.t);
    }
    [[nodiscard]] Eigen::SparseMatrix<double> matrix() const {
        std::vector<Eigen::Triplet<double>> entries;
        const int n = static_cast<int>(on.size());
        for (int i = 0; i < n; ++i) entries.emplace_back(i, i, on[static_cast<std::size_t>(i)]);
        for (int i = 0; i + 1 < n; ++i) {
            entries.emplace_back(i, i + 1, beside[static_cast<std::size_t>(i)]);
            entries.emplace_back(i + 1, i, beside[static_cast<std::size_t>(i)]);
        }
        Eigen::SparseMatrix<double> result(n, n);
        result.setFromTriplets(entries.begin(), entries.end());
        return result;
    }
};

struct NormalEquations {
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> solver;
    Eigen::VectorXd light;
    std::size_t missing = 0;
};

void solve(const MergedPicture& picture, int channel, const RadialPlan& plan, NormalEquations& equations) {
    VOXTONE_EXPECT(plan.samples >= 4 && plan.mm_per_px > 0 && plan.mm_per_px <= plan.spacing_mm);
    Tridiagonal N(plan.samples);
    std::vector<std::size_t> used(plan.samples), missing(plan.samples);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(plan.samples));
    for_ring_pixels(picture, channel, plan, [&](const RingPixel& p) {
        if (!(p.weight > 0)) {
            ++missing[p.ring];
            return;
        }
        ++used[p.ring];
        N.add(p, 1);
        const auto i = static_cast<Eigen::Index>(p.ring);
        b[i] += (1 - p.t) * p.light;
        b[i + 1] += p.t * p.light;
    });
    for (std::size_t i = 0; i + 1 < plan.samples; ++i) {
        equations.missing += missing[i];
        if (4 * missing[i] > used[i])
            throw InputError(fmt::format(
                "{} of {} pixels about {:.3f} mm from the centre of the spot are saturated in every exposure; "
                "begin the series with shorter ones",
                missing[i], missing[i] + used[i], static_cast<double>(i) * plan.spacing_mm));
    }
    equations.solver.compute(N.matrix());
    equations.light = equations.solver.solve(b);
}

// The light of straight lines between samples, over the plane, is the inner product of this with them.
Eigen::VectorXd ring_areas(std::size_t samples, double h) {
    const auto n = static_cast<Eigen::Index>(samples) - 1;
    Eigen::VectorXd areas(n + 1);
    for (Eigen::Index i = 0; i <= n; ++i) areas[i] = 2 * pi * h * h * static_cast<double>(i);
    areas[0] = pi * h * h / 3;
    areas[n] = pi * h * h * (static_cast<double>(n) - 1.0 / 3);
    return areas;
}

// How pixels scatter about the profile: per ring for noise, per eighth of a ring for what is not round.
struct Scatter {
    std::vector<double> chi2, count;
    std::array<std::vector<double>, sectors> sum, variance, pixels;
    double signal = 0;

    explicit Scatter(std::size_t rings) : chi2(rings), count(rings) {
        for (auto* list : {&sum, &variance, &pixels})
            for (auto& sector : *list) sector.assign(rings, 0);
    }

    void add(const RingPixel& p, double model) {
        const double away = p.light - model;
        chi2[p.ring] += p.weight * away * away;
        count[p.ring] += 1;
        signal += model * model;
        const double turn = std::atan2(p.offset_px.y(), p.offset_px.x()) / (2 * pi) + 0.5;
        const auto s = static_cast<std::size_t>(std::min<double>(sectors - 1, std::floor(sectors * turn)));
        sum[s][p.ring] += away, variance[s][p.ring] += 1 / p.weight, pixels[s][p.ring] += 1;
    }

    // How much larger variances are than said, about each ring.
    [[nodiscard]] std::vector<double> pooled() const {
        std::vector<double> result(chi2.size());
        for (std::size_t i = 0; i < chi2.size(); ++i) {
            std::size_t low = i, high = i;
            double sum2 = chi2[i], n = count[i];
            while (n < static_cast<double>(pooled_pixels) && (low > 0 || high + 1 < chi2.size())) {
                if (low > 0) --low, sum2 += chi2[low], n += count[low];
                if (high + 1 < chi2.size()) ++high, sum2 += chi2[high], n += count[high];
            }
            result[i] = n > 0 ? sum2 / n : 1;
        }
        return result;
    }

    [[nodiscard]] double asymmetry(const std::vector<double>& larger) const {
        double away = 0;
        for (std::size_t s = 0; s < sectors; ++s)
            for (std::size_t i = 0; i < chi2.size(); ++i)
                if (pixels[s][i] > 0) away += (sum[s][i] * sum[s][i] - larger[i] * variance[s][i]) / pixels[s][i];
        return signal > 0 ? std::sqrt(std::max(0.0, away) / signal) : 0;
    }
};

}  // namespace

std::vector<double> fit_rings(const MergedPicture& picture, int channel, const RadialPlan& plan) {
    NormalEquations equations;
    solve(picture, channel, plan, equations);
    return {equations.light.begin(), equations.light.end()};
}

RadialProfile average_rings(const MergedPicture& picture, int channel, const RadialPlan& plan, double total) {
    NormalEquations equations;
    solve(picture, channel, plan, equations);
    const Eigen::VectorXd& light = equations.light;
    const Eigen::VectorXd areas = ring_areas(plan.samples, plan.spacing_mm);
    const double sum = areas.dot(light);
    if (!(sum > 0)) throw InputError("there is no more light than in the dark frames; are they in the right order?");

    Scatter scatter(plan.samples - 1);
    for_ring_pixels(picture, channel, plan, [&](const RingPixel& p) {
        if (p.weight > 0) scatter.add(p, p.between(light));
    });
    const std::vector<double> larger = scatter.pooled();
    Tridiagonal spread(plan.samples);
    for_ring_pixels(picture, channel, plan, [&](const RingPixel& p) {
        if (p.weight > 0) spread.add(p, larger[p.ring] / p.weight);
    });
    const Eigen::SparseMatrix<double> M = spread.matrix();

    // f_i / sum: noise of the sample, less what it has in common with the sum.
    const Eigen::VectorXd of_sum = equations.solver.solve(areas), M_of_sum = M * of_sum;
    const double sum_variance = of_sum.dot(M_of_sum);
    const Eigen::VectorXd common = equations.solver.solve(M_of_sum);
    RadialProfile profile;
    profile.scale = total / sum;
    profile.scale_error = std::sqrt(sum_variance) / sum;
    Eigen::VectorXd one = Eigen::VectorXd::Zero(light.size());
    for (Eigen::Index i = 0; i < light.size(); ++i) {
        one[i] = 1;
        const Eigen::VectorXd of_sample = equations.solver.solve(one);
        one[i] = 0;
        const double share = light[i] / sum,
                     variance = of_sample.dot(M * of_sample) - 2 * share * common[i] + share * share * sum_variance;
        profile.light.push_back(profile.scale * light[i]);
        profile.error.push_back(profile.scale * std::sqrt(std::max(0.0, variance)));
    }
    double chi2 = 0, count = 0;
    for (std::size_t i = 0; i < scatter.chi2.size(); ++i) chi2 += scatter.chi2[i], count += scatter.count[i];
    profile.noise = std::sqrt(chi2 / count);
    profile.asymmetry = scatter.asymmetry(larger);
    profile.missing = equations.missing;
    return profile;
}

}  // namespace voxtone::calibration
