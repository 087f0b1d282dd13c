// SPDX-License-Identifier: GPL-3.0-or-later
//
// How light spreads at the places of a cluster: R(r) as the mean over the responses of its points, of any kind of data
// of a surface, so that these can be compared.
//
// The light of each ring around a point is shared between the two knots beside it (profile_rings.h), the mean of the
// points is spread over annuli as wide as the points are apart, and what left beyond the window over one as wide as the
// window: with light from the neighbours, as it is seen there, which a cluster's own profile does not have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/profiles/profile_map.h"
#include "optics/numerics/hankel.h"
#include "scattering/local_profiles/local_profiles.h"
#include "scattering/local_profiles/profile_reconstruction.h"

namespace voxtone::scattering {

/// Of one channel.
struct PlaceProfile {
    std::vector<double> light;    ///< by knot, of one unit that entered
    double beyond = 0;            ///< what left beyond the window; 0 where that is not known
    std::vector<double> per_mm2;  ///< R at the knots
    [[nodiscard]] double total() const;
    [[nodiscard]] std::vector<double> coefficients(const optics::HankelGrid& grid, double pitch_mm) const;
};

/// By channel. `points`: at least one.
[[nodiscard]] std::vector<PlaceProfile> place_profiles(const LocalProfiles& profiles,
                                                       std::span<const std::size_t> points);
[[nodiscard]] std::vector<PlaceProfile> place_profiles(const optics::SampledBssrdf& responses,
                                                       std::span<const std::size_t> points);

/// Above what the noise of counts makes of the rms of such coefficients.
[[nodiscard]] double noise_of(const optics::SampledBssrdf& responses, const std::vector<PlaceProfile>& profiles,
                              std::size_t points);

/// Points of each cluster that are `margin` or more points away from the borders.
[[nodiscard]] std::vector<std::vector<std::size_t>> points_of_clusters(const io::ProfileMap& map, std::uint32_t margin);

/// One channel's wanted profile by knots as many points apart as the map's pixels, up to where its profiles end: the
/// inverse of radial_samples where its samples are as far apart as pixels.
[[nodiscard]] std::vector<double> knots_of(const optics::RadialSamples& samples, std::uint32_t radius, double pitch_mm);

/// How many such knots there are behind the first.
[[nodiscard]] std::uint32_t radius_of_map(const io::ProfileMap& map);

/// The map's profiles by point, as factors again. Contract: pixels are squares.
[[nodiscard]] LocalProfiles profiles_of_map(const io::ProfileMap& map);

}  // namespace voxtone::scattering
