// SPDX-License-Identifier: GPL-3.0-or-later
//
// From photographs of one slab to its profile (Sec. 5.4 of Elek et al. 2017, supplement): each is checked and cut
// (edge_strip.h), all are joined.
//
// Error of a joined sample: that of the mean of its photographs, by what each says of itself or by how far they differ,
// whichever is more. It does not hold what all have in common: white point (BenchLight::level_error), thickness, gel.
#pragma once

#include <string>
#include <vector>

#include "calibration/bench/bench_light.h"
#include "calibration/bench/sheet_reading.h"
#include "calibration/edge/edge_profiles.h"

namespace voxtone::calibration {

struct SlabView {
    BoardView board;
    EdgeStrip strip;
    SeenEdge edge;
    double blur_mm = 0;  ///< of the bare edges beside the slab; 0 where none is seen
};

struct BenchReference {
    const BenchLight* light = nullptr;
    const SheetReading* sheet = nullptr;
    Eigen::Vector2d edge_px = Eigen::Vector2d::Zero();  ///< of the sheet's photograph
    double square_mm = 20, width_mm = 10, length_mm = 10;
};

/// `photograph` linear. Throws InputError: no edge, blurred, clipped, turned, scratched, no slab.
[[nodiscard]] SlabView read_slab(const io::Photograph& photograph, const BenchReference& reference,
                                 std::vector<std::string>& warnings);

/// Of the photographs of one slab. Throws InputError where they have not the same scale.
[[nodiscard]] EdgeProfile join_views(const std::vector<SlabView>& views, const std::string& resin, double thickness_mm,
                                     std::vector<std::string>& warnings);

}  // namespace voxtone::calibration
