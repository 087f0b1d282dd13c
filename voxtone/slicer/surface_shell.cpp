// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/surface_shell.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "voxtone/base/contracts.h"
#include "voxtone/slicer/shell_kernel.h"
#include "voxtone/slicer/triangle_tree.h"

namespace voxtone::slicer {

using Eigen::Vector3d;
using shell_kernel::LocalTriangle;
static_assert(ShellBlock::width == shell_kernel::row_voxels && ShellBlock::max_rows == shell_kernel::max_rows);

struct SurfaceShell::Index {
    TriangleTree tree;
    shell_kernel::BlockPoints points;
    Vector3d half;                   // of the box that holds a block's voxel centres
    std::array<float, 8> corner[3];  // of that box, in the block's frame
};

namespace {

// As long along y and z as eight voxels are along x, as far as the rows allow.
std::array<int, 3> block_size_for(const Vector3d& pitch) {
    const double width = ShellBlock::width * pitch[0];
    const int y = std::clamp(int(std::lround(width / pitch[1])), 1, 16);
    const int z = std::clamp(int(std::lround(width / pitch[2])), 1, ShellBlock::max_rows / y);
    return {ShellBlock::width, y, z};
}

// Bits of the body for the rows of one row of blocks: row r, block b at [r * blocks + b].
struct Masks {
    std::size_t blocks;
    std::vector<std::uint8_t> bits;
    std::vector<std::uint8_t> occupied;  // per block: any bit

    Masks(std::size_t blocks_, std::size_t rows) : blocks(blocks_), bits(blocks_ * rows, 0), occupied(blocks_, 0) {}

