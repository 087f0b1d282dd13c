// SPDX-License-Identifier: GPL-3.0-or-later
//
// One photograph of a print: where the print lies in it, and its cells without uneven light, in linear sRGB up to
// exposure. With a colour chart beside the print its matrix makes colours of the camera's channels; without one they
// are taken for red, green and blue, and the camera's white balance stays in them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/compare/predicted_print.h"
#include "calibration/compare/print_place.h"
#include "calibration/photo/checker_chart.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct ReadPrintOptions {
    io::SampleCoding coding = io::SampleCoding::unknown;  ///< unknown: as the file says, else sRGB of 8 bits
    std::optional<CheckerChart> checker;                  ///< nothing: there is none
    std::optional<std::array<Eigen::Vector2d, 4>> corners, checker_corners;  ///< by hand, px
};

struct PrintReading {
    std::string photograph;
    std::uint32_t width_px = 0, height_px = 0;
    FoundPrint found;
    CellSamples cells;  ///< linear sRGB
    bool light_from_ground = false, light_from_body = false;
    double light_falls_to = 1;  ///< least light on the print / most
    bool has_checker = false;
    std::optional<double> camera_blur_mm;  ///< standard deviation, from the print's edge against the ground
    double clipped = 0;                    ///< share of the cells left out
    double left_out = 0;                   ///< of what is seen of a body: aslant, rims, shadows, gloss
    double overlap = 1;                    ///< of a body's outlines
    struct Camera {
        Eigen::Vector3d position = Eigen::Vector3d::Zero(), look_at = Eigen::Vector3d::Zero();  ///< mm, model's frame
        Eigen::Vector3d up = Eigen::Vector3d::UnitZ();                                          ///< in the picture
        double focal_mm = 0;                                                                    ///< of a frame of 36 mm
    };
    std::optional<Camera> camera;  ///< before a body
    std::vector<std::string> warnings;
};

/// To linear light; `coding` as ReadPrintOptions has it.
void decode(io::Photograph& photo, io::SampleCoding coding);

/// Throws InputError that names the photograph, what is wrong and what to try.
[[nodiscard]] PrintReading read_print(io::Photograph photograph, const PredictedPrint& print,
                                      const ReadPrintOptions& options);

}  // namespace voxtone::calibration
