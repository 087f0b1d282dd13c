// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/surface_shell.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/contracts.h"
#include "slicer/surface/shell_kernel.h"

namespace voxtone::slicer {

using Eigen::Vector2f;
using Eigen::Vector3d;
using shell_kernel::LocalTriangle;
static_assert(ShellBlock::width == shell_kernel::row_voxels && ShellBlock::max_rows == shell_kernel::max_rows);

namespace {

// The tree is asked for so many blocks along x at a time.
constexpr int group = 4;

// As long along y and z as eight voxels are along x, as far as the rows allow.
std::array<int, 3> block_size_for(const Vector3d& pitch) {
    const double width = ShellBlock::width * pitch[0];
    const int y = std::clamp(int(std::lround(width / pitch[1])), 1, 16);
    const int z = std::clamp(int(std::lround(width / pitch[2])), 1, ShellBlock::max_rows / y);
    return {ShellBlock::width, y, z};
}

}  // namespace

// Where the voxel centres of a block and of a group are, the same everywhere in the grid.
struct SurfaceShell::Lattice {
    Lattice(const Vector3d& pitch, const std::array<int, 3>& block_size);

    std::array<shell_kernel::BlockPoints, group> points{};  // all in the frame of the group
    Vector3d half, group_half;                              // of the boxes that hold them
    std::array<float, group> centre_x{};                    // of the blocks, in the group's frame
};

SurfaceShell::Lattice::Lattice(const Vector3d& pitch, const std::array<int, 3>& block_size)
    : half(0.5 * pitch.cwiseProduct(Vector3d(block_size[0] - 1, block_size[1] - 1, block_size[2] - 1))),
      group_half(0.5 * pitch[0] * (8 * group - 1), half[1], half[2]) {
    for (std::size_t b = 0; b < group; ++b) {
        points[b].rows = block_size[1] * block_size[2];
        centre_x[b] = float((double(b) - (group - 1) / 2.0) * 8 * pitch[0]);
        for (int l = 0; l < 8; ++l)
            points[b].x[std::size_t(l)] = float((int(8 * b) + l - (8 * group - 1) / 2.0) * pitch[0]);
        for (int r = 0; r < points[b].rows; ++r) {
            points[b].y[std::size_t(r)] = float((r % block_size[1] - (block_size[1] - 1) / 2.0) * pitch[1]);
            points[b].z[std::size_t(r)] = float((r / block_size[1] - (block_size[2] - 1) / 2.0) * pitch[2]);
        }
    }
}

SurfaceShell::SurfaceShell(const SurfaceIndex& surface, const VoxelGrid& grid, double depth_mm, const Relief* relief)
    : SurfaceShell(surface.tree(), surface->source_uv, grid, depth_mm) {
    relief_ = relief && !relief->depths().empty() ? relief : nullptr;
    VOXTONE_EXPECT(surface->source_uv.size() == surface->triangles.size());
}

SurfaceShell::SurfaceShell(const TriangleTree& tree, const VoxelGrid& grid, double depth_mm)
    : SurfaceShell(tree, {}, grid, depth_mm) {}

SurfaceShell::SurfaceShell(const TriangleTree& tree, std::span<const std::array<Vector2f, 3>> source_uv,
                           const VoxelGrid& grid, double depth_mm)
    : tree_(tree),
      source_uv_(source_uv),
      grid_(grid),
      depth_mm_(depth_mm),
      block_size_(block_size_for(grid.pitch_mm)),
      lattice_(std::make_unique<const Lattice>(grid.pitch_mm, block_size_)) {
    VOXTONE_EXPECT(depth_mm >= 0);
}

SurfaceShell::~SurfaceShell() = default;

// One row of blocks, walked along +x group by group, with the lists that serve one group after the other.
class SurfaceShell::RowWalk {
public:
    RowWalk(const SurfaceShell& shell, int bj, int bk, const SpanSlab& body, int i_begin, int i_end);

