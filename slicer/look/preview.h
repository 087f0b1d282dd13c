// SPDX-License-Identifier: GPL-3.0-or-later
//
// Orthographic pictures of a coloured surface, true to scale: one pixel is 1 / px_per_mm wide in the plane of the
// picture.
//
// A pixel has s x s samples. It shows the mean, in linear light, of the triangles that its samples see, each with its
// colour in the middle of its samples there; so colours should be filtered to the width of a pixel. Coverage is the
// share of samples that see anything. Colours are exact: no lighting, except in the three-quarter view and where it is
// asked for: a factor in [0.6, 1] tells faces apart there, so that colours are not those of the print.
//
// Method: a depth buffer over the samples, in bands of rows. Edges are tested in double precision in an order that the
// two triangles of an edge share, so that no sample falls between them; of triangles at one depth the lower number is
// seen. The same bits for any number of threads. Both sides of a triangle are drawn.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/pictures/picture_writer.h"
#include "slicer/surface/coloured_surface.h"

namespace voxtone::slicer {

/// Named by the side that is seen. Front: looking along +y, x to the right, z up. Back: along -y, x to the left. Left:
/// along +x, y to the left. Right: along -x, y to the right. Top: along -z, x to the right, y up. Bottom: along +z, x
/// to the right, y down. Three-quarter: from the front, the right and above, lit from there.
enum class View { front, right, back, left, top, bottom, three_quarter };

/// Three-quarter first, then the six sides.
[[nodiscard]] std::span<const View> all_views();
/// "front", ..., "three-quarter".
[[nodiscard]] std::string view_name(View view);
/// Rows: right, up and towards the viewer; a rotation.
[[nodiscard]] Eigen::Matrix3d view_axes(View view);

struct PreviewOptions {
    double px_per_mm = 10;  ///< > 0
    int samples = 4;        ///< s, samples per pixel and axis, in [1, 8]
    int margin_px = 4;      ///< around the surface, >= 0
    /// Asks for the colour at every sample instead of once per triangle and pixel: for colours that are not filtered to
    /// the width of a pixel and would be aliased.
    bool colour_per_sample = false;
    bool lit = false;  ///< all views, as the three-quarter view is
};

struct Preview {
    View view{};
    double px_per_mm = 0;
    io::LinearPicture picture;
};

/// px_per_mm at which no side of any of these views is longer than `longest_px`, margins included.
[[nodiscard]] double fitting_scale(const ColouredSurface& surface, std::span<const View> views, int longest_px,
                                   const PreviewOptions& options = {});

/// One picture per view. Throws InputError when a picture would have more than 2^26 pixels; Cancelled.
[[nodiscard]] std::vector<Preview> render_views(const ColouredSurface& surface, std::span<const View> views,
                                                const PreviewOptions& options, const Progress* progress = nullptr);
/// The same of surfaces that have positions and triangles in common: [surface][view]. What is seen where is found once.
[[nodiscard]] std::vector<std::vector<Preview>> render_views(std::span<const ColouredSurface> surfaces,
                                                             std::span<const View> views, const PreviewOptions& options,
                                                             const Progress* progress = nullptr);

}  // namespace voxtone::slicer
