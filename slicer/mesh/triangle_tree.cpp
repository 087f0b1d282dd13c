// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/triangle_tree.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/contracts.h"

namespace voxtone::slicer {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3d nearest_weights(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    // The foot on the plane if it falls inside, else the best of the three edges.
    const Vector3d ab = b - a, ac = c - a, ap = p - a;
    const Vector3d normal = ab.cross(ac);
    const double area2 = normal.squaredNorm();
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
    if (area2 > 1e-20 * longest2 * longest2) {
        const double v = normal.dot(ap.cross(ac)) / area2, w = normal.dot(ab.cross(ap)) / area2;
        if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
    }
    const Vector3d* corner[3] = {&a, &b, &c};
    Vector3d best(1, 0, 0);
    double best2 = std::numeric_limits<double>::infinity();
    for (int e = 0; e < 3; ++e) {
        const Vector3d &from = *corner[e], &to = *corner[(e + 1) % 3];
        const Vector3d edge = to - from;
        const double length2 = edge.squaredNorm();
        const double t = length2 > 0 ? std::clamp((p - from).dot(edge) / length2, 0.0, 1.0) : 0.0;
        const double distance2 = (from + t * edge - p).squaredNorm();
        if (distance2 < best2) {
            best2 = distance2;
            best.setZero();
            best[e] = 1 - t;
            best[(e + 1) % 3] = t;
        }
    }
    return best;
}

struct TriangleTree::Bounds {
    Vector3f low = Vector3f::Constant(std::numeric_limits<float>::infinity());
    Vector3f high = Vector3f::Constant(-std::numeric_limits<float>::infinity());