    void walk(const std::function<void(const ShellBlock&)>& visit);

private:
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
            const auto from = std::uint8_t(0xFF << (span.begin % 8)),
                       to = std::uint8_t(0xFF >> (7 - (span.end - 1) % 8));
            if (first == last) {
                line[first] |= from & to;
                return;
            }
            line[first] |= from;
            std::memset(line + first + 1, 0xFF, last - first - 1);
            line[last] |= to;
        }
    };

    [[nodiscard]] bool wanted(std::size_t block) const;
    [[nodiscard]] bool comes_near(std::size_t g);
    void gather_candidates();
    // b: of the group; block: of the row.
    [[nodiscard]] bool choose_triangles(std::size_t b);
    [[nodiscard]] bool find_shell(std::size_t b, std::size_t block);
    [[nodiscard]] ShellBlock found(std::size_t block) const;

    const SurfaceShell& shell_;
    const Lattice& lattice_;
    std::size_t rows_, blocks_;
    int j0_, k0_, i_begin_, i_end_;
    Masks masks_;
    Vector3d first_centre_;
    double step_;         // from group to group
    double group_reach_;  // farther than that from the surface all is core
    float block_reach_;

    // The group last looked at: which it is, where, and what is nearest to its centre.
    std::size_t group_ = 0;
    Vector3d centre_;
    TriangleTree::Nearest nearest_{.distance = 0};
    std::vector<std::uint32_t> candidates_;
    std::vector<LocalTriangle> local_;           // per candidate
    std::vector<std::array<float, 8>> centre2_;  // per candidate, squared distances from the centres of the blocks
    std::vector<const LocalTriangle*> chosen_;
    std::vector<std::uint32_t> chosen_id_, triangle_;
    std::array<std::uint8_t, ShellBlock::max_rows> bits_;
    std::unique_ptr<shell_kernel::BlockResult> result_ = std::make_unique_for_overwrite<shell_kernel::BlockResult>();
};

SurfaceShell::RowWalk::RowWalk(const SurfaceShell& shell, int bj, int bk, const SpanSlab& body, int i_begin, int i_end)
    : shell_(shell),
      lattice_(*shell.lattice_),
      rows_(std::size_t(shell.block_size_[1] * shell.block_size_[2])),
      blocks_(std::size_t((shell.grid_.size[0] + 7) / 8)),
      j0_(bj * shell.block_size_[1]),
      k0_(bk * shell.block_size_[2]),
      i_begin_(i_begin),
      i_end_(i_end),
      masks_(blocks_, rows_),
      first_centre_(shell.grid_.origin_mm + shell.grid_.pitch_mm.cwiseProduct(Vector3d(0.5, j0_ + 0.5, k0_ + 0.5)) +
                    lattice_.group_half),
      step_(group * 8 * shell.grid_.pitch_mm[0]),
      group_reach_(shell.depth_mm_ + lattice_.group_half.norm() + 1e-3),
      block_reach_(float(shell.depth_mm_ + lattice_.half.norm() + 1e-3)),
      triangle_(rows_ * 8) {
    const auto [width, height, depth] = shell.block_size_;
    for (int z = 0; z < depth; ++z) {
        const int k = k0_ + z;
        if (k < body.k_begin() || k >= body.k_end()) continue;
        for (int y = 0; y < height && j0_ + y < shell.grid_.size[1]; ++y)
            for (const Span& span : body.row(j0_ + y, k)) masks_.add(std::size_t(z * height + y), span);
    }
}

void SurfaceShell::RowWalk::walk(const std::function<void(const ShellBlock&)>& visit) {
    for (std::size_t g = 0; g * group < blocks_; ++g) {
        const std::size_t first = g * group, last = std::min(first + group, blocks_);
        bool any = false;
        for (std::size_t block = first; block < last; ++block) any = any || wanted(block);
        if (!any || !comes_near(g)) continue;
        gather_candidates();
        for (std::size_t block = first; block < last; ++block)
            if (wanted(block) && choose_triangles(block - first) && find_shell(block - first, block))
                visit(found(block));
    }
}

bool SurfaceShell::RowWalk::wanted(std::size_t block) const {
    return masks_.occupied[block] && int(block + 1) * 8 > i_begin_ && int(block) * 8 < i_end_;
}

bool SurfaceShell::RowWalk::comes_near(std::size_t g) {
    // The distance changes by no more than the way walked.
    if (nearest_.distance - double(g - group_) * step_ > group_reach_) return false;
    group_ = g;
    centre_ = first_centre_ + Vector3d(double(g) * step_, 0, 0);
    nearest_ = shell_.tree_.nearest(centre_, nearest_.triangle);
    return nearest_.distance <= group_reach_;
}

