// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/slab_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "io/pictures/texture.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

SlabCells::SlabCells(const optics::Surface& surface) {
    Frame ends{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), std::numeric_limits<int>::min(),
               std::numeric_limits<int>::min()};
    const auto looks_up = [](const optics::SurfaceCell& cell) { return cell.normal[2] > 0.5f; };
    for (const optics::SurfaceCell& cell : surface.cells)
        if (looks_up(cell))
            ends = {std::min(ends[0], cell.cell[0]), std::min(ends[1], cell.cell[1]), std::max(ends[2], cell.cell[0]),
                    std::max(ends[3], cell.cell[1])};
    if (ends[2] < ends[0]) return;
    columns_ = ends[2] - ends[0] + 1, rows_ = ends[3] - ends[1] + 1, first_ = {ends[0], ends[1]};
    at_.assign(std::size_t(columns_) * std::size_t(rows_), -1);
    for (std::size_t i = 0; i < surface.cells.size(); ++i)
        if (const auto& [x, y, z] = surface.cells[i].cell; looks_up(surface.cells[i]))
            at_[std::size_t(ends[3] - y) * std::size_t(columns_) + std::size_t(x - ends[0])] = std::int64_t(i);
}

Eigen::Vector3f SlabCells::colour_at(std::span<const Eigen::Vector3f> rgb, double x, double y) const {
    const double column = x * columns_ - 0.5, row = (1 - y) * rows_ - 0.5, left = std::floor(column),
                 top = std::floor(row);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float all = 0;
    for (int n = 0; n < 4; ++n) {
        const int c = std::clamp(int(left) + n % 2, 0, columns_ - 1), r = std::clamp(int(top) + n / 2, 0, rows_ - 1);
        const std::int64_t i = at(c, r);
        if (i < 0) continue;
        const auto part = float((n % 2 ? column - left : 1 - column + left) * (n / 2 ? row - top : 1 - row + top));
        sum += part * rgb[std::size_t(i)], all += part;
    }
    return all > 0 ? Eigen::Vector3f(sum / all) : Eigen::Vector3f::Ones();
}

io::LuminanceRaster SlabCells::raster(std::span<const Eigen::Vector3f> rgb, const Frame& box) const {
    io::LuminanceRaster picture{box[2] - box[0], box[3] - box[1], {}};
    for (int row = box[1]; row < box[3]; ++row)
        for (int column = box[0]; column < box[2]; ++column) {
            const std::int64_t i = at(column, row);
            picture.grey.push_back(i < 0 ? std::uint8_t{255} : grey_of(rgb[std::size_t(i)]));
        }
    return picture;
}

std::uint8_t grey_of(const Eigen::Vector3f& rgb) {
    const auto light = double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb));
    return std::uint8_t(std::lround(255 * optics::srgb_encode(std::clamp(light, 0.0, 1.0))));
}

const io::Texture* upright_picture(const io::TexturedMesh* mesh) {
    if (!mesh || mesh->triangles.empty() || mesh->corner_uv.empty()) return nullptr;
    const auto& texture = mesh->materials[mesh->material_of_triangle[0]].texture;
    for (int a = 0; a < 3; ++a) {
        const auto corner = [&](int c) { return mesh->positions[mesh->triangles[0][std::size_t((a + c) % 3)]]; };
        const Eigen::Vector2f uv = mesh->corner_uv[0][std::size_t((a + 1) % 3)] - mesh->corner_uv[0][std::size_t(a)];
        const Eigen::Vector3d way = corner(1) - corner(0);
        if (double(uv.x()) * way.x() < 0 || double(uv.y()) * way.y() < 0) return nullptr;
        if ((uv.x() == 0) != (way.x() == 0) || (uv.y() == 0) != (way.y() == 0)) return nullptr;
    }
    return texture.get();
}

