// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"

namespace voxtone::slicer {

namespace {

constexpr double most_pixels = 1 << 26;
constexpr std::uint32_t band_rows_px = 16;
constexpr int most_samples = 8;
constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();
/// Shading: factor of a face that is turned away from the light, and the light's direction as
/// seen (right, up, towards the viewer).
constexpr double least_light = 0.6;
const Eigen::Vector3d light_direction = Eigen::Vector3d(0.25, 0.75, 0.6).normalized();

Eigen::Matrix3d axes_looking(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
    Eigen::Matrix3d axes;
    axes.row(0) = forward.cross(up).normalized();
    axes.row(1) = axes.row(0).cross(forward.normalized());
    axes.row(2) = -forward.normalized();
    return axes;
}

/// The surface in the picture's frame: x to the right and y down in samples, z the distance towards the viewer in mm.
struct Projection {
    std::vector<Eigen::Vector3d> points;
    std::uint32_t width_px, height_px;
};

struct Extent {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector2d high = -low;
    [[nodiscard]] bool empty() const { return low.x() > high.x(); }
    [[nodiscard]] Eigen::Vector2d size() const {
        return empty() ? Eigen::Vector2d::Zero() : Eigen::Vector2d(high - low);
    }
};

/// Of the points that triangles use, in mm in the plane of the picture.
Extent extent_of(const ColouredSurface& surface, const Eigen::Matrix3d& axes) {
    Extent extent;
    for (const auto& triangle : surface.triangles)
        for (const std::uint32_t corner : triangle) {
            const Eigen::Vector2d p = axes.topRows<2>() * surface.positions_mm[corner];
            extent.low = extent.low.cwiseMin(p);
            extent.high = extent.high.cwiseMax(p);
        }
    return extent;
}

Projection project(const ColouredSurface& surface, const Eigen::Matrix3d& axes, const PreviewOptions& options) {
    const Extent extent = extent_of(surface, axes);
    const double margin = options.margin_px;
    const Eigen::Vector2d pixels = (extent.size() * options.px_per_mm).array().ceil() + 2 * margin;
    if (!(pixels.x() * pixels.y() <= most_pixels))
        throw InputError(fmt::format(
            "a preview at {:.3g} px/mm would have {:.3g} x {:.3g} pixels, more than 2^26; ask for fewer pixels per mm",
            options.px_per_mm, pixels.x(), pixels.y()));
    Projection projection;
    projection.width_px = std::max(1u, static_cast<std::uint32_t>(pixels.x()));
    projection.height_px = std::max(1u, static_cast<std::uint32_t>(pixels.y()));
    // The surface stands in the middle of the picture.
    const Eigen::Vector2d centre =
        extent.empty() ? Eigen::Vector2d::Zero() : Eigen::Vector2d((extent.low + extent.high) / 2);
    const double scale = options.px_per_mm * options.samples;
    projection.points.resize(surface.positions_mm.size());
    parallel_for(0, projection.points.size(), 4096, [&](std::size_t i) {
        const Eigen::Vector3d p = axes * surface.positions_mm[i];
        projection.points[i] = {(p.x() - centre.x()) * scale + 0.5 * projection.width_px * options.samples,
                                (centre.y() - p.y()) * scale + 0.5 * projection.height_px * options.samples, p.z()};
    });
    return projection;
}

/// Twice the area of (a, b, p) for the edge from a to b. Evaluated from the lower vertex number to the higher, so that
/// the triangles on both sides get exactly opposite values.
struct Edge {
    Eigen::Vector2d from, along;
    double sign;
    Edge(const Projection& projection, std::uint32_t a, std::uint32_t b)
        : from(projection.points[std::min(a, b)].head<2>()),
          along(projection.points[std::max(a, b)].head<2>() - from),
          sign(a < b ? 1 : -1) {}
    [[nodiscard]] double at(double x, double y) const {
        return sign * (along.x() * (y - from.y()) - along.y() * (x - from.x()));
    }
    /// Narrows [low, high] to where side * at(x, y) may be positive, with a sample to spare; `at` decides.
    void clip(double y, double side, double& low, double& high) const {
        if (along.y() == 0) return;
        const double crossing = from.x() + along.x() * ((y - from.y()) / along.y());
        if (sign * side * along.y() > 0)
            high = std::min(high, crossing + 1);
        else
            low = std::max(low, crossing - 1);
    }
};

/// What one sample sees.
struct Sample {
    double depth = -std::numeric_limits<double>::infinity();
    std::uint32_t triangle = nothing;
    float u = 0, v = 0;
};

/// Samples of rows [first_row, first_row + rows) of the picture.
struct Band {
    std::uint32_t first_row, rows, width;  // samples
    std::vector<Sample> samples;
};

void draw_triangle(const Projection& projection, const std::array<std::uint32_t, 3>& corners, std::uint32_t number,
                   Band& band) {
    const Eigen::Vector3d &p0 = projection.points[corners[0]], &p1 = projection.points[corners[1]],
                          &p2 = projection.points[corners[2]];
    const Edge edges[3] = {{projection, corners[1], corners[2]},
                           {projection, corners[2], corners[0]},
                           {projection, corners[0], corners[1]}};
    const double area = edges[2].at(p2.x(), p2.y());
    if (area == 0) return;
    const double side = area > 0 ? 1 : -1;
    // Samples are at half-integers.
    const double x_low = std::min({p0.x(), p1.x(), p2.x()}), x_high = std::max({p0.x(), p1.x(), p2.x()});
    const double y_low = std::min({p0.y(), p1.y(), p2.y()}), y_high = std::max({p0.y(), p1.y(), p2.y()});
    const double y_first = std::max<double>(band.first_row, std::ceil(y_low - 0.5));
    const double y_last = std::min(band.first_row + band.rows - 1.0, std::floor(y_high - 0.5));
    for (double y = y_first; y <= y_last; ++y) {
        double low = x_low, high = x_high;
        for (const Edge& edge : edges) edge.clip(y + 0.5, side, low, high);
        const double x_first = std::max(0.0, std::ceil(low - 0.5));
        const double x_last = std::min(band.width - 1.0, std::floor(high - 0.5));
        Sample* row = &band.samples[static_cast<std::size_t>(y - band.first_row) * band.width];
        for (double x = x_first; x <= x_last; ++x) {
            const double e0 = edges[0].at(x + 0.5, y + 0.5), e1 = edges[1].at(x + 0.5, y + 0.5),
                         e2 = edges[2].at(x + 0.5, y + 0.5);
            if (e0 * side < 0 || e1 * side < 0 || e2 * side < 0) continue;
            const double sum = e0 + e1 + e2;
            const double depth = (e0 * p0.z() + e1 * p1.z() + e2 * p2.z()) / sum;
            Sample& sample = row[static_cast<std::size_t>(x)];
            if (depth > sample.depth)
                sample = {depth, number, static_cast<float>(e1 / sum), static_cast<float>(e2 / sum)};
        }
    }
}

/// Triangles that reach into each band, in order.
std::vector<std::vector<std::uint32_t>> triangles_of_bands(const ColouredSurface& surface, const Projection& projection,
                                                           std::uint32_t band_samples) {
    const std::uint32_t bands = (projection.height_px + band_rows_px - 1) / band_rows_px;
    std::vector<std::vector<std::uint32_t>> result(bands);
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const std::uint32_t corner : surface.triangles[t]) {
            low = std::min(low, projection.points[corner].y());
            high = std::max(high, projection.points[corner].y());
        }
        const auto first = static_cast<std::uint32_t>(std::max(0.0, low / band_samples));
        const auto last = static_cast<std::uint32_t>(std::clamp(high / band_samples, 0.0, bands - 1.0));
        for (std::uint32_t b = first; b <= last; ++b) result[b].push_back(t);
    }
    return result;
}

