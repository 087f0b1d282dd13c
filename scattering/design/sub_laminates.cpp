// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/sub_laminates.h"

#include <algorithm>
#include <numeric>

#include "base/contracts.h"

namespace voxtone::scattering {

SubLaminateRows backing_rows(const LaminateBlocks& blocks) {
    return {{SubLaminate{}}, std::vector<float>(blocks.backing().begin(), blocks.backing().end())};
}

SubLaminateRows cover_all(const LaminateBlocks& blocks, const SubLaminateRows& below) {
    const std::size_t n = blocks.coefficients();
    SubLaminateRows rows;
    std::vector<std::size_t> covered;
    for (std::size_t s = 0; s < below.laminates.size(); ++s) {
        const SubLaminate& lower = below.laminates[s];
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            const auto b = static_cast<BlockIndex>(i);
            const std::uint32_t units = blocks[b].units;
            if (lower.units + units > blocks.units() || (lower.count > 0 && !blocks.may_follow(b, lower.blocks[0])))
                continue;
            SubLaminate laminate;
            laminate.blocks[0] = b;
            std::copy_n(lower.blocks.begin(), lower.count, laminate.blocks.begin() + 1);
            laminate.count = lower.count + 1;
            laminate.units = lower.units + units;
            laminate.clear_units =
                std::max(blocks.clear_units(b), lower.clear_units > units ? lower.clear_units - units : 0);
            if (laminate.clear_units + laminate.units > blocks.units()) continue;
            rows.laminates.push_back(laminate);
            covered.push_back(s);
        }
    }
    rows.R.resize(rows.laminates.size() * n);
    for (std::size_t s = 0; s < rows.laminates.size(); ++s)
        blocks.cover(rows.laminates[s].blocks[0], {below.R.data() + covered[s] * n, n}, {rows.R.data() + s * n, n});
    return rows;
}

class SubLaminateTree::Builder {
public:
    Builder(const LaminateBlocks& blocks, const SubLaminateRows& rows, SubLaminateTree& tree)
        : n_(blocks.coefficients()), rows_(rows), tree_(tree), order_(rows.laminates.size()) {
        constexpr std::size_t candidates = 24;
        std::iota(order_.begin(), order_.end(), 0U);
        for (std::size_t k = 0; k < std::min(candidates, n_); ++k) {
            const std::size_t i = k * n_ / std::min(candidates, n_);
            axes_.push_back(i);
            axis_weight_.push_back(blocks.root_weight()[i]);
        }
        keys_.resize(order_.size() * axes_.size());
        for (std::size_t s = 0; s < order_.size(); ++s)
            for (std::size_t a = 0; a < axes_.size(); ++a)
                keys_[s * axes_.size() + a] = axis_weight_[a] * rows.R[s * n_ + axes_[a]];
        if (!order_.empty()) add(0, order_.size());
    }

private:
    struct Part {
        std::size_t first, last;
    };

    void split(std::size_t first, std::size_t last, std::size_t parts, std::vector<Part>& out) {
        if (parts == 1) {
            out.push_back({first, last});
            return;
        }
        const std::size_t axes = axes_.size();
        std::vector<float> low(axes, 1e30F), high(axes, -1e30F);
        for (std::size_t k = first; k < last; ++k) {
            const float* key = &keys_[order_[k] * axes];
            for (std::size_t a = 0; a < axes; ++a) {
                low[a] = std::min(low[a], key[a]);
                high[a] = std::max(high[a], key[a]);
            }
        }
        std::size_t widest = 0;
        for (std::size_t a = 1; a < axes; ++a)
            if (high[a] - low[a] > high[widest] - low[widest]) widest = a;
        const std::size_t half = parts / 2, middle = first + (last - first) * half / parts;
        const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
        std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t p, std::uint32_t q) {
            const float x = keys_[p * axes + widest], y = keys_[q * axes + widest];
            return x != y ? x < y : p < q;
        });
        split(first, middle, half, out);
        split(middle, last, parts - half, out);
    }

    /// Children come before their parent: the root is the last node.
    std::uint32_t add(std::size_t first, std::size_t last) {
        Node node;
        std::vector<float> low(n_ * laminate_lanes, 0.0F), high;
        if (last - first <= laminate_lanes) {
            node.leaf = true;
            node.count = static_cast<std::uint32_t>(last - first);
            for (std::uint32_t l = 0; l < node.count; ++l) {
                const std::uint32_t s = order_[first + l];
                node.child[l] = s;
                node.units[l] = rows_.laminates[s].units;
                node.clear[l] = rows_.laminates[s].clear_units;
                const float* R = &rows_.R[s * n_];
                for (std::size_t i = 0; i < n_; ++i) low[i * laminate_lanes + l] = R[i];
            }
            node.low = node.high = keep(low);
        } else {
            std::vector<Part> parts;
            split(first, last, std::min(laminate_lanes, (last - first + laminate_lanes - 1) / laminate_lanes), parts);
            node.count = static_cast<std::uint32_t>(parts.size());
            high.assign(n_ * laminate_lanes, 0.0F);
            for (std::uint32_t l = 0; l < node.count; ++l) {
                node.child[l] = add(parts[l].first, parts[l].last);
                const Node& child = tree_.nodes_[node.child[l]];
                node.units[l] = *std::min_element(child.units.begin(), child.units.begin() + child.count);
                node.clear[l] = *std::min_element(child.clear.begin(), child.clear.begin() + child.count);
                for (std::size_t i = 0; i < n_; ++i) {
                    const float *from = tree_.boxes(child.low) + i * laminate_lanes,
                                *to = tree_.boxes(child.high) + i * laminate_lanes;
                    low[i * laminate_lanes + l] = *std::min_element(from, from + child.count);
                    high[i * laminate_lanes + l] = *std::max_element(to, to + child.count);
                }
            }
            node.low = keep(low);
            node.high = keep(high);
        }
        tree_.nodes_.push_back(node);
        return static_cast<std::uint32_t>(tree_.nodes_.size() - 1);
    }

    std::size_t keep(const std::vector<float>& box) {
        const std::size_t place = tree_.boxes_.size();
        tree_.boxes_.insert(tree_.boxes_.end(), box.begin(), box.end());
        return place;
    }

    std::size_t n_;
    const SubLaminateRows& rows_;
    SubLaminateTree& tree_;
    std::vector<std::uint32_t> order_;
    std::vector<std::size_t> axes_;
    std::vector<float> axis_weight_, keys_;
};

SubLaminateTree::SubLaminateTree(const LaminateBlocks& blocks, const SubLaminateRows& rows)
    : laminates_(rows.laminates) {
    const std::size_t leaves = rows.laminates.size() / laminate_lanes * 2 + 2;  // leaves are at least half full
    boxes_.reserve(leaves * laminate_lanes * blocks.coefficients() * 9 / 8);
    Builder(blocks, rows, *this);
}

}  // namespace voxtone::scattering
