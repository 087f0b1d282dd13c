// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/path_volume.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "optics/media/lateral_spread.h"

namespace voxtone::optics {
namespace {

constexpr int edge = ResinVolume::block_edge, levels = 4, halo = 2;
constexpr std::size_t block_voxels = std::size_t{edge} * edge * edge;
static_assert(1 << levels == edge);

using Block = std::array<Material, block_voxels>;
using NearBoxes = std::array<bool, block_voxels / 8>;  ///< of 2^3 voxels: the boundary may pass

std::size_t at(int x, int y, int z) { return static_cast<std::size_t>((z * edge + y) * edge + x); }
std::size_t box_at(int x, int y, int z) {
    return static_cast<std::size_t>(((z / 2) * (edge / 2) + y / 2) * (edge / 2) + x / 2);
}

/// The level of the largest aligned box around each voxel without air and, from 4^3 voxels on, without boundary.
/// `inside`: how much of the block belongs to the volume; what is beyond does not count, boxes end there.
void add_levels(const Block& block, const NearBoxes& near, const std::array<int, 3>& inside, std::uint16_t* voxels) {
    std::array<std::uint8_t, block_voxels> free{};  // at the box's first voxel: the box of this level is free of air
    for (int z = 0; z < edge; ++z)
        for (int y = 0; y < edge; ++y)
            for (int x = 0; x < edge; ++x) {
                const std::size_t i = at(x, y, z);
                free[i] = x >= inside[0] || y >= inside[1] || z >= inside[2] || block[i] != air;
                voxels[i] =
                    static_cast<std::uint16_t>(block[i] | (near[box_at(x, y, z)] ? PathVolume::boundary_is_near : 0));
            }
    for (int level = 1; level <= levels; ++level) {
        const int side = 1 << level, half = side / 2;
        for (int z = 0; z < edge; z += side)
            for (int y = 0; y < edge; y += side)
                for (int x = 0; x < edge; x += side) {
                    bool all = true;
                    for (int k = 0; k < 8; ++k) {
                        const int a = x + (k & 1) * half, b = y + (k >> 1 & 1) * half, c = z + (k >> 2) * half;
                        all = all && free[at(a, b, c)] && (level == 1 || !near[box_at(a, b, c)]);
                    }
                    free[at(x, y, z)] = all;
                    if (!all) continue;
                    for (int c = z; c < z + side; ++c)
                        for (int b = y; b < y + side; ++b)
                            for (int a = x; a < x + side; ++a) {
                                std::uint16_t& voxel = voxels[at(a, b, c)];
                                voxel = static_cast<std::uint16_t>((voxel & ~0xf00) | level << 8);
                            }
                }
    }
}

/// Steps to the voxels around one, the nearest first.
std::vector<std::array<int, 3>> steps_around(const std::array<double, 3>& pitch) {
    std::vector<std::array<int, 3>> steps;
    for (int z = -halo; z <= halo; ++z)
        for (int y = -halo; y <= halo; ++y)
            for (int x = -halo; x <= halo; ++x) steps.push_back({x, y, z});
    std::stable_sort(steps.begin(), steps.end(), [&](const auto& a, const auto& b) {
        const auto far = [&](const auto& s) { return std::hypot(s[0] * pitch[0], s[1] * pitch[1], s[2] * pitch[2]); };
        return far(a) < far(b);
    });
    return steps;
}

constexpr int around = edge + 2 * halo;

/// Whether something solid lies within the halo of a voxel of a block, given the block and its halo: most air is far
/// from all. A bit a voxel, rows along x.
class SolidNear {
public:
    explicit SolidNear(const std::vector<Material>& box) {
        std::array<std::array<std::uint32_t, around>, around> rows{}, columns{};  // [z][y]; the second: along y, too
        for (std::size_t i = 0; i < box.size(); ++i)
            if (box[i] != air) rows[i / (around * around)][i / around % around] |= 1u << i % around;
        for (std::size_t z = 0; z < around; ++z)
            for (std::size_t y = 0; y < edge; ++y)
                for (std::size_t k = 0; k <= 2 * halo; ++k) columns[z][y] |= rows[z][y + k];
        for (std::size_t z = 0; z < edge; ++z)
            for (std::size_t y = 0; y < edge; ++y)
                for (std::size_t k = 0; k <= 2 * halo; ++k) solid_[z][y] |= columns[z + k][y];
    }
    [[nodiscard]] bool operator()(int x, int y, int z) const {
        constexpr std::uint32_t window = (1u << (2 * halo + 1)) - 1;
        return (solid_[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] >> x & window) != 0;
    }

private:
    std::array<std::array<std::uint32_t, edge>, edge> solid_{};
};

/// Blocks of a volume as paths see them.
class BlockReader {
public:
    BlockReader(const ResinVolume& volume, const BodyBoundary* boundary, int offset)
        : volume_(volume), boundary_(boundary), offset_(offset), steps_(steps_around(volume.pitch_mm())) {}

