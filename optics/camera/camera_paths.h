// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture of printed bodies as a camera would take it: light paths from the camera to the light.
//
// A path begins at a random place of a pixel and goes where light could have come from (reciprocity):
//   resin     reflected or refracted by Fresnel's equations at a surface that is smooth or rough (rough_boundary.h);
//             within, scattered and absorbed voxel by voxel (path_packets.h); out again, to whatever is there: another
//             part of the body, another body, the ground, the sky. Nothing is cut off: Russian roulette only
//   diffuser  (the ground, a target beside its print): the sky drawn by its luminance and a direction drawn by the
//             cosine law, weighed by the balance heuristic (E. Veach, L. Guibas, "Optimally combining sampling
//             techniques for Monte Carlo rendering", SIGGRAPH 1995)
//   sky       its radiance counts, and the path ends
// At the first surface of a path the mirrored part and the part that enters are both followed.
//
// Every channel has its own paths; all channels of a sample begin at the same place of its pixel. Unbiased; the noise
// is estimated from the spread of the samples of a pixel. The same bits for any number of threads.
//
// Memory: two floats and two doubles a pixel and channel besides the bodies.
#pragma once

#include <cstdint>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/camera/camera_scene.h"

namespace voxtone::optics {

struct CameraOptions {
    std::uint32_t samples = 64;  ///< per pixel and channel, >= 2; where an error is wanted, the least number
    double error = 0;            ///< wanted standard error of luminance (rms over each tile); 0: `samples` decides
    std::uint32_t max_samples = 4096;
    std::uint64_t seed = 1;
};

struct CameraPicture {
    static constexpr int tile_px = 16;
    int width_px = 0, height_px = 0;
    std::size_t channels = 0;
    // Rows from the top; value[(y * width + x) * channels + channel]. Radiance; 1 is a diffuser that lies in the open.
    std::vector<float> value, standard_error;
    std::vector<std::uint32_t> samples;  ///< per pixel; 0: it was not drawn before the request to stop
    std::vector<std::uint8_t> sees;      ///< per pixel, in the middle: 0 sky, 1 ground, 2 a print, 3 a diffuser
    bool complete = true;                ///< false: stopped before all was as wanted
    double rms_error = 0;                ///< of luminance, over the pixels that see a body
    std::uint64_t paths = 0;             ///< in all channels
};

/// Where `progress` is asked to stop it leaves what there is, if every tile has something; else throws Cancelled.
/// Throws InputError where a material has no resin.
[[nodiscard]] CameraPicture take_picture(const CameraScene& scene, const CameraOptions& options, Progress& progress);

}  // namespace voxtone::optics