/// Factor of the light at the corners of every triangle. Normals are averaged where faces meet
/// within 45 degrees of their mean, so that a smooth body looks smooth and an edge stays an edge.
std::vector<std::array<float, 3>> light_on(const ColouredSurface& surface, const Eigen::Matrix3d& axes) {
    const auto twice_area = [&](const std::array<std::uint32_t, 3>& t) -> Eigen::Vector3d {
        const Eigen::Vector3d& a = surface.positions_mm[t[0]];
        return axes * (surface.positions_mm[t[1]] - a).cross(surface.positions_mm[t[2]] - a);
    };
    std::vector<Eigen::Vector3d> mean(surface.positions_mm.size(), Eigen::Vector3d::Zero());
    for (const auto& triangle : surface.triangles)
        for (const std::uint32_t corner : triangle) mean[corner] += twice_area(triangle);
    std::vector<std::array<float, 3>> light(surface.triangles.size());
    parallel_for(0, light.size(), 4096, [&](std::size_t t) {
        const Eigen::Vector3d face = twice_area(surface.triangles[t]).normalized();  // zero stays zero
        for (std::size_t c = 0; c < 3; ++c) {
            const Eigen::Vector3d smooth = mean[surface.triangles[t][c]].normalized();
            Eigen::Vector3d normal = face.dot(smooth) > std::sqrt(0.5) ? smooth : face;
            if (face.z() < 0) normal = -normal;  // the side that is seen
            light[t][c] =
                static_cast<float>(least_light + (1 - least_light) * std::max(0.0, normal.dot(light_direction)));
        }
    });
    return light;
}

