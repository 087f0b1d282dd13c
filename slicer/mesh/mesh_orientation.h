// SPDX-License-Identifier: GPL-3.0-or-later
//
// Turning faces: so that neighbours agree, and so that shells face outward. Own code because CGAL's orient_polygon_soup
// doubles the corners where more than two faces meet at an edge, which opens the chain; here such edges stay, and what
// meets there is turned so that the edge closes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/mesh_chain.h"

namespace voxtone::slicer {

/// Turns faces so that faces that share an edge (two at that edge) run it in opposite ways wherever that is possible,
/// as few as possible per connected patch; then whole patches where that closes edges at which more faces meet. Returns
/// how many.
std::size_t orient_consistently(std::span<Triangle> triangles);

struct ShellTurns {
    std::size_t turned = 0;    ///< shells
    std::size_t cavities = 0;  ///< shells of negative volume inside others, left as they are
    std::vector<std::uint8_t> turned_triangle;
};
/// Turns shells of negative volume outward, and with each the shells inside it; a shell of negative volume inside
/// another shell is a cavity and stays. The mesh is a closed chain. Throws InputError where shells lie inside one
/// another by the thousand: the work is bounded (work_budget.h; `most_steps` 0: by the number of triangles).
ShellTurns orient_outward(std::span<const Eigen::Vector3d> positions, std::span<Triangle> triangles,
                          const Shells& shells, const Progress* progress = nullptr, std::uint64_t most_steps = 0);

}  // namespace voxtone::slicer
