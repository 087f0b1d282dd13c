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

#include "base/job_result.h"
#include "base/progress.h"
#include "calibration/edge/edge_profiles.h"
#include "calibration/edge/edge_setup.h"
#include "io/files/json_writer.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct EdgeBench {
    double bias = 1;           ///< values are divided by it: the mu that a fit should find
    double noise = 0.001;      ///< standard error of a sample at 1; falls with the root of the value, not below a tenth
    double thickness_off = 0;  ///< slabs are thicker by this part than their profiles say
    double gel_from_mm = 0, gel_to_mm = 0;  ///< every layer of gel is drawn from this range; 0 and 0: as in the setup
    std::uint32_t paths = 1u << 19;
    std::uint64_t seed = 1;

    /// Throws InputError that names the option and the rule.
    void validate() const;
};

/// What is seen of one slab across the edge, before a camera looks at it: means over cells of `step_mm` from -reach_mm
/// to reach_mm.
struct RenderedSlab {
    static constexpr double step_mm = 0.005;
    std::string resin;
    double thickness_mm = 0;  ///< as it is said to be
    double gel_above_mm = 0, gel_below_mm = 0;
    double reach_mm = 0;
    std::array<std::vector<double>, 3> F;
};

/// Every resin at every thickness, in this order.
[[nodiscard]] std::vector<RenderedSlab> render_slabs(const optics::ResinSet& set, const EdgeSetup& setup,
                                                     const std::vector<double>& thickness_mm, const EdgeBench& bench,
                                                     Progress* progress = nullptr);
/// Means over the setup's pixels at `x_mm`, blurred by its camera.
[[nodiscard]] std::vector<double> seen_by_camera(const RenderedSlab& slab, std::size_t channel,
                                                 const std::vector<double>& x_mm, const EdgeSetup& setup);
/// As a camera of the setup and a bench of such faults would give them.
[[nodiscard]] std::vector<EdgeProfile> noisy_profiles(const std::vector<RenderedSlab>& slabs, const EdgeSetup& setup,
                                                      const EdgeBench& bench);

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

/// The set of the job, RGB, its roles only. Throws FileError, InputError.
[[nodiscard]] optics::ResinSet simulated_set(const EdgeSimulationJob& job);
/// Writes profiles that were rendered, and says so: to the object that `json` is in, and as a line for a person.
[[nodiscard]] std::string write_simulated_profiles(const EdgeSimulationJob& job, const EdgeSetup& setup,
                                                   const std::string& set_name, const std::vector<RenderedSlab>& slabs,
                                                   io::JsonWriter& json);
[[nodiscard]] JobResult run_edge_simulation(const EdgeSimulationJob& job, Progress& progress);

}  // namespace voxtone::calibration
