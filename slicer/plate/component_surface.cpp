// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/component_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "halftone/separation/appearance_colour.h"
#include "optics/scene/surface.h"
#include "slicer/look/cell_mesh.h"
#include "slicer/look/viewer_surface.h"
#include "slicer/part/job_colour.h"

namespace voxtone::slicer {

namespace {

constexpr const char* print_look = "print";

/// Voxels of each resin in each cell, x fastest.
class CellCounts {
public:
    CellCounts(const VoxelGrid& grid, std::size_t resins) : grid_(grid), resins_(resins) {
        constexpr double most_cells = 250'000, least_mm = 0.15;
        const Eigen::Vector3d mm =
            grid.pitch_mm.cwiseProduct(Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]));
        cell_ = optics::cell_voxels({grid.pitch_mm.x(), grid.pitch_mm.y(), grid.pitch_mm.z()},
                                    std::max(least_mm, std::cbrt(mm.prod() / most_cells)));
        for (std::size_t axis = 0; axis < 3; ++axis) cells_[axis] = (grid.size[axis] + cell_[axis] - 1) / cell_[axis];
        voxels_.resize(std::size_t(cells_[0]) * std::size_t(cells_[1]) * std::size_t(cells_[2]) * resins);
    }

    void count(const LayerSource& layers, Progress& progress) {
        progress.begin_stage("look at a component", std::uint64_t(cells_[2]), "levels");
        parallel_for(
            0, std::size_t(cells_[2]), 1,
            [&](std::size_t level) {
                const int first = int(level) * cell_[2], last = std::min(first + cell_[2], grid_.size[2]);
                const int depth = layers.slab_layers();
                for (int slab = first / depth; slab <= (last - 1) / depth; ++slab)
                    (void)layers.make(slab, first, last,
                                      [&](int, const io::LayerRuns& layer) { add(int(level), layer); });
                progress.advance();
            },
            &progress);
        progress.end_stage();
    }

    [[nodiscard]] const std::array<int, 3>& cells() const { return cells_; }
    [[nodiscard]] std::array<double, 3> cell_mm() const {
        return {cell_[0] * grid_.pitch_mm.x(), cell_[1] * grid_.pitch_mm.y(), cell_[2] * grid_.pitch_mm.z()};
    }
    /// Of a cell, by resin.
    [[nodiscard]] const std::uint32_t* at(int x, int y, int z) const { return voxels_.data() + index(x, y, z); }
    [[nodiscard]] bool is_full(int x, int y, int z) const {
        const std::array<int, 3> cell{x, y, z};
        std::uint64_t room = 1, filled = 0;  // what of it is in the grid
        for (std::size_t axis = 0; axis < 3; ++axis)
            room *=
                std::uint64_t(std::min((cell[axis] + 1) * cell_[axis], grid_.size[axis]) - cell[axis] * cell_[axis]);
        for (std::size_t r = 0; r < resins_; ++r) filled += at(x, y, z)[r];
        return 2 * filled >= room;
    }

private:
    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return (std::size_t(z * cells_[1] + y) * std::size_t(cells_[0]) + std::size_t(x)) * resins_;
    }
    void add(int level, const io::LayerRuns& layer) {
        for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
            const int row = (grid_.size[1] - 1 - int(y)) / cell_[1];
            int i = 0;
            for (const io::Run& run : layer.row(y)) {
                const int end = i + run.length;
                if (run.material == io::background) {
                    i = end;
                    continue;
                }
                while (i < end) {
                    const int next = std::min(end, (i / cell_[0] + 1) * cell_[0]);
                    voxels_[index(i / cell_[0], row, level) + run.material - 1] += std::uint32_t(next - i);
                    i = next;
                }
            }
        }
    }

    const VoxelGrid& grid_;
    std::size_t resins_;
    std::array<int, 3> cell_{}, cells_{};
    std::vector<std::uint32_t> voxels_;
};

