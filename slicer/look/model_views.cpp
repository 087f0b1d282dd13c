// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/model_views.h"

#include <array>
#include <span>
#include <vector>

#include "base/contracts.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/preview.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

io::LinearPicture model_views(const io::TexturedMesh& mesh, bool is_picture, int width_px, const Progress* progress) {
    VOXTONE_EXPECT(width_px >= least_views_px && width_px <= most_views_px);
    static constexpr std::array body_views{View::three_quarter, View::front, View::top};
    static constexpr std::array slab_views{View::top};
    const std::span<const View> views =
        is_picture ? std::span<const View>(slab_views) : std::span<const View>(body_views);
    ColouredSurface surface{mesh.positions, mesh.triangles, {}};
    PreviewOptions options;
    options.lit = !is_picture;
    options.samples = 3;  // of small triangles each asks for a colour
    const int count = static_cast<int>(views.size());
    options.px_per_mm = fitting_scale(surface, views, (width_px - (count - 1) * views_gap_px) / count, options);
    const SurfaceColour colour(mesh, 1 / options.px_per_mm);
    surface.colour = [&](std::uint32_t t, float u, float v) { return colour.at(t, u, v); };
    return side_by_side(render_views(surface, views, options, progress));
}

}  // namespace voxtone::slicer