    /// The material of the whole block, or -1 where it has to be read. `corner` in path coordinates.
    [[nodiscard]] int uniform(const std::array<int, 3>& corner, const std::array<int, 3>& inside) const {
        if (!boundary_) return volume_.uniform_material(corner, inside);
        const int material = volume_.uniform_material(moved(corner, -offset_ - halo), {around, around, around});
        return material >= 0 && !passes(corner, edge) ? material : -1;
    }

    void read(const std::array<int, 3>& corner, Block& block, NearBoxes& near) const {
        near.fill(false);
        if (!boundary_) {
            volume_.copy_box(corner, {edge, edge, edge}, block);
            return;
        }
        std::vector<Material> box(static_cast<std::size_t>(around * around * around));
        volume_.copy_box(moved(corner, -offset_ - halo), {around, around, around}, box);
        const auto in_box = [](int x, int y, int z) {
            return static_cast<std::size_t>(((z + halo) * around + y + halo) * around + x + halo);
        };
        const SolidNear solid_near(box);
        for (int z = 0; z < edge; ++z)
            for (int y = 0; y < edge; ++y)
                for (int x = 0; x < edge; ++x) {
                    Material found = box[in_box(x, y, z)];
                    if (found == air && solid_near(x, y, z))
                        for (const auto& s : steps_) {
                            found = box[in_box(x + s[0], y + s[1], z + s[2])];
                            if (found != air) break;
                        }
                    block[at(x, y, z)] = found;
                }
        mark(corner, {0, 0, 0}, edge, near);
    }

private:
    static std::array<int, 3> moved(std::array<int, 3> corner, int by) {
        for (int& c : corner) c += by;
        return corner;
    }
    [[nodiscard]] bool passes(const std::array<int, 3>& corner, int side) const {
        Point centre{};
        double square = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            centre[a] = (corner[a] - offset_ + 0.5 * side) * volume_.pitch_mm()[a];
            square += std::pow(0.5 * side * volume_.pitch_mm()[a], 2);
        }
        return boundary_->comes_within(centre, std::sqrt(square) + 2 * inside_boundary_mm);
    }
    void mark(const std::array<int, 3>& corner, const std::array<int, 3>& in_block, int side, NearBoxes& near) const {
        if (!passes({corner[0] + in_block[0], corner[1] + in_block[1], corner[2] + in_block[2]}, side)) return;
        if (side == 2) {
            near[box_at(in_block[0], in_block[1], in_block[2])] = true;
            return;
        }
        const int half = side / 2;
        for (int k = 0; k < 8; ++k)
            mark(corner,
                 {in_block[0] + (k & 1) * half, in_block[1] + (k >> 1 & 1) * half, in_block[2] + (k >> 2) * half}, half,
                 near);
    }

    const ResinVolume& volume_;
    const BodyBoundary* boundary_;
    int offset_;
    std::vector<std::array<int, 3>> steps_;
};

}  // namespace

