// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light paths between the base of the sheet, the camera and the light, counted by their number of scatterings.
//
// The scene (edge_assembly.h) does not change along x but for the reflectance R(x) of the sheet's diffuse base, which
// forgets whence light came. So all of it is in paths that end at their first meeting with the base:
//
//   from the camera     to the light (without the base), or to the base at a distance x
//   from the base       to the base again at a distance x
//   from the light      to the base: by reciprocity what the base sends to the light, and far less noisy
//
// edge_response.h puts them together for any R(x): one path serves every place of the edge. Resin absorbs nothing on
// these paths; a path of n scatterings counts alpha^n in a resin of albedo alpha, so one run serves all albedos,
// exactly. Both ways x and -x are alike, so only |x| is kept; the extent along y is summed over.
//
// Paths go against the light from the camera; from the base they start in directions of diffuse light. Free paths are
// exponential, scattering is Henyey and Greenstein's, every boundary is met as rough_interface.h says. No roulette, no
// cap but `most_scatterings`, of which it is counted how many met it.
//
// Units mm, mm^-1. The same counts for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "optics/edge/edge_assembly.h"

namespace voxtone::optics {

/// Numbers of scatterings, kept one by one up to 24, then in bins 8 % wide.
class OrderBins {
public:
    OrderBins();
    [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
    [[nodiscard]] std::size_t of(std::uint32_t scatterings) const;
    /// Mean of alpha^n over the bin; 0 <= alpha <= 1.
    [[nodiscard]] double mean_power(std::size_t bin, double alpha) const;
    static constexpr std::uint32_t most_scatterings = 200000;

private:
    std::vector<std::uint32_t> first_;
};

/// Distances |x| along the sheet: edges from 0, the first bin 2 um, the others 1.1 times as far each, to 30 mm.
class DistanceBins {
public:
    DistanceBins();
    [[nodiscard]] std::size_t size() const { return edges_.size() - 1; }
    [[nodiscard]] std::size_t of(double distance_mm) const;  ///< the last for what lies beyond
    [[nodiscard]] const std::vector<double>& edges() const { return edges_; }

private:
    std::vector<double> edges_;
};
[[nodiscard]] const OrderBins& order_bins();
[[nodiscard]] const DistanceBins& distance_bins();

/// What paths from one place came to, by order bin.
struct PathCounts {
    std::vector<std::uint32_t> to_light, elsewhere;  ///< left through the top: in the light's window, or not
    std::vector<std::uint32_t> to_base;              ///< order bin * distance bins + distance bin
    std::uint64_t paths = 0, lost = 0;               ///< started; ended by the cap
};

/// What is traced.
struct EdgeRun {
    EdgeAssembly assembly;
    double slab_mm = 0.5, sigma_t = 5, g = 0.4;  ///< sigma_t > 0
    DirectionWindow camera{1, 1};
    DirectionWindow light{0, 1};  ///< see light_window
    std::uint32_t paths = 1u << 17;
    std::uint64_t seed = 1;
};

/// Batches are independent of each other: their spread tells the noise.
inline constexpr std::size_t edge_batches = 32;
struct PathBatch {
    PathCounts camera, base, light;
};
using EdgeCounts = std::array<PathBatch, edge_batches>;

/// `paths` from the camera, half as many from the base and from the light. Throws Cancelled.
[[nodiscard]] EdgeCounts trace_edge_paths(const EdgeRun& run, const Progress* progress = nullptr);

}  // namespace voxtone::optics
