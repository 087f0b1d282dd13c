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
    bool light_from_ground = false;
    double light_falls_to = 1;  ///< least light on the print / most
    bool has_checker = false;
    std::optional<double> camera_blur_mm;  ///< standard deviation, from the print's edge against the ground
    double clipped = 0;                    ///< share of the cells left out
    std::vector<std::string> warnings;
};

/// Throws InputError that names the photograph, what is wrong and what to try.
[[nodiscard]] PrintReading read_print(io::Photograph photograph, const PredictedPrint& print,
                                      const ReadPrintOptions& options);

}  // namespace voxtone::calibration
