// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/refit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "base/error.h"
#include "optics/colour/colour.h"
#include "optics/numerics/dense.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {

namespace {

// A choice, no measurement: what Stratasys lets a cartridge differ by is not published.
constexpr double alike_sd = 0.12, own_sd = 0.06;
constexpr double gain_sd = 1, cast_sd = 0.3, cast_sd_by_checker = 0.03, veil_sd = 0.01;
constexpr double least_colour = 0.01, dark_offset = 0.02;
constexpr double least_scale = 0.003;  // of L / 100: what a camera's noise leaves of a region
constexpr double biweight = 4.685;     // 95 % efficient where errors are normal
constexpr int reweighings = 8;
constexpr double light_sd = 0.1;
constexpr Eigen::Index nuisances = 4 + light_terms;  // three gains, a veil, and light
using Nuisances = Eigen::Matrix<double, nuisances, 1>;

double log_ratio(double albedo) { return std::log((1 - albedo) / albedo); }
bool has_ratio(double albedo) { return albedo > 0 && albedo < 1; }

/// x of a set; where there is none, 0.
Eigen::VectorXd values_of(const optics::ResinSet& set) {
    const std::size_t channels = set.channels.size();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(Eigen::Index(2 * set.resins.size() * channels));
    for (std::size_t r = 0; r < set.resins.size(); ++r)
        for (std::size_t c = 0; c < channels; ++c) {
            const auto at = Eigen::Index(2 * (r * channels + c));
            if (set.resins[r].sigma_t_per_mm[c] > 0) x[at] = std::log(set.resins[r].sigma_t_per_mm[c]);
            if (has_ratio(set.resins[r].albedo[c])) x[at + 1] = log_ratio(set.resins[r].albedo[c]);
        }
    return x;
}

optics::ResinSet moved(optics::ResinSet set, const Eigen::VectorXd& by) {
    const std::size_t channels = set.channels.size();
    for (std::size_t r = 0; r < set.resins.size(); ++r)
        for (std::size_t c = 0; c < channels; ++c) {
            const auto at = Eigen::Index(2 * (r * channels + c));
            set.resins[r].sigma_t_per_mm[c] *= std::exp(by[at]);
            double& albedo = set.resins[r].albedo[c];
            if (has_ratio(albedo)) albedo = 1 / (1 + std::exp(log_ratio(albedo) + by[at + 1]));
        }
    return set;
}

/// C^-1.
Eigen::MatrixXd precision_of(const optics::ResinSet& set) {
    const auto channels = Eigen::Index(set.channels.size()), resins = Eigen::Index(set.resins.size());
    const Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(channels, channels, alike_sd * alike_sd) +
                                       own_sd * own_sd * Eigen::MatrixXd::Identity(channels, channels);
    const Eigen::MatrixXd inverse = covariance.inverse();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 * resins * channels, 2 * resins * channels);
    for (Eigen::Index r = 0; r < resins; ++r)
        for (Eigen::Index part = 0; part < 2; ++part)
            for (Eigen::Index a = 0; a < channels; ++a)
                for (Eigen::Index b = 0; b < channels; ++b)
                    all(2 * (r * channels + a) + part, 2 * (r * channels + b) + part) = inverse(a, b);
    return all;
}

/// By which a print is brighter than predicted, so that both have one level.
Eigen::Vector3d level_of(const RegionSheet& sheet, const Eigen::VectorXd& shift) {
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();
    for (Eigen::Index k = 0; k < 3; ++k) {
        std::vector<double> ratios;
        for (const PrintRegion& region : sheet.regions) {
            const double predicted = region.predicted[k] + region.by_value.row(k).dot(shift);
            if (predicted > dark_offset && region.printed[k] > 0)
                ratios.push_back(std::log(region.printed[k] / predicted));
        }
        gain[k] = std::exp(optics::median(std::move(ratios)));
    }
    return gain;
}

/// One channel of a region, as an equation row (x - x_known) + nuisances = off, in L / 100.
struct Equation {
    Eigen::VectorXd row;
    Nuisances nuisance = Nuisances::Zero();
    double off = 0;
};

