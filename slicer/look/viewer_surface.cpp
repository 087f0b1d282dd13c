// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/viewer_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include <fmt/core.h>

#include "base/contracts.h"
#include "io/pictures/srgb_code.h"
#include "io/report/report_html.h"
#include "io/report/viewer_data.h"
#include "slicer/look/clustered_mesh.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/preview.h"
#include "slicer/look/vertex_colours.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

constexpr double surface_share = 0.65;

/// Bytes of the page for a place, as the bundled cow of 30 mm (11.4, up to 2.7, 1.1) and a photograph (0, 2.7, 1.2)
/// have them after deflate and base64, and a little more.
std::size_t most_places(std::size_t bytes, const SurfaceLooks& looks, double of_shape) {
    constexpr double of_look = 2.9, of_difference = 1.3;
    const double each = of_shape + of_look * double(looks.looks.size()) +
                        of_difference * (double(!looks.seen.empty()) + double(!looks.single.empty()));
    return std::max<std::size_t>(16, std::size_t(double(bytes) / each));
}

/// Mean values of the new places; `place_of` says where each old one went.
class Gathered {
public:
    Gathered(std::span<const std::uint32_t> place_of, std::size_t places) : place_of_(place_of), count_(places, 0.0f) {
        for (const std::uint32_t place : place_of) count_[place] += 1;
    }
    [[nodiscard]] std::vector<std::uint8_t> codes(const std::vector<Eigen::Vector3f>& rgb) const {
        VOXTONE_EXPECT(rgb.size() == place_of_.size());
        std::vector<Eigen::Vector3f> sum(count_.size(), Eigen::Vector3f::Zero());
        for (std::size_t i = 0; i < rgb.size(); ++i) sum[place_of_[i]] += rgb[i];
        std::vector<std::uint8_t> codes;
        codes.reserve(3 * sum.size());
        for (std::size_t p = 0; p < sum.size(); ++p)
            for (Eigen::Index c = 0; c < 3; ++c)
                codes.push_back(io::linear_to_srgb8(count_[p] > 0 ? sum[p][c] / count_[p] : 0));
        return codes;
    }
    [[nodiscard]] io::ViewerDifferences tenths(const std::vector<double>& difference) const {
        if (difference.empty()) return {};
        VOXTONE_EXPECT(difference.size() == place_of_.size());
        std::vector<double> sum(count_.size(), 0.0);
        for (std::size_t i = 0; i < difference.size(); ++i) sum[place_of_[i]] += difference[i];
        io::ViewerDifferences tenths;
        tenths.reserve(sum.size());
        for (std::size_t p = 0; p < sum.size(); ++p)
            tenths.push_back(std::uint8_t(std::lround(std::min(25.5, sum[p] / std::max(1.0f, count_[p])) * 10)));
        return tenths;
    }
    [[nodiscard]] std::vector<std::uint8_t> covered() const {
        std::vector<std::uint8_t> covered;
        for (const float count : count_) covered.push_back(count > 0 ? 1 : 0);
        return covered;
    }

private:
    std::span<const std::uint32_t> place_of_;
    std::vector<float> count_;
};

void add_looks(const SurfaceLooks& looks, const Gathered& gathered, io::ViewerSurface& to) {
    for (const SurfaceLook& look : looks.looks) to.looks.push_back({look.name, look.caption, gathered.codes(look.rgb)});
    to.seen = gathered.tenths(looks.seen);
    to.single = gathered.tenths(looks.single);
}

std::size_t left(const io::Report& report) {
    const std::size_t still = io::still_page_bytes(report);
    return still < io::most_page_bytes ? io::most_page_bytes - still : 0;
}

}  // namespace

std::size_t surface_bytes_left(const io::Report& report) { return std::size_t(surface_share * double(left(report))); }
std::size_t voxel_bytes_left(const io::Report& report) {
    return std::size_t((1 - surface_share) * double(left(report)));
}

