// SPDX-License-Identifier: GPL-3.0-or-later
//
// How large a sphere may be around any point of a volume that holds nothing but the resin which most of its inside is
// of: for walks on spheres (first_passage.h).
//
// Per cell of 8^3 voxels a bound from below: the distance of its box to the nearest cell that holds anything else, air
// or a piece of the boundary (per axis by the lower envelope of squared distances, as A. Meijster, J. Roerdink, W.
// Hesselink, "A general algorithm for computing distance transforms in linear time", 2000; here by windows).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "optics/monte_carlo/first_passage.h"
#include "optics/monte_carlo/path_volume.h"

namespace voxtone::optics {

class ClearSpheres {
public:
    static constexpr int cell_edge = 8;
    static constexpr std::size_t most_radii = 32;

    ClearSpheres(const Scene& scene, const PathVolume& volume);

    /// The resin, 0 where there is none with room for a sphere and an albedo for it in any channel.
    [[nodiscard]] Material material() const { return material_; }
    /// Per cell, x fastest: how many of the radii fit. Three bytes more than cells, since vector code reads four.
    [[nodiscard]] const std::vector<std::uint8_t>& fitting() const { return fitting_; }
    [[nodiscard]] const std::array<int, 3>& cells() const { return cells_; }
    [[nodiscard]] const std::vector<double>& radii_mm() const { return radii_; }
    /// Per radius and channel: the weight that a path keeps; 0: no step there.
    [[nodiscard]] const std::vector<float>& weights(std::size_t channel) const { return tables_[channel].weights; }
    /// intervals + 1 a radius.
    [[nodiscard]] const std::vector<float>& cosines(std::size_t channel) const { return tables_[channel].cosines; }

private:
    struct Table {
        std::vector<float> weights, cosines;
    };
    [[nodiscard]] std::vector<Material> materials_of_cells(const PathVolume& volume) const;
    void choose_material(const Scene& scene, const std::vector<Material>& cells);
    void spread(std::vector<float>& square, std::size_t axis, double edge_mm, double reach_mm) const;

    Material material_ = air;
    std::array<int, 3> cells_{};
    std::vector<double> radii_;
    std::vector<std::uint8_t> fitting_;
    std::vector<Table> tables_;
};

}  // namespace voxtone::optics
