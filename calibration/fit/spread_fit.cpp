// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/spread_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "calibration/patches/patch_file.h"
#include "calibration/patches/patch_model.h"
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

/// By channel: how much darker a mixture is than its resins side by side.
std::vector<double> lost_by_mixing(const Patch& patch, const optics::ResinSet& resins) {
    std::vector<Patch> three(3, patch);
    three[0].top = {{patch.top[0].role, 1.0}}, three[1].top = {{patch.top[1].role, 1.0}};
    std::vector<std::string> roles;
    for (const optics::Resin& resin : resins.resins) roles.push_back(resin.role);
    const PatchModel model(three, roles, {.g = resins.g, .eta = resins.eta});
    std::vector<double> lost;
    for (std::size_t c = 0; c < resins.channels.size(); ++c) {
        std::vector<optics::Medium> media;
        for (const optics::Resin& resin : resins.resins) media.push_back(resin.medium(c));
        const std::vector<double> rho = model.rho(media);
        lost.push_back((rho[0] + rho[1]) / 2 - rho[2]);
    }
    return lost;
}

std::vector<CheckerValue> telling_values(const PatchTable& table, const optics::ResinSet& resins) {
    constexpr std::size_t most_channels = 3;
    constexpr double of_largest = 0.75, least_lost = 0.05;
    std::vector<CheckerValue> values;
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        const Patch& patch = table.patches[p];
        VOXTONE_EXPECT(patch.is_checker() && patch.top.size() == 2);
        for (const std::string& role : {patch.top[0].role, patch.top[1].role, patch.backing})
            if (resins.find(role) < 0)
                throw InputError(fmt::format("{}: checker {} holds {}, a resin of which no square tells anything.",
                                             table.source, patch_name(patch), role));
        const std::vector<double> lost = lost_by_mixing(patch, resins);
        std::vector<std::size_t> order(lost.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return lost[a] > lost[b]; });
        for (std::size_t k = 0; k < std::min(most_channels, order.size()); ++k)
            if (lost[order[k]] >= std::max(least_lost, of_largest * lost[order[0]])) values.push_back({p, order[k]});
    }
    return values;
}

/// Weighted residuals of all values.
class Residuals {
public:
    Residuals(const PatchTable& table, const optics::ResinSet& resins, std::vector<CheckerValue> values, double noise,
              std::uint32_t paths, const Progress* progress)
        : table_(table),
          noise_(noise),
          paths_(table, resins, paths),
          values_(std::move(values)),
          strips_(strips()),
          progress_(progress) {}

    [[nodiscard]] Eigen::VectorXd operator()(const Eigen::Vector2d& spread_mm) const {
        Eigen::VectorXd left(static_cast<Eigen::Index>(values_.size()));
        Eigen::VectorXd level(left.size());
        parallel_for(
            0, values_.size(), 1,
            [&](std::size_t i) {
                const Patch& patch = table_.patches[values_[i].patch];
                const auto [rho, error] = paths_(values_[i], {spread_mm.x(), spread_mm.y()});
                const double read = patch.error.empty() ? noise_ : patch.error[values_[i].channel];
                const auto n = static_cast<Eigen::Index>(i);
                left[n] = (patch.rho[values_[i].channel] - rho) / std::hypot(read, error);
                level[n] = rho / std::hypot(read, error);
            },
            progress_);
        for (const std::vector<Eigen::Index>& strip : strips_) {
            const Eigen::VectorXd of_strip = level(strip);
            left(strip) -= of_strip * (of_strip.dot(left(strip)) / of_strip.squaredNorm());
        }
        return left;
    }
    [[nodiscard]] int freedom() const { return static_cast<int>(values_.size() - strips_.size()) - 2; }

private:
    /// Values of one channel, pair of resins and base: what fitted resins are wrong by moves them alike.
    [[nodiscard]] std::vector<std::vector<Eigen::Index>> strips() const {
        std::map<std::tuple<std::string, std::string, std::string, std::size_t>, std::vector<Eigen::Index>> found;
        for (std::size_t i = 0; i < values_.size(); ++i) {
            const Patch& patch = table_.patches[values_[i].patch];
            found[{patch.top[0].role, patch.top[1].role, patch.backing, values_[i].channel}].push_back(
                static_cast<Eigen::Index>(i));
        }
        std::vector<std::vector<Eigen::Index>> all;
        for (auto& [name, strip] : found) all.push_back(std::move(strip));
        return all;
    }

    const PatchTable& table_;
    double noise_;
    CheckerPaths paths_;
    std::vector<CheckerValue> values_;
    std::vector<std::vector<Eigen::Index>> strips_;
    const Progress* progress_;
};

struct MovedResins {
    const optics::ResinSet& resins;
    const ExtinctionErrors& errors;
    const std::vector<CheckerValue>& values;
};

