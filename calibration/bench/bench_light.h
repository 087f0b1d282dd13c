// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the bench's light and camera do to reflectance, from the photograph of a colour checker (white point, colours,
// linearity; calibration/photo/light_field.h) and that of a white sheet over all of the picture (how even the light is;
// Sec. 5.1 of Elek et al. 2017, supplement). Both in the light and with the exposure of the slabs.
//
// Without a white sheet the white squares of the bare edge sheet tell the light: coarser, and no map.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/bench/board_view.h"
#include "calibration/bench/edge_strip.h"
#include "calibration/photo/colour_checker.h"
#include "calibration/photo/light_field.h"

namespace voxtone::calibration {

struct BenchLightOptions {
    io::SampleCoding coding = io::SampleCoding::unknown;
    std::optional<std::array<Eigen::Vector2d, 4>> checker_corners;  ///< by hand, px
    double width_mm = 10;                                           ///< of the region that is measured, a square
};

struct BenchLight {
    PhotoModel model;
    CheckerView checker;
    io::SampleCoding coding = io::SampleCoding::linear;  ///< of all photographs
    bool guessed = false;                                ///< the coding is what the checker's greys say
    /// Largest deviation from its mean of the light over the region, smoothed over 1 mm; nothing without white paper.
    std::optional<double> unevenness;
    double left_over = 0;                                   ///< the same after the correction
    Eigen::Vector3d level_error = Eigen::Vector3d::Zero();  ///< relative standard error of white at the edge
    std::vector<std::string> warnings;

    /// For a photograph, which clips by itself.
    [[nodiscard]] PhotoScale scale(const io::Photograph& photograph) const {
        return {&model, clipping_level(photograph)};
    }
};

struct BenchLightPhotos {
    io::Photograph checker, sheet;
    std::optional<io::Photograph> paper;
};

/// `board`: of the sheet. All photographs become linear. Throws InputError that names photograph and fault.
[[nodiscard]] BenchLight measure_bench_light(BenchLightPhotos& photos, const CheckerChart& chart,
                                             const BenchLightOptions& options, BoardView& board, double square_mm);

/// Light of the white sheet, smoothed over 1 mm, relative to its mean about the edge: a picture small enough to draw.
struct LightMap {
    int width = 0, height = 0;
    double scale = 1;  ///< its pixels per pixel of the photograph
    std::vector<float> relative;
};
[[nodiscard]] LightMap light_map(const io::Photograph& paper, const BoardView& board, double width_mm);

}  // namespace voxtone::calibration
