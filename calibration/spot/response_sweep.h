// SPDX-License-Identifier: GPL-3.0-or-later
//
// From photographs of a surface, lit by a projected square that is moved from cell to cell, to the 4-D function R(x_i,
// x_o) of its light (optics/monte_carlo/sampled_bssrdf.h; M. Goesele et al., "DISCO", 2004, and Hasan et al. 2010, Sec.
// 7.1, are what it is after).
//
// Each frame's exposures, less their dark frames, are merged (calibration/spot/exposure_merge.h). Of a card of known
// albedo, lit by the same square, comes how much light that is: Phi = sum of the card's light / its albedo. Then
//
//   R(x_i, x_o) = mean light of the cell of x_o in the frame of x_i / Phi,    total(x_i) = sum of its light / Phi
//
// Both ways between two cells are alike (reciprocity), so their mean is kept, and what a cell sends to others against
// what it gets from them tells frames that were lit or exposed otherwise.
//
// What it cannot see: directions (the camera stands above, light is taken as diffuse), a square blurred beyond its
// cell, a projector's own black beyond the dark frames, mirror reflections (cross polarisers take them).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "calibration/spot/exposure_merge.h"
#include "optics/monte_carlo/sampled_bssrdf.h"

namespace voxtone::calibration {

struct SweepGeometry {
    double mm_per_px = 0;                   ///< on the surface
    std::array<double, 2> corner_px{};      ///< of the surface's upper left corner in the pictures
    std::array<std::uint32_t, 2> points{};  ///< cells along x and y
    double pitch_mm = 0;                    ///< of cells
    std::uint32_t radius = 10;              ///< of the window that is kept, cells

    /// Throws UsageError that names the option and the rule it breaks.
    void validate() const;
};

/// Exposures of one scene from short to long, each with its dark frame.
struct SweepExposures {
    std::vector<ExposureFile> lit, dark;
};

/// The frame of each cell, row by row from the top, of a table
///
///   file,dark,x_mm,y_mm
///
/// with the middle of the lit square from the surface's upper left corner, x to the right and y down; a file may be
/// FILE@SECONDS; several rows of one place are its exposures. Names are looked up beside the table. Throws InputError:
/// rows without a place, places off the surface, cells with no frame or with several; FileError.
[[nodiscard]] std::vector<SweepExposures> read_sweep(const std::filesystem::path& table, const SweepGeometry& geometry);

struct SweptResponses {
    optics::SampledBssrdf responses;
    double asymmetry = 0;  ///< rms over cells of sent / got - 1, the worst channel
};

/// Throws InputError in one sentence: pictures of several sizes, a surface that reaches beyond them, saturated cells,
/// cells that send more than all light, frames that are not reciprocal; FileError.
[[nodiscard]] SweptResponses measure_sweep(const std::vector<SweepExposures>& frames, const SweepExposures& card,
                                           double card_albedo, const SweepGeometry& geometry, const CameraNoise& noise,
                                           Progress& progress);

}  // namespace voxtone::calibration
