// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colour charts of known colours that lie beside a target in its photograph. `colorchecker24` is in the program
// (data/checkers/); one's own is a file of the same form (format "voxtone-checker", version 1).
//
// Coordinates of a chart: cells of 1 x 1, the first one's upper left corner at (0, 0), y down; a patch lies in the
// middle of its cell. The corners of the chart, where a person or a program points at them, are those of the cells.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

struct CheckerChart {
    std::string name;
    int columns = 0, rows = 0;
    std::vector<std::string> names;            ///< of patches, row by row from the upper left
    std::vector<Eigen::Vector3d> linear_srgb;  ///< relative to a perfect white; may leave [0, 1]
};

/// The chart "colorchecker24" or one from a file. Throws InputError, FileError.
[[nodiscard]] CheckerChart find_checker(const std::string& name_or_file);

}  // namespace voxtone::calibration
