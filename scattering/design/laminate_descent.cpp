// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_descent.h"

#include <algorithm>
#include <cmath>

namespace voxtone::scattering {
namespace {

/// What single precision may take from the root of a sum of squares, relative.
double sum_error(std::size_t coefficients) { return (12 + static_cast<double>(coefficients) / 8) * 0x1p-25; }

struct Promise {
    float squares;
    std::uint32_t lane;
};

class Descent {
public:
    Descent(const DescentTables& tables, std::span<const double> target)
        : t_(tables), target_(target), target_single_(target.begin(), target.end()), levels_(tables.max_blocks + 1) {
        const std::size_t n = target.size();
        for (Level& level : levels_) {
            for (std::vector<float>* values : {&level.R, &level.R_below, &level.seen.a, &level.seen.c, &level.seen.q})
                values->assign(n, 0.0F);
            level.T.assign(n, 1.0F);
            level.seen.b.assign(n, 1.0F);
        }
        see_through(levels_[0]);
        best_.squares = t_.blocks.squares({}, target_);
        lower_limit();
    }

    DescentResult run() {
        for (std::uint32_t d = 1; d <= t_.max_blocks; ++d) open(0, d);
        return std::move(best_);
    }

private:
    /// A partial laminate: the blocks above, and how they look from above and below.
    struct Level {
        std::vector<float> R, R_below, T;
        SeenThrough seen;
        std::uint32_t units = 0;
        std::vector<Promise> promises;
    };

    void lower_limit() {
        const double root_weights = std::sqrt(t_.blocks.weight_sum());
        const double limit =
            std::sqrt(best_.squares) * (1 + sum_error(target_.size())) + (residual_error - t_.tolerance) * root_weights;
        limit_ = limit > 0 ? static_cast<float>(limit * limit) : 0.0F;
    }

    void see_through(Level& level) const {
        const std::span<const float> w = t_.blocks.root_weight();
        SeenThrough& seen = level.seen;
        for (std::size_t i = 0; i < w.size(); ++i) {
            const float missing = target_single_[i] - level.R[i], T2 = level.T[i] * level.T[i];
            seen.a[i] = -w[i] * missing;
            seen.b[i] = w[i] * T2;
            seen.c[i] = level.R_below[i];
            // Too bright already: nothing below is best. Where T = 0 nothing below matters.
            const float wanted = missing > 0 ? missing / std::max(T2 + level.R_below[i] * missing, 1e-30F) : 0.0F;
            seen.q[i] = std::min(wanted, 1.0F);
        }
        const std::span<const float> least = t_.bounds.least(), most = t_.bounds.most();
        seen.tail.assign((w.size() + lane_stride - 1) / lane_stride + 1, 0.0F);
        for (std::size_t k = seen.tail.size() - 1; k-- > 0;) {
            float sum = 0;
            for (std::size_t i = lane_stride * k; i < std::min(lane_stride * (k + 1), w.size()); ++i) {
                const float x = std::min(std::max(seen.q[i], least[i]), most[i]);
                const float e = seen.a[i] + seen.b[i] * x / std::max(1 - seen.c[i] * x, 1e-30F);
                sum += e * e;
            }
            seen.tail[k] = seen.tail[k + 1] + sum;
        }
    }

    void put_under(const Level& above, BlockIndex b, Level& out) const {
        const std::span<const float> R = t_.blocks.R_single(b), T = t_.blocks.T_single(b);
        for (std::size_t i = 0; i < R.size(); ++i) {
            const float repeated = 1 / std::max(1 - above.R_below[i] * R[i], 1e-30F);
            out.R[i] = above.R[i] + above.T[i] * above.T[i] * R[i] * repeated;
            out.R_below[i] = R[i] + T[i] * T[i] * above.R_below[i] * repeated;
            out.T[i] = above.T[i] * T[i] * repeated;
        }
        out.units = above.units + t_.blocks[b].units;
        see_through(out);
    }

