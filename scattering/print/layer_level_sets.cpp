// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layer_level_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include <fmt/core.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/parallel.h"
#include "slicer/mesh/box.h"
#include "slicer/printer/placement.h"
#include "slicer/solid/solid.h"
#include "slicer/surface/surface_shell.h"

namespace voxtone::scattering {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int margin = 3;  ///< cells around the body, and where f is cut off

/// The depths that the materials fill at one surface point.
class Intervals {
public:
    explicit Intervals(const WrappedLayers& wrapped) : wrapped_(wrapped), bottom_(wrapped.fields().layers()) {}

    void look_up(const Eigen::Vector2f& place) {
        wrapped_.fields().bottoms(place.x(), place.y(), bottom_);
        intervals_.clear();
        float top = -infinity;
        for (std::size_t l = 0; l < bottom_.size(); ++l) {
            if (bottom_[l] <= (intervals_.empty() ? 0 : top)) continue;
            add(wrapped_.material(l), top, bottom_[l]);
            top = bottom_[l];
        }
        add(wrapped_.material(bottom_.size()), top, infinity);
    }
    [[nodiscard]] float f(io::Material material, float d) const {
        float least = infinity;
        for (const Interval& i : intervals_)
            if (i.material == material) least = std::min(least, std::max(i.top - d, d - i.bottom));
        return least;
    }

private:
    struct Interval {
        io::Material material;
        float top, bottom;
    };
    void add(io::Material material, float top, float bottom) {
        if (!intervals_.empty() && intervals_.back().material == material)
            intervals_.back().bottom = bottom;
        else
            intervals_.push_back({material, top, bottom});
    }
    const WrappedLayers& wrapped_;
    std::vector<float> bottom_;
    std::vector<Interval> intervals_;
};

slicer::VoxelGrid grid_about(const slicer::SolidMesh& mesh, double cell_mm) {
    const Eigen::AlignedBox3d box = slicer::bounding_box(mesh.positions_mm, mesh.triangles);
    const Eigen::Vector3d cell = Eigen::Vector3d::Constant(cell_mm);
    // All of the body and of its margin: whole cells, which grid_around does not round.
    const Eigen::Vector3d half_mm = 0.5 * cell_mm * (2 * margin + (box.sizes() / cell_mm).array().ceil());
    if ((box.sizes() / cell_mm + Eigen::Vector3d::Constant(2 * margin + 1)).prod() > std::pow(2.0, 29))
        throw InputError(
            fmt::format("--surface-cell {:g}mm: the body would take more than 2^29 cells; give larger ones", cell_mm));
    return slicer::grid_around(box.center() - half_mm, box.center() + half_mm, cell);
}

slicer::SpanSlab everything(const slicer::VoxelGrid& grid, int first, int last) {
    slicer::SpanSlab all;
    all.reset(first, last, grid.size[1]);
    for (int row = 0; row < grid.size[1] * (last - first); ++row) {
        all.push(0, grid.size[0]);
        all.end_row();
    }
    return all;
}

/// f of every material in one layer of blocks: cells where it is below the cut-off.
class SlabFields {
public:
    SlabFields(const slicer::VoxelGrid& grid, const WrappedLayers& wrapped, std::span<const io::Material> materials)
        : grid_(grid), cut_off_(float(margin * grid.pitch_mm.x())), wrapped_(wrapped), materials_(materials) {}

