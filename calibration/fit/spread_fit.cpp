// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/spread_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "calibration/patches/patch_file.h"
#include "calibration/resins/checker_contrast.h"
#include "calibration/target/square_ends.h"
#include "optics/media/lateral_spread.h"
#include "optics/media/resin_volume.h"
#include "optics/monte_carlo/monte_carlo.h"

namespace voxtone::calibration {

namespace {

using optics::Material;

constexpr double part_mm = 0.025;  // of a cell: below the least spread that printers have
constexpr int levels = 127;        // of the shares of two resins

struct CheckerValue {
    std::size_t patch, channel;
};

/// `share` of one, the rest of the other.
optics::Resin mixed(const optics::Resin& one, const optics::Resin& other, double share, std::size_t channel,
                    std::string role) {
    const optics::Medium a = one.medium(channel), b = other.medium(channel);
    const optics::Medium m{share * a.sigma_a + (1 - share) * b.sigma_a, share * a.sigma_s + (1 - share) * b.sigma_s};
    return {.name = role, .role = std::move(role), .sigma_t_per_mm = {m.sigma_t()}, .albedo = {m.albedo()}};
}

class CheckerPaths {
public:
    CheckerPaths(const PatchTable& table, const optics::ResinSet& resins, std::uint32_t paths)
        : table_(table), resins_(resins), paths_(paths) {}

    struct Seen {
        double rho, error;
    };
    [[nodiscard]] Seen operator()(const CheckerValue& value, const std::array<double, 2>& spread_mm) const {
        const Patch& patch = table_.patches[value.patch];
        // Half a cell, and half of the next: an even number of parts of a cell each.
        std::array<int, 2> parts{};
        std::array<double, 3> pitch_mm{};
        for (std::size_t a = 0; a < 2; ++a) {
            parts[a] = 2 * std::max(1, static_cast<int>(std::ceil(patch.cell_mm[a] / (2 * part_mm))));
            pitch_mm[a] = patch.cell_mm[a] / parts[a];
        }
        constexpr int top_layers = 5;
        pitch_mm[2] = patch.thickness_mm / top_layers;
        const double base_mm = patch.base_mm > 0 ? patch.base_mm : endless_mm;
        const int base_layers = std::clamp(static_cast<int>(std::lround(base_mm / pitch_mm[2])), 1, most_layers);
        const std::vector<float> shares = first_shares(parts, pitch_mm, spread_mm);
        const optics::ResinVolume volume = optics::make_resin_volume(
            {parts[0], parts[1], base_layers + top_layers}, pitch_mm, [&](int x, int y, int z) -> Material {
                if (z < base_layers) return static_cast<Material>(levels + 1);
                const float share = shares[static_cast<std::size_t>(y * parts[0] + x)];
                return static_cast<Material>(1 + std::lround(share * (levels - 1)));
            });
        const optics::ResinSet set = shades(patch, value.channel);
        const optics::Scene scene{&volume, &set, optics::Backing::black, optics::Sides::mirrored};
        const optics::Surface surface = optics::find_surface(scene, {parts[0], parts[1], 1}, optics::SurfacePart::top);
        optics::MonteCarloSummary summary;
        const optics::Appearance seen =
            optics::MonteCarlo({.paths = paths_, .seed = 1 + value.patch}).reflectance_45_0(scene, surface, summary);
        return {seen.value[0], seen.standard_error[0]};
    }

private:
    static constexpr double endless_mm = 10;
    static constexpr int most_layers = 200;

    /// Of the first resin, x fastest.
    static std::vector<float> first_shares(const std::array<int, 2>& parts, const std::array<double, 3>& pitch_mm,
                                           const std::array<double, 2>& spread_mm) {
        const optics::ResinVolume sharp = optics::make_resin_volume(
            {parts[0], parts[1], 1}, pitch_mm,
            [&](int x, int y, int) { return static_cast<Material>((x < parts[0] / 2) == (y < parts[1] / 2) ? 1 : 2); });
        const optics::LateralSpread spread(spread_mm, pitch_mm);
        optics::SpreadBox box(sharp, true, spread, 2);
        box.read({0, 0, 0}, {parts[0], parts[1], 1});
        std::vector<float> shares;
        for (std::size_t v = 0; v < static_cast<std::size_t>(parts[0] * parts[1]); ++v)
            shares.push_back(std::clamp(box.shares(v)[0], 0.0f, 1.0f));
        return shares;
    }

