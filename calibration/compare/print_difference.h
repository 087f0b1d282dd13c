// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a photographed print differs in from its prediction, and how much of that is the exposure, a cast, a spread, a
// resin, and the rest.
//
// CIEDE2000 is that of both as an eye sees them (PredictedPrint::seen), cell by cell, away from the print's edge.
// Exposure is the weighted median of the ratios of luminance, the cast that of each channel after it: most of a print
// that is right stays right however far off the rest is. Without a colour chart the camera's exposure and white balance
// cannot be told from the print's lightness and cast, so both are taken out of what is reported; with one the cast is
// the print's and stays in. The exposure is taken out always: how light falls on a print is not known to a few percent.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/compare/predicted_print.h"
#include "calibration/compare/print_reading.h"
#include "calibration/compare/print_regions.h"
#include "calibration/compare/resin_hint.h"
#include "optics/colour/colour.h"

namespace voxtone::calibration {

/// A square of the print.
struct PrintTile {
    Eigen::Vector2d corner_mm = Eigen::Vector2d::Zero(), size_mm = Eigen::Vector2d::Zero();  ///< from the upper left
    Eigen::Vector3d predicted = Eigen::Vector3d::Zero(), printed = Eigen::Vector3d::Zero();  ///< linear sRGB, means
    Eigen::Vector3d off_lab = Eigen::Vector3d::Zero();  ///< L, a, b of the print less those of the prediction
    double ciede2000 = 0;
};

/// "printed 3.1 lighter than predicted", "printed 2.0 darker and 1.2 bluer than predicted".
[[nodiscard]] std::string tile_words(const PrintTile& tile);

struct PrintDifference {
    optics::DifferenceSummary ciede2000;                                        ///< after what is taken out
    double as_taken = 0, after_exposure = 0, after_cast = 0, after_spread = 0;  ///< means
    double exposure_ev = 0;                          ///< by which the photograph is brighter than predicted
    Eigen::Vector3d cast = Eigen::Vector3d::Ones();  ///< of red, green, blue after that
    double spread_mm = 0;                            ///< fitted, camera and all
    double print_spread_mm = 0;                      ///< less the camera's, where that is known
    std::vector<PrintRegion> regions;                ///< what they say of the resins
    ResinHints hints;
    std::vector<PrintTile> tiles;                                        ///< the worst first
    std::vector<Eigen::Vector3f> printed, predicted_seen, printed_seen;  ///< of all cells, after what is taken out
    std::vector<Eigen::Vector3f> shown;  ///< `printed`, and the photograph where nothing counts
    std::vector<std::uint8_t> counts;    ///< cells that do
    std::vector<float> difference;       ///< CIEDE2000 of each cell; where none counts, 0
    std::vector<std::string> causes;     ///< sentences, the largest first
};

/// Several readings of one print are averaged, each after its own exposure and cast.
[[nodiscard]] PrintDifference difference_of(const PredictedPrint& print, const std::vector<PrintReading>& readings);

}  // namespace voxtone::calibration
