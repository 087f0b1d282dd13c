// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate trace`: does a print of layered profiles spread light as it was asked to? Every voxel of the slab
// is traced from each pixel of its map, and R(r) at the places of each cluster set beside what the map asks there and,
// with the data set that the map was made from, beside that and its factors: the columns of Fig. 7 (Hasan et al. 2010).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"

namespace voxtone::scattering {

struct LaminateTraceJob {
    std::string stack;           ///< what `slice --show layered-profile` made of a picture
    std::string profiles;        ///< its map; empty: the one that its job.json names
    std::string dataset;         ///< that the map was made from; empty: none
    std::string resins;          ///< empty: those of its job
    std::uint32_t paths = 1000;  ///< per pixel and channel, [1, 2^24]
    std::uint64_t seed = 1;
    std::vector<std::string> files;  ///< to write: .png (the columns as pictures), .svg (R of the largest clusters)
    bool overwrite = false;
};

/// The same for the report of a print, without files: a table of clusters, and the columns as a picture.
struct SeenSpread {
    std::string summary;
    std::vector<std::string> header;  ///< of the table by cluster: R and the mm that half of it leaves within, ...
    std::vector<std::vector<std::string>> rows;  ///< ... as the map asks and as printed
    std::string caption;
    std::vector<std::uint8_t> png;
    std::uint32_t width_px = 0, height_px = 0;
};
[[nodiscard]] SeenSpread seen_spread(const LaminateTraceJob& job, Progress& progress);

/// Throws Error (with its exit code): also for a body, whose surface has no place that lies flat as a map's.
[[nodiscard]] JobResult run_laminate_trace(const LaminateTraceJob& job, Progress& progress);

}  // namespace voxtone::scattering