std::vector<Equation> equations_of(const RegionSheet& sheet, const Eigen::VectorXd& known) {
    const Eigen::VectorXd at = values_of(sheet.set) - known;
    const Eigen::Vector3d gain = level_of(sheet, Eigen::VectorXd::Zero(at.size()));
    std::vector<Equation> equations;
    for (const PrintRegion& region : sheet.regions)
        for (Eigen::Index k = 0; k < 3; ++k) {
            const double predicted = region.predicted[k];
            if (predicted < least_colour) continue;
            // d L / 100 = 1.16 / 3 d y / y^(2/3)
            const double scale = 1.16 / 3 * std::pow(predicted + dark_offset, -2.0 / 3);
            Equation e;
            e.row = scale * region.by_value.row(k).transpose();
            e.off = scale * (region.printed[k] / gain[k] - predicted) + e.row.dot(at);
            e.nuisance[k] = scale * predicted;
            e.nuisance[3] = scale;
            e.nuisance.tail<light_terms>() = scale * predicted * light_at(region.place);
            equations.push_back(std::move(e));
        }
    return equations;
}

/// Of gains about the level, which is free, of the veil and of light.
Eigen::Matrix<double, nuisances, nuisances> nuisance_precision(bool has_checker) {
    const double cast = has_checker ? cast_sd_by_checker : cast_sd;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Constant(gain_sd * gain_sd);
    covariance.diagonal().array() += cast * cast;
    Eigen::Matrix<double, nuisances, nuisances> precision = Eigen::Matrix<double, nuisances, nuisances>::Zero();
    precision.topLeftCorner<3, 3>() = covariance.inverse();
    precision(3, 3) = 1 / (veil_sd * veil_sd);
    precision.diagonal().tail<light_terms>().setConstant(1 / (light_sd * light_sd));
    return precision;
}

struct Solved {
    Eigen::VectorXd change;
    Eigen::MatrixXd covariance;
};

Solved solve(std::span<const RegionSheet> sheets, const optics::ResinSet& known, std::size_t without) {
    const Eigen::VectorXd x = values_of(known);
    const Eigen::Index values = x.size();
    std::vector<std::vector<Equation>> equations;
    std::vector<const RegionSheet*> used;
    for (std::size_t s = 0; s < sheets.size(); ++s) {
        if (s == without) continue;
        equations.push_back(equations_of(sheets[s], x));
        used.push_back(&sheets[s]);
    }
    const Eigen::Index all = values + nuisances * Eigen::Index(used.size());
    const Eigen::MatrixXd prior = precision_of(known);
    Eigen::VectorXd found = Eigen::VectorXd::Zero(all);
    Eigen::MatrixXd normal;
    for (int round = 0; round < reweighings; ++round) {
        std::vector<double> sizes;
        const auto left = [&](const Equation& e, std::size_t s) {
            return e.off - e.row.dot(found.head(values)) -
                   e.nuisance.dot(found.segment<nuisances>(values + nuisances * Eigen::Index(s)));
        };
        for (std::size_t s = 0; s < used.size(); ++s)
            for (const Equation& e : equations[s]) sizes.push_back(std::abs(left(e, s)));
        const double scale = std::max(1.4826 * optics::median(std::move(sizes)), least_scale);
        normal = Eigen::MatrixXd::Zero(all, all);
        normal.topLeftCorner(values, values) = prior;
        Eigen::VectorXd right = Eigen::VectorXd::Zero(all);
        for (std::size_t s = 0; s < used.size(); ++s) {
            const Eigen::Index at = values + nuisances * Eigen::Index(s);
            normal.block<nuisances, nuisances>(at, at) += nuisance_precision(used[s]->has_checker);
            for (const Equation& e : equations[s]) {
                const double u = left(e, s) / (biweight * scale);
                if (round > 0 && std::abs(u) >= 1) continue;
                const double weight = (round > 0 ? std::pow(1 - u * u, 2) : 1.0) / (scale * scale);
                normal.topLeftCorner(values, values).noalias() += weight * e.row * e.row.transpose();
                normal.block(0, at, values, nuisances).noalias() += weight * e.row * e.nuisance.transpose();
                normal.block<nuisances, nuisances>(at, at) += weight * e.nuisance * e.nuisance.transpose();
                right.head(values) += weight * e.off * e.row;
                right.segment<nuisances>(at) += weight * e.off * e.nuisance;
            }
            normal.block(at, 0, nuisances, values) = normal.block(0, at, values, nuisances).transpose();
        }
        found = optics::symmetric_preimage(normal, right);
    }
    const Eigen::MatrixXd covariance = optics::symmetric_solved(normal, Eigen::MatrixXd::Identity(all, all));
    return {found.head(values), covariance.topLeftCorner(values, values)};
}

