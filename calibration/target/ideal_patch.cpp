// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/ideal_patch.h"

#include <array>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "optics/layered/directional.h"

namespace voxtone::calibration {

namespace {

constexpr double cos_45 = std::numbers::sqrt2 / 2;
constexpr int trapped = 8, escaping = 8;  // 1e-6 for calibration patches (quadrature.h)

}  // namespace

IdealPatches::IdealPatches(const optics::ResinSet& set)
    : set_(set),
      solver_(optics::angular_grid(set.eta, trapped, escaping, std::array{cos_45, 1.0}), set.g,
              2 * (trapped + escaping)) {}

std::vector<double> IdealPatches::fractions(const PatchMixture& mixture) const {
    std::vector<double> all(set_.resins.size(), 0.0);
    for (const ResinShare& share : mixture) {
        const int resin = set_.find(share.role);
        if (resin < 0) {
            std::string there;
            for (const optics::Resin& known : set_.resins) there += (there.empty() ? "" : ", ") + known.role;
            throw InputError(fmt::format("the resin set {} has no resin {}; it has {}", set_.name, share.role, there));
        }
        all[std::size_t(resin)] = share.fraction;
    }
    return all;
}

std::vector<double> IdealPatches::reflectance(const PatchMixture& top, double top_mm, const std::string& backing,
                                              double base_mm) const {
    const std::vector<double> upper = fractions(top), lower = fractions({{backing, 1.0}});
    const optics::AngularGrid& grid = solver_.grid();
    const int out = grid.find(1.0), in = grid.find(cos_45);
    std::vector<double> rho;
    for (std::size_t channel = 0; channel < set_.channels.size(); ++channel) {
        const optics::Medium base = set_.mix(lower, channel), square = set_.mix(upper, channel);
        const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(grid.size(), grid.size());
        const bool endless = base_mm <= 0 && base.sigma_t() > 0;
        Eigen::MatrixXd R = endless       ? solver_.half_space(base)
                            : base_mm > 0 ? solver_.over(solver_.layer(base, base_mm), nothing)
                                          : nothing;
        R = solver_.over(solver_.layer(square, top_mm), R);
        rho.push_back(optics::reflectance_factors(grid, R)(out, in));
    }
    return rho;
}

std::vector<std::vector<double>> IdealPatches::squares(const Target& target) const {
    std::vector<std::vector<double>> all(target.squares.size());
    parallel_for(0, all.size(), 1, [&](std::size_t s) {
        all[s] = reflectance(target.squares[s].top, target.depth_mm(target.squares[s]), target.squares[s].backing,
                             target.under_mm(target.squares[s]));
    });
    return all;
}

std::vector<double> lost_through_base(const optics::ResinSet& set, const std::string& role, double base_mm) {
    const IdealPatches patches(set);
    const PatchMixture resin{{role, 1.0}};
    std::vector<double> finite = patches.reflectance(resin, base_mm / 2, role, base_mm / 2);
    const std::vector<double> endless = patches.reflectance(resin, base_mm / 2, role, 0);
    for (std::size_t channel = 0; channel < finite.size(); ++channel)
        finite[channel] = endless[channel] - finite[channel];
    return finite;
}

}  // namespace voxtone::calibration