    /// From all of the second resin to all of the first, and the base; of one channel.
    [[nodiscard]] optics::ResinSet shades(const Patch& patch, std::size_t channel) const {
        const auto resin = [&](const std::string& role) -> const optics::Resin& {
            return resins_.resins[static_cast<std::size_t>(resins_.find(role))];
        };
        optics::ResinSet set{
            .name = resins_.name, .source = {}, .channels = {}, .g = resins_.g, .eta = resins_.eta, .resins = {}};
        set.channels.wavelengths_nm = {550};  // any one
        for (int level = 0; level < levels; ++level)
            set.resins.push_back(mixed(resin(patch.top[0].role), resin(patch.top[1].role), double(level) / (levels - 1),
                                       channel, std::to_string(level)));
        set.resins.push_back(mixed(resin(patch.backing), resin(patch.backing), 1, channel, "base"));
        return set;
    }

    const PatchTable& table_;
    const optics::ResinSet& resins_;
    std::uint32_t paths_;
};

std::vector<CheckerValue> telling_values(const PatchTable& table, const optics::ResinSet& resins) {
    constexpr std::size_t most_channels = 3;
    constexpr double of_best = 0.75, least_darker = 0.05;
    std::vector<CheckerValue> values;
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        const Patch& patch = table.patches[p];
        VOXTONE_EXPECT(patch.is_checker() && patch.top.size() == 2);
        for (const std::string& role : {patch.top[0].role, patch.top[1].role, patch.backing})
            if (resins.find(role) < 0)
                throw InputError(fmt::format("{}: checker {} holds {}, a resin of which no square tells anything.",
                                             table.source, patch_name(patch), role));
        const auto resin = [&](std::size_t k) {
            return resins.resins[static_cast<std::size_t>(resins.find(patch.top[k].role))];
        };
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t c = 0; c < resins.channels.size(); ++c) {
            const CheckerContrast of = checker_contrast(resin(0).medium(c), resin(1).medium(c), resins.g);
            if (of.darker >= least_darker) order.emplace_back(-of.per_mm, c);
        }
        std::ranges::stable_sort(order, {}, &std::pair<double, std::size_t>::first);
        for (std::size_t k = 0; k < std::min(most_channels, order.size()); ++k)
            if (order[k].first <= of_best * order[0].first) values.push_back({p, order[k].second});
    }
    return values;
}

/// What all values are off by, in their errors, as spread and resins have it.
class Residuals {
public:
    Residuals(const PatchTable& table, std::vector<CheckerValue> values, double noise, std::uint32_t paths,
              const Progress* progress)
        : table_(table), values_(std::move(values)), noise_(noise), paths_(paths), progress_(progress) {}

    /// `with`: of values that hold this resin alone, the others 0; empty: of all.
    [[nodiscard]] Eigen::VectorXd operator()(const Eigen::Vector2d& spread_mm, const optics::ResinSet& resins,
                                             const std::string& with = {}) const {
        const CheckerPaths paths(table_, resins, paths_);
        Eigen::VectorXd left = Eigen::VectorXd::Zero(size());
        parallel_for(
            0, values_.size(), 1,
            [&](std::size_t i) {
                const Patch& patch = table_.patches[values_[i].patch];
                if (!with.empty() && !holds(values_[i], with)) return;
                const auto [rho, error] = paths(values_[i], {spread_mm.x(), spread_mm.y()});
                const double read = patch.error.empty() ? noise_ : patch.error[values_[i].channel];
                left[static_cast<Eigen::Index>(i)] = (patch.rho[values_[i].channel] - rho) / std::hypot(read, error);
            },
            progress_);
        return left;
    }
    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(values_.size()); }
    [[nodiscard]] const std::vector<CheckerValue>& values() const { return values_; }

    [[nodiscard]] bool holds(const CheckerValue& value, const std::string& role) const {
        const Patch& patch = table_.patches[value.patch];
        return patch.top[0].role == role || patch.top[1].role == role || patch.backing == role;
    }

private:
    const PatchTable& table_;
    std::vector<CheckerValue> values_;
    double noise_;
    std::uint32_t paths_;
    const Progress* progress_;
};

