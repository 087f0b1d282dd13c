// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body as it was predicted, for photographs of it to be compared with: a mesh with a vertex for each place that was
// predicted, mm in the model's frame.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "optics/camera/camera.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct PredictedBody {
    std::string name;   ///< of the stack, for messages
    std::string model;  ///< that predicted
    std::string illuminant = "D65";
    std::vector<Eigen::Vector3f> position, normal;
    std::vector<Eigen::Vector3f> rgb;  ///< linear sRGB, 1 is thick white resin in even light
    std::vector<std::array<std::uint32_t, 3>> triangles;
    double cell_mm = 0;  ///< from place to place
    optics::ResinSet set;
    /// Where the user says that the camera stands, of a picture of so many pixels; of another side, by its name.
    std::function<optics::CameraView(int width_px, int height_px)> start;
    struct OtherSide {
        std::string name;
        std::function<optics::CameraView(int width_px, int height_px)> start;
    };
    std::vector<OtherSide> other_sides;
    /// [place * directions + direction]: 1 where a place sees the sky in a direction, past the body's other parts.
    std::function<std::vector<std::uint8_t>(std::span<const std::uint32_t> places,
                                            std::span<const Eigen::Vector3d> directions)>
        sees_sky;
    /// What an eye makes of pictures of this size, cells in mm.
    using Seen = std::function<std::vector<Eigen::Vector3f>(std::span<const Eigen::Vector3f>)>;
    std::function<Seen(int columns, int rows, const Eigen::Vector2d& cell_mm)> eye;

    [[nodiscard]] Eigen::Vector3d middle() const;
};

}  // namespace voxtone::calibration
