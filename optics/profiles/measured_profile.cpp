// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/measured_profile.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t fewest_samples = 4;
constexpr double largest_sum = 1.02;

void check(const RadialSamples& samples, const char* name) {
    if (!(samples.spacing_mm > 0 && std::isfinite(samples.spacing_mm)))
        throw InputError(fmt::format(
            "The {} profile has a spacing of {} mm; it must be above 0. Give the distance between samples in mm.", name,
            samples.spacing_mm));
    if (samples.light.size() < fewest_samples)
        throw InputError(
            fmt::format("The {} profile has {} samples; at least {} are needed to know how light falls off.", name,
                        samples.light.size(), fewest_samples));
    for (std::size_t i = 0; i < samples.light.size(); ++i)
        if (!std::isfinite(samples.light[i]))
            throw InputError(fmt::format("Sample {} of the {} profile is {}; every sample must be a finite number.", i,
                                         name, samples.light[i]));
    if (samples.total && !(*samples.total >= 0 && *samples.total <= 1))
        throw InputError(
            fmt::format("The total of the {} profile is {}; a share of the light that entered lies between 0 and 1.",
                        name, *samples.total));
}

// Light of the samples in rings about them.
double light_at(const RadialSamples& samples, std::size_t i) { return static_cast<double>(i) * samples.light[i]; }

double negative_share(const RadialSamples& samples) {
    double below = 0, all = 0;
    for (std::size_t i = 0; i < samples.light.size(); ++i) {
        all += std::abs(light_at(samples, i));
        below += std::max(0.0, -light_at(samples, i));
    }
    return all > 0 ? below / all : 0;
}

// Fits light = a exp(-r / L) to the last third by its two halves' sums; beyond the end r it holds 2 pi a L (r + L)
// exp(-r / L).
double share_beyond(const RadialSamples& samples) {
    const std::size_t n = samples.light.size(), half = std::max<std::size_t>(1, n / 6), first = n - 2 * half;
    double near = 0, far = 0, all = 0;
    for (std::size_t i = 0; i < n; ++i) all += light_at(samples, i);
    for (std::size_t i = 0; i < half; ++i) near += samples.light[first + i], far += samples.light[first + half + i];
    if (far <= 0) return 0;
    if (near <= far || all <= 0) return 1;
    const double h = static_cast<double>(half), L = h / std::log(near / far), end = static_cast<double>(n - 1);
    // In samples; far is a geometric series that ends at the last sample.
    const double ratio = std::exp(-1 / L), last = far * (1 - ratio) / (1 - std::pow(ratio, h)) * std::pow(ratio, h - 1);
    const double beyond = last * L * (end + L);
    return beyond / (all + beyond);
}

std::vector<double> coefficients(const RadialSamples& samples, const char* name, const HankelGrid& grid) {
    std::vector<double> f = grid.from_even(samples.light, samples.spacing_mm);
    if (!samples.total) return f;
    const double sum = f[0];
    if (!(sum > 0)) {
        if (*samples.total == 0) return std::vector<double>(f.size(), 0.0);
        throw InputError(fmt::format(
            "The {} profile holds no light, but its total is {}: it cannot be scaled. Measure it with longer "
            "exposures or a thinner layer.",
            name, *samples.total));
    }
    for (double& x : f) x *= *samples.total / sum;
    return f;
}

// As far below zero as noise may take what is black.
void expect_light(double total, const char* what) {
    if (total < 1 - largest_sum)
        throw InputError(
            fmt::format("The {} profile holds {:.4g} of the light, less than nothing. Were dark frames of another "
                        "exposure subtracted? Measure "
                        "again, or give its total.",
                        what, total));
}

}  // namespace

HomogeneousLayer measured_layer(const MeasuredProfile& measured, const HankelGrid& grid, MeasuredSummary& summary) {
    if (!(measured.thickness_mm > 0 && std::isfinite(measured.thickness_mm)))
        throw InputError(fmt::format(
            "The measured layer is {} mm thick; other thicknesses can be predicted from a thickness above 0 only.",
            measured.thickness_mm));
    check(measured.T, "transmission");
    check(measured.R, "reflection");
    const std::vector<double> T = coefficients(measured.T, "transmission", grid),
                              R = coefficients(measured.R, "reflection", grid);
    expect_light(T[0], "transmission");
    expect_light(R[0], "reflection");
    if (T[0] + R[0] > largest_sum)
        throw InputError(fmt::format(
            "The layer transmits {:.4g} and reflects {:.4g} of the light: {:.4g} in all, more than it got. Check the "
            "scale of the profiles or give the measured albedos.",
            T[0], R[0], T[0] + R[0]));
    const HomogeneousLayer layer(T, R, measured.thickness_mm);
    summary = {T[0],
               R[0],
               negative_share(measured.T),
               negative_share(measured.R),
               share_beyond(measured.T),
               share_beyond(measured.R),
               layer.clamped()};
    return layer;
}

std::vector<double> measured_reflection(const RadialSamples& R, const HankelGrid& grid, MeasuredSummary& summary) {
    check(R, "reflection");
    std::vector<double> f = coefficients(R, "reflection", grid);
    expect_light(f[0], "reflection");
    if (f[0] > largest_sum)
        throw InputError(
            fmt::format("The reflection profile sends back {:.4g} of the light, more than it got. Check its scale or "
                        "give its total.",
                        f[0]));
    summary = {};
    summary.R_total = f[0];
    summary.negative_R = negative_share(R);
    summary.beyond_R = share_beyond(R);
    return f;
}

}  // namespace voxtone::optics
