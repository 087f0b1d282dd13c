// SPDX-License-Identifier: GPL-3.0-or-later
//
// What local profiles (local_profiles.h) say of a surface, and how near that comes to the responses they stand for.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "optics/monte_carlo/sampled_bssrdf.h"
#include "optics/profiles/measured_profile.h"
#include "scattering/local_profiles/local_profiles.h"

namespace voxtone::scattering {

/// Of one channel, over the pairs of the data set. R: data, R': sqrt(P P).
struct ReconstructionError {
    double light_error = 0;  ///< sum |R - R'| / sum R: share of the light that is in the wrong place
    double noise_error = 0;  ///< about what the noise of R alone would make of it, were R' the truth
    /// sqrt(sum((R - R')^2 - variance of R) / sum R^2), variance by R': what noise does not explain. Unbiased for other
    /// data of the surface than R' was found from (else too small: R' follows some of the noise). 0 where noise
    /// explains all.
    double excess = 0;
    double light = 0;  ///< sum R' / sum R
    double albedo_error = 0,
           largest_albedo_error = 0;  ///< root mean square and largest, over points: light within the window
};

[[nodiscard]] ReconstructionError reconstruction_error(const optics::SampledBssrdf& responses, std::size_t channel,
                                                       const LocalProfiles& profiles);

/// R'(x, x + offset) of one channel for a window around a point: (2 radius + 1)^2 values, rows from the top; 0 outside
/// of the window and the grid. And the same of the data.
[[nodiscard]] std::vector<double> response_at(const LocalProfiles& profiles, std::size_t channel, std::size_t point);
[[nodiscard]] std::vector<double> response_at(const optics::SampledBssrdf& responses, std::size_t channel,
                                              std::size_t point);

/// Light and mean distance that it goes, by point.
struct SpreadImages {
    std::vector<double> albedo;    ///< light within the window / light that entered
    std::vector<double> width_mm;  ///< mean distance from where it entered, of the light within the window
};
/// Of R' in the grid: what is seen of the surface. And the same of the data.
[[nodiscard]] SpreadImages spread_of(const LocalProfiles& profiles, std::size_t channel);
[[nodiscard]] SpreadImages spread_of(const optics::SampledBssrdf& responses, std::size_t channel);

/// The light of an endless surface of one profile within the window, of one unit that entered, by ring. P: by knot.
[[nodiscard]] std::vector<double> light_by_ring(std::span<const double> P, std::span<const ProfileRing> rings,
                                                double pitch_mm);
/// The same by knot: each ring's is shared between its two knots.
[[nodiscard]] std::vector<double> light_by_knot(std::span<const double> P, std::span<const ProfileRing> rings,
                                                double pitch_mm);

/// A profile as samples at 0, pitch, 2 pitch, ... mm with the light that it has on the grid: the sample at 0, where
/// only the light of the whole cell is known, makes up for the difference to straight lines.
[[nodiscard]] optics::RadialSamples radial_samples(std::span<const double> P, std::uint32_t radius, double pitch_mm);

}  // namespace voxtone::scattering
