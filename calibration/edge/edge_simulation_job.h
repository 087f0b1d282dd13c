// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate edge simulate`: the profiles that a bench would measure of known resins, to rehearse the road and
// to test it. Rendered path by path (optics/edge/edge_scene_paths.h), not from a dictionary.
//
// What a bench does wrong can be asked for: a common factor on all values, slabs that are thicker than they are said to
// be, noise; gel, glass and blur are those of the setup that is simulated, which may be another than the one that a fit
// is given.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voxtone/base/job_result.h"
#include "voxtone/base/progress.h"
#include "voxtone/calibration/edge/edge_profiles.h"
#include "voxtone/calibration/edge/edge_setup.h"
#include "voxtone/optics/media/resins.h"

namespace voxtone::calibration {

struct EdgeBench {
    double bias = 1;           ///< values are divided by it: the mu that a fit should find
    double noise = 0.001;      ///< standard error of a sample at 1; falls with the root of the value, not below a tenth
    double thickness_off = 0;  ///< slabs are thicker by this part than their profiles say
    std::uint32_t paths = 1u << 19;
    std::uint64_t seed = 1;

    /// Throws InputError that names the option and the rule.
    void validate() const;
};

/// Every resin at every thickness, in this order.
[[nodiscard]] std::vector<EdgeProfile> simulate_edge_profiles(const optics::ResinSet& set, const EdgeSetup& setup,
                                                              const std::vector<double>& thickness_mm,
                                                              const EdgeBench& bench, Progress* progress = nullptr);

struct EdgeSimulationJob {
    std::string setup;                   ///< setup.json; empty: the defaults
    std::string resins = "vero-opaque";  ///< set or file, RGB
    std::vector<std::string> roles;      ///< empty: all
    std::vector<double> thickness_mm{0.5, 1};
    EdgeBench bench;
    std::string out;  ///< profiles.csv
    bool overwrite = false;

    void validate() const;
};

[[nodiscard]] JobResult run_edge_simulation(const EdgeSimulationJob& job, Progress& progress);

}  // namespace voxtone::calibration
