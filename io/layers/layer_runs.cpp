// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/layer_runs.h"

#include "base/contracts.h"

namespace voxtone::io {

LayerRuns::LayerRuns(std::uint32_t width_px, std::uint32_t height_px) : width_px_(width_px), height_px_(height_px) {
    VOXTONE_EXPECT(width_px >= 1 && width_px <= 65535);
    VOXTONE_EXPECT(height_px >= 1 && height_px <= 65535);
    row_begin_.reserve(height_px + 1);
}

void LayerRuns::end_row() {
    VOXTONE_EXPECT(rows() < height_px_);
    std::uint64_t sum = 0;
    for (std::size_t i = row_begin_.back(); i < runs_.size(); ++i) {
        VOXTONE_EXPECT(runs_[i].material < max_materials);
        sum += runs_[i].length;
    }
    VOXTONE_EXPECT(sum == width_px_);
    row_begin_.push_back(runs_.size());
}

void LayerRuns::clear() {
    runs_.clear();
    row_begin_.resize(1);
}

}  // namespace voxtone::io
