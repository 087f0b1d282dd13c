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

#include "optics/media/resins.h"

namespace voxtone::calibration {

/// How what it sends back moves with its resins, means over blocks of cells (slicer/predict/resin_response.h).
struct ResinResponse {
    static constexpr int block = 4;  ///< cells along each side
    int columns = 0, rows = 0;       ///< of blocks
    std::size_t channels = 0, resins = 0;
    std::vector<float> value;          ///< [block * channels + channel]
    std::vector<float> by_extinction;  ///< [(block * resins + resin) * channels + channel]
    std::vector<float> by_absorption;  ///< the same; empty where it was not asked for
};

struct PredictedPrint {
    std::string name;                ///< of the stack, for messages
    std::string model;               ///< that predicted
    std::string illuminant = "D65";  ///< lamp under which it is looked at
    bool of_body = false;            ///< a body as its photograph shows it; else flat
    int columns = 0, rows = 0;
    Eigen::Vector2d cell_mm = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector3f> rgb;       ///< linear sRGB, 1 is thick white resin in even light
    std::vector<Eigen::Vector3f> by_paths;  ///< the same by light paths, up to a gain for each of red, green, blue
    optics::ResinSet set;                   ///< by which it was predicted
    ResinResponse response;
    /// What an eye makes of a picture of this print.
    std::function<std::vector<Eigen::Vector3f>(std::span<const Eigen::Vector3f>)> seen;

    /// "VeroCyan (C)"
    [[nodiscard]] std::string resin(std::size_t r) const {
        return set.resins[r].name + " (" + set.resins[r].role + ")";
    }
    [[nodiscard]] std::size_t cells() const { return rgb.size(); }
    [[nodiscard]] std::size_t index(int column, int row) const {
        return std::size_t(row) * std::size_t(columns) + std::size_t(column);
    }
    [[nodiscard]] Eigen::Vector2d size() const { return {columns, rows}; }
};

}  // namespace voxtone::calibration