/// Coordinates of all resins in all channels, and how far they may be from where squares have them.
class MovedResins {
public:
    MovedResins(const optics::ResinSet& resins, const ResinCovariance& squares)
        : resins_(resins), moved_(Eigen::VectorXd::Zero(at(resins.channels.size(), 0))) {
        covariance_ = Eigen::MatrixXd::Zero(moved_.size(), moved_.size());
        for (std::size_t c = 0; c < squares.size(); ++c) {
            const Eigen::Index n = squares[c].rows();
            VOXTONE_EXPECT(n <= at(1, 0) && squares.size() == resins.channels.size());
            covariance_.block(at(c, 0), at(c, 0), n, n) = within(squares[c]);
        }
    }
    [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
    [[nodiscard]] const Eigen::VectorXd& moved() const { return moved_; }
    void move_to(const Eigen::VectorXd& moved) { moved_ = moved; }
    [[nodiscard]] optics::ResinSet set() const { return set_at(moved_); }

    /// Slopes of residuals by all coordinates.
    [[nodiscard]] Eigen::MatrixXd slopes(const Residuals& residuals, const Eigen::Vector2d& spread_mm,
                                         const Eigen::VectorXd& left) const {
        constexpr double probe_v = 0.02, probe_ln = 0.05;
        Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(left.size(), moved_.size());
        if (covariance_.isZero(0)) return slope;
        for (std::size_t r = 0; r < resins_.resins.size(); ++r)
            for (const Eigen::Index k : {Eigen::Index{0}, Eigen::Index{1}}) {
                Eigen::VectorXd beside = moved_;
                for (std::size_t c = 0; c < resins_.channels.size(); ++c)
                    beside[at(c, r) + k] += k == 1 ? probe_ln : v_of(c, r) > 0.5 ? -probe_v : probe_v;
                const Eigen::VectorXd by = residuals(spread_mm, set_at(beside), resins_.resins[r].role) - left;
                for (Eigen::Index i = 0; i < left.size(); ++i) {
                    const CheckerValue& value = residuals.values()[static_cast<std::size_t>(i)];
                    const Eigen::Index to = at(value.channel, r) + k;
                    if (residuals.holds(value, resins_.resins[r].role))
                        slope(i, to) = by[i] / (beside[to] - moved_[to]);
                }
            }
        return slope;
    }

private:
    /// What no square tells is known as well as that no resin is so black, or so thin.
    static Eigen::MatrixXd within(const Eigen::MatrixXd& squares) {
        constexpr double widest_v = 0.5, widest_ln = 1;
        Eigen::VectorXd most(squares.rows());
        for (Eigen::Index i = 0; i < most.size(); ++i) most[i] = std::pow(i % 2 == 0 ? widest_v : widest_ln, 2);
        const Eigen::MatrixXd both = squares + Eigen::MatrixXd(most.asDiagonal());
        return squares * both.ldlt().solve(Eigen::MatrixXd(most.asDiagonal()));
    }
    /// Where the coordinates of a channel's resin begin.
    [[nodiscard]] Eigen::Index at(std::size_t channel, std::size_t resin) const {
        return static_cast<Eigen::Index>(2 * (channel * resins_.resins.size() + resin));
    }
    [[nodiscard]] double v_of(std::size_t channel, std::size_t resin) const {
        return point_of(resins_.resins[resin].medium(channel), resins_.g).v + moved_[at(channel, resin)];
    }
    [[nodiscard]] optics::ResinSet set_at(const Eigen::VectorXd& moved) const {
        const ResinBounds bounds = resin_bounds(resins_.g);
        optics::ResinSet set = resins_;
        for (std::size_t r = 0; r < set.resins.size(); ++r)
            for (std::size_t c = 0; c < set.channels.size(); ++c) {
                const Eigen::Index k = at(c, r);
                if (moved[k] == 0 && moved[k + 1] == 0) continue;
                ResinPoint point = point_of(resins_.resins[r].medium(c), resins_.g);
                point.v = std::clamp(point.v + moved[k], bounds.least_v, bounds.most_v),
                point.ln_sigma_t += moved[k + 1];
                set.resins[r].albedo[c] = albedo_of_v(point.v, set.g);
                set.resins[r].sigma_t_per_mm[c] = std::exp(point.ln_sigma_t);
            }
        return set;
    }

    const optics::ResinSet& resins_;
    Eigen::VectorXd moved_;
    Eigen::MatrixXd covariance_;
};

/// By spread along x and along y, from either side.
Eigen::MatrixXd slopes_by_spread(const Residuals& residuals, const optics::ResinSet& resins,
                                 const Eigen::Vector2d& at) {
    constexpr double ratio = 1.25;
    Eigen::MatrixXd slope(residuals.size(), 2);
    for (Eigen::Index a = 0; a < 2; ++a) {
        Eigen::Vector2d more = at, less = at;
        more[a] *= ratio, less[a] /= ratio;
        slope.col(a) = (residuals(more, resins) - residuals(less, resins)) / (more[a] - less[a]);
    }
    return slope;
}

Eigen::Vector2d best_of_equal(const Residuals& residuals, const optics::ResinSet& resins) {
    constexpr std::array starts_mm{0.02, 0.045, 0.09, 0.18};
    Eigen::Vector2d at;
    double least = std::numeric_limits<double>::infinity();
    for (const double start : starts_mm) {
        const Eigen::Vector2d even(start, start);
        if (const double chi2 = residuals(even, resins).squaredNorm(); chi2 < least) least = chi2, at = even;
    }
    return at;
}

}  // namespace

