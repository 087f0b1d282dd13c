// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies of one colour, which need no Monte Carlo: slabs have an exact solution; a slab looks the same however it is
// tilted; a sphere is one colour.
#pragma once

#include <string>
#include <vector>

#include "optics/transport/transport.h"

namespace voxtone::accuracy {

struct HomogeneousErrors {
    std::size_t mixtures = 0;
    double mean = 0, percentile_95 = 0, max = 0;  ///< CIEDE2000, media-relative
    std::array<double, 3> largest{};              ///< |appearance - exact| per channel
    std::string worst;                            ///< the mixture of `max`
};

/// Slabs of 1.08 mm with mirrored sides over black of every mixture of C M Y K W in steps of 1 / `steps` (10: 1001
/// mixtures), against adding-doubling. Mirrors a third of a millimetre apart pass on one image a sweep:
/// `options.sweeps` is set to 12.
[[nodiscard]] HomogeneousErrors compare_mixtures(optics::TransportOptions options, int steps);

/// How much a body of one colour is not one colour, media-relative, CIEDE2000.
struct Spread {
    std::string body, colour;
    /// Largest difference between the mean colours of any two tilts (slabs) or of any two of 26 directions (sphere).
    double between = 0;
    /// Of single viewing cells from the mean of all, by area.
    double cells_mean = 0, cells_95 = 0;
    /// Mean L* of each tilt, or of the 26 directions from bottom to top, y and x rising.
    std::vector<double> lightness;
};

/// A slab of 2.4 x 2.4 x 1 mm at eleven tilts about y, then about z, degrees: 0, 10, 25, 45, 60, 80,
/// 90 about y alone; 35 and 45, 60 and 30, 45 and 90, 90 and 90 (the cells within 0.7 mm of the middle of its large
/// sides), and a sphere of 2.4 mm.
[[nodiscard]] std::vector<Spread> one_colour_bodies(const optics::TransportOptions& options);

}  // namespace voxtone::accuracy
