// SPDX-License-Identifier: GPL-3.0-or-later
//
// Marks as a camera would see them: pictures of a marked body's target colours from a side, and decoders for them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/models/mesh.h"
#include "slicer/mesh/spatial_index.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::test {

/// A closed mesh of one colour, ready to be marked.
struct Body {
    io::TexturedMesh mesh;
    slicer::SolidIndex solid;
    slicer::SurfaceIndex surface;
};
[[nodiscard]] Body body_of(const slicer::SolidMesh& solid, const Eigen::Vector3f& rgb);

/// sRGB codes of luminance, rows from the top.
struct GreyPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
    [[nodiscard]] double at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};
/// What is asked of the surface, seen straight from `out` (its axes: surface/mark_frame.h).
[[nodiscard]] GreyPicture seen_from(const Body& body, const Eigen::Vector3d& out, double pixel_mm);

/// Text of the one code that is found, of either kind; empty: none. Mirrored ones are none.
[[nodiscard]] std::string code_in(const GreyPicture& picture);

}  // namespace voxtone::test
