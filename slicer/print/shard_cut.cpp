// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/shard_cut.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace voxtone::slicer {

namespace {

// Of voxels in the shell; by `slice` of the bundled cow at 60 mm and of a model of 2e10 voxels (docs/decisions/014:
// solid, runs, encoder against nearest point, colour, screen).
constexpr double work_per_inner_voxel = 0.002, work_per_grid_voxel = 0.001;

/// Slabs along z.
struct SlabScale {
    double bottom_mm, slab_mm;
    std::vector<double>& sum;

    [[nodiscard]] double at(double z_mm) const { return (z_mm - bottom_mm) / slab_mm; }
    [[nodiscard]] std::size_t slab_of(double place) const {
        return std::size_t(std::clamp(place, 0.0, double(sum.size()) - 1));
    }
};

/// Share of a triangle below z, from the z of its corners, lowest first.
double share_below(const std::array<double, 3>& z, double at) {
    if (at <= z[0]) return 0;
    if (at >= z[2]) return 1;
    if (at < z[1]) return (at - z[0]) * (at - z[0]) / ((z[1] - z[0]) * (z[2] - z[0]));
    return 1 - (z[2] - at) * (z[2] - at) / ((z[2] - z[1]) * (z[2] - z[0]));
}

void spread(std::array<double, 3> z, double amount, const SlabScale& slabs) {
    std::sort(z.begin(), z.end());
    const std::size_t first = slabs.slab_of(z[0]), last = slabs.slab_of(z[2]);
    double below = 0;
    for (std::size_t slab = first; slab <= last; ++slab) {
        const double upto = slab == last ? 1 : share_below(z, double(slab) + 1);
        slabs.sum[slab] += amount * (upto - below);
        below = upto;
    }
}

/// mm^3 of the coloured shell in each slab: that of a triangle lies behind it, along its normal.
void add_shell(const VisibleSurface& surface, double shell_mm, const SlabScale& slabs) {
    constexpr int parts = 8;  // of the depth
    for (const auto& triangle : surface.triangles) {
        const Eigen::Vector3d &a = surface.positions_mm[triangle[0]], &b = surface.positions_mm[triangle[1]],
                              &c = surface.positions_mm[triangle[2]];
        const Eigen::Vector3d twice_area = (b - a).cross(c - a);
        const double area = 0.5 * twice_area.norm();
        if (!(area > 0)) continue;
        const double inward = -twice_area.z() / (2 * area);
        for (int part = 0; part < parts; ++part) {
            const double down = inward * shell_mm * (part + 0.5) / parts;
            spread({slabs.at(a.z() + down), slabs.at(b.z() + down), slabs.at(c.z() + down)}, area * shell_mm / parts,
                   slabs);
        }
    }
}

/// mm^3 of the body in each slab, from its section in the slab's middle.
void add_inside(const SolidMesh& solid, const SlabScale& slabs) {
    std::vector<double> section(slabs.sum.size());
    for (const auto& triangle : solid.triangles) {
        std::array<Eigen::Vector3d, 3> p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = solid.positions_mm[triangle[i]];
        const auto [low, high] = std::minmax({p[0].z(), p[1].z(), p[2].z()});
        const double from = std::ceil(slabs.at(low) - 0.5), to = slabs.at(high) - 0.5;
        for (double slab = std::max(0.0, from); slab <= to && slab < double(section.size()); ++slab) {
            const double z = slabs.bottom_mm + (slab + 0.5) * slabs.slab_mm;
            // The cut's two ends, from where the triangle's outline goes down through it to where it comes up.
            Eigen::Vector2d down = Eigen::Vector2d::Zero(), up = down;
            bool crosses = false;
            for (std::size_t i = 0; i < 3; ++i) {
                const Eigen::Vector3d &a = p[i], &b = p[(i + 1) % 3];
                if ((a.z() > z) == (b.z() > z)) continue;
                const Eigen::Vector2d at = (a + (z - a.z()) / (b.z() - a.z()) * (b - a)).head<2>();
                (a.z() > z ? down : up) = at;
                crosses = true;
            }
            if (crosses) section[std::size_t(slab)] += 0.5 * (up.x() * down.y() - up.y() * down.x());
        }
    }
    for (std::size_t slab = 0; slab < section.size(); ++slab)
        slabs.sum[slab] += std::abs(section[slab]) * slabs.slab_mm;
}

}  // namespace

std::vector<double> slab_work(const JobBody& body, double shell_mm, int slab_layers) {
    const VoxelGrid& grid = body.grid;
    const std::size_t slabs = std::size_t((grid.size[2] + slab_layers - 1) / slab_layers);
    const double voxel_mm3 = grid.pitch_mm.prod(), slab_mm = slab_layers * grid.pitch_mm.z();
    std::vector<double> shell(slabs), inside(slabs), work(slabs);
    add_shell(*body.surface, shell_mm, {grid.origin_mm.z(), slab_mm, shell});
    add_inside(*body.solid, {grid.origin_mm.z(), slab_mm, inside});
    for (std::size_t s = 0; s < slabs; ++s) {
        const int layers = std::min(slab_layers, grid.size[2] - int(s) * slab_layers);
        work[s] = shell[s] / voxel_mm3 + work_per_inner_voxel * inside[s] / voxel_mm3 +
                  work_per_grid_voxel * double(grid.size[0]) * grid.size[1] * layers;
    }
    return work;
}

LayerRange shard_layers(const std::vector<double>& work, int slab_layers, const LayerRange& all,
                        const io::ShardNumber& number) {
    const int first = all.first / slab_layers, end = all.last / slab_layers + 1;
    double total = 0;
    for (int s = first; s < end; ++s) total += work[std::size_t(s)];
    // The border before which the sum is nearest to its share; the same for the shard below as for the one above.
    const auto border = [&](std::uint32_t shards) {
        if (shards == 0) return all.first;
        if (shards == number.of) return all.last + 1;
        const double wanted = total * double(shards) / double(number.of);
        double sum = 0;
        int s = first;
        for (; s < end && sum + 0.5 * work[std::size_t(s)] < wanted; ++s) sum += work[std::size_t(s)];
        return std::clamp(s * slab_layers, all.first, all.last + 1);
    };
    return {border(number.shard - 1), border(number.shard) - 1};
}

}  // namespace voxtone::slicer