PathVolume::PathVolume(const Scene& scene, const BodyBoundary* boundary)
    : boundary_(boundary), offset_(boundary ? halo : 0), majorant_(scene.resins->channels.size()) {
    VOXTONE_EXPECT(!boundary || scene.sides == Sides::open);
    const ResinVolume& volume = *scene.volume;
    const BlockReader reader(volume, boundary, offset_);
    for (std::size_t a = 0; a < 3; ++a) {
        size_[a] = volume.size()[a] + 2 * offset_;
        blocks_[a] = (size_[a] + edge - 1) / edge;
    }
    const auto nx = static_cast<std::size_t>(blocks_[0]), ny = static_cast<std::size_t>(blocks_[1]);
    base_.resize(nx * ny * static_cast<std::size_t>(blocks_[2]));
    const auto corner_of = [&](std::size_t b) {
        return std::array<int, 3>{static_cast<int>(b % nx) * edge, static_cast<int>(b / nx % ny) * edge,
                                  static_cast<int>(b / (nx * ny)) * edge};
    };
    const auto inside_of = [&](const std::array<int, 3>& corner) {
        std::array<int, 3> inside{};
        for (std::size_t a = 0; a < 3; ++a) inside[a] = std::min(edge, size_[a] - corner[a]);
        return inside;
    };

    constexpr std::uint32_t several = 0xffffffff;
    parallel_for(0, base_.size(), 64, [&](std::size_t b) {
        const auto corner = corner_of(b);
        const int material = reader.uniform(corner, inside_of(corner));
        base_[b] = material < 0 ? several : static_cast<std::uint32_t>(material);
    });
    std::size_t mixed = 0;
    for (std::uint32_t& base : base_)
        if (base == several) base = static_cast<std::uint32_t>(256 + block_voxels * mixed++);
    if (mixed > (std::size_t{1} << 30) / block_voxels - 1)
        throw ResourceError(
            fmt::format("{} blocks of 16^3 voxels hold several resins; Monte Carlo has room for 262143 (1e9 voxels); "
                        "predict a part "
                        "of the print.",
                        mixed));
    // One more, since vector code reads two voxels at a time.
    voxels_.resize(256 + block_voxels * mixed + 1);
    for (std::size_t m = 0; m < 256; ++m) voxels_[m] = static_cast<std::uint16_t>(m | levels << 8);

    std::vector<std::array<double, 256>> sigma_t(majorant_.size());
    for (std::size_t c = 0; c < majorant_.size(); ++c) {
        majorant_[c].resize(base_.size());
        for (std::size_t r = 0; r < scene.resins->resins.size() && r < 255; ++r)
            sigma_t[c][r + 1] = scene.resins->resins[r].own_medium(c).sigma_t();
    }
    parallel_for(0, base_.size(), 16, [&](std::size_t b) {
        std::array<bool, 256> seen{};
        if (base_[b] < 256) {
            seen[base_[b]] = true;
        } else {
            const auto corner = corner_of(b);
            Block block;
            NearBoxes near;
            reader.read(corner, block, near);
            for (const Material m : block) seen[m] = true;
            add_levels(block, near, inside_of(corner), voxels_.data() + base_[b]);
        }
        for (std::size_t c = 0; c < majorant_.size(); ++c) {
            double largest = 0;
            for (std::size_t m = 1; m < 256; ++m)
                if (seen[m]) largest = std::max(largest, sigma_t[c][m]);
            majorant_[c][b] = static_cast<float>(largest);
        }
    });
    const std::array<int, 2> reach = LateralSpread(scene.spread_mm, volume.pitch_mm()).reach();
    for (std::size_t a = 0; a < 2; ++a)
        if (reach[a] > 0) widen_majorants(a, (reach[a] + edge - 1) / edge);
}

Material PathVolume::material(const std::array<int, 3>& voxel) const {
    std::size_t block = 0;
    for (std::size_t a = 3; a-- > 0;) {
        if (voxel[a] < 0 || voxel[a] >= size_[a]) return air;
        block = block * static_cast<std::size_t>(blocks_[a]) + static_cast<std::size_t>(voxel[a] / edge);
    }
    const std::uint32_t base = base_[block];
    return static_cast<Material>(
        voxels_[base < 256 ? base : base + at(voxel[0] % edge, voxel[1] % edge, voxel[2] % edge)] & 255);
}

/// Particles may belong to voxels that lie so many blocks away along an axis.
void PathVolume::widen_majorants(std::size_t axis, int blocks_away) {
    const auto n = static_cast<std::size_t>(blocks_[axis]), away = static_cast<std::size_t>(blocks_away),
               stride = axis == 0 ? std::size_t{1} : static_cast<std::size_t>(blocks_[0]);
    for (std::vector<float>& majorants : majorant_) {
        const std::vector<float> own = majorants;
        for (std::size_t b = 0; b < own.size(); ++b) {
            const std::size_t place = b / stride % n;
            for (std::size_t k = place - std::min(place, away); k <= std::min(place + away, n - 1); ++k)
                majorants[b] = std::max(majorants[b], own[b + k * stride - place * stride]);
        }
    }
}

}  // namespace voxtone::optics
