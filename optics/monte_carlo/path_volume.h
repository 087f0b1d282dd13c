// SPDX-License-Identifier: GPL-3.0-or-later
//
// A volume of resins made ready for light paths: which material is here, and how far the path may go without asking.
//
// Free paths are drawn by delta tracking (Woodcock, Murphy, Hemmings, Longworth 1965): within a box that holds no air
// the path flies with the largest extinction there is in its block, the majorant; where it stops it meets a real
// particle with probability sigma_t / majorant, and else flies on. Exact for any arrangement of voxels, and far fewer
// steps than from voxel to voxel. Boxes are aligned to powers of two: a block of 16^3 voxels without air, else the
// largest such box around the voxel.
//
// With a boundary of its own the body may reach beyond its solid voxels. Air voxels within two voxels of solid ones
// then take the resin of the nearest, and boxes where the boundary may pass are marked; path coordinates begin two
// voxels before the volume's corner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "optics/scene/appearance_model.h"
#include "optics/scene/boundary.h"

namespace voxtone::optics {

class PathVolume {
public:
    static constexpr int boundary_is_near = 0x8000;

    /// `boundary` may be nullptr: the faces of the voxels. Throws ResourceError where blocks of several materials take
    /// more than 2 GiB.
    explicit PathVolume(const Scene& scene, const BodyBoundary* boundary = nullptr);

    // Voxels of a block: voxels()[base + local], local = ((z % 16) * 16 + y % 16) * 16 + x % 16, or voxels()[base] for
    // all of them where base < 256. The low byte is the material, bits 8 to 11 the level of the box (2^level voxels),
    // bit 15 is set where the boundary may pass through the box.
    [[nodiscard]] const std::vector<std::uint16_t>& voxels() const { return voxels_; }
    [[nodiscard]] const std::vector<std::uint32_t>& base() const { return base_; }  ///< per block, x fastest
    /// In path coordinates; air beyond.
    [[nodiscard]] Material material(const std::array<int, 3>& voxel) const;
    [[nodiscard]] const std::array<int, 3>& blocks() const { return blocks_; }
    [[nodiscard]] const std::array<int, 3>& size() const { return size_; }  ///< with the offset at all sides
    [[nodiscard]] int offset() const { return offset_; }
    [[nodiscard]] const BodyBoundary* boundary() const { return boundary_; }
    /// Per block: the largest sigma_t in it and in what runs into it, mm^-1.
    [[nodiscard]] const std::vector<float>& majorant(std::size_t channel) const { return majorant_[channel]; }

private:
    void widen_majorants(std::size_t axis, int blocks_away);
    const BodyBoundary* boundary_;
    int offset_;
    std::array<int, 3> size_{}, blocks_{};
    std::vector<std::uint16_t> voxels_;
    std::vector<std::uint32_t> base_;
    std::vector<std::vector<float>> majorant_;
};

}  // namespace voxtone::optics
