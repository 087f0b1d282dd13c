// SPDX-License-Identifier: GPL-3.0-or-later
//
// A photograph of a target that was never printed: to rehearse the road from photographs to resins, and to test it
// against a truth that is known.
//
// The target lies on a dark sheet beside a colour chart. Light: one lamp at 45 degrees, at a finite distance or far
// away. Camera: a pinhole that may be tilted, and sensor.h. Dirt: dust (dark and light specks) and scratches (light
// lines) on the target.
//
// Simpler than the world: squares are even (light between them moves their level alone, square_ends.h), mixtures are
// smooth, the lens distorts by its cubic term alone and does not flare, and camera and chart see colours that a matrix
// can relate exactly.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "calibration/rehearsal/sensor.h"
#include "calibration/target/target_scene.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct PhotoOptions : Sensor {
    std::uint32_t width_px = 2400, height_px = 1600;  ///< 64 to 20000 each
    int rays = 3;                                     ///< along each side of a pixel, 1 to 16
    double tilt_x_deg = 0, tilt_y_deg = 0;            ///< of the camera about the picture's axes, +-50
    double turn_deg = 0;                              ///< of the picture
    double margin = 0.06;                             ///< of the picture, free on each side, [0, 0.4]
    double distance = 3;                              ///< of the camera, in widths of the scene, >= 1
    double lamp_mm = 1000;                            ///< distance of the lamp, 0: far away; >= 100
    double lamp_azimuth_deg = 120;
    double blur_px = 0.8;  ///< standard deviation
    double lens = 0;       ///< barrel distortion: so much nearer lie the picture's corners to its middle, [-0.2, 0.2]
    double sheet = 0.03;   ///< reflectance of what all lies on, [0, 1]
    int dust = 60, scratches = 6;  ///< how many
    bool mirrored = false;         ///< as a print is on a printer that mirrors
    bool checker = true;           ///< the chart lies beside the target
    int checker_turns = 1;         ///< quarter turns of the chart
    double checker_cell_mm = 12;   ///< edge of a cell
    double checker_error = 0;      ///< relative standard deviation of its patches from what is known of them

    /// Throws InputError that names the option and the rule it breaks.
    void validate() const;
};

struct SimulatedPhoto {
    io::Photograph photograph;
    std::vector<Eigen::Vector2d> target_corners_px;  ///< upper left, upper right, lower right, lower left of the target
    std::vector<Eigen::Vector2d> checker_corners_px;               ///< of the chart's cells, in the chart's own order
    std::function<Eigen::Vector2d(const Eigen::Vector2d&)> to_px;  ///< from mm of the target
};

/// `colours` are those of the target (target_scene.h). The same bits for any number of threads.
[[nodiscard]] SimulatedPhoto simulate_photo(const Target& target, const TargetColours& colours,
                                            const CheckerChart& chart, const PhotoOptions& options);

/// Anything flat, mm from its lower left corner, in linear sRGB.
struct FlatThing {
    Eigen::Vector2d size_mm = Eigen::Vector2d::Zero();
    std::function<Eigen::Vector3d(const Eigen::Vector2d&)> at;
};
/// The same of it.
[[nodiscard]] SimulatedPhoto simulate_photo(const FlatThing& thing, const CheckerChart& chart,
                                            const PhotoOptions& options);

}  // namespace voxtone::calibration
