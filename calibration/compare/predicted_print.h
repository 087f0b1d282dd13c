// SPDX-License-Identifier: GPL-3.0-or-later
//
// A flat print as it was predicted, seen from above, for its photographs to be compared with.
//
// Cells lie in rows from the top (the largest y), as pixels of a picture; places on the print are told in cells, (0, 0)
// its upper left corner, y down.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

struct PredictedPrint {
    std::string name;   ///< of the stack, for messages
    std::string model;  ///< that predicted
    int columns = 0, rows = 0;
    Eigen::Vector2d cell_mm = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector3f> rgb;  ///< linear sRGB, relative to the white resin
    std::vector<std::string> resins;   ///< "VeroCyan (C)"
    /// d ln rgb / d ln extinction of a resin: [cell * resins + resin].
    std::vector<Eigen::Vector3f> by_extinction;
    /// What an eye makes of a picture of this print.
    std::function<std::vector<Eigen::Vector3f>(std::span<const Eigen::Vector3f>)> seen;

    [[nodiscard]] std::size_t cells() const { return rgb.size(); }
    [[nodiscard]] std::size_t index(int column, int row) const {
        return std::size_t(row) * std::size_t(columns) + std::size_t(column);
    }
    [[nodiscard]] Eigen::Vector2d size() const { return {columns, rows}; }
};

}  // namespace voxtone::calibration
