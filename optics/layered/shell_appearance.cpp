// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/shell_appearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/layered/adding_doubling.h"
#include "optics/layered/directional.h"
#include "optics/layered/layered_appearance.h"
#include "optics/numerics/bicubic_table.h"
#include "optics/scene/sheet.h"

namespace voxtone::optics {

namespace {

// Grid of the table. With these scales (in units of 1/shell_mm) the spline stays within 2e-6 of the function for shells
// of 0.1 to 5 mm, mixtures with clear resin included: thin media vary like tau ln(tau), which wants small scales.
constexpr int absorption_samples = 48;
constexpr int scattering_samples = 40;
constexpr double absorption_scale = 0.02;
constexpr double scattering_scale = 0.02;

Admittance core_law(const OrdinatePlan& plan, const Medium& core, const Medium& clear, const ShellGeometry& geometry,
                    Backing backing, double sent_back) {
    if (std::isinf(geometry.core_mm)) return half_space(plan, core);
    const auto below = [&] {
        switch (backing) {
            case Backing::none:
                return Admittance::air(plan, true);
            case Backing::black:
                return Admittance::air(plan, false);
            case Backing::white:
                return Admittance::white_sheet(plan);
            case Backing::sheet:
                return Admittance::white_sheet(plan, sent_back);
        }
        VOXTONE_EXPECT(!"a backing that is known");
        return Admittance::black(plan);
    }();
    const std::array layers{LayerOf{core, geometry.core_mm}, LayerOf{clear, geometry.under_mm}};
    return layered_admittance(plan, layers, below);
}

/// What lies under the shell, and what is taken off: of light from behind, what black under it would show.
struct Below {
    Admittance core;
    std::optional<Admittance> less;
};
Below below_shell(const OrdinatePlan& plan, const Medium& core, const Medium& clear, const ShellGeometry& geometry,
                  double sent_back) {
    if (!geometry.from_behind) return {core_law(plan, core, clear, geometry, geometry.backing, sent_back), {}};
    return {core_law(plan, core, clear, geometry, Backing::none, 0),
            core_law(plan, core, clear, geometry, Backing::black, 0)};
}

double appearance_over(const OrdinatePlan& plan, const Medium& shell, const Medium& clear,
                       const ShellGeometry& geometry, const Below& below) {
    const std::array layers{LayerOf{clear, geometry.over_mm}, LayerOf{shell, geometry.shell_mm}};
    const double seen = layered_appearance(plan, layers, below.core);
    return below.less ? seen - layered_appearance(plan, layers, *below.less) : seen;
}

/// What a sheet lets in again (sheet.h); 0 where there is none.
double sent_back_of(const ResinSet& set, const ShellGeometry& geometry, std::size_t channel) {
    if (geometry.backing != Backing::sheet) return 0;
    return share_sent_back(geometry.sheet[channel], reflectance_in_air(set.eta));
}

/// Nothing to light where there is none.
Medium clear_of(const ResinSet& set, const ShellGeometry& geometry, std::size_t channel) {
    if (geometry.clear_resin < 0) return {0, 0};
    return set.resins[static_cast<std::size_t>(geometry.clear_resin)].medium(channel);
}

}  // namespace

struct ShellAppearance::Tables {
    ResinSet set;
    ShellGeometry geometry;
    double inverse_absorption_scale, inverse_scattering_scale;  // mm
    std::vector<BicubicTable> tables;                           // per channel
    EffectiveMedium medium;
    std::vector<double> white;  // per channel

    Tables(const ResinSet& resins, const ShellGeometry& shell);
    void tabulate(std::size_t channel, const OrdinatePlan& plan);

    [[nodiscard]] Medium mix(std::span<const double> fractions, std::size_t channel) const {
        const Medium mixed = medium(fractions, channel);
        // Shares a rounding below 0 must not leave the table.
        return {std::max(mixed.sigma_a, 0.0), std::max(mixed.sigma_s, 0.0)};
    }

