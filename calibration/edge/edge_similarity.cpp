// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_similarity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/parallel.h"
#include "calibration/resins/resin_coordinates.h"

namespace voxtone::calibration {
namespace {

constexpr int map_albedos = 32, map_extinctions = 24;
constexpr double least_co_albedo = 1e-4, most_co_albedo = 0.97;

std::vector<double> even_logarithms(double from, double to, int count) {
    std::vector<double> list;
    for (int k = 0; k < count; ++k) list.push_back(from * std::pow(to / from, static_cast<double>(k) / (count - 1)));
    return list;
}

EdgePoint point_at(const EdgeMedium& m) { return {v_of_albedo(m.albedo, m.g), std::log(m.sigma_t)}; }

EdgeMedium similar_medium(const EdgeMedium& m, double g) {
    const double sigma_a = m.sigma_t * (1 - m.albedo), sigma_s = m.sigma_t * m.albedo * (1 - m.g) / (1 - g);
    return {sigma_a + sigma_s, sigma_s / (sigma_a + sigma_s), g};
}

// The map, and its least refined.
EdgeMap map_of(const EdgeObjective& objective, const EdgeSimilarity& axes, const EdgeMedium& fit, double g, double mu) {
    EdgeMap map{g, {}, similar_medium(fit, g), 0, 0, {}};
    map.distance.resize(static_cast<Eigen::Index>(axes.sigma_t.size()),
                        static_cast<Eigen::Index>(axes.co_albedo.size()));
    for (std::size_t s = 0; s < axes.sigma_t.size(); ++s)
        for (std::size_t a = 0; a < axes.co_albedo.size(); ++a)
            map.distance(static_cast<Eigen::Index>(s), static_cast<Eigen::Index>(a)) =
                objective(point_at({axes.sigma_t[s], 1 - axes.co_albedo[a], g}), g, mu);
    Eigen::Index s = 0, a = 0;
    map.distance.minCoeff(&s, &a);
    const EdgePoint start =
        point_at({axes.sigma_t[static_cast<std::size_t>(s)], 1 - axes.co_albedo[static_cast<std::size_t>(a)], g});
    EdgeObjective::Minimum least = objective.minimum_from(start, g, mu);
    const EdgeObjective::Minimum other = objective.minimum_from(point_at(map.similar), g, mu);
    if (other.distance < least.distance) least = other;
    map.fitted = edge_medium(least.at, g);
    map.at_fitted = least.distance;
    map.at_similar = objective(point_at(map.similar), g, mu);
    return map;
}

// What the fit says of other g, where it has not looked at them itself.
void fill_in(EdgeFit& fit, const EdgeSimilarity& found, const std::vector<double>& gs) {
    for (std::size_t r = 0; r < fit.resins.size(); ++r) {
        EdgeResinFit& resin = fit.resins[r];
        if (!resin.by_g.empty()) continue;
        for (std::size_t k = 0; k < gs.size(); ++k) {
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                if (found.maps[r][c].empty()) continue;
                const EdgeMap& map = found.maps[r][c][k];
                sum += map.at_fitted;
                resin.similar[c].push_back({map.g, map.fitted, map.similar});
            }
            resin.by_g.emplace_back(gs[k], sum);
        }
    }
}

}  // namespace

EdgeSimilarity::Agreement EdgeSimilarity::agreement(std::size_t resin, std::size_t channel) const {
    Agreement sum;
    double count = 0;
    for (const EdgeMap& map : maps[resin][channel]) {
        if (map.similar.sigma_t < sigma_t.front() || map.similar.sigma_t > sigma_t.back()) continue;
        const EdgePoint off = point_at(map.fitted) - point_at(map.similar);
        sum.v += off[0] * off[0], sum.ln_sigma_t += off[1] * off[1], ++count;
    }
    return {std::sqrt(sum.ln_sigma_t / std::max(count, 1.0)), std::sqrt(sum.v / std::max(count, 1.0))};
}

EdgeSimilarity edge_similarity(EdgeFit& fit, const std::vector<EdgeProfile>& profiles, EdgeProfileTable& table,
                               const EdgeFitOptions& options, const Progress* progress) {
    const std::vector<double>& gs = table.grid().g;
    table.prepare(gs.front(), true, progress);
    EdgeSimilarity found{even_logarithms(table.grid().sigma_t.front(), table.grid().sigma_t.back(), map_extinctions),
                         even_logarithms(least_co_albedo, most_co_albedo, map_albedos),
                         {}};
    found.maps.resize(fit.resins.size());
    struct Part {
        std::size_t resin, channel;
        std::unique_ptr<EdgeObjective> objective;
    };
    std::vector<Part> parts;
    for (std::size_t r = 0; r < fit.resins.size(); ++r) {
        std::vector<const EdgeProfile*> slabs;
        for (const EdgeProfile& profile : profiles)
            if (profile.resin == fit.resins[r].role) slabs.push_back(&profile);
        for (std::size_t c = 0; c < 3; ++c) {
            std::vector<std::string> ignored;
            auto seen = edge_observations(slabs, c, table, options.metric, ignored);
            if (seen.empty()) continue;
            parts.push_back({r, c, std::make_unique<EdgeObjective>(std::move(seen), c, table, options.metric)});
            found.maps[r][c].resize(gs.size());
        }
    }
    parallel_for(
        0, parts.size() * gs.size(), 1,
        [&](std::size_t i) {
            const Part& part = parts[i / gs.size()];
            const EdgeResinFit& resin = fit.resins[part.resin];
            const EdgeMedium at = edge_medium(resin.channel[part.channel].at, resin.g);
            found.maps[part.resin][part.channel][i % gs.size()] =
                map_of(*part.objective, found, at, gs[i % gs.size()], fit.mu);
        },
        progress);
    if (gs.size() > 1) fill_in(fit, found, gs);
    return found;
}

}  // namespace voxtone::calibration
