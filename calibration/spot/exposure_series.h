// SPDX-License-Identifier: GPL-3.0-or-later
//
// A series of photographs of one scene at rising exposure times, and the dark frames that belong to it: how a user
// names them, and what is wrong with them.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct ExposureFile {
    std::filesystem::path file;
    double seconds = 0;  ///< 0: as the file says (EXIF)
};

/// "FILE", "FILE@SECONDS" or "FILE@1/15". A file whose own name holds an @ needs its seconds. Throws UsageError.
[[nodiscard]] ExposureFile parse_exposure(const std::string& text);

/// 0.0667 as "1/15 s", 2 as "2 s".
[[nodiscard]] std::string seconds_text(double seconds);

struct Exposure {
    io::Photograph photograph;
    double seconds = 0;
};

/// Of all of them.
[[nodiscard]] std::vector<std::filesystem::path> names_of(std::span<const ExposureFile> files);

/// Reads one, linear. Throws InputError for sRGB codes and where neither user nor file says how long it was; FileError.
[[nodiscard]] Exposure read_exposure(const ExposureFile& file, io::PhotographReader& reader,
                                     const Progress* progress = nullptr);

/// Throws InputError unless both have one size and, within 1 %, one time.
void expect_dark_frame(const Exposure& lit, const Exposure& dark);

}  // namespace voxtone::calibration