    /// All that have exactly `left` more blocks than the partial laminate at `depth`.
    void open(std::size_t depth, std::uint32_t left) {
        if (left <= t_.trees.size()) {
            const SubLaminateTree& tree = t_.trees[left - 1];
            if (!tree.empty()) open_tree(depth, tree, tree.root(), 0);
            return;
        }
        ++best_.count.visited;
        Level& here = levels_[depth];
        const std::uint32_t units_left = t_.blocks.units() - here.units;
        here.promises.clear();
        for (std::size_t g = 0; g * laminate_lanes < t_.blocks.size(); ++g) {
            t_.bounds.next_block(left, units_left, g, boxes_);
            LaneSums sums;
            box_distances(here.seen, boxes_.low.data(), boxes_.high.data(), limit_, sums);
            const std::size_t begin = g * laminate_lanes, end = std::min(begin + laminate_lanes, t_.blocks.size());
            for (std::size_t i = begin; i < end; ++i) {
                const auto b = static_cast<BlockIndex>(i);
                if (t_.blocks[b].units + left - 1 > units_left || here.units < t_.blocks.clear_units(b)) continue;
                if (depth > 0 && !t_.blocks.may_follow(path_[depth - 1], b)) continue;
                if (sums[i - begin] < limit_)
                    here.promises.push_back({sums[i - begin], b});
                else
                    ++best_.count.pruned;
            }
        }
        sort(here.promises);
        for (const Promise& promise : here.promises) {
            if (!(promise.squares < limit_)) {
                ++best_.count.pruned;
                continue;
            }
            path_.resize(depth);
            path_.push_back(static_cast<BlockIndex>(promise.lane));
            put_under(here, path_[depth], levels_[depth + 1]);
            open(depth + 1, left - 1);
        }
    }

    void open_tree(std::size_t depth, const SubLaminateTree& tree, const SubLaminateTree::Node& node,
                   std::size_t tree_depth) {
        ++best_.count.visited;
        const Level& above = levels_[depth];
        const std::uint32_t units_left = t_.blocks.units() - above.units;
        LaneSums sums;
        box_distances(above.seen, tree.boxes(node.low), tree.boxes(node.high), limit_, sums);
        if (promises_.size() <= tree_depth) promises_.resize(tree_depth + 1);
        promises_[tree_depth].clear();
        for (std::uint32_t l = 0; l < node.count; ++l) {
            if (node.units[l] > units_left || node.clear[l] > above.units) continue;
            if (node.leaf && depth > 0 &&
                !t_.blocks.may_follow(path_[depth - 1], tree.laminate(node.child[l]).blocks[0]))
                continue;
            if (sums[l] < limit_)
                promises_[tree_depth].push_back({sums[l], l});
            else
                ++best_.count.pruned;
        }
        sort(promises_[tree_depth]);
        for (std::size_t k = 0; k < promises_[tree_depth].size(); ++k) {
            const Promise promise = promises_[tree_depth][k];
            if (!(promise.squares < limit_))
                ++best_.count.pruned;
            else if (node.leaf)
                judge(depth, tree.laminate(node.child[promise.lane]));
            else
                open_tree(depth, tree, tree.node(node.child[promise.lane]), tree_depth + 1);
        }
    }

    void judge(std::size_t depth, const SubLaminate& lower) {
        ++best_.count.judged;
        path_.resize(depth);
        path_.insert(path_.end(), lower.blocks.begin(), lower.blocks.begin() + lower.count);
        const double squares = t_.blocks.squares(path_, target_);
        if (squares < best_.squares) {
            best_.squares = squares;
            best_.blocks = path_;
            lower_limit();
        }
        path_.resize(depth);
    }

    static void sort(std::vector<Promise>& promises) {
        std::sort(promises.begin(), promises.end(), [](const Promise& p, const Promise& q) {
            return p.squares != q.squares ? p.squares < q.squares : p.lane < q.lane;
        });
    }

    const DescentTables& t_;
    std::span<const double> target_;
    std::vector<float> target_single_;
    std::vector<Level> levels_;
    std::vector<std::vector<Promise>> promises_;  ///< by depth in a tree
    LaneBoxes boxes_;
    std::vector<BlockIndex> path_;
    DescentResult best_;
    float limit_ = 0;
};

}  // namespace

DescentResult descend(const DescentTables& tables, std::span<const double> target) {
    return Descent(tables, target).run();
}

}  // namespace voxtone::scattering
