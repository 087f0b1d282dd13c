// SPDX-License-Identifier: GPL-3.0-or-later
//
// All stackings of exactly e blocks over the backing, in a tree of boxes, sixteen children to a node.
//
// The tree is split in the middle of the coefficient that is widest (times the root of its weight) among some two
// dozen: near in reflection is near in the tree, whatever the blocks are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "halftone/stacks/stack_blocks.h"
#include "halftone/stacks/stack_lanes.h"

namespace voxtone::halftone {

inline constexpr std::uint32_t most_table_blocks = 6;

struct SubStack {
    std::array<BlockIndex, most_table_blocks> blocks{};  ///< from the top
    std::uint32_t count = 0;
    std::uint32_t units = 0;
    std::uint32_t clear_units = 0;  ///< steps that must lie above, for every block to be deep enough
};

/// Stackings of e blocks and what they reflect, row after row.
struct SubStackRows {
    std::vector<SubStack> stacks;
    std::vector<float> R;
};
/// No block: the backing.
[[nodiscard]] SubStackRows backing_rows(const StackBlocks& blocks);
/// One block more on top of each, where the order and the thickness allow it. Sub-stacks for which there can never be
/// enough above are left out.
[[nodiscard]] SubStackRows cover_all(const StackBlocks& blocks, const SubStackRows& below);

class SubStackTree {
public:
    SubStackTree(const StackBlocks& blocks, const SubStackRows& rows);

    struct Node {
        std::uint32_t count = 0;
        bool leaf = false;
        std::size_t low = 0, high = 0;                   ///< places of the boxes; the same in a leaf
        std::array<std::uint32_t, stack_lanes> child{};  ///< node, or stack of a leaf
        std::array<std::uint32_t, stack_lanes> units{};  ///< least of what is inside
        std::array<std::uint32_t, stack_lanes> clear{};  ///< likewise
    };
    [[nodiscard]] bool empty() const { return stacks_.empty(); }
    [[nodiscard]] const Node& root() const { return nodes_.back(); }
    [[nodiscard]] const Node& node(std::uint32_t index) const { return nodes_[index]; }
    [[nodiscard]] const SubStack& stack(std::uint32_t index) const { return stacks_[index]; }
    [[nodiscard]] const float* boxes(std::size_t place) const { return boxes_.data() + place; }

private:
    class Builder;
    std::vector<Node> nodes_;
    std::vector<SubStack> stacks_;
    std::vector<float> boxes_;
};

}  // namespace voxtone::halftone