namespace {

/// Colours that hardly become smaller take more room than was thought: once more then, with fewer places.
template <class Make>
io::ViewerSurface fitting(std::size_t bytes, std::size_t most, Make make) {
    constexpr std::size_t fewest = 64;
    for (;;) {
        io::ViewerSurface surface = make(most);
        const std::size_t taken = io::packed_bytes(surface);
        if (taken <= bytes || most <= fewest) return surface;
        most = std::max(fewest, std::size_t(0.95 * double(most) * double(bytes) / double(taken)));
    }
}

io::ViewerSurface body_of(const io::ColouredMesh& mesh, const SurfaceLooks& looks, double grain_mm, std::size_t most) {
    const ClusteredMesh shape = clustered(mesh.positions_mm, mesh.triangles, most, grain_mm);
    io::ViewerSurface out;
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
    for (const Eigen::Vector3f& p : shape.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
    for (std::size_t a = 0; a < 3; ++a) {
        out.low_mm[a] = double(low[Eigen::Index(a)]);
        out.high_mm[a] = double(high[Eigen::Index(a)]);
    }
    out.positions.reserve(3 * shape.positions_mm.size());
    for (const Eigen::Vector3f& p : shape.positions_mm)
        for (Eigen::Index a = 0; a < 3; ++a)
            out.positions.push_back(
                std::uint16_t(std::lround(65535 * double(p[a] - low[a]) / std::max(1e-6, double(high[a] - low[a])))));
    for (const auto& t : shape.triangles) out.triangles.insert(out.triangles.end(), t.begin(), t.end());
    out.place_mm = std::max(grain_mm, shape.cube_mm);
    add_looks(looks, Gathered(shape.vertex_of, shape.positions_mm.size()), out);
    out.note = shape.cube_mm > 0
                   ? fmt::format("{} places about {:.2f} mm apart, each the mean of what is known in {:.3f} mm.",
                                 shape.positions_mm.size(), shape.cube_mm, grain_mm)
                   : fmt::format("{} places up to {:.2f} mm apart.", shape.positions_mm.size(), grain_mm);
    return out;
}

io::ViewerSurface picture_of(const optics::ResinVolume& volume, const optics::Surface& surface,
                             const SurfaceLooks& looks, std::size_t most) {
    const std::array<int, 2> cells = picture_cells(volume, surface.cell_voxels);
    int across = 1;  // cells that become one
    const auto size = [&](std::size_t a) { return std::uint32_t((cells[a] + across - 1) / across); };
    while (std::size_t{size(0)} * size(1) > most) ++across;
    io::ViewerSurface out;
    out.size_px = {size(0), size(1)};
    std::vector<std::uint32_t> place_of;
    place_of.reserve(surface.cells.size());
    double top_mm = 0;
    for (const optics::SurfaceCell& cell : surface.cells) {
        const std::uint32_t row = std::uint32_t((cells[1] - 1 - cell.cell[1]) / across);
        place_of.push_back(row * size(0) + std::uint32_t(cell.cell[0] / across));
        top_mm = std::max(top_mm, double(cell.centre_mm[2]));
    }
    const auto& pitch = volume.pitch_mm();
    const double cell_x = surface.cell_voxels[0] * pitch[0], cell_y = surface.cell_voxels[1] * pitch[1];
    // The last column and the last row may stick out.
    out.low_mm = {0, (cells[1] - double(size(1)) * across) * cell_y, 0};
    out.high_mm = {size(0) * across * cell_x, cells[1] * cell_y, top_mm};
    out.place_mm = across * cell_x;
    const Gathered gathered(place_of, std::size_t{size(0)} * size(1));
    out.covered = gathered.covered();
    add_looks(looks, gathered, out);
    out.note = across > 1 ? fmt::format("A pixel is {0:.3f} mm wide, the mean of {1} x {1} that were predicted.",
                                        out.place_mm, across)
                          : fmt::format("A pixel is {:.3f} mm wide, as it was predicted.", out.place_mm);
    return out;
}

}  // namespace

io::ViewerSurface viewer_body(const io::ColouredMesh& mesh, const SurfaceLooks& looks, double grain_mm,
                              std::size_t bytes) {
    constexpr double of_shape = 12;
    constexpr std::size_t opens_at_once = 160'000;  // vertices: twice as many triangles, searched at each probe
    return fitting(bytes, std::min(opens_at_once, most_places(bytes, looks, of_shape)),
                   [&](std::size_t most) { return body_of(mesh, looks, grain_mm, most); });
}

io::ViewerSurface viewer_picture(const optics::ResinVolume& volume, const optics::Surface& surface,
                                 const SurfaceLooks& looks, std::size_t bytes) {
    constexpr double of_shape = 0.1;
    return fitting(bytes, most_places(bytes, looks, of_shape),
                   [&](std::size_t most) { return picture_of(volume, surface, looks, most); });
}

namespace {

/// From above, as fine as the page has room for and no finer than the eye.
io::ViewerSurface painted_slab(std::span<const PaintedSurface> surfaces, const Eigen::Vector3d& corner_mm,
                               std::size_t most, const Progress* progress) {
    static constexpr View top_only[] = {View::top};
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Eigen::Vector3d& p : surfaces[0].surface.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
    PreviewOptions options;
    options.margin_px = 0;
    options.colour_per_sample = true;
    const double area_mm2 = std::max(1e-6, (high.x() - low.x()) * (high.y() - low.y()));
    options.px_per_mm = std::min(1 / 0.085, 0.98 * std::sqrt(double(most) / area_mm2));
    io::ViewerSurface out;
    for (const PaintedSurface& painted : surfaces) {
        const io::LinearPicture picture = render_views(painted.surface, top_only, options, progress)[0].picture;
        out.size_px = {picture.width_px, picture.height_px};
        out.looks.push_back({painted.name, painted.caption, {}});
        out.covered.clear();
        for (const Eigen::Vector4f& pixel : picture.pixels) {
            out.covered.push_back(pixel[3] > 0 ? 1 : 0);
            for (Eigen::Index c = 0; c < 3; ++c) out.looks.back().rgb.push_back(io::linear_to_srgb8(pixel[c]));
        }
    }
    // The picture stands in the middle of its pixels.
    const Eigen::Vector2d half = Eigen::Vector2d(out.size_px[0], out.size_px[1]) / options.px_per_mm / 2;
    const Eigen::Vector3d middle = (low + high) / 2 - corner_mm;
    out.low_mm = {middle.x() - half.x(), middle.y() - half.y(), low.z() - corner_mm.z()};
    out.high_mm = {middle.x() + half.x(), middle.y() + half.y(), high.z() - corner_mm.z()};
    out.place_mm = 1 / options.px_per_mm;
    out.note = fmt::format("A pixel is {:.3f} mm wide.", out.place_mm);
    return out;
}

}  // namespace

io::ViewerSurface viewer_painted(std::span<const PaintedSurface> surfaces, const Eigen::Vector3d& corner_mm,
                                 bool from_above, bool differences, std::size_t bytes, const Progress* progress) {
    SurfaceLooks looks;
    for (const PaintedSurface& painted : surfaces) looks.looks.push_back({painted.name, painted.caption, {}});
    if (from_above)
        return fitting(bytes, most_places(bytes, looks, 0.1),
                       [&](std::size_t most) { return painted_slab(surfaces, corner_mm, most, progress); });
    VertexColours first = vertex_colours(surfaces[0].surface, {.edge_mm = 0.25, .max_vertices = 150'000}, progress);
    for (Eigen::Vector3f& p : first.mesh.positions_mm) p -= corner_mm.cast<float>();
    looks.looks[0].rgb = first.mesh.rgb;
    for (std::size_t i = 1; i < surfaces.size(); ++i)
        for (const SurfacePlace& at : first.places)
            looks.looks[i].rgb.push_back(surfaces[i].surface.colour(at.triangle, at.u, at.v));
    if (differences) looks.single = colour_differences(looks.looks[0].rgb, looks.looks[1].rgb);
    return viewer_body(first.mesh, looks, first.longest_edge_mm, bytes);
}

}  // namespace voxtone::slicer
