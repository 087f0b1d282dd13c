// SPDX-License-Identifier: GPL-3.0-or-later
//
// Monte Carlo of printed voxels, kept in a folder under the digest of everything that decides it, so that a second run
// of the benchmark traces nothing that it has traced before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "optics/scene/appearance_model.h"
#include "optics/scene/boundary.h"

namespace voxtone::loop_benchmark {

struct Tracing {
    std::uint32_t paths = 64;  ///< per cell and channel
    std::uint64_t seed = 1;
    const optics::BodyBoundary* boundary = nullptr;
    std::string boundary_name;  ///< stands for the boundary in the digest
};

/// SHA-256 of size, pitch and the layers' XXH64.
[[nodiscard]] std::string volume_digest(const optics::ResinVolume& volume);

/// value[cell * channels + channel]. `digest`: that of the scene's volume.
[[nodiscard]] std::vector<float> traced(const optics::Scene& scene, const std::string& digest,
                                        const optics::Surface& surface, const Tracing& how,
                                        const std::filesystem::path& cache);

}  // namespace voxtone::loop_benchmark
