// SPDX-License-Identifier: GPL-3.0-or-later
//
// A prediction as a page to look at (io/report): the surface, and the voxels that it was predicted from.
#pragma once

#include <array>
#include <string>

#include "slicer/look/surface_prediction.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::slicer {

struct PredictionPage {
    std::string title;  ///< the stack's name
    std::string model;  ///< that predicted
    bool from_above = false;
    std::array<double, 3> cell_um{};
    double seconds = 0;
};

/// HTML of at most `io::most_page_bytes`, about.
[[nodiscard]] std::string prediction_page(const PredictionPage& page, const StackVolume& stack,
                                          const SurfacePrediction& prediction);

}  // namespace voxtone::slicer
