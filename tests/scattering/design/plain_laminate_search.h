// SPDX-License-Identifier: GPL-3.0-or-later
//
// Algorithm 1 of Hasan et al. 2010 as it stands in Sec. 6: block after block from the top, bounds with nothing and with
// white below. Slow, plain, double precision: what the fast search is compared with.
#pragma once

#include <cmath>
#include <limits>

#include "scattering/design/laminate_search.h"

namespace voxtone {

class PlainLaminateSearch {
public:
    /// Over black, no weights, no limits from the top. `steps` is a power of 2.
    PlainLaminateSearch(std::span<const scattering::LaminateMaterial> materials, double thickness_mm,
                        std::uint32_t steps)
        : steps_(steps) {
        for (std::uint32_t units = steps; units > 0; units /= 2)
            for (std::size_t m = 0; m < materials.size(); ++m) {
                Block& block = blocks_.emplace_back(Block{m, units, {}, {}});
                for (const optics::HomogeneousLayer& channel : materials[m]) {
                    const optics::LayerProfile layer = channel.of_thickness(units * thickness_mm / steps);
                    block.R.insert(block.R.end(), layer.R_top.begin(), layer.R_top.end());
                    block.T.insert(block.T.end(), layer.T.begin(), layer.T.end());
                }
            }
    }

    struct Found {
        double distance;
        std::uint64_t visited = 0, pruned = 0;
    };
    Found find(const scattering::ChannelProfiles& target, std::uint32_t max_blocks) {
        target_.clear();
        for (const std::vector<double>& channel : target) target_.insert(target_.end(), channel.begin(), channel.end());
        found_ = {std::numeric_limits<double>::infinity()};
        const std::size_t n = target_.size();
        const Node root{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), std::vector<double>(n, 1.0), nullptr,
                        0};
        for (std::uint32_t depth = 1; depth <= max_blocks; ++depth) search(root, depth);
        found_.distance = std::sqrt(found_.distance / static_cast<double>(n));
        return found_;
    }

private:
    struct Block {
        std::size_t material;
        std::uint32_t units;
        std::vector<double> R, T;
    };
    struct Node {
        std::vector<double> R_top, R_bottom, T;
        const Block* last;
        std::uint32_t units;
    };

    void search(const Node& node, std::uint32_t depth) {
        ++found_.visited;
        double distance = 0, bright = 0, dark = 0;
        for (std::size_t i = 0; i < target_.size(); ++i) {
            const double e = node.R_top[i] - target_[i],
                         most = node.R_top[i] + node.T[i] * node.T[i] / (1 - node.R_bottom[i]);
            distance += e * e;
            bright += e > 0 ? e * e : 0;
            dark += most < target_[i] ? (target_[i] - most) * (target_[i] - most) : 0;
        }
        found_.distance = std::min(found_.distance, distance);
        if (depth == 0) return;
        if (std::max(bright, dark) > found_.distance) {
            ++found_.pruned;
            return;
        }
        for (const Block& block : blocks_) {
            if (node.last && block.material == node.last->material && block.units >= node.last->units) continue;
            if (node.units + block.units > steps_) continue;
            Node child{node.R_top, block.R, block.T, &block, node.units + block.units};
            for (std::size_t i = 0; i < target_.size(); ++i) {
                const double repeated = 1 / (1 - node.R_bottom[i] * block.R[i]);
                child.R_top[i] += node.T[i] * node.T[i] * block.R[i] * repeated;
                child.R_bottom[i] += block.T[i] * block.T[i] * node.R_bottom[i] * repeated;
                child.T[i] *= node.T[i] * repeated;
            }
            search(child, depth - 1);
        }
    }

    std::uint32_t steps_;
    std::vector<Block> blocks_;
    std::vector<double> target_;
    Found found_{};
};

}  // namespace voxtone
