// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that both roads from photographs share: `calibrate photo` and `calibrate edge photo`.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/pictures/photograph.h"

namespace voxtone::cli {

/// Four points of a picture, eight numbers in pixels.
void add_corners_option(Verb& command, const char* name, std::vector<double>& corners, const char* help);
/// None where no numbers were given.
[[nodiscard]] std::optional<std::array<Eigen::Vector2d, 4>> four_points(const std::vector<double>& numbers);

/// auto, linear or srgb.
void add_coding_option(Verb& command, std::string& coding);
[[nodiscard]] io::SampleCoding coding_of(const std::string& word);

}  // namespace voxtone::cli
