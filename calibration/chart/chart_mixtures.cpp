// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_mixtures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/contracts.h"
#include "calibration/chart/mixture_samples.h"
#include "optics/layered/flat_colour.h"

namespace voxtone::calibration {

namespace {

using Percents = std::vector<int>;

constexpr double lab_scale = 10, share_floor = 0.01;
constexpr std::size_t candidates_wanted = 6000;

// Whole percents that sum to 100, by largest remainders.
Percents percents_of(const std::vector<double>& shares) {
    Percents percents;
    std::vector<std::pair<double, std::size_t>> rest;
    int sum = 0;
    for (std::size_t r = 0; r < shares.size(); ++r) {
        percents.push_back(static_cast<int>(std::floor(100 * shares[r] + 1e-9)));
        sum += percents.back();
        rest.emplace_back(percents.back() - 100 * shares[r], r);
    }
    std::ranges::sort(rest);
    for (std::size_t k = 0; sum < 100; ++k, ++sum) ++percents[rest[k % rest.size()].second];
    return percents;
}

std::vector<Percents> always(std::size_t resins) {
    std::vector<Percents> taken;
    for (std::size_t r = 0; r < resins; ++r) {
        taken.emplace_back(resins, 0);
        taken.back()[r] = 100;
    }
    for (std::size_t a = 0; a < resins; ++a)
        for (std::size_t b = a + 1; b < resins; ++b) {
            taken.emplace_back(resins, 0);
            taken.back()[a] = taken.back()[b] = 50;
        }
    return taken;
}

std::vector<Percents> candidates(std::size_t resins) {
    std::set<Percents> different;
    for (std::vector<double> shares : mixture_samples(resins - 1, candidates_wanted)) {
        double rest = 1;
        for (const double share : shares) rest -= share;
        shares.push_back(std::max(rest, 0.0));
        different.insert(percents_of(shares));
    }
    return {different.begin(), different.end()};
}

Eigen::VectorXd place_of(const optics::FlatColour& flat, const Percents& percents) {
    std::vector<double> shares;
    for (const int percent : percents) shares.push_back(percent / 100.0);
    Eigen::VectorXd place(3 + static_cast<Eigen::Index>(shares.size()));
    place.head<3>() = flat.lab(shares) / lab_scale;
    for (std::size_t r = 0; r < shares.size(); ++r)
        place[3 + static_cast<Eigen::Index>(r)] = std::log(shares[r] + share_floor);
    return place;
}

}  // namespace

std::size_t least_chart_patches(std::size_t resins) { return resins + resins * (resins - 1) / 2; }

std::vector<Percents> chart_mixtures(const optics::ResinSet& set, std::size_t count) {
    const std::size_t resins = set.resins.size();
    VOXTONE_EXPECT(resins >= 2 && count >= least_chart_patches(resins));
    const optics::FlatColour flat(set);
    std::vector<Percents> taken = always(resins);
    const std::vector<Percents> all = candidates(resins);
    std::vector<Eigen::VectorXd> places;
    for (const Percents& percents : all) places.push_back(place_of(flat, percents));
    std::vector<double> nearest(all.size(), std::numeric_limits<double>::infinity());
    const auto take = [&](const Eigen::VectorXd& place) {
        for (std::size_t i = 0; i < all.size(); ++i)
            nearest[i] = std::min(nearest[i], (places[i] - place).squaredNorm());
    };
    for (const Percents& percents : taken) take(place_of(flat, percents));
    while (taken.size() < count) {
        const auto farthest = static_cast<std::size_t>(std::ranges::max_element(nearest) - nearest.begin());
        VOXTONE_EXPECT(nearest[farthest] > 0);
        taken.push_back(all[farthest]);
        take(places[farthest]);
    }
    return taken;
}

}  // namespace voxtone::calibration
