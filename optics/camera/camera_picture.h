// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture by light paths, its errors, and how it is wanted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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

}  // namespace voxtone::optics