    void add(const Bounds& other) {
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
    [[nodiscard]] float half_area() const {
        const Vector3f d = high - low;
        return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
    [[nodiscard]] Vector3f twice_centre() const { return low + high; }

    /// Of a range of triangles.
    [[nodiscard]] static Bounds of(std::span<const std::uint32_t> range, std::span<const Bounds> bounds);
    /// Where to cut a range of at least two triangles; reorders it.
    [[nodiscard]] static std::size_t split(std::span<std::uint32_t> range, std::span<const Bounds> bounds);
};

TriangleTree::TriangleTree(std::span<const Vector3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles)
    : positions_(positions), triangles_(triangles) {
    VOXTONE_EXPECT(triangles.size() < leaf_bit);
    double largest = 0;
    for (const Vector3d& p : positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    VOXTONE_EXPECT(largest < 1e5);
    // Wider than the rounding of corners and of query points to float.
    const float margin = 4 * (std::nextafter(float(largest), std::numeric_limits<float>::infinity()) - float(largest));

    std::vector<Bounds> bounds(triangles.size());
    std::vector<std::uint32_t> order(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        order[t] = static_cast<std::uint32_t>(t);
        for (const std::uint32_t v : triangles[t]) {
            bounds[t].low = bounds[t].low.cwiseMin(positions[v].cast<float>());
            bounds[t].high = bounds[t].high.cwiseMax(positions[v].cast<float>());
        }
        bounds[t].low.array() -= margin;
        bounds[t].high.array() += margin;
    }
    nodes_.reserve(triangles.size() / 2 + 1);
    if (!triangles.empty()) build(order, bounds);
}

TriangleTree::Bounds TriangleTree::Bounds::of(std::span<const std::uint32_t> range, std::span<const Bounds> bounds) {
    Bounds all;
    for (const std::uint32_t t : range) all.add(bounds[t]);
    return all;
}

std::size_t TriangleTree::Bounds::split(std::span<std::uint32_t> range, std::span<const Bounds> bounds) {
    constexpr int bins = 16;
    Bounds centres;
    for (const std::uint32_t t : range) centres.add({bounds[t].twice_centre(), bounds[t].twice_centre()});
    int best_axis = -1, best_bin = 0;
    float best_cost = std::numeric_limits<float>::infinity();
    const auto bin_of = [&](std::uint32_t t, int axis) {
        const float width = centres.high[axis] - centres.low[axis];
        return std::min(bins - 1, int((bounds[t].twice_centre()[axis] - centres.low[axis]) / width * bins));
    };
    for (int axis = 0; axis < 3; ++axis) {
        if (!(centres.high[axis] > centres.low[axis])) continue;
        Bounds box[bins];
        int count[bins] = {};
        for (const std::uint32_t t : range) {
            const int b = bin_of(t, axis);
            box[b].add(bounds[t]);
            ++count[b];
        }
        float right_cost[bins] = {};
        Bounds right;
        int n = 0;
        for (int b = bins - 1; b > 0; --b) {
            right.add(box[b]);
            n += count[b];
            right_cost[b] = n ? right.half_area() * float(n) : 0;
        }
        Bounds left;
        n = 0;
        for (int b = 1; b < bins; ++b) {
            left.add(box[b - 1]);
            n += count[b - 1];
            if (n == 0 || n == int(range.size())) continue;
            const float cost = left.half_area() * float(n) + right_cost[b];
            if (cost < best_cost) best_cost = cost, best_axis = axis, best_bin = b;
        }
    }
    if (best_axis < 0) return range.size() / 2;  // all centres in one place
    const auto middle =
        std::partition(range.begin(), range.end(), [&](std::uint32_t t) { return bin_of(t, best_axis) < best_bin; });
    return std::size_t(middle - range.begin());
}

std::uint32_t TriangleTree::build(std::span<std::uint32_t> triangles, std::span<const Bounds> bounds) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    std::array<std::span<std::uint32_t>, 4> child{triangles};
    std::array<Bounds, 4> box{Bounds::of(triangles, bounds)};
    int children = 1;
    while (children < 4) {
        int widest = -1;
        for (int c = 0; c < children; ++c)
            if (child[c].size() > 1 && (widest < 0 || box[c].half_area() > box[widest].half_area())) widest = c;
        if (widest < 0) break;
        const std::size_t middle = Bounds::split(child[widest], bounds);
        child[children] = child[widest].subspan(middle);
        child[widest] = child[widest].first(middle);
        box[widest] = Bounds::of(child[widest], bounds);
        box[children] = Bounds::of(child[children], bounds);
        ++children;
    }
    for (int c = 0; c < 4; ++c) {
        const Bounds b = c < children ? box[c] : Bounds{};  // an empty box is infinitely far from everything
        const std::uint32_t below = c >= children          ? none
                                    : child[c].size() == 1 ? child[c][0] | leaf_bit
                                                           : build(child[c], bounds);
        Node& node = nodes_[index];
        for (int a = 0; a < 3; ++a) {
            node.low[a][c] = b.low[a];
            node.high[a][c] = b.high[a];
        }
        node.child[c] = below;
    }
    return index;
}

namespace {

// Four lanes; the compiler makes vector code of loops this plain.
using Lanes = std::array<float, 4>;

struct Entry {
    float distance2;
    std::uint32_t child;
};

constexpr float tolerance = 1 + 1e-6f;  // above the rounding of a squared distance

}  // namespace

TriangleTree::Nearest TriangleTree::nearest(const Vector3d& p, std::uint32_t guess, double limit) const {
    Nearest best;
    double best2 = limit * limit;
    const auto visit = [&](std::uint32_t t) {
        const auto [a, b, c] = corners(t);
        const Vector3d w = nearest_weights(p, a, b, c);
        const Vector3d point = w[0] * a + w[1] * b + w[2] * c;
        const double distance2 = (point - p).squaredNorm();
        // Every triangle within the best distance is visited, whatever the order, so this choice is the same for any
        // guess.
        if (distance2 < best2 || (distance2 == best2 && t < best.triangle)) {
            best2 = distance2;
            best = {t, 0, point};
        }
    };
    if (guess != none) visit(guess);
    if (empty()) return best;

    const Vector3f q = p.cast<float>();
    std::array<Entry, 256> stack;
    int top = 0;
    stack[top++] = {0, 0};
    while (top) {
        const Entry entry = stack[--top];
        if (entry.distance2 > float(best2) * tolerance) continue;
        if (entry.child & leaf_bit) {
            visit(entry.child & ~leaf_bit);
            continue;
        }
        const Node& node = nodes_[entry.child];
        Lanes distance2{};
        for (int a = 0; a < 3; ++a)
            for (int c = 0; c < 4; ++c) {
                const float below = node.low[a][c] - q[a], above = q[a] - node.high[a][c];
                const float outside = std::max(std::max(below, above), 0.0f);
                distance2[c] += outside * outside;
            }
        const int first = top;
        for (int c = 0; c < 4; ++c) {
            if (node.child[c] == none || distance2[c] > float(best2) * tolerance) continue;
            int at = top++;  // farthest first, so that the nearest is taken first
            for (; at > first && stack[at - 1].distance2 < distance2[c]; --at) stack[at] = stack[at - 1];
            stack[at] = {distance2[c], node.child[c]};
        }
        VOXTONE_EXPECT(top + 4 <= int(stack.size()));
    }
    if (best.triangle != none) best.distance = std::sqrt(best2);
    return best;
}

void TriangleTree::nearest_candidates(const Vector3d& low, const Vector3d& high, const Vector3d& q,
                                      std::vector<std::uint32_t>& out) const {
    if (empty()) return;
    const Vector3f side[2] = {low.cast<float>(), high.cast<float>()};
    float reach2[8];
    for (int v = 0; v < 8; ++v) {
        const Vector3d corner(v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
        reach2[v] = float((corner - q).squaredNorm() * (1 + 2e-5) + 1e-6);
    }
    std::array<std::uint32_t, 256> stack;
    int top = 0;
    stack[top++] = 0;
    while (top) {
        const Node& node = nodes_[stack[--top]];
        Lanes axis2[3][2];
        for (int a = 0; a < 3; ++a)
            for (int s = 0; s < 2; ++s)
                for (int c = 0; c < 4; ++c) {
                    const float below = node.low[a][c] - side[s][a], above = side[s][a] - node.high[a][c];
                    const float outside = std::max(std::max(below, above), 0.0f);
                    axis2[a][s][c] = outside * outside;
                }
        Lanes excess;  // smallest over the corners of distance^2 - reach^2
        excess.fill(std::numeric_limits<float>::infinity());
        for (int v = 0; v < 8; ++v)
            for (int c = 0; c < 4; ++c)
                excess[c] = std::min(
                    excess[c], (axis2[0][v & 1][c] + axis2[1][v >> 1 & 1][c]) + (axis2[2][v >> 2][c] - reach2[v]));
        for (int c = 0; c < 4; ++c) {
            if (!(excess[c] <= 0) || node.child[c] == none) continue;
            if (node.child[c] & leaf_bit)
                out.push_back(node.child[c] & ~leaf_bit);
            else
                stack[top++] = node.child[c];
        }
        VOXTONE_EXPECT(top + 4 <= int(stack.size()));
    }
}

void TriangleTree::overlapping(const Vector3d& low, const Vector3d& high, std::vector<std::uint32_t>& out) const {
    if (empty()) return;
    const Vector3f l = low.cast<float>(), h = high.cast<float>();
    std::array<std::uint32_t, 256> stack;
    int top = 0;
    stack[top++] = 0;
    while (top) {
        const Node& node = nodes_[stack[--top]];
        for (int c = 0; c < 4; ++c) {
            if (node.child[c] == none) continue;
            bool meets = true;
            for (int a = 0; a < 3; ++a) meets = meets && node.low[a][c] <= h[a] && node.high[a][c] >= l[a];
            if (!meets) continue;
            if (node.child[c] & leaf_bit)
                out.push_back(node.child[c] & ~leaf_bit);
            else
                stack[top++] = node.child[c];
        }
        VOXTONE_EXPECT(top + 4 <= int(stack.size()));
    }
}

}  // namespace voxtone::slicer
