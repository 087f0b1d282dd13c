// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate search`: for each wanted reflection profile the laminate that shows it (docs/laminate-search.md).
//
// Writes for each target TARGET.json, with TARGET the name of its file without ending, into the folder:
// NAME.laminate.json (io/profiles/layer_sequence_file.h) and NAME.svg, the profiles of what is wanted and found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "scattering/design/laminate_materials.h"
#include "scattering/jobs/laminate_setting.h"

namespace voxtone::scattering {

struct LaminateSearchJob {
    std::vector<std::string> targets;  ///< profile files; of a measured layer its R is the target
    LaminateSettingOptions setting;
    std::string out;
    bool overwrite = false;
    double thickness_mm = 5;
    std::uint32_t steps = 64, max_blocks = 6;
    double dc_weight = 1;
    bool edge = false;  ///< coefficients weigh what they do beyond the edge of a shadow (ProfileWeights)
    std::vector<std::string> clear_top;  ///< "T=0.2mm": the material T stays that far from the top
    bool refine = true;
    double layer_mm = 0;             ///< of the printer; 0: any thickness
    double known_mm = 0;             ///< thickness at which resins are known; 0: what fits (laminate_materials.h)
    int rounds = 2;                  ///< searches, each corrected in all directions, [0, 20]; 0: never
    std::uint32_t paths = 1u << 17;  ///< per layer and channel, and per laminate and channel, >= 2
    std::uint64_t seed = 1;
};

/// Throws Error (with its exit code).
[[nodiscard]] JobResult run_laminate_search(const LaminateSearchJob& job, Progress& progress);

}  // namespace voxtone::scattering
