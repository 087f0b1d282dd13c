// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which surface cell a place on the surface belongs to: where the unknowns of the appearance loop meet the voxels.
//
// The mesh passes through places of the viewing grid where the voxels have no face; those belong to the cell, among the
// 27 around, whose centre is nearest. Places farther from every cell (which thin features can have) search on.
//
// Memory: 2 KiB per block of 8^3 places near the surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "optics/scene/appearance_model.h"

namespace voxtone::slicer {

class CellIndex {
public:
    /// `pitch_mm`: of the voxels. The surface has at least one cell; it is not needed afterwards.
    CellIndex(const optics::Surface& surface, const std::array<double, 3>& pitch_mm);

    [[nodiscard]] std::size_t size() const { return centre_.size(); }
    /// The cell of a place, mm from the volume's corner.
    [[nodiscard]] std::uint32_t at(const Eigen::Vector3f& place_mm) const;

private:
    static constexpr int edge = 8;
    static constexpr std::uint32_t none = 0xffffffffu;
    [[nodiscard]] std::uint32_t lookup(const std::array<int, 3>& place) const;
    [[nodiscard]] std::uint32_t nearest(const Eigen::Vector3f& place_mm) const;
    template <class Consider>
    void for_each_in_ring(const std::array<int, 3>& home, int ring, Consider&& consider) const;
    void offer(const std::array<int, 3>& place, std::uint32_t cell);

    std::array<float, 3> per_mm_{};
    std::array<int, 3> size_{}, blocks_{};  ///< places and blocks along each axis
    std::vector<std::int32_t> block_;       ///< of each block of places, -1: none near
    std::vector<std::uint32_t> cell_;       ///< of each place of the blocks
    std::vector<std::array<float, 3>> centre_;
};

}  // namespace voxtone::slicer
