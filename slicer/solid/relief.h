// SPDX-License-Identifier: GPL-3.0-or-later
//
// Voxels that are added to a body or taken away from it after its mesh was rasterised: raised and engraved marks.
#pragma once

#include <cstdint>
#include <vector>

#include "slicer/solid/span_slab.h"

namespace voxtone::slicer {

/// Voxels [begin, end) of row j of layer k.
struct ReliefRun {
    std::int32_t k, j, begin, end;
    bool adds;
};

class Relief {
public:
    Relief() = default;
    /// In any order; where runs overlap the later in the list wins.
    explicit Relief(const std::vector<ReliefRun>& runs);

    [[nodiscard]] bool empty() const { return runs_.empty(); }
    [[nodiscard]] const std::vector<ReliefRun>& runs() const { return runs_; }
    void apply(SpanSlab& body) const;

private:
    std::vector<ReliefRun> runs_;  ///< by layer and row, in the order given within a row
};

}  // namespace voxtone::slicer