/// What a mixture looks like in a thick layer.
class MixtureColour {
public:
    explicit MixtureColour(const OpenedJob& common)
        : appearance_(common.resins.set, shell_geometry(common.options.colour, common.resins,
                                                        common.printer.sliced_pitch_mm(), std::nullopt)),
          colour_(appearance_, common.resins.set.channels) {}
    [[nodiscard]] Eigen::Vector3f of(std::vector<double> share) const {
        double sum = 0;
        for (const double one : share) sum += one;
        for (double& one : share) one /= sum;
        return colour_.rgb(share).cast<float>().cwiseMax(0).cwiseMin(1);
    }

private:
    optics::ShellAppearance appearance_;
    halftone::AppearanceColour colour_;
};

/// Whether one looks through it: light goes a centimetre before it is turned aside or taken.
bool is_clear(const ReadyComponent& component, const OpenedJob& common) {
    constexpr double clear_per_mm = 0.1;
    double voxels = 0, per_mm = 0;
    for (std::size_t r = 0; r < component.voxels.size(); ++r) {
        const optics::Resin& resin = common.resins.set.resins[r];
        voxels += double(component.voxels[r]);
        for (std::size_t c = 0; c < resin.sigma_t_per_mm.size(); ++c)
            per_mm += double(component.voxels[r]) * resin.sigma_t_per_mm[c] *
                      (1 - common.resins.set.g * resin.albedo[c]) / double(resin.sigma_t_per_mm.size());
    }
    return voxels > 0 && per_mm < clear_per_mm * voxels;
}

}  // namespace

std::optional<io::ViewerSurface> component_surface(const ReadyComponent& component, const OpenedJob& common,
                                                   std::size_t bytes, Progress& progress) {
    const std::size_t resins = common.resins.entries.size();
    CellCounts counts(component.layers->grid(), resins);
    counts.count(*component.layers, progress);
    const optics::ResinVolume volume = optics::make_resin_volume(
        counts.cells(), counts.cell_mm(),
        [&](int x, int y, int z) { return optics::Material(counts.is_full(x, y, z) ? 1 : 0); });
    optics::Scene scene;
    scene.volume = &volume;
    const optics::Surface surface = optics::find_surface(scene, {1, 1, 1}, optics::SurfacePart::all, &progress);
    if (surface.cells.empty()) return std::nullopt;
    io::ColouredMesh mesh;
    mesh.triangles = cell_triangles(volume, surface);
    const MixtureColour colour(common);
    const Eigen::Vector3f of_all = colour.of({component.voxels.begin(), component.voxels.end()});
    SurfaceLooks looks;
    looks.looks.push_back({print_look, "a component: its resins as they look in a thick layer", {}});
    for (const optics::SurfaceCell& cell : surface.cells) {
        mesh.positions_mm.emplace_back(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]);
        const std::uint32_t* voxels = counts.at(cell.cell[0], cell.cell[1], cell.cell[2]);
        looks.looks[0].rgb.push_back(component.is_one_mixture ? of_all : colour.of({voxels, voxels + resins}));
    }
    if (mesh.triangles.empty()) return std::nullopt;
    io::ViewerSurface made = viewer_body(mesh, looks, std::ranges::max(counts.cell_mm()), bytes);
    if (is_clear(component, common)) made.clear = made.triangles.size();
    return made;
}

io::ViewerSurface with_looks_of(io::ViewerSurface surface, const io::ViewerSurface& other) {
    const io::ViewerLook own = surface.looks.at(0);
    surface.asked = other.asked, surface.expected = other.expected;
    surface.looks.clear();
    for (const io::ViewerLook& look : other.looks) surface.looks.push_back({look.name, look.caption, own.rgb});
    const std::size_t places = surface.positions.size() / 3;
    if (!other.seen.empty()) surface.seen.assign(places, 0);
    if (!other.single.empty()) surface.single.assign(places, 0);
    return surface;
}

}  // namespace voxtone::slicer