/// Mean CIEDE2000 of a print's regions, were its resins so far from `known`.
double mean_difference(const RegionSheet& sheet, const optics::ResinSet& known, const Eigen::VectorXd& change) {
    const Eigen::VectorXd shift = values_of(known) + change - values_of(sheet.set);
    const Eigen::Vector3d gain = level_of(sheet, shift);
    constexpr Eigen::Index n = 3 + light_terms;
    const auto terms = [](const PrintRegion& region, Eigen::Index channel) {
        Eigen::Matrix<double, n, 1> all = Eigen::Matrix<double, n, 1>::Zero();
        all[channel] = 1;
        all.tail<light_terms>() = light_at(region.place);
        return all;
    };
    Eigen::Matrix<double, n, n> normal = 1e-6 * decltype(normal)::Identity();
    Eigen::Matrix<double, n, 1> right = Eigen::Matrix<double, n, 1>::Zero();
    for (const PrintRegion& region : sheet.regions)
        for (Eigen::Index k = 0; k < 3; ++k) {
            const double predicted = region.predicted[k] + region.by_value.row(k).dot(shift);
            if (predicted < dark_offset) continue;
            normal += predicted * terms(region, k) * terms(region, k).transpose();
            right += (region.printed[k] / gain[k] - predicted) * terms(region, k);
        }
    const Eigen::Matrix<double, n, 1> light = normal.ldlt().solve(right);
    double sum = 0;
    for (const PrintRegion& region : sheet.regions) {
        Eigen::Vector3d predicted = region.predicted + region.by_value * shift;
        for (Eigen::Index k = 0; k < 3; ++k) predicted[k] *= 1 + light.dot(terms(region, k));
        sum += optics::ciede2000(optics::lab_from_linear_srgb(predicted.cwiseMax(0)),
                                 optics::lab_from_linear_srgb(region.printed.cwiseQuotient(gain).cwiseMax(0)));
    }
    return sum / double(sheet.regions.size());
}

void expect_same_resins(const RegionSheet& sheet, const optics::ResinSet& known) {
    const auto same_role = [](const optics::Resin& a, const optics::Resin& b) { return a.role == b.role; };
    if (!std::ranges::equal(sheet.set.resins, known.resins, same_role) || !(sheet.set.channels == known.channels))
        throw InputError(fmt::format(
            "the print {} was predicted by the set {}, whose resins or channels are not those of {}: what its regions "
            "say is of others; compare it again with --resins, or name its set with --prior",
            sheet.stack, sheet.set.name, known.name));
    if (sheet.regions.empty())
        throw InputError(fmt::format("the print {} has no regions that count; compare a larger one", sheet.stack));
}

}  // namespace

Refit refit_resins(std::span<const RegionSheet> sheets, const optics::ResinSet& known) {
    for (const RegionSheet& sheet : sheets) expect_same_resins(sheet, known);
    const Solved solved = solve(sheets, known, sheets.size());
    Refit refit;
    refit.set = moved(known, solved.change);
    const auto channels = Eigen::Index(known.channels.size());
    for (Eigen::Index r = 0; r < Eigen::Index(known.resins.size()); ++r) {
        const auto mean_of = [&](Eigen::Index part, double& mean, double& error) {
            Eigen::VectorXd pick = Eigen::VectorXd::Zero(solved.change.size());
            for (Eigen::Index c = 0; c < channels; ++c) pick[2 * (r * channels + c) + part] = 1.0 / double(channels);
            mean = pick.dot(solved.change);
            error = std::sqrt(pick.dot(solved.covariance * pick));
        };
        ResinChange change;
        mean_of(0, change.extinction, change.extinction_error);
        mean_of(1, change.absorption, change.absorption_error);
        refit.resins.push_back(change);
    }
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(solved.change.size());
    double left_out = 0;
    const double n = double(sheets.size());
    for (std::size_t s = 0; s < sheets.size(); ++s) {
        refit.before += mean_difference(sheets[s], known, none) / n;
        refit.after += mean_difference(sheets[s], known, solved.change) / n;
        if (sheets.size() > 1) left_out += mean_difference(sheets[s], known, solve(sheets, known, s).change) / n;
    }
    if (sheets.size() > 1) refit.left_out = left_out;
    return refit;
}

}  // namespace voxtone::calibration