    [[nodiscard]] std::vector<openvdb::FloatGrid::Ptr> make(const slicer::SurfaceShell& visible,
                                                            const slicer::SurfaceShell& boundary,
                                                            const slicer::Solid& solid, int bk) const {
        const int depth = visible.block_size()[2], first = bk * depth, last = std::min(first + depth, grid_.size[2]);
        const slicer::SpanSlab all = everything(grid_, first, last), inside = solid.slab(first, last);
        const std::size_t cells = std::size_t(last - first) * std::size_t(grid_.size[0]) * std::size_t(grid_.size[1]);
        // Signed distance to the body's surface, cut off; and the sign of every cell.
        std::vector<float> body(cells, -cut_off_);
        for (int k = first; k < last; ++k)
            for (int j = 0; j < grid_.size[1]; ++j)
                for (const slicer::Span& span : inside.row(j, k))
                    std::fill_n(body.begin() + std::ptrdiff_t(at(span.begin, j, k - first)), span.end - span.begin,
                                cut_off_);
        for_each_cell(boundary, all, bk, [&](const slicer::ShellBlock& block, int i, int j, int k, int n) {
            float& b = body[at(i, j, k - first)];
            b = std::copysign(std::min(block.distance_mm[n], cut_off_), b);
        });
        std::vector<openvdb::FloatGrid::Ptr> fields;
        std::vector<openvdb::FloatGrid::Accessor> write;
        for (std::size_t m = 0; m < materials_.size(); ++m) {
            fields.push_back(openvdb::FloatGrid::create(cut_off_));
            write.push_back(fields.back()->getAccessor());
        }
        std::vector<bool> seen(cells, false);
        Intervals intervals(wrapped_);
        for_each_cell(visible, all, bk, [&](const slicer::ShellBlock& block, int i, int j, int k, int n) {
            const float b = body[at(i, j, k - first)];
            seen[at(i, j, k - first)] = true;
            if (b <= -cut_off_) return;
            intervals.look_up(wrapped_.map_point(block.triangle[n], block.u[n], block.v[n]));
            const float d = b < 0 ? b : block.distance_mm[n];
            for (std::size_t m = 0; m < materials_.size(); ++m) {
                const float f = std::max(std::max(intervals.f(materials_[m], d), -b), -cut_off_);
                if (f < cut_off_) write[m].setValue({i, j, k}, f);
            }
        });
        // Too deep for any layer: base.
        const auto base =
            std::find(materials_.begin(), materials_.end(), wrapped_.material(wrapped_.fields().layers())) -
            materials_.begin();
        for (int k = first; k < last; ++k)
            for (int j = 0; j < grid_.size[1]; ++j)
                for (const slicer::Span& span : inside.row(j, k))
                    for (int i = span.begin; i < span.end; ++i)
                        if (!seen[at(i, j, k - first)])
                            write[std::size_t(base)].setValue({i, j, k}, -body[at(i, j, k - first)]);
        return fields;
    }

private:
    [[nodiscard]] std::size_t at(int i, int j, int k) const {
        return (std::size_t(k) * std::size_t(grid_.size[1]) + std::size_t(j)) * std::size_t(grid_.size[0]) +
               std::size_t(i);
    }
    template <class Visit>
    static void for_each_cell(const slicer::SurfaceShell& shell, const slicer::SpanSlab& all, int bk, Visit&& visit) {
        for (int bj = 0; bj < shell.block_rows(); ++bj)
            shell.for_each_block(bj, bk, all, [&](const slicer::ShellBlock& block) {
                slicer::for_each_shell_voxel(block, [&](int row, int lane) {
                    visit(block, block.origin[0] + lane, block.origin[1] + row % block.size[1],
                          block.origin[2] + row / block.size[1], row * slicer::ShellBlock::width + lane);
                });
            });
    }
    const slicer::VoxelGrid& grid_;
    float cut_off_;
    const WrappedLayers& wrapped_;
    std::span<const io::Material> materials_;
};

LayerSurface surface_of(const openvdb::FloatGrid& field, const slicer::VoxelGrid& grid, io::Material material) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(field, points, triangles, quads, 0.0, 0.0, false);
    LayerSurface surface;
    surface.material = material;
    const Eigen::Vector3f origin = (grid.origin_mm + 0.5 * grid.pitch_mm).cast<float>();
    for (const openvdb::Vec3s& p : points)
        surface.positions_mm.push_back(origin + Eigen::Vector3f(p.x(), p.y(), p.z()) * float(grid.pitch_mm.x()));
    // OpenVDB's faces run clockwise as seen from outside.
    for (const openvdb::Vec3I& t : triangles) surface.triangles.push_back({t[0], t[2], t[1]});
    for (const openvdb::Vec4I& q : quads) {
        surface.triangles.push_back({q[0], q[2], q[1]});
        surface.triangles.push_back({q[0], q[3], q[2]});
    }
    for (const auto& [a, b, c] : surface.triangles) {
        const Eigen::Vector3d p = surface.positions_mm[a].cast<double>(), q = surface.positions_mm[b].cast<double>(),
                              r = surface.positions_mm[c].cast<double>();
        surface.volume_mm3 += p.dot(q.cross(r)) / 6;
    }
    return surface;
}

}  // namespace

std::vector<LayerSurface> mesh_layer_level_sets(const slicer::JobBody& body, const WrappedLayers& wrapped,
                                                double cell_mm, Progress& progress) {
    openvdb::initialize();
    const slicer::VoxelGrid grid = grid_about(*body.solid, cell_mm);
    std::set<io::Material> used;
    for (std::size_t l = 0; l <= wrapped.fields().layers(); ++l) used.insert(wrapped.material(l));
    const std::vector<io::Material> materials(used.begin(), used.end());

    const slicer::Solid solid(*body.solid, grid);
    const slicer::SurfaceShell visible(body.surface, grid, wrapped.fields().most_depth_mm() + margin * cell_mm),
        boundary(body.solid.tree(), grid, margin * cell_mm);
    const SlabFields slabs(grid, wrapped, materials);
    std::vector<std::vector<openvdb::FloatGrid::Ptr>> parts(std::size_t(visible.block_layers()));
    progress.begin_stage("surfaces", parts.size(), "slabs");
    parallel_for(
        0, parts.size(), 1,
        [&](std::size_t bk) {
            parts[bk] = slabs.make(visible, boundary, solid, int(bk));
            progress.advance();
        },
        &progress);
    std::vector<LayerSurface> surfaces;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        progress.check_cancelled();
        const openvdb::FloatGrid::Ptr whole = openvdb::FloatGrid::create(float(margin * cell_mm));
        whole->setGridClass(openvdb::GRID_LEVEL_SET);
        // Slabs end at borders of OpenVDB's leaves, of eight cells: nothing is in two of them.
        for (const auto& part : parts) whole->tree().merge(part[m]->tree());
        LayerSurface surface = surface_of(*whole, grid, materials[m]);
        if (!surface.triangles.empty()) surfaces.push_back(std::move(surface));
    }
    progress.end_stage();
    return surfaces;
}

}  // namespace voxtone::scattering

void voxtone_mesh_layer_level_sets(const voxtone::slicer::JobBody& body,
                                   const voxtone::scattering::WrappedLayers& wrapped, double cell_mm,
                                   voxtone::Progress& progress,
                                   std::vector<voxtone::scattering::LayerSurface>& surfaces) {
    surfaces = voxtone::scattering::mesh_layer_level_sets(body, wrapped, cell_mm, progress);
}