namespace {

/// Whether one of the four cells around a place is none.
bool is_beside(const SlabCells& slab, double u, double v) {
    const double half[2] = {0.5 / slab.all()[2], 0.5 / slab.all()[3]};
    for (int n = 0; n < 4; ++n)
        if (slab.at(Eigen::Vector2d(u + (n % 2 ? half[0] : -half[0]), v + (n / 2 ? half[1] : -half[1]))) < 0)
            return true;
    return false;
}

/// `part`: of the picture's pixels, each way.
PicturePage page_of(const JobPrediction& p, const SlabCells& slab, const io::Texture& picture, double part) {
    const int columns = std::max(1, int(part * picture.width_px())),
              rows = std::max(1, int(part * picture.height_px()));
    const std::array<double, 2> print_mm{slab.all()[2] * p.cell_um[0] / 1e3, slab.all()[3] * p.cell_um[1] / 1e3};
    PicturePage made;
    made.times = columns * std::sqrt(p.cell_um[0] * p.cell_um[1]) / 1e3 / print_mm[0];
    const std::array<double, 2> cell_mm{made.times * print_mm[0] / columns, made.times * print_mm[1] / rows};
    JobPrediction& page = made.page;
    page.cell_um = {1e3 * cell_mm[0], 1e3 * cell_mm[1], p.cell_um[2]};
    page.predicted.surface.cell_voxels = {1, 1, 1};
    page.predicted.surface.cells.resize(std::size_t(columns) * std::size_t(rows));
    page.target.resize(page.predicted.surface.cells.size()),
        page.predicted.rgb.assign(page.target.size(), Eigen::Vector3f::Zero());
    const int samples = std::max(1, int(std::ceil(1 / made.times)));
    const auto level = float(-std::log2(part));
    parallel_for(0, std::size_t(rows), 8, [&](std::size_t y) {
        const double v = (double(y) + 0.5) / rows;
        for (int x = 0; x < columns; ++x) {
            const double u = (x + 0.5) / columns;
            const std::size_t i = y * std::size_t(columns) + std::size_t(x);
            optics::SurfaceCell& cell = page.predicted.surface.cells[i];
            cell.cell = {x, int(y), 0};
            cell.centre_mm = {float(u * columns * cell_mm[0]), float(v * rows * cell_mm[1]), 0};
            cell.normal = {0, 0, 1}, cell.area_mm2 = float(cell_mm[0] * cell_mm[1]);
            page.target[i] = picture.sample(float(u), float(v), level);
            for (int n = 0; n < samples * samples; ++n)
                page.predicted.rgb[i] +=
                    slab.colour_at(p.predicted.rgb, u + ((n % samples + 0.5) / samples - 0.5) / columns,
                                   v + ((n / samples + 0.5) / samples - 0.5) / rows) /
                    float(samples * samples);
            // Beside what is cut to shape nothing was asked for.
            if (is_beside(slab, u, v)) page.target[i] = page.predicted.rgb[i];
        }
    });
    page.seen.regions = halftone::colour_regions(page.predicted.surface, page.target);
    return made;
}

}  // namespace

std::vector<PicturePage> picture_pages(const JobPrediction& print, const io::TexturedMesh* picture) {
    constexpr double most_pixels = 1e6, least_pixels = 2e3, probe_pixels = 2.5e5, finer = 1.2;
    std::vector<PicturePage> pages;
    const io::Texture* const given = upright_picture(picture);
    const SlabCells slab(print.predicted.surface);
    if (!given || slab.all()[2] == 0) return pages;
    const double all = double(given->width_px()) * given->height_px();
    const auto part_of = [&](double pixels) { return std::sqrt(std::min(1.0, pixels / all)); };
    if (part_of(most_pixels) * given->width_px() < finer * slab.all()[2]) return pages;  // the target has all of it
    if (!is_graphics(page_of(print, slab, *given, part_of(probe_pixels)).page)) return pages;
    for (double part = part_of(most_pixels); part * part * all >= least_pixels; part *= std::sqrt(0.5))
        pages.push_back(page_of(print, slab, *given, part));
    return pages;
}

bool is_graphics(const JobPrediction& p) {
    constexpr double of_graphics = 0.3;
    double flat = 0, all = 0;
    for (const halftone::ColourRegion& of : p.seen.regions) flat += of.area_mm2;
    for (const optics::SurfaceCell& cell : p.predicted.surface.cells) all += double(cell.area_mm2);
    return flat >= of_graphics * all;
}

}  // namespace voxtone::slicer