/// Spread and the logarithms of extinctions by least squares, from slopes; gives the spread's curvature, extinctions
/// left free. `left`: residuals at the end, those of `at`.
template <class ResidualsOf>
Eigen::Matrix2d move_extinctions(const MovedResins& of, const Eigen::MatrixXd& by_spread,
                                 const ResidualsOf& residuals_of, Eigen::Vector2d& at, Eigen::VectorXd& left) {
    constexpr double probe = 0.03, least_error = 1e-4;
    constexpr int rounds = 3;
    const std::size_t resins = of.resins.resins.size(), channels = of.resins.channels.size();
    const auto unknowns = static_cast<Eigen::Index>(2 + resins * channels);
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(left.size(), unknowns);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(unknowns), moved = weight;
    slope.leftCols<2>() = by_spread;
    for (std::size_t r = 0; r < resins; ++r) {
        optics::ResinSet other = of.resins;
        for (double& sigma_t : other.resins[r].sigma_t_per_mm) sigma_t *= std::exp(probe);
        const Eigen::VectorXd by = (residuals_of(other) - left) / probe;
        for (Eigen::Index i = 0; i < left.size(); ++i)
            slope(i, static_cast<Eigen::Index>(2 + r * channels + of.values[static_cast<std::size_t>(i)].channel)) =
                by[i];
        for (std::size_t c = 0; c < channels; ++c)
            weight[static_cast<Eigen::Index>(2 + r * channels + c)] =
                1 / std::pow(std::max(of.errors[r][c], least_error), 2);
    }
    const Eigen::MatrixXd curvature = slope.transpose() * slope + Eigen::MatrixXd(weight.asDiagonal());
    for (int round = 0; round < rounds; ++round) {
        const Eigen::VectorXd step = -curvature.ldlt().solve(slope.transpose() * left + weight.cwiseProduct(moved));
        at = (at + step.head<2>()).cwiseMax(at / 2).cwiseMin(2 * at).cwiseMin(optics::widest_spread_mm);
        moved.tail(unknowns - 2) += step.tail(unknowns - 2);
        optics::ResinSet other = of.resins;
        for (std::size_t r = 0; r < resins; ++r)
            for (std::size_t c = 0; c < channels; ++c)
                other.resins[r].sigma_t_per_mm[c] *= std::exp(moved[static_cast<Eigen::Index>(2 + r * channels + c)]);
        left = residuals_of(other);
    }
    return curvature.inverse().topLeftCorner<2, 2>().inverse();
}

}  // namespace

bool SpreadFit::is_told() const { return error[0] > 0 && (mm[0] > 2 * error[0] || mm[1] > 2 * error[1]); }

SpreadFit fit_spread(const PatchTable& checkers, const optics::ResinSet& resins, double noise,
                     const ExtinctionErrors& errors, std::uint32_t paths, const Progress* progress) {
    constexpr std::array starts_mm{0.02, 0.045, 0.09, 0.18};
    constexpr double probe_mm = 0.008, still_mm = 5e-4;
    constexpr int most_steps = 6;
    if (paths == 0) {
        constexpr double paths_at_noise = 6000, usual_noise = 0.005, most = 60000;  // paths add a tenth to the error
        paths = static_cast<std::uint32_t>(
            std::clamp(paths_at_noise * std::pow(usual_noise / noise, 2), paths_at_noise, most));
    }
    const std::vector<CheckerValue> values = telling_values(checkers, resins);
    const Residuals residuals(checkers, resins, values, noise, paths, progress);
    if (residuals.freedom() < 1)
        throw InputError(fmt::format(
            "{}: its checkers are of resins too much alike to tell how far they run; print cells of a light resin and "
            "of a dark one (calibrate target --strips).",
            checkers.source));
    const Residuals rough(checkers, resins, values, noise, std::max(paths / 4, 2u), progress);
    Eigen::Vector2d at;
    double least = std::numeric_limits<double>::infinity();
    for (const double start : starts_mm) {
        const Eigen::Vector2d even(start, start);
        if (const double chi2 = rough(even).squaredNorm(); chi2 < least) least = chi2, at = even;
    }
    Eigen::VectorXd left = residuals(at);
    Eigen::MatrixXd slope(left.size(), 2);
    for (Eigen::Index a = 0; a < 2; ++a) {
        Eigen::Vector2d beside = at;
        beside[a] += probe_mm;
        slope.col(a) = (residuals(beside) - left) / probe_mm;
    }
    Eigen::Matrix2d curvature = slope.transpose() * slope;
    for (int step = 0; step < most_steps; ++step) {
        Eigen::Vector2d next = at - curvature.ldlt().solve(slope.transpose() * left);
        next = next.cwiseMax(at / 2).cwiseMin(2 * at).cwiseMin(optics::widest_spread_mm);
        const Eigen::Vector2d by = next - at;
        if (by.norm() < still_mm) break;
        const Eigen::VectorXd of_next = residuals(next);
        slope += (of_next - left - slope * by) * by.transpose() / by.squaredNorm();
        curvature = slope.transpose() * slope;
        if (of_next.squaredNorm() < left.squaredNorm()) at = next, left = of_next;
    }
    if (!errors.empty()) {
        const auto residuals_of = [&](const optics::ResinSet& set) {
            return Residuals(checkers, set, values, noise, paths, progress)(at);
        };
        curvature = move_extinctions({resins, errors, values}, slope, residuals_of, at, left);
    }
    SpreadFit fit;
    fit.chi2 = left.squaredNorm();
    fit.freedom = residuals.freedom();
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