    [[nodiscard]] double value(std::span<const double> fractions, std::size_t channel) const {
        const Medium mixed = mix(fractions, channel);
        return tables[channel](std::log1p(mixed.sigma_a * inverse_absorption_scale),
                               std::log1p(mixed.sigma_s * inverse_scattering_scale));
    }

    // Value and gradient, both times `factor`.
    double with_gradient(std::span<const double> fractions, std::size_t channel, double factor,
                         std::span<double> gradient) const {
        const EffectiveMedium::Point at = medium.at(fractions, channel);
        const double x = 1 + std::max(at.medium.sigma_a, 0.0) * inverse_absorption_scale,
                     y = 1 + std::max(at.medium.sigma_s, 0.0) * inverse_scattering_scale;
        const BicubicTable::Value value = tables[channel].with_gradient(std::log(x), std::log(y));
        medium.gradient(at, channel, factor * value.df_dx * inverse_absorption_scale / x,
                        factor * value.df_dy * inverse_scattering_scale / y, gradient);
        return factor * value.f;
    }
};

ShellAppearance::Tables::Tables(const ResinSet& resins, const ShellGeometry& shell)
    : set(resins), geometry(shell), medium(resins, shell.pitch_mm, shell.seen) {
    set.validate();
    VOXTONE_EXPECT(shell.shell_mm > 0 && std::isfinite(shell.shell_mm) && shell.core_mm > 0);
    VOXTONE_EXPECT(shell.core_resin >= 0 && static_cast<std::size_t>(shell.core_resin) < set.resins.size());
    VOXTONE_EXPECT(!shell.from_behind || std::isfinite(shell.core_mm));
    VOXTONE_EXPECT(shell.backing != Backing::sheet || shell.sheet.size() == set.channels.size());
    VOXTONE_EXPECT((shell.over_mm == 0 && shell.under_mm == 0) ||
                   (shell.clear_resin >= 0 && static_cast<std::size_t>(shell.clear_resin) < set.resins.size()));
    VOXTONE_EXPECT(shell.white() >= 0 && static_cast<std::size_t>(shell.white()) < set.resins.size());
    inverse_absorption_scale = shell.shell_mm / absorption_scale;
    inverse_scattering_scale = shell.shell_mm / scattering_scale;
    const std::size_t channels = set.channels.size();
    tables.resize(channels);
    white.resize(channels);
    const OrdinatePlan plan = appearance_plan(set.g, set.eta);
    for (std::size_t c = 0; c < channels; ++c) tabulate(c, plan);
}

void ShellAppearance::Tables::tabulate(std::size_t channel, const OrdinatePlan& plan) {
    const Medium core = set.resins[static_cast<std::size_t>(geometry.core_resin)].medium(channel);
    const Medium clear = clear_of(set, geometry, channel);
    const double sent_back = sent_back_of(set, geometry, channel);
    const Below below = below_shell(plan, core, clear, geometry, sent_back);
    // A range of nothing (no resin absorbs, say) still needs an interval to stand on.
    const Medium most = medium.bound(channel);
    const double most_a = std::max(most.sigma_a, 1e-6 / inverse_absorption_scale),
                 most_s = std::max(most.sigma_s, 1e-6 / inverse_scattering_scale);
    const double x_max = std::log1p(most_a * inverse_absorption_scale),
                 y_max = std::log1p(most_s * inverse_scattering_scale);
    Eigen::MatrixXd samples(absorption_samples, scattering_samples);
    const std::size_t count = absorption_samples * scattering_samples;
    parallel_for(0, count, 16, [&](std::size_t k) {
        const auto i = static_cast<Eigen::Index>(k % absorption_samples),
                   j = static_cast<Eigen::Index>(k / absorption_samples);
        const Medium shell{
            std::expm1(x_max * static_cast<double>(i) / (absorption_samples - 1)) / inverse_absorption_scale,
            std::expm1(y_max * static_cast<double>(j) / (scattering_samples - 1)) / inverse_scattering_scale};
        samples(i, j) = appearance_over(plan, shell, clear, geometry, below);
    });
    tables[channel] = BicubicTable(samples, x_max, y_max);
    const Medium white_medium = set.resins[static_cast<std::size_t>(geometry.white())].medium(channel);
    white[channel] = appearance_over(plan, white_medium, clear, geometry,
                                     below_shell(plan, white_medium, clear, geometry, sent_back));
}

ShellAppearance::ShellAppearance(const ResinSet& resins, const ShellGeometry& geometry)
    : tables_(std::make_shared<const Tables>(resins, geometry)) {}

std::size_t ShellAppearance::channels() const { return tables_->tables.size(); }
std::size_t ShellAppearance::resins() const { return tables_->set.resins.size(); }
const ShellGeometry& ShellAppearance::geometry() const { return tables_->geometry; }
const ResinSet& ShellAppearance::set() const { return tables_->set; }
std::span<const double> ShellAppearance::white_appearance() const { return tables_->white; }

void ShellAppearance::appearance(std::span<const double> fractions, std::span<double> out) const {
    VOXTONE_EXPECT(fractions.size() == resins() && out.size() == channels());
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = tables_->value(fractions, c);
}

void ShellAppearance::media_relative(std::span<const double> fractions, std::span<double> out) const {
    VOXTONE_EXPECT(fractions.size() == resins() && out.size() == channels());
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = tables_->value(fractions, c) / tables_->white[c];
}

std::vector<double> ShellAppearance::appearance(std::span<const double> fractions) const {
    std::vector<double> out(channels());
    appearance(fractions, out);
    return out;
}

std::vector<double> ShellAppearance::media_relative(std::span<const double> fractions) const {
    std::vector<double> out(channels());
    media_relative(fractions, out);
    return out;
}

void ShellAppearance::appearance(std::span<const double> fractions, std::span<double> out,
                                 std::span<double> gradient) const {
    VOXTONE_EXPECT(fractions.size() == resins() && out.size() == channels() &&
                   gradient.size() == resins() * channels());
    for (std::size_t c = 0; c < out.size(); ++c) {
        out[c] = tables_->with_gradient(fractions, c, 1, gradient.subspan(c * fractions.size(), fractions.size()));
    }
}

void ShellAppearance::media_relative(std::span<const double> fractions, std::span<double> out,
                                     std::span<double> gradient) const {
    VOXTONE_EXPECT(fractions.size() == resins() && out.size() == channels() &&
                   gradient.size() == resins() * channels());
    for (std::size_t c = 0; c < out.size(); ++c) {
        out[c] = tables_->with_gradient(fractions, c, 1 / tables_->white[c],
                                        gradient.subspan(c * fractions.size(), fractions.size()));
    }
}

std::vector<double> ShellAppearance::exact(std::span<const double> fractions) const {
    VOXTONE_EXPECT(fractions.size() == resins());
    const ResinSet& set = tables_->set;
    const ShellGeometry& geometry = tables_->geometry;
    const AngularGrid grid = angular_grid(set.eta, 8, 8);
    const AddingDoubling solver(grid, set.g, 32);
    std::vector<double> out(channels());
    for (std::size_t c = 0; c < out.size(); ++c) {
        const Medium core = set.resins[static_cast<std::size_t>(geometry.core_resin)].medium(c);
        const Medium clear = clear_of(set, geometry, c);
        LayerResponse shell = solver.layer(tables_->mix(fractions, c), geometry.shell_mm);
        if (geometry.over_mm > 0) shell = solver.add(solver.layer(clear, geometry.over_mm), shell);
        if (std::isinf(geometry.core_mm)) {
            out[c] = appearance_of(grid, solver.over(shell, solver.half_space(core)));
        } else {
            LayerResponse whole = solver.add(shell, solver.layer(core, geometry.core_mm));
            if (geometry.under_mm > 0) whole = solver.add(whole, solver.layer(clear, geometry.under_mm));
            out[c] = geometry.from_behind
                         ? appearance_of(grid, whole, Backing::none) - appearance_of(grid, whole, Backing::black)
                         : appearance_of(grid, whole, geometry.backing, sent_back_of(set, geometry, c));
        }
    }
    return out;
}

}  // namespace voxtone::optics
