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
// In the air one path carries all channels; in a print each channel has its own, and channels that make little of the
// luminance have fewer: of linear sRGB red half as many as green, blue a quarter (tile_paths.h). A pixel gathers its
// samples by a filter (pixel_filter.h). Unbiased but for the filter's blur; the noise is estimated from the spread of
// the samples (exposure.h). The same bits for any number of threads.
//
// Memory of linear sRGB: 200 bytes a pixel besides the bodies.
#pragma once

#include <cstdint>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/camera/camera_scene.h"

namespace voxtone::optics {

struct CameraOptions {
    std::uint32_t samples = 64;  ///< per pixel, >= 1; at least 8, in fours; where an error is wanted, the least number
    double error = 0;            ///< wanted standard error of luminance (rms over each tile); 0: `samples` decides
    std::uint32_t max_samples = 4096;
    std::uint64_t seed = 1;
    double filter_px = 0.5;  ///< sigma of the Gaussian that pixels gather by; 0: each its own square
};

struct CameraPicture {
    static constexpr int tile_px = 16;
    int width_px = 0, height_px = 0;
    std::size_t channels = 0;
    // Rows from the top; value[(y * width + x) * channels + channel]. Radiance; 1 is a diffuser that lies in the open.
    std::vector<float> value, standard_error;
    std::vector<float> colour_error;     ///< of linear sRGB, three a pixel
    std::vector<std::uint32_t> samples;  ///< per pixel; 0: it was not drawn before the request to stop
    std::vector<std::uint8_t> sees;      ///< per pixel, in the middle: 0 sky, 1 ground, 2 a print, 3 a diffuser
    bool complete = true;                ///< false: stopped before all was as wanted
    double rms_error = 0;                ///< of luminance, over the pixels that see a body
    std::uint64_t paths = 0;             ///< from the camera
};

/// Where `progress` is asked to stop it leaves what there is, if every tile has something; else throws Cancelled.
/// Throws InputError where a material has no resin.
[[nodiscard]] CameraPicture take_picture(const CameraScene& scene, const CameraOptions& options, Progress& progress);

}  // namespace voxtone::optics
