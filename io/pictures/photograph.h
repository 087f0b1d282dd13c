// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs as measurements: samples as floats, as near to what the sensor counted as the file has them. PNG, TIFF,
// EXR, and the camera's own files (RAW) where OpenImageIO was built with LibRaw. Unlike `decode_image`, nothing is
// rounded to 16 bits, clamped or converted by a profile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/files/packed_values.h"

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
    int orientation = 1;                  ///< EXIF's, 1 to 8: as what it is stored; a RAW's is not told

    [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y) const { return std::size_t{y} * width_px + x; }
};

/// Reads by another program (io/files/isolate.h); the EXIF orientation is not applied. Throws FileError, InputError,
/// Cancelled.
[[nodiscard]] Photograph read_photograph(const std::filesystem::path& file, const Progress* progress = nullptr);

class IsolatedProgram;

/// Reads many by one program, which takes 0.2 s of a processor to start: more than most pictures take. By one thread.
class PhotographReader {
public:
    /// All that may be asked for; those that are not there are said when they are.
    /// `by_profile`: whole numbers become sRGB codes where an ICC profile of RGB says what they are, as in phones'
    /// pictures; else they stay what they are in the file.
    explicit PhotographReader(std::span<const std::filesystem::path> files, bool by_profile = false);
    PhotographReader(const PhotographReader&) = delete;
    PhotographReader& operator=(const PhotographReader&) = delete;
    ~PhotographReader();

    /// As read_photograph. After an error the next one is read by another program.
    [[nodiscard]] Photograph read(const std::filesystem::path& file, const Progress* progress = nullptr);

private:
    std::vector<std::string> files_;
    bool by_profile_;
    std::unique_ptr<IsolatedProgram> program_;  ///< waits for the next one; null: none has been read
};

/// Turns the pixels as the orientation says, which then is 1: as the picture is shown. A camera that looks down does
/// not know how it is held: of several pictures from one place each may be turned otherwise.
void turn_upright(Photograph& photograph);

/// sRGB codes become linear light.
void make_linear(Photograph& photograph);

/// To bytes and back, on one machine; samples that are not finite come back as 0. Unpacking throws InputError when the
/// bytes are no photograph.
[[nodiscard]] std::vector<std::byte> pack(const Photograph& photograph);
[[nodiscard]] Packing packing_of(Photograph photograph);
[[nodiscard]] Photograph unpack_photograph(std::span<const std::byte> bytes);

}  // namespace voxtone::io