    void add(std::size_t row, Span span) {
        const auto first = std::size_t(span.begin) / 8, last = std::size_t(span.end - 1) / 8;
        std::uint8_t* const line = bits.data() + row * blocks;
        std::memset(occupied.data() + first, 1, last - first + 1);
        const auto from = std::uint8_t(0xFF << (span.begin % 8)), to = std::uint8_t(0xFF >> (7 - (span.end - 1) % 8));
        if (first == last) {
            line[first] |= from & to;
            return;
        }
        line[first] |= from;
        std::memset(line + first + 1, 0xFF, last - first - 1);
        line[last] |= to;
    }
};

}  // namespace

SurfaceShell::SurfaceShell(const VisibleSurface& surface, const VoxelGrid& grid, double depth_mm)
    : surface_(surface), grid_(grid), depth_mm_(depth_mm), block_size_(block_size_for(grid.pitch_mm)) {
    VOXTONE_EXPECT(depth_mm >= 0);
    VOXTONE_EXPECT(surface.source_triangle.size() == surface.triangles.size() && surface.source_uv.size() == surface.triangles.size());
    shell_kernel::BlockPoints points;
    points.rows = block_size_[1] * block_size_[2];
    for (int l = 0; l < 8; ++l) points.x[std::size_t(l)] = float((l - 3.5) * grid.pitch_mm[0]);
    for (int r = 0; r < points.rows; ++r) {
        points.y[std::size_t(r)] = float((r % block_size_[1] - (block_size_[1] - 1) / 2.0) * grid.pitch_mm[1]);
        points.z[std::size_t(r)] = float((r / block_size_[1] - (block_size_[2] - 1) / 2.0) * grid.pitch_mm[2]);
    }
    const Vector3d half = 0.5 * grid.pitch_mm.cwiseProduct(Vector3d(block_size_[0] - 1, block_size_[1] - 1, block_size_[2] - 1));
    std::array<float, 8> corner[3];
    for (std::size_t c = 0; c < 8; ++c)
        for (int a = 0; a < 3; ++a) corner[a][c] = float(c >> a & 1 ? half[a] : -half[a]);
    index_ = std::make_unique<const Index>(
        Index{TriangleTree(surface.positions_mm, surface.triangles), points, half, {corner[0], corner[1], corner[2]}});
}

SurfaceShell::~SurfaceShell() = default;

void SurfaceShell::for_each_block(int bj, int bk, const SpanSlab& body, const std::function<void(const ShellBlock&)>& visit) const {
    VOXTONE_EXPECT(0 <= bj && bj < block_rows() && 0 <= bk && bk < block_layers() && body.rows() == grid_.size[1]);
    const TriangleTree& tree = index_->tree;
    if (tree.empty()) return;
    const int rows = index_->points.rows;
    const auto blocks = std::size_t((grid_.size[0] + 7) / 8);
    const int j0 = bj * block_size_[1], k0 = bk * block_size_[2];

    Masks masks(blocks, std::size_t(rows));
    for (int z = 0; z < block_size_[2]; ++z) {
        const int k = k0 + z;
        if (k < body.k_begin() || k >= body.k_end()) continue;
        for (int y = 0; y < block_size_[1] && j0 + y < grid_.size[1]; ++y)
            for (const Span& span : body.row(j0 + y, k)) masks.add(std::size_t(z * block_size_[1] + y), span);
    }

    const Vector3d half = index_->half;
    const double reach = depth_mm_ + half.norm() + 1e-3;  // a block farther from the surface is all core
    const double step = 8 * grid_.pitch_mm[0];
    const Vector3d first_centre = grid_.origin_mm + grid_.pitch_mm.cwiseProduct(Vector3d(0.5, j0 + 0.5, k0 + 0.5)) + half;
    const float depth2 = float(depth_mm_ * depth_mm_);

    std::vector<std::uint32_t> candidates, triangle(std::size_t(rows) * 8);
    std::vector<LocalTriangle> local;
    std::array<std::uint8_t, ShellBlock::max_rows> bits;
    const auto result = std::make_unique_for_overwrite<shell_kernel::BlockResult>();
    std::uint32_t guess = TriangleTree::none;
    std::size_t known_block = 0;
    double known_distance = 0;
    for (std::size_t bi = 0; bi < blocks; ++bi) {
        if (!masks.occupied[bi]) continue;
        // The distance changes by no more than the way walked.
        if (known_distance - double(bi - known_block) * step > reach) continue;
        const Vector3d centre = first_centre + Vector3d(double(bi) * step, 0, 0);
        const TriangleTree::Nearest nearest = tree.nearest(centre, guess);
        guess = nearest.triangle;
        known_block = bi;
        known_distance = nearest.distance;
        if (nearest.distance > reach) continue;

        candidates.clear();
        tree.nearest_candidates(centre - half, centre + half, nearest.point, candidates);
        std::sort(candidates.begin(), candidates.end());
        // The same test as the tree's, with the triangles themselves in the place of their boxes.
        std::array<float, 8> reach2, distance2;
        for (std::size_t c = 0; c < 8; ++c) {
            const Vector3d corner(index_->corner[0][c], index_->corner[1][c], index_->corner[2][c]);
            reach2[c] = float((centre + corner - nearest.point).squaredNorm() * (1 + 2e-5) + 1e-6);
        }
        local.clear();
        std::size_t kept = 0;
        for (const std::uint32_t t : candidates) {
            const auto [a, b, c] = tree.corners(t);
            const LocalTriangle seen = shell_kernel::make_local(a, b, c, surface_.source_uv[t], centre);
            shell_kernel::distances2(seen, index_->corner[0].data(), index_->corner[1].data(), index_->corner[2].data(), distance2.data());
            bool near = false;
            for (std::size_t n = 0; n < 8; ++n) near = near || distance2[n] <= reach2[n];
            if (!near) continue;
            local.push_back(seen);
            candidates[kept++] = t;
        }
        VOXTONE_EXPECT(kept > 0);

        for (int r = 0; r < rows; ++r) bits[std::size_t(r)] = masks.bits[std::size_t(r) * blocks + bi];
        shell_kernel::nearest(local.data(), local.size(), index_->points, bits.data(), *result);
        bool any = false;
        for (std::size_t r = 0; r < std::size_t(rows); ++r) {
            if (!bits[r]) continue;
            unsigned within = 0;
            for (std::size_t l = 0; l < 8; ++l) within |= unsigned(result->distance2[r * 8 + l] <= depth2) << l;
            bits[r] &= std::uint8_t(within);
            any = any || bits[r];
        }
        if (!any) continue;
        shell_kernel::finish(local.data(), index_->points, bits.data(), *result);
        for (std::size_t r = 0; r < std::size_t(rows); ++r) {
            if (!bits[r]) continue;
            for (std::size_t l = 0; l < 8; ++l) triangle[r * 8 + l] = candidates[std::size_t(result->slot[r * 8 + l])];
        }
        ShellBlock block;
        block.origin = {int(bi * 8), j0, k0};
        block.size = block_size_;
        block.shell = bits.data();
        block.distance_mm = result->distance.data();
        block.triangle = triangle.data();
        block.u = result->u.data();
        block.v = result->v.data();
        visit(block);
    }
}

}  // namespace voxtone::slicer
