// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone calibrate edge simulate`: the profiles of known resins (edge_simulation_job.h), and the photographs in which
// a bench would see them (bench_camera.h), with their list (bench_list.h).
#pragma once

#include <string>

#include "calibration/rehearsal/bench_camera.h"

namespace voxtone::calibration {

struct BenchSimulationJob {
    EdgeSimulationJob profiles;  ///< its `out` may be empty where there are photographs
    BenchCameraOptions camera;
    std::string photos;  ///< folder of the photographs; empty: none
    int shots = 2;       ///< of every slab

    void validate() const;
};

[[nodiscard]] JobResult run_bench_simulation(const BenchSimulationJob& job, Progress& progress);

}  // namespace voxtone::calibration
