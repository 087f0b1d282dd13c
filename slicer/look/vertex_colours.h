// SPDX-License-Identifier: GPL-3.0-or-later
//
// A textured surface as a mesh with vertex colours: edges longer than wanted are halved, all at once and again, until
// none is left, so that neighbours stay joined; then every vertex takes its colour from the surface. Where faces
// disagree about the colour of a vertex (a seam of the texture, a change of material) it becomes several vertices. The
// same result for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "io/models/coloured_mesh.h"
#include "slicer/surface/coloured_surface.h"

namespace voxtone::slicer {

struct VertexColourOptions {
    double edge_mm = 0.5;                ///< wanted: no longer edge is left; > 0
    std::size_t max_vertices = 400'000;  ///< before seams are opened; a surface that has more already is not refined
    double same_colour = 4.0 / 255;      ///< corners that differ less in every sRGB code share a vertex
};

/// A point of the surface: corner0 + u (corner1 - corner0) + v (corner2 - corner0) of a triangle.
struct SurfacePlace {
    std::uint32_t triangle;
    float u, v;
};

struct VertexColours {
    io::ColouredMesh mesh;
    std::vector<SurfacePlace> places;  ///< where each vertex took its colour
    double longest_edge_mm = 0;        ///< what was reached
};

[[nodiscard]] VertexColours vertex_colours(const ColouredSurface& surface, const VertexColourOptions& options,
                                           const Progress* progress = nullptr);

}  // namespace voxtone::slicer
