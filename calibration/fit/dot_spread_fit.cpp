// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/dot_spread_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <span>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "calibration/fit/channel_fit.h"

namespace voxtone::calibration {

namespace {

constexpr double refused_beyond = 10.83;  // chi2 of one value, exceeded once in a thousand times
constexpr double golden_tolerance = 0.01;
constexpr double parabola_step = 0.05;

// chi2 of spreads, each with the resins that suit it best.
class SpreadProfile {
public:
    SpreadProfile(const PatchTable& table, const TargetRoles& roles, const PatchModelOptions& model, double noise,
                  const ResinPrior& prior, const Progress* progress)
        : table_(table), roles_(roles), model_(model), noise_(noise), prior_(prior), progress_(progress) {}

    [[nodiscard]] std::vector<double> operator()(std::span<const double> spreads) {
        const std::size_t channels = table_.channels.size();
        std::deque<ChannelFitter> fitters;  // they stay where they are
        for (const double spread : spreads) {
            PatchModelOptions model = model_;
            model.dot_spread = spread;
            fitters.emplace_back(table_, roles_, model, noise_, prior_);
        }
        std::vector<ChannelFit> fits(spreads.size() * channels);
        parallel_for(
            0, fits.size(), 1, [&](std::size_t i) { fits[i] = fitters[i / channels].fit(i % channels); }, progress_);
        freedom_ = static_cast<double>(channels) * fits.front().freedom - 1;
        std::vector<double> chi2(spreads.size(), 0.0);
        for (std::size_t i = 0; i < fits.size(); ++i) chi2[i / channels] += fits[i].least_chi2;
        return chi2;
    }
    [[nodiscard]] double at(double spread) { return (*this)(std::array{spread}).front(); }
    /// Values of all channels that are left over.
    [[nodiscard]] double freedom() const { return freedom_; }

private:
    const PatchTable& table_;
    const TargetRoles& roles_;
    const PatchModelOptions& model_;
    double noise_;
    const ResinPrior& prior_;
    const Progress* progress_;
    double freedom_ = 0;
};

}  // namespace

bool has_mixtures(const PatchTable& table) {
    return std::ranges::any_of(table.patches, [](const Patch& patch) { return patch.top.size() > 1; });
}

DotSpreadFit fit_dot_spread(const PatchTable& table, const TargetRoles& roles, const PatchModelOptions& model,
                            double noise, const ResinPrior& prior, const Progress* progress) {
    VOXTONE_EXPECT(!model.ideal_mixtures());
    if (!has_mixtures(table)) return {};
    SpreadProfile chi2(table, roles, model, noise, prior, progress);
    constexpr std::array net{0.0, 0.25, 0.5, 0.75, 1.0};
    const std::vector<double> of_net = chi2(net);
    if (!(chi2.freedom() > 0)) return {};
    const auto best = static_cast<std::size_t>(std::ranges::min_element(of_net) - of_net.begin());
    const double scale = std::max(1.0, of_net[best] / chi2.freedom());
    DotSpreadFit fit{net[best], 0, (of_net.front() - of_net[best]) / scale, (of_net.back() - of_net[best]) / scale};
    if (std::max(fit.sharp, fit.ideal) < refused_beyond) return fit;

    double low = net[best > 0 ? best - 1 : 0], high = net[std::min(best + 1, net.size() - 1)];
    constexpr double ratio = std::numbers::phi - 1;
    double left = high - ratio * (high - low), right = low + ratio * (high - low);
    double of_left = chi2.at(left), of_right = chi2.at(right);
    while (high - low > golden_tolerance) {
        if (of_left < of_right) {
            high = right, right = left, of_right = of_left;
            left = high - ratio * (high - low), of_left = chi2.at(left);
        } else {
            low = left, left = right, of_left = of_right;
            right = low + ratio * (high - low), of_right = chi2.at(right);
        }
    }
    if (std::min(of_left, of_right) < of_net[best]) fit.value = of_left < of_right ? left : right;

    const double middle = std::clamp(fit.value, parabola_step, 1 - parabola_step);
    const std::vector<double> around = chi2(std::array{middle - parabola_step, middle, middle + parabola_step});
    const double curvature = (around[0] - 2 * around[1] + around[2]) / (2 * parabola_step * parabola_step);
    if (curvature > 0) fit.error = std::sqrt(scale / curvature);
    return fit;
}

}  // namespace voxtone::calibration
