// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/clear_spheres.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "optics/media/droplet_spread.h"
#include "optics/media/lateral_spread.h"

namespace voxtone::optics {
namespace {

constexpr int cell_side = ClearSpheres::cell_edge;
// A choice, not tuned: a print is seldom clear farther than that, and a step is at worst 0.7 of what has room.
constexpr double largest_mm = 5, growth = std::numbers::sqrt2;

/// The one material of a cell, air where it is not all of one or the boundary may pass.
Material material_of(const PathVolume& volume, const std::array<int, 3>& cell) {
    std::array<int, 3> block{};
    for (std::size_t a = 0; a < 3; ++a) {
        block[a] = cell[a] / 2;
        if ((cell[a] + 1) * cell_side > volume.size()[a]) return air;
    }
    const auto& blocks = volume.blocks();
    const std::uint32_t base =
        volume.base()[static_cast<std::size_t>((block[2] * blocks[1] + block[1]) * blocks[0] + block[0])];
    if (base < 256) return static_cast<Material>(base);
    const auto low = [&](std::size_t a) { return cell[a] % 2 * cell_side; };
    const std::uint16_t* voxels = volume.voxels().data() + base;
    const auto at = [&](int x, int y, int z) { return voxels[((low(2) + z) * 16 + low(1) + y) * 16 + low(0) + x]; };
    const auto first = static_cast<Material>(at(0, 0, 0) & 255);
    for (int z = 0; z < cell_side; ++z)
        for (int y = 0; y < cell_side; ++y)
            for (int x = 0; x < cell_side; ++x)
                if ((at(x, y, z) & (255 | PathVolume::boundary_is_near)) != first) return air;
    return first;
}

}  // namespace

ClearSpheres::ClearSpheres(const Scene& scene, const PathVolume& volume) : tables_(scene.resins->channels.size()) {
    for (std::size_t a = 0; a < 3; ++a) cells_[a] = (volume.size()[a] + cell_side - 1) / cell_side;
    const std::vector<Material> of_cells = materials_of_cells(volume);
    choose_material(scene, of_cells);
    fitting_.assign(of_cells.size() + 3, 0);
    if (material_ == air) return;

    std::vector<float> square(of_cells.size());
    for (std::size_t i = 0; i < square.size(); ++i) square[i] = of_cells[i] == material_ ? 1e30f : 0.0f;
    for (std::size_t a = 0; a < 3; ++a) spread(square, a, cell_side * scene.volume->pitch_mm()[a], largest_mm);
    constexpr double rounding = 0.999;
    const double droplets_mm = DropletSpread(scene.resins->dot_spread, scene.volume->pitch_mm()).farthest_mm() +
                               LateralSpread(scene.spread_mm, scene.volume->pitch_mm()).farthest_mm();
    for (std::size_t i = 0; i < square.size(); ++i) {
        const double room = rounding * std::sqrt(static_cast<double>(square[i])) - droplets_mm;
        fitting_[i] = static_cast<std::uint8_t>(std::upper_bound(radii_.begin(), radii_.end(), room) - radii_.begin());
    }
    parallel_for(0, tables_.size(), 1, [&](std::size_t c) {
        const Resin& resin = scene.resins->resins[material_ - 1u];
        const Medium medium = resin.own_medium(c);
        Table& table = tables_[c];
        table.weights.assign(radii_.size(), 0);
        table.cosines.assign(radii_.size() * (FirstPassage::intervals + 1), 0);
        if (medium.albedo() < FirstPassage::least_albedo) return;
        const FirstPassage passage(medium, scene.resins->g_of(resin), radii_);
        for (std::size_t i = passage.first(); i < radii_.size(); ++i) {
            table.weights[i] = static_cast<float>(passage.weight(i));
            std::copy(passage.cosines(i).begin(), passage.cosines(i).end(),
                      table.cosines.begin() + static_cast<std::ptrdiff_t>(i * (FirstPassage::intervals + 1)));
        }
    });
}

std::vector<Material> ClearSpheres::materials_of_cells(const PathVolume& volume) const {
    const auto nx = static_cast<std::size_t>(cells_[0]), ny = static_cast<std::size_t>(cells_[1]);
    std::vector<Material> of_cells(nx * ny * static_cast<std::size_t>(cells_[2]));
    parallel_for(0, of_cells.size(), 1024, [&](std::size_t i) {
        of_cells[i] = material_of(
            volume, {static_cast<int>(i % nx), static_cast<int>(i / nx % ny), static_cast<int>(i / (nx * ny))});
    });
    return of_cells;
}

/// Of most cells; and the radii for it.
void ClearSpheres::choose_material(const Scene& scene, const std::vector<Material>& of_cells) {
    std::array<std::size_t, 256> count{};
    for (const Material m : of_cells) ++count[m];
    count[air] = 0;
    const auto most = std::max_element(count.begin(), count.end());
    if (*most == 0) return;
    const auto material = static_cast<Material>(most - count.begin());
    double thickest = 0;
    for (std::size_t c = 0; c < tables_.size(); ++c) {
        const Medium medium = scene.resins->resins[material - 1u].own_medium(c);
        if (medium.albedo() >= FirstPassage::least_albedo) thickest = std::max(thickest, medium.sigma_t());
    }
    if (thickest <= 0) return;
    for (double r = FirstPassage::least_optical_radius / thickest; r <= largest_mm && radii_.size() < most_radii;
         r *= growth)
        radii_.push_back(r);
    if (!radii_.empty()) material_ = material;
}

/// Squared distances between boxes, along one axis more: boxes side by side touch.
void ClearSpheres::spread(std::vector<float>& square, std::size_t axis, double edge_mm, double reach_mm) const {
    const auto nx = static_cast<std::size_t>(cells_[0]), ny = static_cast<std::size_t>(cells_[1]);
    const std::array<std::size_t, 3> stride{1, nx, nx * ny};
    const auto n = static_cast<std::size_t>(cells_[axis]);
    const auto reach = static_cast<std::size_t>(reach_mm / edge_mm) + 2;
    std::vector<float> gap(reach + 1);
    for (std::size_t k = 1; k <= reach; ++k) gap[k] = static_cast<float>(std::pow(double(k - 1) * edge_mm, 2));
    parallel_for(0, square.size() / n, 64, [&](std::size_t row) {
        const std::size_t first = row / stride[axis] * stride[axis] * n + row % stride[axis];
        std::vector<float> line(n);
        for (std::size_t i = 0; i < n; ++i) line[i] = square[first + i * stride[axis]];
        for (std::size_t i = 0; i < n; ++i) {
            // Nothing is known of what is beyond the lattice.
            float least = line[i];
            for (std::size_t k = 1; k <= reach && gap[k] < least; ++k) {
                least = std::min(least, gap[k] + (i >= k ? line[i - k] : 0.0f));
                least = std::min(least, gap[k] + (i + k < n ? line[i + k] : 0.0f));
            }
            square[first + i * stride[axis]] = least;
        }
    });
}

}  // namespace voxtone::optics
