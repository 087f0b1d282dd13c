// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs as measurements: samples as floats, as near to what the sensor counted as the file has them. PNG, TIFF,
// EXR, and the camera's own files (RAW) where OpenImageIO was built with LibRaw. Unlike `decode_image`, nothing is
// rounded to 16 bits, clamped or converted by a profile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "voxtone/base/progress.h"

namespace voxtone::io {

/// How samples stand for light.
enum class SampleCoding {
    linear,   ///< proportional to it
    srgb,     ///< as sRGB codes
    unknown,  ///< the file does not say: deep integers may be either
};

struct Photograph {
    std::string name;  ///< of the file, for messages
    std::uint32_t width_px = 0, height_px = 0;
    SampleCoding coding = SampleCoding::linear;
    int bits = 16;                        ///< of a sample in the file: 8, 16, 32 (float)
    std::vector<Eigen::Vector3f> pixels;  ///< rows from the top, as stored; integers have 1 as their largest value
    double exposure_s = 0;                ///< time of exposure, s, where the file tells it (EXIF), else 0

    [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y) const { return std::size_t{y} * width_px + x; }
};

/// Reads in a child process (isolate.h); the EXIF orientation is not applied. Throws FileError, InputError, Cancelled.
[[nodiscard]] Photograph read_photograph(const std::filesystem::path& file, const Progress* progress = nullptr);

/// sRGB codes become linear light.
void make_linear(Photograph& photograph);

/// The bytes of a file of the kind that the name's extension tells: .png or .tif (16 bits, linear; a PNG says so, TIFF
/// has no word for it), .exr (float). The time of exposure is written to .exr. With `bits` 8: .png of sRGB codes.
/// Throws UsageError for other extensions.
[[nodiscard]] std::vector<std::uint8_t> photograph_bytes(const Photograph& photograph, const std::string& file_name);

}  // namespace voxtone::io