bool SpreadFit::is_told() const { return error[0] > 0 && (mm[0] > 2 * error[0] || mm[1] > 2 * error[1]); }

SpreadFit fit_spread(const PatchTable& checkers, const optics::ResinSet& resins, double noise,
                     const ResinCovariance& squares, std::uint32_t paths, const Progress* progress) {
    constexpr double still_mm = 5e-4;
    constexpr int most_steps = 4;
    if (paths == 0) {
        constexpr double paths_at_noise = 12000, usual_noise = 0.005, most = 60000;  // they add 3 % to the error
        paths = static_cast<std::uint32_t>(
            std::clamp(paths_at_noise * std::pow(usual_noise / noise, 2), paths_at_noise, most));
    }
    const std::vector<CheckerValue> values = telling_values(checkers, resins);
    const Residuals residuals(checkers, values, noise, paths, progress);
    SpreadFit fit;
    fit.freedom = static_cast<int>(values.size()) - 2;
    if (fit.freedom < 1)
        throw InputError(fmt::format(
            "{}: its checkers are of resins too much alike to tell how far they run; print cells of a light resin and "
            "of a dark one (calibrate target --strips).",
            checkers.source));
    Eigen::Vector2d at = best_of_equal({checkers, values, noise, std::max(paths / 4, 2u), progress}, resins);
    MovedResins moved(resins, squares);
    Eigen::VectorXd left = residuals(at, resins);
    const Eigen::MatrixXd by_resins = moved.slopes(residuals, at, left),
                          reach = moved.covariance() * by_resins.transpose();
    // Readings and resins are drawn together: what is not known of resins is noise that many values share.
    const Eigen::LDLT<Eigen::MatrixXd> spoiled(by_resins * reach + Eigen::MatrixXd::Identity(left.size(), left.size()));
    Eigen::Matrix2d curvature;
    for (int step = 0; step < most_steps; ++step) {
        const Eigen::MatrixXd by_spread = slopes_by_spread(residuals, moved.set(), at);
        const Eigen::VectorXd of_known = left - by_resins * moved.moved();
        curvature = by_spread.transpose() * spoiled.solve(by_spread);
        Eigen::Vector2d next = at - curvature.ldlt().solve(by_spread.transpose() * spoiled.solve(of_known));
        next = next.cwiseMax(at / 2).cwiseMin(2 * at).cwiseMin(optics::widest_spread_mm);
        const Eigen::Vector2d by = next - at;
        at = next;
        moved.move_to(-reach * spoiled.solve(of_known + by_spread * by));
        left = residuals(at, moved.set());
        if (by.norm() < still_mm) break;
    }
    const Eigen::VectorXd of_known = left - by_resins * moved.moved();
    fit.chi2 = of_known.dot(spoiled.solve(of_known));
    const Eigen::Matrix2d covariance = curvature.inverse() * std::max(1.0, fit.chi2 / fit.freedom);
    for (std::size_t a = 0; a < 2; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        fit.mm[a] = at[i];
        fit.error[a] = covariance.allFinite() && covariance(i, i) > 0 ? std::sqrt(covariance(i, i)) : 0;
    }
    return fit;
}

void take_ends_off_checkers(PatchTable& checkers, const Target& target, const optics::ResinSet& resins,
                            bool air_below) {
    constexpr double rounding_mm = 1e-4;  // of tables
    const auto light = light_of_squares(target, resins, air_below, LightOfSquares(target.squares.size()));
    for (Patch& patch : checkers.patches) {
        const auto is_it = [&](const TargetSquare& square) {
            const std::array<double, 2> cell = target.cell_mm(square);
            return square.top == patch.top && square.backing == patch.backing &&
                   std::abs(cell[0] - patch.cell_mm[0]) < rounding_mm &&
                   std::abs(cell[1] - patch.cell_mm[1]) < rounding_mm;
        };
        const auto square = std::ranges::find_if(target.squares, is_it);
        if (square == target.squares.end())
            throw InputError(
                fmt::format("--target: has no checker {}; is it the target of these patches?", patch_name(patch)));
        const auto s = static_cast<std::size_t>(square - target.squares.begin());
        for (std::size_t c = 0; c < patch.rho.size(); ++c)
            patch.rho[c] = std::max(patch.rho[c] - light[s][c].more(patch.rho[c]), 0.0);
    }
}

}  // namespace voxtone::calibration
