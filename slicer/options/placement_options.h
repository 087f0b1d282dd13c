// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a model is to lie on the tray (printer/placement.h).
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace voxtone::slicer {

/// A unit of length that the user named.
struct FileUnit {
    std::string name;
    double mm = 1;
};

struct PlacementOptions {
    std::optional<FileUnit> unit{};  ///< of the model's numbers; nothing: the file's own, mm where it has none
    double scale = 1;                ///< > 0
    double size_mm = 0;              ///< largest extent, after `scale`; 0: as the file has it
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    std::string rotation_text{};                           ///< the same as option_values.h reads it; empty: none
    bool flip_x = false, flip_y = false, swap_xy = false;  ///< the swap comes first
};

}  // namespace voxtone::slicer