Eigen::Vector3f colour_of(const ColouredSurface& surface, const std::vector<std::array<float, 3>>& light,
                          std::uint32_t triangle, float u, float v) {
    const Eigen::Vector3f rgb = surface.colour(triangle, u, v);
    if (light.empty()) return rgb;
    const auto& corner = light[triangle];
    return (corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0])) * rgb;
}

Eigen::Vector4f pixel_of(const ColouredSurface& surface, const std::vector<std::array<float, 3>>& light,
                         const Band& band, std::uint32_t x, std::uint32_t y, const PreviewOptions& options) {
    const auto samples = static_cast<std::uint32_t>(options.samples);
    std::array<const Sample*, std::size_t{most_samples} * most_samples> seen;
    std::uint32_t covered = 0;
    for (std::uint32_t j = 0; j < samples; ++j)
        for (std::uint32_t i = 0; i < samples; ++i) {
            const Sample& sample = band.samples[std::size_t{y * samples + j} * band.width + x * samples + i];
            if (sample.triangle != nothing) seen[covered++] = &sample;
        }
    if (covered == 0) return Eigen::Vector4f::Zero();
    const auto first = seen.begin(), last = first + covered;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    if (options.colour_per_sample) {
        for (auto s = first; s != last; ++s) sum += colour_of(surface, light, (*s)->triangle, (*s)->u, (*s)->v);
    } else {
        if (std::any_of(first, last, [&](const Sample* s) { return s->triangle != seen[0]->triangle; }))
            std::sort(first, last, [](const Sample* s, const Sample* t) {
                return s->triangle != t->triangle ? s->triangle < t->triangle : s < t;
            });
        for (auto from = first; from != last;) {
            const std::uint32_t triangle = (*from)->triangle;
            float u = 0, v = 0, count = 0;
            for (; from != last && (*from)->triangle == triangle; ++from, ++count) {
                u += (*from)->u;
                v += (*from)->v;
            }
            sum += count * colour_of(surface, light, triangle, u / count, v / count);
        }
    }
    const auto count = static_cast<float>(covered);
    return {sum[0] / count, sum[1] / count, sum[2] / count, count / static_cast<float>(samples * samples)};
}

/// Of each surface.
std::vector<Preview> render(std::span<const ColouredSurface> surfaces, View view, const PreviewOptions& options,
                            const Progress* progress) {
    const ColouredSurface& shape = surfaces.front();
    const Eigen::Matrix3d axes = view_axes(view);
    const Projection projection = project(shape, axes, options);
    const auto samples = static_cast<std::uint32_t>(options.samples);
    const auto bands = triangles_of_bands(shape, projection, band_rows_px * samples);
    std::vector<std::array<float, 3>> light;  // empty: not lit
    if (options.lit || view == View::three_quarter) light = light_on(shape, axes);
    std::vector<Preview> previews(surfaces.size(),
                                  {view, options.px_per_mm, {projection.width_px, projection.height_px, {}}});
    for (Preview& preview : previews)
        preview.picture.pixels.resize(std::size_t{projection.width_px} * projection.height_px);
    parallel_for(
        0, bands.size(), 1,
        [&](std::size_t b) {
            const auto first_px = static_cast<std::uint32_t>(b) * band_rows_px;
            const std::uint32_t rows_px = std::min(band_rows_px, projection.height_px - first_px);
            Band band{first_px * samples, rows_px * samples, projection.width_px * samples, {}};
            band.samples.resize(std::size_t{band.rows} * band.width);
            for (const std::uint32_t t : bands[b]) draw_triangle(projection, shape.triangles[t], t, band);
            for (std::size_t s = 0; s < surfaces.size(); ++s)
                for (std::uint32_t y = 0; y < rows_px; ++y)
                    for (std::uint32_t x = 0; x < projection.width_px; ++x)
                        previews[s].picture.pixels[std::size_t{first_px + y} * projection.width_px + x] =
                            pixel_of(surfaces[s], light, band, x, y, options);
        },
        progress);
    return previews;
}

}  // namespace

