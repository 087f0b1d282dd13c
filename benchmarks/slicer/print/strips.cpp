// SPDX-License-Identifier: GPL-3.0-or-later
#include "strips.h"

#include <algorithm>

#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "scores.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::loop_benchmark {
namespace {

constexpr std::uint32_t panel_px = 480, gap_px = 8;
constexpr std::size_t enlarged = 6;

/// Cells of a slab that a panel shows.
struct View {
    std::size_t x = 0, y = 0, width = 0, height = 0, zoom = 1;
};

/// The window of a sixth of the slab's width and height over which the target changes most from cell to cell.
View busiest(const Judgement& j, std::size_t zoom) {
    const std::size_t w = std::max<std::size_t>(1, j.columns / enlarged),
                      h = std::max<std::size_t>(1, j.rows / enlarged);
    std::vector<double> sum((j.columns + 1) * (j.rows + 1), 0);
    const auto grey = [&](std::size_t x, std::size_t y) {
        return std::cbrt(std::max(0.0, static_cast<double>(j.target[y * j.columns + x].sum())));
    };
    for (std::size_t y = 0; y < j.rows; ++y)
        for (std::size_t x = 0; x < j.columns; ++x) {
            double step = 0;
            if (x + 1 < j.columns) step += std::abs(grey(x + 1, y) - grey(x, y));
            if (y + 1 < j.rows) step += std::abs(grey(x, y + 1) - grey(x, y));
            sum[(y + 1) * (j.columns + 1) + x + 1] = step + sum[y * (j.columns + 1) + x + 1] +
                                                     sum[(y + 1) * (j.columns + 1) + x] - sum[y * (j.columns + 1) + x];
        }
    View best{0, 0, w, h, zoom * enlarged};
    double most = -1;
    for (std::size_t y = 0; y + h <= j.rows; ++y)
        for (std::size_t x = 0; x + w <= j.columns; ++x) {
            const std::size_t c = j.columns + 1;
            const double here = sum[(y + h) * c + x + w] - sum[y * c + x + w] - sum[(y + h) * c + x] + sum[y * c + x];
            if (here > most) most = here, best.x = x, best.y = y;
        }
    return best;
}

void draw(io::LinearPicture& picture, std::size_t left, std::size_t top, const Judgement& j, const Colours& colours,
          const View& view) {
    for (std::size_t y = 0; y < view.height * view.zoom; ++y)
        for (std::size_t x = 0; x < view.width * view.zoom; ++x) {
            const std::size_t row = view.y + view.height - 1 - y / view.zoom, column = view.x + x / view.zoom;
            const Eigen::Vector3f c = colours[row * j.columns + column].cwiseMax(0.0F).cwiseMin(1.0F);
            picture.pixels[(top + y) * picture.width_px + left + x] = {c[0], c[1], c[2], 1.0F};
        }
}

}  // namespace

void write_strip(const std::filesystem::path& file, const std::vector<const Judgement*>& prints) {
    const Judgement& first = *prints.front();
    const std::size_t zoom = std::max<std::size_t>(1, panel_px / first.columns);
    const View whole{0, 0, first.columns, first.rows, zoom}, part = busiest(first, zoom);
    const std::size_t panel_w = std::max(whole.width * whole.zoom, part.width * part.zoom) + gap_px,
                      whole_h = whole.height * whole.zoom + gap_px, part_h = part.height * part.zoom + gap_px;
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>((prints.size() + 1) * panel_w - gap_px);
    picture.height_px = static_cast<std::uint32_t>(2 * whole_h + part_h - gap_px);
    picture.pixels.assign(std::size_t{picture.width_px} * picture.height_px, Eigen::Vector4f::Zero());
    draw(picture, 0, 0, first, first.target, whole);
    draw(picture, 0, 2 * whole_h, first, first.target, part);
    Colours inside(first.target.size(), Eigen::Vector3f::Ones());
    for (std::size_t i = 0; i < inside.size(); ++i)
        if (!first.in_gamut[i]) inside[i] = {0.35F, 0.35F, 0.5F};
    draw(picture, 0, whole_h, first, inside, whole);
    for (std::size_t p = 0; p < prints.size(); ++p) {
        const Judgement& j = *prints[p];
        const Colours print = j.print();
        Colours map;
        for (const double d : differences(j.target, print)) map.push_back(slicer::difference_colour(d));
        const std::size_t left = (p + 1) * panel_w;
        draw(picture, left, 0, j, print, whole);
        draw(picture, left, whole_h, j, map, whole);
        draw(picture, left, 2 * whole_h, j, print, part);
    }
    io::write_whole_file(file, io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Constant(0.6F))));
}

}  // namespace voxtone::loop_benchmark
