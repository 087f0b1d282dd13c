// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_refinement.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Core>

#include "base/error.h"
#include "scattering/design/hildreth.h"
#include "scattering/design/laminate_search.h"

namespace voxtone::scattering {
namespace {

constexpr int most_iterations = 1000;
constexpr double least_gain = 1e-10;  ///< five steps in a row that gain less are the end
constexpr double slack_mm = 1e-9;

/// slope * h >= least.
struct Limits {
    Eigen::MatrixXd slope;
    Eigen::VectorXd least;
};

Limits make_limits(std::span<const LaminateLayer> layers, const LaminateSearchOptions& o) {
    const auto n = static_cast<Eigen::Index>(layers.size());
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> least;
    for (Eigen::Index j = 0; j < n; ++j) {
        rows.emplace_back(Eigen::VectorXd::Unit(n, j));
        least.push_back(0);
    }
    rows.emplace_back(Eigen::VectorXd::Constant(n, -1));
    least.push_back(-o.thickness_mm);
    std::vector<char> met(o.clear_top_mm.size(), 0);
    for (Eigen::Index j = 0; j < n; ++j) {
        const std::size_t m = layers[static_cast<std::size_t>(j)].material;
        if (m >= met.size() || met[m] || o.clear_top_mm[m] == 0) continue;
        met[m] = 1;  // the uppermost layer of a material stands for those below
        Eigen::VectorXd above = Eigen::VectorXd::Zero(n);
        above.head(j).setOnes();
        rows.push_back(above);
        least.push_back(o.clear_top_mm[m]);
    }
    Limits limits{Eigen::MatrixXd(static_cast<Eigen::Index>(rows.size()), n),
                  Eigen::VectorXd(static_cast<Eigen::Index>(rows.size()))};
    for (std::size_t r = 0; r < rows.size(); ++r) {
        limits.slope.row(static_cast<Eigen::Index>(r)) = rows[r].transpose();
        limits.least[static_cast<Eigen::Index>(r)] = least[r];
    }
    return limits;
}

class Refinement {
public:
    Refinement(std::span<const LaminateMaterial> materials, std::span<const LaminateLayer> layers,
               const ChannelProfiles& target, const LaminateSearchOptions& options)
        : materials_(materials), layers_(layers.begin(), layers.end()), target_(target), options_(options) {}

    /// The root of the weight, over the root of their sum, times the residuals; and their derivatives by thickness.
    void linearise(const Eigen::VectorXd& h, Eigen::VectorXd& residual, Eigen::MatrixXd& slope) const {
        const std::size_t layers = layers_.size(), channels = target_.size(), length = target_[0].size();
        const ProfileWeights weights = options_.weights();
        const double all = static_cast<double>(channels) * weights.sum(length);
        residual.resize(static_cast<Eigen::Index>(channels * length));
        slope.resize(residual.size(), h.size());
        for (std::size_t c = 0; c < channels; ++c) {
            std::vector<optics::LayerProfile> own(layers), above(layers);
            std::vector<std::vector<double>> below(layers + 1);  // what is under layer j at [j + 1]
            for (std::size_t j = 0; j < layers; ++j) {
                own[j] = materials_[layers_[j].material][c].of_thickness(h[static_cast<Eigen::Index>(j)]);
                above[j] = j == 0 ? own[j] : optics::laminate(above[j - 1], own[j]);
            }
            optics::LayerProfile under = optics::no_layer(length);
            under.T.assign(length, 0.0);
            if (!options_.backing.empty()) under.R_top = options_.backing[c];
            below[layers] = under.R_top;
            for (std::size_t j = layers; j-- > 0;) {
                under = optics::laminate(own[j], under);
                below[j] = under.R_top;
            }
            for (std::size_t i = 0; i < length; ++i) {
                const auto at = static_cast<Eigen::Index>(c * length + i);
                const double root_weight = std::sqrt(weights.of(i) / all);
                residual[at] = root_weight * (below[0][i] - target_[c][i]);
                for (std::size_t j = 0; j < layers; ++j) {
                    const optics::HomogeneousLayer& material = materials_[layers_[j].material][c];
                    const double R = below[j + 1][i],
                                 growth = material.S()[i] * (1 - R) * (1 - R) - 2 * material.K()[i] * R;
                    const double seen = above[j].T[i] / std::max(1 - above[j].R_bottom[i] * R, 1e-300);
                    slope(at, static_cast<Eigen::Index>(j)) = root_weight * growth * seen * seen;
                }
            }
        }
    }