std::span<const View> all_views() {
    static constexpr std::array<View, 7> views{View::three_quarter, View::front, View::right, View::back,
                                               View::left,          View::top,   View::bottom};
    return views;
}

std::string view_name(View view) {
    switch (view) {
        case View::front:
            return "front";
        case View::right:
            return "right";
        case View::back:
            return "back";
        case View::left:
            return "left";
        case View::top:
            return "top";
        case View::bottom:
            return "bottom";
        case View::three_quarter:
            return "three-quarter";
    }
    VOXTONE_EXPECT(!"a view");
    return "";
}

Eigen::Matrix3d view_axes(View view) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
    switch (view) {
        case View::front:
            return axes_looking(y, z);
        case View::right:
            return axes_looking(-x, z);
        case View::back:
            return axes_looking(-y, z);
        case View::left:
            return axes_looking(x, z);
        case View::top:
            return axes_looking(-z, y);
        case View::bottom:
            return axes_looking(z, -y);
        case View::three_quarter:
            return axes_looking({-0.55, 0.75, -0.4}, z);
    }
    VOXTONE_EXPECT(!"a view");
    return Eigen::Matrix3d::Identity();
}

double fitting_scale(const ColouredSurface& surface, std::span<const View> views, int longest_px,
                     const PreviewOptions& options) {
    const int room_px = longest_px - 2 * options.margin_px;
    VOXTONE_EXPECT(room_px >= 1);
    std::vector<double> longest_of(views.size());
    parallel_for(0, views.size(), 1,
                 [&](std::size_t v) { longest_of[v] = extent_of(surface, view_axes(views[v])).size().maxCoeff(); });
    const double longest_mm = views.empty() ? 0 : std::max(0.0, std::ranges::max(longest_of));
    // A hair less, so that rounding cannot add a pixel.
    return longest_mm > 0 ? room_px / longest_mm * (1 - 1e-9) : 1.0;
}

std::vector<Preview> render_views(const ColouredSurface& surface, std::span<const View> views,
                                  const PreviewOptions& options, const Progress* progress) {
    return std::move(render_views(std::span(&surface, 1), views, options, progress).front());
}

std::vector<std::vector<Preview>> render_views(std::span<const ColouredSurface> surfaces, std::span<const View> views,
                                               const PreviewOptions& options, const Progress* progress) {
    VOXTONE_EXPECT(options.px_per_mm > 0 && options.samples >= 1 && options.samples <= most_samples &&
                   options.margin_px >= 0);
    VOXTONE_EXPECT(!surfaces.empty() && std::ranges::all_of(surfaces, [&](const ColouredSurface& surface) {
        return surface.positions_mm.data() == surfaces[0].positions_mm.data() &&
               surface.triangles.data() == surfaces[0].triangles.data();
    }));
    std::vector<std::vector<Preview>> by_view(views.size());
    parallel_for(0, views.size(), 1,
                 [&](std::size_t v) { by_view[v] = render(surfaces, views[v], options, progress); });
    std::vector<std::vector<Preview>> previews(surfaces.size());
    for (std::vector<Preview>& of_view : by_view)
        for (std::size_t s = 0; s < surfaces.size(); ++s) previews[s].push_back(std::move(of_view[s]));
    return previews;
}

}  // namespace voxtone::slicer
