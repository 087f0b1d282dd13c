// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sheets that enclose nothing (capes, leaves, flags), as the print has them. In the mesh both of their sides lie in one
// place, so no ray can tell them apart; printed, a sheet is the voxels of thin_features.h, whose middles are no farther
// from it than half of max |n_i| p_i along its normal n, for a pitch p: it is so thick. Each side is moved outward by
// half of that, and along the sheet's rim a strip joins the two. A face that another of the body comes as near to as
// twice the sheet's thickness (a label on a body) stays where it is.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

struct PartedSheets {
    std::vector<Eigen::Vector3d> positions_mm;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< those of the mesh, in its order, then the strips
    std::vector<std::uint32_t> rim_of;                    ///< per strip's triangle the face that it goes along
};

/// Time n log n. A mesh without sheets comes back as it is.
[[nodiscard]] PartedSheets part_sheets(std::span<const Eigen::Vector3d> positions_mm,
                                       std::span<const std::array<std::uint32_t, 3>> triangles,
                                       const Eigen::Vector3d& pitch_mm);

}  // namespace voxtone::slicer
