// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/translucency_alpha.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::optics {

namespace {

constexpr double rate_cm = 0.0153, power = 0.6, absorption_weight = 0.4, mm_per_cm = 10;
constexpr std::size_t ratios = 32, extinctions = 40;
constexpr double least_through = 1e-10;  // below, differences of two appearances are rounding

/// Where `values`, which falls, passes through `x`: an index and how far to the next one.
double place_in_falling(const std::vector<double>& values, double x) {
    const auto after = std::ranges::partition_point(values, [&](double value) { return value > x; });
    if (after == values.begin()) return 0;
    if (after == values.end()) return double(values.size() - 1);
    const auto i = std::size_t(after - values.begin()) - 1;
    return double(i) + (values[i] - x) / (values[i] - values[i + 1]);
}

double value_at(const std::vector<double>& values, double place) {
    const auto i = std::min(std::size_t(place), values.size() - 2);
    const double t = place - double(i);
    return (1 - t) * values[i] + t * values[i + 1];
}

}  // namespace

double translucency_eta(double absorption_per_cm, double scattering_per_cm) {
    return absorption_weight * absorption_per_cm + scattering_per_cm;
}

double translucency_alpha(double eta_per_cm) {
    VOXTONE_EXPECT(eta_per_cm >= 0);
    return std::pow(-std::expm1(-rate_cm * eta_per_cm), power);
}

double translucency_eta_per_cm(double alpha) {
    VOXTONE_EXPECT(alpha >= 0 && alpha <= 1);
    return -std::log1p(-std::pow(alpha, 1 / power)) / rate_cm;
}

TranslucencyScale::TranslucencyScale(double eta, double slab_mm) {
    constexpr double least_ratio = 1e-5, most_ratio = 30, least_per_mm = 2e-3, most_per_mm = 60;
    const auto spaced = [](double least, double most, double share) { return least * std::pow(most / least, share); };
    for (std::size_t j = 0; j < extinctions; ++j)
        log_extinction_.push_back(std::log(spaced(least_per_mm, most_per_mm, double(j) / (extinctions - 1))));
    rows_.resize(ratios);
    const OrdinatePlan plan = appearance_plan(0, eta);
    const Admittance white = Admittance::white_sheet(plan), lit = Admittance::air(plan, true),
                     dark = Admittance::air(plan, false);
    parallel_for(0, ratios, 1, [&](std::size_t i) {
        Row& row = rows_[i];
        row.absorbed = i == 0 ? 0 : spaced(least_ratio, most_ratio, double(i - 1) / (ratios - 2));
        for (const double log_extinction : log_extinction_) {
            const double per_mm = std::exp(log_extinction), s = per_mm / (1 + row.absorbed);
            const LayerModes slab(plan, {per_mm - s, s});
            const auto seen = [&](const Admittance& below) { return appearance(plan, slab.over(below, slab_mm)); };
            row.log_through.push_back(std::log(std::max(seen(lit) - seen(dark), least_through)));
            row.on_white.push_back(seen(white));
        }
    });
}

double TranslucencyScale::eta_per_cm(const SlabReading& reading) const {
    const double log_through = std::log(std::max(reading.through, least_through));
    // In each row the grey that lets as much through; among these the one that throws as much back.
    std::vector<double> place, on_white;
    for (const Row& row : rows_) {
        place.push_back(place_in_falling(row.log_through, log_through));
        on_white.push_back(value_at(row.on_white, place.back()));
    }
    const double at = place_in_falling(on_white, reading.on_white);
    const auto i = std::min(std::size_t(at), rows_.size() - 2);
    const double t = at - double(i);
    const auto eta_in = [&](std::size_t row) {
        const double per_mm = std::exp(value_at(log_extinction_, place[row])), a_over_s = rows_[row].absorbed;
        return mm_per_cm * per_mm * (absorption_weight * a_over_s + 1) / (1 + a_over_s);
    };
    return (1 - t) * eta_in(i) + t * eta_in(i + 1);
}

}  // namespace voxtone::optics
