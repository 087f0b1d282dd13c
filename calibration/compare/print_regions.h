// SPDX-License-Identifier: GPL-3.0-or-later
//
// Regions of a photographed print as samples of its resins: what was printed, what light paths predicted, and how that
// moves with each resin; and their file (data/schema/print-regions.schema.json), which `calibrate fit` reads.
//
//   printed ~ gain predicted + d predicted / d x (x - x_set),    x: ln sigma_t and ln (sigma_a / sigma_s)
//
// of every resin in every channel (slicer/predict/resin_response.h). Both sides are means over the same cells; the
// prediction is spread as the photograph is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/compare/predicted_print.h"

namespace voxtone::calibration {

/// Cells of a print that are taken together, from the upper left.
struct TileCells {
    int column = 0, row = 0, columns = 0, rows = 0;
};
/// Squares of at least 0.7 mm, some two hundred of them at most.
[[nodiscard]] std::vector<TileCells> tiles_over(const PredictedPrint& print);

/// What light leaves in a photograph when its field was taken out: u, v and their squares, u and v in [-1, 1] over a
/// print.
inline constexpr Eigen::Index light_terms = 5;
using LightTerms = Eigen::Matrix<double, light_terms, 1>;
[[nodiscard]] inline LightTerms light_at(const Eigen::Vector2d& p) {
    return (LightTerms() << p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y()).finished();
}

struct PrintRegion {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< its middle: (-1, -1) upper left, (1, 1) lower right
    Eigen::Vector3d printed = Eigen::Vector3d::Zero(), predicted = Eigen::Vector3d::Zero();  ///< linear sRGB
    /// d predicted / d x: column 2 (resin channels + channel) by ln sigma_t, the next by ln (sigma_a / sigma_s).
    Eigen::Matrix3Xd by_value;
};

/// Of the cells that count; tiles with few of them are left out. `by_paths`: PredictedPrint::by_paths, spread.
[[nodiscard]] std::vector<PrintRegion> regions_of(const PredictedPrint& print, std::span<const Eigen::Vector3f> printed,
                                                  std::span<const Eigen::Vector3f> by_paths,
                                                  std::span<const std::uint8_t> counts);

struct RegionSheet {
    std::string stack;  ///< that was printed
    bool has_checker = false;
    optics::ResinSet set;  ///< by which it was predicted
    std::vector<PrintRegion> regions;
};

[[nodiscard]] std::string region_sheet_text(const RegionSheet& sheet);
/// Whether it is one, by its first bytes.
[[nodiscard]] bool is_region_sheet(const std::filesystem::path& file);
/// Throws FileError, InputError.
[[nodiscard]] RegionSheet read_region_sheet(const std::filesystem::path& file);

}  // namespace voxtone::calibration