    double distance(const Eigen::VectorXd& h) const {
        return profile_distance(laminate_reflection(materials_, stacked(h), options_.backing), target_,
                                options_.weights());
    }

    std::vector<LaminateLayer> stacked(const Eigen::VectorXd& h) const {
        std::vector<LaminateLayer> out;
        for (std::size_t j = 0; j < layers_.size(); ++j) {
            const double mm = h[static_cast<Eigen::Index>(j)];
            if (mm <= 0) continue;
            if (!out.empty() && out.back().material == layers_[j].material)
                out.back().thickness_mm += mm;
            else
                out.push_back({layers_[j].material, mm});
        }
        return out;
    }

private:
    std::span<const LaminateMaterial> materials_;
    std::vector<LaminateLayer> layers_;
    const ChannelProfiles& target_;
    const LaminateSearchOptions& options_;
};

/// The step p that minimises p A p / 2 + g p where slope p >= room; cut short where rounding would leave the limits.
Eigen::VectorXd limited_step(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::MatrixXd& slope,
                             const Eigen::VectorXd& room) {
    const Eigen::VectorXd p = hildreth_minimum(A, g, slope, room);
    double share = 1;
    for (Eigen::Index r = 0; r < room.size(); ++r) {
        const double moved = slope.row(r).dot(p);
        if (moved < room[r] - slack_mm) share = std::min(share, std::max(0.0, (slack_mm - room[r]) / -moved));
    }
    return share * p;
}

/// InputError where the limits are broken by more than rounding; what is broken by less is let be.
Limits reachable_limits(std::span<const LaminateLayer> layers, const Eigen::VectorXd& h,
                        const LaminateSearchOptions& o) {
    Limits limits = make_limits(layers, o);
    const Eigen::VectorXd start = limits.slope * h;
    if (((start - limits.least).array() < -1e-6).any())
        throw InputError(
            fmt::format("laminate refinement: the layers break the limits already: {} mm thick (at most {}), or a "
                        "material nearer to "
                        "the top than allowed",
                        h.sum(), o.thickness_mm));
    limits.least = limits.least.cwiseMin(start);
    return limits;
}

/// Nielsen's rule: the damping follows how well the model foresees the gain (K. Madsen, H. B. Nielsen, O. Tingleff,
/// "Methods for non-linear least squares problems", 2nd ed., DTU 2004, Sec. 3.2).
struct Damping {
    double value = 1e-3, raise = 2;
    void after_loss() {
        value *= raise;
        raise *= 2;
    }
    void after_gain(double gained, double foreseen) {
        const double trust = 2 * gained / foreseen - 1;
        value = std::max(value * std::clamp(1 - trust * trust * trust, 1.0 / 3, 2.0), 1e-12);
        raise = 2;
    }
};

/// The floor keeps layers that are hardly seen from running far ahead of what the model knows of them.
Eigen::MatrixXd damped(const Eigen::MatrixXd& normal, double damping) {
    Eigen::MatrixXd A = normal;
    A.diagonal() += damping * normal.diagonal().cwiseMax(1e-2 * normal.diagonal().maxCoeff()) +
                    Eigen::VectorXd::Constant(normal.rows(), 1e-12 * (normal.trace() + 1e-30));
    return A;
}

/// Levenberg and Marquardt's method from h, until five steps in a row gain nothing.
void minimise(const Refinement& refinement, const Limits& limits, Eigen::VectorXd& h, RefinedLaminate& refined) {
    Eigen::VectorXd residual;
    Eigen::MatrixXd slope;
    Damping damping;
    int small_gains = 0;
    refined.converged = false;
    refinement.linearise(h, residual, slope);
    for (int iteration = 0; iteration < most_iterations && !refined.converged; ++iteration) {
        const Eigen::MatrixXd normal = slope.transpose() * slope;
        const Eigen::VectorXd g = slope.transpose() * residual;
        const Eigen::VectorXd p =
            limited_step(damped(normal, damping.value), g, limits.slope, limits.least - limits.slope * h);
        const double foreseen = std::max(-2 * g.dot(p) - p.dot(normal * p), 1e-300);
        const Eigen::VectorXd next = (h + p).cwiseMax(0.0);
        const double before = refined.distance, distance = refinement.distance(next);
        if (!(distance < before)) {
            damping.after_loss();
            refined.converged = damping.value > 1e12 || (next - h).cwiseAbs().maxCoeff() < 1e-12;
            continue;
        }
        h = next;
        refined.distance = distance;
        ++refined.steps;
        damping.after_gain(before * before - distance * distance, foreseen);
        refinement.linearise(h, residual, slope);
        small_gains = before - distance < least_gain ? small_gains + 1 : 0;
        refined.converged = small_gains == 5;
    }
}

void check(std::span<const LaminateMaterial> materials, std::span<const LaminateLayer> layers,
           const ChannelProfiles& target, const LaminateSearchOptions& o) {
    if (materials.empty() || materials[0].empty())
        throw InputError("laminate refinement: no material; give at least one");
    const std::size_t length = materials[0][0].K().size();
    const auto fits = [&](const ChannelProfiles& profiles) {
        return profiles.size() == materials[0].size() &&
               std::all_of(profiles.begin(), profiles.end(), [&](const std::vector<double>& channel) {
                   return channel.size() == length &&
                          std::all_of(channel.begin(), channel.end(), [](double x) { return std::isfinite(x); });
               });
    };
    for (const LaminateMaterial& material : materials)
        if (material.size() != materials[0].size() ||
            std::any_of(material.begin(), material.end(),
                        [&](const optics::HomogeneousLayer& layer) { return layer.K().size() != length; }))
            throw InputError(
                "laminate refinement: materials differ in channels or coefficients; bring all to one spacing and "
                "length");
    if (length == 0 || !fits(target) || !(o.backing.empty() || fits(o.backing)))
        throw InputError(
            "laminate refinement: the target or the backing differs from the materials in channels or coefficients, or "
            "has values "
            "that are not finite");
    if (!(o.dc_weight > 0) || !std::isfinite(o.dc_weight))
        throw InputError(fmt::format("laminate refinement: a weight of {} on the first coefficient; it must be above 0",
                                     o.dc_weight));
    if (!o.clear_top_mm.empty() && o.clear_top_mm.size() != materials.size())
        throw InputError(fmt::format("laminate refinement: distances from the top for {} materials, but there are {}",
                                     o.clear_top_mm.size(), materials.size()));
    for (std::size_t j = 0; j < layers.size(); ++j) {
        if (layers[j].material >= materials.size())
            throw InputError(fmt::format("laminate refinement: layer {} is of material {}, but there are {}", j + 1,
                                         layers[j].material + 1, materials.size()));
        if (!(layers[j].thickness_mm >= 0) || !std::isfinite(layers[j].thickness_mm))
            throw InputError(fmt::format("laminate refinement: layer {} is {} mm thick; it must be 0 or above", j + 1,
                                         layers[j].thickness_mm));
    }
}

}  // namespace

RefinedLaminate refine_laminate(std::span<const LaminateMaterial> materials, std::span<const LaminateLayer> layers,
                                const ChannelProfiles& target, const LaminateSearchOptions& options) {
    check(materials, layers, target, options);
    std::vector<LaminateLayer> present;  // a layer of thickness 0 is none
    std::copy_if(layers.begin(), layers.end(), std::back_inserter(present),
                 [](const LaminateLayer& layer) { return layer.thickness_mm > 0; });
    const Refinement refinement(materials, present, target, options);
    Eigen::VectorXd h(static_cast<Eigen::Index>(present.size()));
    for (std::size_t j = 0; j < present.size(); ++j) h[static_cast<Eigen::Index>(j)] = present[j].thickness_mm;
    RefinedLaminate refined{present, refinement.distance(h), 0, 0, true};
    refined.distance_before = refined.distance;
    if (present.empty()) return refined;

    minimise(refinement, reachable_limits(present, h, options), h, refined);
    refined.layers = refinement.stacked(h);
    return refined;
}

}  // namespace voxtone::scattering
