// SPDX-License-Identifier: GPL-3.0-or-later
//
// Voids within a body: found, and filled where they are no cavity that anybody meant.
//
// Models that were made from unsigned distances, scans and games have every surface twice, a fraction of a millimetre
// apart: taken at its word such a mesh is a coloured skin over nothing, which a printer fills with support material.
// Colour then leaves the skin at its back, and the print breaks when it is washed. So a void is filled where the wall
// around it is thinner than the coloured shell; what people draw to be hollow has thicker walls and stays.
//
// How: voids are what a flood from outside cannot reach (enclosed_space.h), so that pinholes and slits narrower than a
// cell are no way in. Triangles from which a void is seen are taken off the mesh, with all that lies in it, and the
// rims of pinholes are closed: the body is then what its outer surface encloses, and that surface stays as it was.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "slicer/mesh/cavity.h"
#include "slicer/mesh/mesh_repair.h"

namespace voxtone::slicer {

struct CavityOptions {
    CavityMode mode = CavityMode::automatic;
    double shell_mm = 1;     ///< depth of the coloured shell
    double pitch_mm = 0.05;  ///< the largest of the voxel grid
};

/// Those of `repaired`, the largest first; voids below half a cubic millimetre are left as they are and not told of.
/// Fills by changing `repaired.solid` and its diagnosis. Throws Cancelled.
std::vector<Cavity> treat_cavities(RepairedMesh& repaired, const CavityOptions& options, Progress* progress = nullptr);

/// Whole sentences for the user, one for what was filled, one for what was kept: volume, place, share, wall, and what
/// else can be asked for. `body_mm3`: what the material encloses once voids are filled.
[[nodiscard]] std::vector<std::string> cavity_sentences(const std::vector<Cavity>& cavities,
                                                        const CavityOptions& options, double body_mm3);

}  // namespace voxtone::slicer
