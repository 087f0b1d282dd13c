// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/prediction_time.h"

#include <algorithm>

#include "slicer/look/coarse_cells.h"

namespace voxtone::slicer {

double prediction_seconds(PredictionModel model, const ModelOptions& quality, const std::array<double, 3>& pitch_mm,
                          double area_mm2, std::size_t channels) {
    // Seconds on two cores of 2.5 GHz, by `voxtone predict` of a photograph 10 mm wide and `slice --predict-cell` of
    // the bundled cow at 10 mm, R, G and B; in whole cells, `predict` of the cow at 30 mm with j750-vivid; of paths:
    // docs/heterogeneous.md, in white.
    constexpr double transport_s_per_cell = 1.5e-4, whole_s_per_cell = 1e-4, quick_s_per_cell = 6e-5,
                     layered_s_per_cell = 1.7e-4, s_per_path = 7e-7;
    constexpr double print_and_white = 2;
    const double cells = area_mm2 / (quality.cell_mm * quality.cell_mm), of_rgb = double(channels) / 3;
    switch (model) {
        case PredictionModel::monte_carlo:
            return s_per_path * print_and_white * double(channels) * quality.paths * cells;
        case PredictionModel::layered_profile:
            return layered_s_per_cell * of_rgb * cells;
        case PredictionModel::transport:
            break;
    }
    // Larger cells than the eye's are predicted in the eye's, and quickly.
    if (coarse_cells(pitch_mm, quality.cell_mm))
        return quick_s_per_cell * of_rgb * area_mm2 / (eye_cell_mm * eye_cell_mm);
    if (quality.viewing_cells) return whole_s_per_cell * of_rgb * cells;
    return transport_s_per_cell * of_rgb * cells;
}

double prediction_bytes(double cells) {
    constexpr double of_a_tile = 4e5;  // cells; what is beyond waits in few bits
    return 1.5e8 + 6000 * std::min(cells, of_a_tile) + 1500 * std::max(cells - of_a_tile, 0.0);
}

}  // namespace voxtone::slicer
