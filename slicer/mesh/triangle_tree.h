// SPDX-License-Identifier: GPL-3.0-or-later
//
// A bounding-volume tree over triangles, four boxes to a node and one triangle to a leaf: nearest points, and all
// triangles that may be nearest to some point of a box.
//
// The tree is built by binned surface-area splits (I. Wald, "On fast construction of SAH-based bounding volume
// hierarchies", 2007) by one thread, so it is the same on every run. Boxes are floats rounded outward.
//
// Own code because answers are points in doubles and, of triangles at the same distance, the lowest, whatever the tree
// looks like: Embree's point query works in floats, CGAL's AABB tree keeps what it meets first. Neither can be asked
// for the nearest triangles of a whole box (nearest_candidates, which walks half spaces).
// Coordinates in mm, below 1e5 mm. Threads: const members may be called from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

/// The point of triangle abc nearest to p, as weights of the corners; sums to one. Any shape, also without area.
[[nodiscard]] Eigen::Vector3d nearest_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                              const Eigen::Vector3d& b, const Eigen::Vector3d& c);

class TriangleTree {
public:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    /// Keeps references to both; they must live as long as the tree.
    TriangleTree(std::span<const Eigen::Vector3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles);
    TriangleTree(const TriangleTree&) = delete;
    TriangleTree& operator=(const TriangleTree&) = delete;
    TriangleTree(TriangleTree&&) = default;
    TriangleTree& operator=(TriangleTree&&) = default;

    [[nodiscard]] bool empty() const { return triangles_.empty(); }
    [[nodiscard]] std::span<const Eigen::Vector3d> positions() const { return positions_; }
    [[nodiscard]] std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }
    [[nodiscard]] std::array<Eigen::Vector3d, 3> corners(std::uint32_t t) const {
        return {positions_[triangles_[t][0]], positions_[triangles_[t][1]], positions_[triangles_[t][2]]};
    }

    struct Nearest {
        std::uint32_t triangle = none;
        double distance = std::numeric_limits<double>::infinity();
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
    };
    /// The surface point nearest to p, no farther than `limit`; of triangles at the same distance the lowest. `guess`,
    /// a triangle likely to be near, speeds it up and does not change the result.
    [[nodiscard]] Nearest nearest(const Eigen::Vector3d& p, std::uint32_t guess = none,
                                  double limit = std::numeric_limits<double>::infinity()) const;

    /// Appends every triangle whose bounding box comes nearer to some corner of the box [low, high] than q does, q any
    /// point. No other triangle can hold the nearest surface point of any point of the box if q is on the surface: the
    /// points nearer to s than to q are a half space, and one that meets a box holds one of its corners. A margin of
    /// 1e-5 of the distance is allowed for, so that near-ties are in.
    void nearest_candidates(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Eigen::Vector3d& q,
                            std::vector<std::uint32_t>& out) const;

    /// Appends every triangle whose bounding box meets the box [low, high].
    void overlapping(const Eigen::Vector3d& low, const Eigen::Vector3d& high, std::vector<std::uint32_t>& out) const;

private:
    struct Bounds;
    struct alignas(16) Node {
        float low[3][4], high[3][4];
        std::uint32_t child[4];  // leaf_bit set: a triangle; none: no child
    };
    static constexpr std::uint32_t leaf_bit = 0x80000000u;

    std::uint32_t build(std::span<std::uint32_t> triangles, std::span<const Bounds> bounds);

    std::span<const Eigen::Vector3d> positions_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace voxtone::slicer
