// SPDX-License-Identifier: GPL-3.0-or-later
//
// From any mesh to a surface that encloses a body (solid_mesh.h), with a diagnosis in numbers.
//
// For winding numbers it is enough that the oriented faces form a closed chain, so a mesh that does is left exactly as
// it is, crossings and non-manifold edges included; only shells that face inward are turned, and what is there several
// times in one place, or once for each side, is taken once (coincident_faces.h). With `automatic` anything
// else is welded (corners nearer than a tenth of a voxel or 1e-5 of the size), freed of faces without area and doubled
// faces, oriented alike, and its holes are filled on the vertices that are there, which always gives a closed chain.
// Where a large part of the surface consists of loose pieces that such filling would only close upon themselves (a
// soup), these pieces are wrapped instead: a surface is shrunk onto them from outside (alpha_wrap.h). `wrap` does so
// with everything. Holes as large as what has them are no holes (open_pieces.h): sheets get another side, and a mesh
// that is mostly torn is refused; `fill` closes them all the same.
//
// Welding, orienting and filling are own code: those of CGAL's Polygon Mesh Processing work on 2-manifold meshes and
// split or drop what is none, while a chain may keep crossings and edges with more than two faces, and so the user's
// triangles and their colours.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/models/mesh.h"
#include "slicer/mesh/cavity.h"
#include "slicer/mesh/mesh_diagnosis.h"
#include "slicer/mesh/spatial_index.h"

namespace voxtone::slicer {

enum class RepairMode {
    off,        ///< open meshes are refused
    automatic,  ///< as above
    fill,       ///< so, and holes of any size are filled
    wrap,       ///< everything is wrapped
};

struct RepairOptions {
    RepairMode mode = RepairMode::automatic;
    double pitch_mm = 0.027;  ///< the smallest of the voxel grid: what is far below it need not be told apart
    double sheet_mm = 0;      ///< thickness of open sheets; 0: none, thin_features.h makes a voxel of it
    /// Crossing pairs are counted for meshes up to so many triangles; they are reported and change nothing.
    std::size_t count_crossings_up_to = 200'000;
};

struct RepairReport {
    MeshDiagnosis before, after;
    std::size_t welded_vertices = 0;
    std::size_t dropped_faces = 0;  ///< degenerate and duplicate
    std::size_t turned_faces = 0;   ///< to agree with their neighbours
    std::size_t turned_shells = 0;  ///< that faced inward
    std::size_t cavities = 0;       ///< shells that face inward inside others, kept
    std::size_t filled_holes = 0;
    double filled_area_mm2 = 0;
    std::size_t wrapped_faces = 0;  ///< of the input, replaced by a wrap
    double wrap_alpha_mm = 0, wrap_offset_mm = 0;
    std::vector<Cavity> voids;  ///< that solid/cavities.h found in what came of it
    /// Whole sentences for the user; empty when the mesh was fine as it was.
    std::vector<std::string> messages;
};

struct RepairedMesh {
    SolidIndex solid;
    /// Triangles of the textured mesh that a wrap stands for in `solid`; their colour counts where they are near it.
    std::vector<std::uint32_t> wrapped_triangles;
    RepairReport report;
};

/// What `repair_mesh` advances its progress by.
[[nodiscard]] std::uint64_t repair_steps(const io::TexturedMesh& mesh);

/// Positions of `mesh` in mm. Throws InputError: nothing there, or open and not to be repaired.
[[nodiscard]] RepairedMesh repair_mesh(const io::TexturedMesh& mesh, const RepairOptions& options,
                                       Progress* progress = nullptr);

}  // namespace voxtone::slicer
