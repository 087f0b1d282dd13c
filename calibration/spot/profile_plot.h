// SPDX-License-Identifier: GPL-3.0-or-later
//
// A profile file as a picture: R and T over the distance, light on a logarithmic scale, a line per channel and a band
// of two standard errors to each side where they are known.
#pragma once

#include <string>

#include "io/profiles/profile_file.h"

namespace voxtone::calibration {

/// An SVG file.
[[nodiscard]] std::string profile_plot(const io::ProfileFile& profile);

}  // namespace voxtone::calibration
