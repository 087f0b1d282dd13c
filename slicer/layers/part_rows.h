// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rows of a print's layer, laid together from those of its parts: run by run where no voxel is of two parts, which is
// nearly everywhere, voxel by voxel else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/layers/layer_runs.h"
#include "slicer/layers/layer_source.h"

namespace voxtone::slicer {

/// Voxels of a part that another one has.
struct Overlap {
    std::uint64_t voxels = 0;
    std::uint64_t to_equals = 0;  ///< of these, to parts of the same priority, which the order of the list decides
};

/// A part as it stands in one layer of the print.
struct PartInLayer {
    const SlabLayers* layers;
    std::array<int, 3> at;
    int k, width, height;  ///< of the part's own
    bool cuts;
    std::size_t part;
    int priority;
    const io::LayerRuns* shown = nullptr;  ///< its layer, where somebody wanted to see it

    [[nodiscard]] int left() const { return at[0]; }
    [[nodiscard]] int right() const { return at[0] + width; }
    [[nodiscard]] bool reaches(int j) const { return j >= at[1] && j < at[1] + height; }
    /// Appends row `j`, counted upward in the print, which it reaches.
    void push_row(int j, io::LayerRuns& out) const {
        if (!shown) return layers->push_row(j - at[1], k, at, out);
        for (const io::Run& run : shown->row(static_cast<std::uint32_t>(height - 1 - (j - at[1]))))
            out.push(run.length, static_cast<io::Material>(run.material));
    }
    [[nodiscard]] io::LayerRuns layer() const {
        io::LayerRuns out(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
        for (int j = height - 1; j >= 0; --j) {
            layers->push_row(j, k, at, out);
            out.end_row();
        }
        return out;
    }
    [[nodiscard]] bool fills(const VoxelGrid& grid) const {
        return !cuts && width == grid.size[0] && height == grid.size[1];
    }
};

/// Parts of a layer, row by row as far as no voxel is of two of them.
class PartRows {
public:
    /// `width`: of the print.
    PartRows(std::span<const PartInLayer> parts, int width);
    /// Whether row j is such a one.
    [[nodiscard]] bool are_apart(int j);
    /// Appends the row. Contract: are_apart(j) was asked last, and it is so.
    void push(int j, io::LayerRuns& out) const;

private:
    struct Part {
        const PartInLayer* standing;
        io::LayerRuns row;  ///< of its own, that was asked for last
    };
    /// Voxels of a part without air between them.
    struct Stretch {
        int begin, end;
        std::span<const io::Run> runs;
        bool cuts;
    };
    void find_stretches(int j);
    void push_boxes(int j, io::LayerRuns& out) const;

    int width_;
    bool boxes_are_apart_ = true;
    std::vector<Part> parts_;  ///< from the left
    std::vector<Part*> here_;  ///< in the row that was asked for last
    std::vector<Stretch> stretches_;
};

/// Parts that may lie over each other, voxel by voxel in the order in which they are laid down.
class OverlaidRow {
public:
    explicit OverlaidRow(int width)
        : material_(static_cast<std::size_t>(width)), owner_(static_cast<std::size_t>(width)) {}
    /// `lost`: by part, voxels that it had and has no more.
    void lay(std::span<const PartInLayer> parts, int j, std::vector<Overlap>& lost);
    void push(io::LayerRuns& out) const;

private:
    void take(const PartInLayer& part, std::size_t begin, std::size_t end, std::uint16_t material,
              std::vector<Overlap>& lost);
    std::vector<io::Material> material_;
    std::vector<const PartInLayer*> owner_;  ///< null: nobody
};

}  // namespace voxtone::slicer
