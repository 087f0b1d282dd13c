// SPDX-License-Identifier: GPL-3.0-or-later
//
// All laminates of exactly e blocks over the backing, in a tree of boxes, sixteen children to a node.
//
// The tree is split in the middle of the coefficient that is widest (times the root of its weight) among some two
// dozen: near in reflection is near in the tree, whatever the blocks are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scattering/design/laminate_blocks.h"
#include "scattering/design/laminate_lanes.h"

namespace voxtone::scattering {

inline constexpr std::uint32_t most_table_blocks = 6;

struct SubLaminate {
    std::array<BlockIndex, most_table_blocks> blocks{};  ///< from the top
    std::uint32_t count = 0;
    std::uint32_t units = 0;
    std::uint32_t clear_units = 0;  ///< steps that must lie above, for every block to be deep enough
};

/// Laminates of e blocks and what they reflect, row after row.
struct SubLaminateRows {
    std::vector<SubLaminate> laminates;
    std::vector<float> R;
};
/// No block: the backing.
[[nodiscard]] SubLaminateRows backing_rows(const LaminateBlocks& blocks);
/// One block more on top of each, where the order and the thickness allow it. Sub-laminates for which there can never
/// be enough above are left out.
[[nodiscard]] SubLaminateRows cover_all(const LaminateBlocks& blocks, const SubLaminateRows& below);

class SubLaminateTree {
public:
    SubLaminateTree(const LaminateBlocks& blocks, const SubLaminateRows& rows);

    struct Node {
        std::uint32_t count = 0;
        bool leaf = false;
        std::size_t low = 0, high = 0;                      ///< places of the boxes; the same in a leaf
        std::array<std::uint32_t, laminate_lanes> child{};  ///< node, or laminate of a leaf
        std::array<std::uint32_t, laminate_lanes> units{};  ///< least of what is inside
        std::array<std::uint32_t, laminate_lanes> clear{};  ///< likewise
    };
    [[nodiscard]] bool empty() const { return laminates_.empty(); }
    [[nodiscard]] const Node& root() const { return nodes_.back(); }
    [[nodiscard]] const Node& node(std::uint32_t index) const { return nodes_[index]; }
    [[nodiscard]] const SubLaminate& laminate(std::uint32_t index) const { return laminates_[index]; }
    [[nodiscard]] const float* boxes(std::size_t place) const { return boxes_.data() + place; }

private:
    class Builder;
    std::vector<Node> nodes_;
    std::vector<SubLaminate> laminates_;
    std::vector<float> boxes_;
};

}  // namespace voxtone::scattering
