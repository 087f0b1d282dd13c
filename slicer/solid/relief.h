// SPDX-License-Identifier: GPL-3.0-or-later
//
// Voxels that are added to a body or taken away from it after its mesh was rasterised: raised and engraved marks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slicer/solid/span_slab.h"

namespace voxtone::slicer {

/// Voxels [begin, end) of row j of layer k.
struct ReliefRun {
    std::int32_t k, j, begin, end;
    bool adds;
};

/// Voxels whose depth below the mesh d is another below the relief: sign * d + offset_mm, at least 0.
struct DepthRun {
    std::int32_t k, j, begin, end;
    float sign, offset_mm;
};

class Relief {
public:
    Relief() = default;
    /// In any order; where runs overlap the later in the list wins. Depths: of voxels that stay and of those that are
    /// added, so that their shell begins where the body does.
    explicit Relief(const std::vector<ReliefRun>& runs, const std::vector<DepthRun>& depths = {});

    [[nodiscard]] bool empty() const { return runs_.empty(); }
    [[nodiscard]] const std::vector<ReliefRun>& runs() const { return runs_; }
    [[nodiscard]] const std::vector<DepthRun>& depths() const { return depths_; }
    void apply(SpanSlab& body) const;
    /// Depths of the voxels i, i + 1, ... of a row.
    void apply(int i, int j, int k, std::span<float> depth_mm) const;

private:
    std::vector<ReliefRun> runs_;   ///< by layer and row, in the order given within a row
    std::vector<DepthRun> depths_;  ///< the same
};

}  // namespace voxtone::slicer
