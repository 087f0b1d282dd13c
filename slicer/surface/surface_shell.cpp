// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/surface/surface_shell.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "voxtone/base/contracts.h"
#include "voxtone/slicer/surface/shell_kernel.h"

namespace voxtone::slicer {

using Eigen::Vector2f;
using Eigen::Vector3d;
using shell_kernel::LocalTriangle;
static_assert(ShellBlock::width == shell_kernel::row_voxels && ShellBlock::max_rows == shell_kernel::max_rows);

namespace {

// The tree is asked for so many blocks along x at a time.
constexpr int group = 4;

const std::array<Vector2f, 3> no_uv{Vector2f::Zero(), Vector2f::Zero(), Vector2f::Zero()};

}  // namespace

// Where the voxel centres of a block and of a group are, the same everywhere in the grid.
struct SurfaceShell::Lattice {
    std::array<shell_kernel::BlockPoints, group> points;  // all in the frame of the group
    Vector3d half, group_half;          // of the boxes that hold the voxel centres of a block, of a group
    std::array<float, group> centre_x;  // of the blocks, in the group's frame
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

SurfaceShell::SurfaceShell(const SurfaceIndex& surface, const VoxelGrid& grid, double depth_mm)
    : SurfaceShell(surface.tree(), surface->source_uv, grid, depth_mm) {
    VOXTONE_EXPECT(surface->source_uv.size() == surface->triangles.size());
}

SurfaceShell::SurfaceShell(const TriangleTree& tree, const VoxelGrid& grid, double depth_mm)
    : SurfaceShell(tree, {}, grid, depth_mm) {}

SurfaceShell::SurfaceShell(const TriangleTree& tree, std::span<const std::array<Vector2f, 3>> source_uv,
                           const VoxelGrid& grid, double depth_mm)
    : tree_(tree), source_uv_(source_uv), grid_(grid), depth_mm_(depth_mm), block_size_(block_size_for(grid.pitch_mm)) {
    VOXTONE_EXPECT(depth_mm >= 0);
    const Vector3d& pitch = grid.pitch_mm;
    const Vector3d half =
        0.5 * pitch.cwiseProduct(Vector3d(block_size_[0] - 1, block_size_[1] - 1, block_size_[2] - 1));
    const Vector3d group_half(0.5 * pitch[0] * (8 * group - 1), half[1], half[2]);
    Lattice lattice{{}, half, group_half, {}};
    for (std::size_t b = 0; b < group; ++b) {
        shell_kernel::BlockPoints& points = lattice.points[b];
        points.rows = block_size_[1] * block_size_[2];
        lattice.centre_x[b] = float((double(b) - (group - 1) / 2.0) * 8 * pitch[0]);
        for (int l = 0; l < 8; ++l)
            points.x[std::size_t(l)] = float((int(8 * b) + l - (8 * group - 1) / 2.0) * pitch[0]);
        for (int r = 0; r < points.rows; ++r) {
            points.y[std::size_t(r)] = float((r % block_size_[1] - (block_size_[1] - 1) / 2.0) * pitch[1]);
            points.z[std::size_t(r)] = float((r / block_size_[1] - (block_size_[2] - 1) / 2.0) * pitch[2]);
        }
    }
    lattice_ = std::make_unique<const Lattice>(lattice);
}

SurfaceShell::~SurfaceShell() = default;

void SurfaceShell::for_each_block(int bj, int bk, const SpanSlab& body,
                                  const std::function<void(const ShellBlock&)>& visit, int i_begin, int i_end) const {
    VOXTONE_EXPECT(0 <= bj && bj < block_rows() && 0 <= bk && bk < block_layers() && body.rows() == grid_.size[1]);
    const TriangleTree& tree = tree_;
    if (tree.empty()) return;
    const auto rows = std::size_t(block_size_[1] * block_size_[2]);
    const auto blocks = std::size_t((grid_.size[0] + 7) / 8);
    const int j0 = bj * block_size_[1], k0 = bk * block_size_[2];

    Masks masks(blocks, rows);
    for (int z = 0; z < block_size_[2]; ++z) {
        const int k = k0 + z;
        if (k < body.k_begin() || k >= body.k_end()) continue;
        for (int y = 0; y < block_size_[1] && j0 + y < grid_.size[1]; ++y)
            for (const Span& span : body.row(j0 + y, k)) masks.add(std::size_t(z * block_size_[1] + y), span);
    }

    const Vector3d half = lattice_->half, group_half = lattice_->group_half;
    // Farther than that from the surface all is core.
    const double group_reach = depth_mm_ + group_half.norm() + 1e-3;
    const float block_reach = float(depth_mm_ + half.norm() + 1e-3);
    const double step = group * 8 * grid_.pitch_mm[0];
    const Vector3d first_centre =
        grid_.origin_mm + grid_.pitch_mm.cwiseProduct(Vector3d(0.5, j0 + 0.5, k0 + 0.5)) + group_half;
    const float depth2 = float(depth_mm_ * depth_mm_);

    std::vector<std::uint32_t> candidates, triangle(rows * 8);
    std::vector<LocalTriangle> local;
    std::vector<std::array<float, 8>> centre2;  // per candidate, squared distances from the centres of the blocks
    std::vector<const LocalTriangle*> chosen;
    std::vector<std::uint32_t> chosen_id;
    std::array<std::uint8_t, ShellBlock::max_rows> bits;
    const auto result = std::make_unique_for_overwrite<shell_kernel::BlockResult>();
    std::uint32_t guess = TriangleTree::none;
    std::size_t known_group = 0;
    double known_distance = 0;
    for (std::size_t g = 0; g * group < blocks; ++g) {
        const std::size_t first = g * group, last = std::min(first + group, blocks);
        if (int(last) * 8 <= i_begin || int(first) * 8 >= i_end) continue;
        if (std::find(masks.occupied.begin() + std::ptrdiff_t(first), masks.occupied.begin() + std::ptrdiff_t(last),
                      1) == masks.occupied.begin() + std::ptrdiff_t(last))
            continue;
        // The distance changes by no more than the way walked.
        if (known_distance - double(g - known_group) * step > group_reach) continue;
        const Vector3d centre = first_centre + Vector3d(double(g) * step, 0, 0);
        const TriangleTree::Nearest nearest = tree.nearest(centre, guess);
        guess = nearest.triangle;
        known_group = g;
        known_distance = nearest.distance;
        if (nearest.distance > group_reach) continue;

        candidates.clear();
        tree.nearest_candidates(centre - group_half, centre + group_half, nearest.point, candidates);
        std::sort(candidates.begin(), candidates.end());
        local.clear();
        centre2.resize(candidates.size());
        std::array<float, 8> px{}, py{}, pz{};
        for (std::size_t b = 0; b < 8; ++b) px[b] = lattice_->centre_x[b % group];
        for (std::size_t c = 0; c < candidates.size(); ++c) {
            const std::uint32_t t = candidates[c];
            const auto [p0, p1, p2] = tree.corners(t);
            local.push_back(shell_kernel::make_local(p0, p1, p2, source_uv_.empty() ? no_uv : source_uv_[t], centre));
            shell_kernel::distances2(local.back(), px.data(), py.data(), pz.data(), centre2[c].data());
        }

        for (std::size_t bi = first; bi < last; ++bi) {
            if (!masks.occupied[bi] || int(bi + 1) * 8 <= i_begin || int(bi) * 8 >= i_end) continue;
            const std::size_t b = bi - first;
            std::size_t best = 0;
            for (std::size_t c = 1; c < candidates.size(); ++c)
                if (centre2[c][b] < centre2[best][b]) best = c;
            if (centre2[best][b] > block_reach * block_reach) continue;

            // The tree's test for this block, with the triangles themselves in the place of their boxes.
            const auto [p0, p1, p2] = tree.corners(candidates[best]);
            const Vector3d block_centre(lattice_->centre_x[b], 0, 0);
            const Vector3d w = nearest_weights(centre + block_centre, p0, p1, p2);
            const Vector3d q = w[0] * p0 + w[1] * p1 + w[2] * p2 - centre;
            std::array<float, 8> cx, cy, cz, reach2, distance2;
            for (std::size_t c = 0; c < 8; ++c) {
                const Vector3d corner =
                    block_centre + half.cwiseProduct(Vector3d(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1));
                cx[c] = float(corner[0]);
                cy[c] = float(corner[1]);
                cz[c] = float(corner[2]);
                reach2[c] = float((corner - q).squaredNorm() * (1 + 2e-5) + 1e-6);
            }
            chosen.clear();
            chosen_id.clear();
            for (std::size_t c = 0; c < candidates.size(); ++c) {
                shell_kernel::distances2(local[c], cx.data(), cy.data(), cz.data(), distance2.data());
                bool near = false;
                for (std::size_t n = 0; n < 8; ++n) near = near || distance2[n] <= reach2[n];
                if (!near) continue;
                chosen.push_back(&local[c]);
                chosen_id.push_back(candidates[c]);
            }
            VOXTONE_EXPECT(!chosen.empty());

            for (std::size_t r = 0; r < rows; ++r) bits[r] = masks.bits[r * blocks + bi];
            if (!shell_kernel::nearest(chosen.data(), chosen.size(), lattice_->points[b], depth2, bits.data(), *result))
                continue;
            shell_kernel::finish(chosen.data(), lattice_->points[b], bits.data(), *result);
            for (std::size_t r = 0; r < rows; ++r) {
                if (!bits[r]) continue;
                for (std::size_t l = 0; l < 8; ++l)
                    triangle[r * 8 + l] = chosen_id[std::size_t(result->slot[r * 8 + l])];
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
}

}  // namespace voxtone::slicer