// Every triangle that may hold the nearest point of any place in the group.
void SurfaceShell::RowWalk::gather_candidates() {
    const TriangleTree& tree = shell_.tree_;
    candidates_.clear();
    tree.nearest_candidates(centre_ - lattice_.group_half, centre_ + lattice_.group_half, nearest_.point, candidates_);
    std::sort(candidates_.begin(), candidates_.end());
    local_.clear();
    centre2_.resize(candidates_.size());
    const std::array<Vector2f, 3> no_uv{Vector2f::Zero(), Vector2f::Zero(), Vector2f::Zero()};
    std::array<float, 8> px{}, py{}, pz{};
    for (std::size_t b = 0; b < 8; ++b) px[b] = lattice_.centre_x[b % group];
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
        const std::uint32_t t = candidates_[c];
        const auto [p0, p1, p2] = tree.corners(t);
        local_.push_back(
            shell_kernel::make_local(p0, p1, p2, shell_.source_uv_.empty() ? no_uv : shell_.source_uv_[t], centre_));
        shell_kernel::distances2(local_.back(), px.data(), py.data(), pz.data(), centre2_[c].data());
    }
}

// The tree's test for one block, with the triangles themselves in the place of their boxes. False: all is core.
bool SurfaceShell::RowWalk::choose_triangles(std::size_t b) {
    std::size_t best = 0;
    for (std::size_t c = 1; c < candidates_.size(); ++c)
        if (centre2_[c][b] < centre2_[best][b]) best = c;
    if (centre2_[best][b] > block_reach_ * block_reach_) return false;

    const auto [p0, p1, p2] = shell_.tree_.corners(candidates_[best]);
    const Vector3d block_centre(lattice_.centre_x[b], 0, 0);
    const Vector3d w = nearest_weights(centre_ + block_centre, p0, p1, p2);
    const Vector3d q = w[0] * p0 + w[1] * p1 + w[2] * p2 - centre_;
    std::array<float, 8> cx, cy, cz, reach2, distance2;
    for (std::size_t c = 0; c < 8; ++c) {
        const Vector3d corner =
            block_centre + lattice_.half.cwiseProduct(Vector3d(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1));
        cx[c] = float(corner[0]);
        cy[c] = float(corner[1]);
        cz[c] = float(corner[2]);
        reach2[c] = float((corner - q).squaredNorm() * (1 + 2e-5) + 1e-6);
    }
    chosen_.clear();
    chosen_id_.clear();
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
        shell_kernel::distances2(local_[c], cx.data(), cy.data(), cz.data(), distance2.data());
        bool near = false;
        for (std::size_t n = 0; n < 8; ++n) near = near || distance2[n] <= reach2[n];
        if (!near) continue;
        chosen_.push_back(&local_[c]);
        chosen_id_.push_back(candidates_[c]);
    }
    VOXTONE_EXPECT(!chosen_.empty());
    return true;
}

// Every voxel of the block against the triangles chosen. False: none is in the shell.
bool SurfaceShell::RowWalk::find_shell(std::size_t b, std::size_t block) {
    const shell_kernel::BlockPoints& points = lattice_.points[b];
    for (std::size_t r = 0; r < rows_; ++r) bits_[r] = masks_.bits[r * blocks_ + block];
    const float depth2 = float(shell_.depth_mm_ * shell_.depth_mm_);
    if (!shell_kernel::nearest(chosen_.data(), chosen_.size(), points, depth2, bits_.data(), *result_)) return false;
    shell_kernel::finish(chosen_.data(), points, bits_.data(), *result_);
    for (std::size_t r = 0; r < rows_; ++r) {
        if (!bits_[r]) continue;
        if (shell_.relief_)
            shell_.relief_->apply(int(block * 8), j0_ + int(r) % shell_.block_size_[1],
                                  k0_ + int(r) / shell_.block_size_[1], std::span(result_->distance).subspan(r * 8, 8));
        for (std::size_t l = 0; l < 8; ++l) triangle_[r * 8 + l] = chosen_id_[std::size_t(result_->slot[r * 8 + l])];
    }
    return true;
}

ShellBlock SurfaceShell::RowWalk::found(std::size_t block) const {
    return {.origin = {int(block * 8), j0_, k0_},
            .size = shell_.block_size_,
            .shell = bits_.data(),
            .distance_mm = result_->distance.data(),
            .triangle = triangle_.data(),
            .u = result_->u.data(),
            .v = result_->v.data()};
}

void SurfaceShell::for_each_block(int bj, int bk, const SpanSlab& body,
                                  const std::function<void(const ShellBlock&)>& visit, int i_begin, int i_end) const {
    VOXTONE_EXPECT(0 <= bj && bj < block_rows() && 0 <= bk && bk < block_layers() && body.rows() == grid_.size[1]);
    if (!tree_.empty()) RowWalk(*this, bj, bk, body, i_begin, i_end).walk(visit);
}

}  // namespace voxtone::slicer
