// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/printed_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "base/error.h"
#include "io/pictures/codes_in_picture.h"
#include "io/pictures/texture.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

using Frame = std::array<int, 4>;  // left, top, right, bottom, cells; the last ones are not in it

std::uint8_t grey_of(const Eigen::Vector3f& rgb) {
    const auto light = double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb));
    return std::uint8_t(std::lround(255 * optics::srgb_encode(std::clamp(light, 0.0, 1.0))));
}

/// Which cell lies at each place of the slab's upper side, rows from the top; -1: none.
class SlabCells {
public:
    explicit SlabCells(const optics::Surface& surface) {
        std::array<int, 4> ends{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(),
                                std::numeric_limits<int>::min(), std::numeric_limits<int>::min()};
        const auto looks_up = [](const optics::SurfaceCell& cell) { return cell.normal[2] > 0.5f; };
        for (const optics::SurfaceCell& cell : surface.cells)
            if (looks_up(cell))
                ends = {std::min(ends[0], cell.cell[0]), std::min(ends[1], cell.cell[1]),
                        std::max(ends[2], cell.cell[0]), std::max(ends[3], cell.cell[1])};
        if (ends[2] < ends[0]) return;
        columns_ = ends[2] - ends[0] + 1, rows_ = ends[3] - ends[1] + 1;
        at_.assign(std::size_t(columns_) * std::size_t(rows_), -1);
        for (std::size_t i = 0; i < surface.cells.size(); ++i)
            if (const auto& [x, y, z] = surface.cells[i].cell; looks_up(surface.cells[i]))
                at_[std::size_t(ends[3] - y) * std::size_t(columns_) + std::size_t(x - ends[0])] = std::int64_t(i);
    }
    [[nodiscard]] Frame all() const { return {0, 0, columns_, rows_}; }
    [[nodiscard]] std::int64_t at(int column, int row) const {
        return at_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
    }
    [[nodiscard]] io::LuminanceRaster raster(std::span<const Eigen::Vector3f> rgb, const Frame& box) const {
        io::LuminanceRaster picture{box[2] - box[0], box[3] - box[1], {}};
        for (int row = box[1]; row < box[3]; ++row)
            for (int column = box[0]; column < box[2]; ++column) {
                const std::int64_t i = at(column, row);
                picture.grey.push_back(i < 0 ? std::uint8_t{255} : grey_of(rgb[std::size_t(i)]));
            }
        return picture;
    }
    [[nodiscard]] Frame around(const std::array<double, 4>& code) const {
        const double more = std::max(code[2] - code[0], code[3] - code[1]) / 6;
        return {std::clamp(int(code[0] - more), 0, columns_), std::clamp(int(code[1] - more), 0, rows_),
                std::clamp(int(code[2] + more) + 1, 0, columns_), std::clamp(int(code[3] + more) + 1, 0, rows_)};
    }

private:
    int columns_ = 0, rows_ = 0;
    std::vector<std::int64_t> at_;
};

/// The picture of a slab, which covers it upright: u along x, v along y.
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

/// In pixels of the picture, or as many as are read, and where they lie in cells.
std::vector<io::CodeInPicture> codes_of_picture(const io::Texture& texture, const Frame& cells) {
    constexpr double most_pixels = 4e6;
    const double all = double(texture.width_px()) * texture.height_px(),
                 part = std::sqrt(std::min(1.0, most_pixels / all));
    io::LuminanceRaster raster{
        std::max(1, int(part * texture.width_px())), std::max(1, int(part * texture.height_px())), {}};
    if (raster.columns <= cells[2] && raster.rows <= cells[3]) return {};  // the target has all of it
    for (int row = 0; row < raster.rows; ++row)
        for (int column = 0; column < raster.columns; ++column)
            raster.grey.push_back(
                grey_of(texture.sample((float(column) + 0.5f) / float(raster.columns),
                                       1 - (float(row) + 0.5f) / float(raster.rows), float(-std::log2(part)))));
    std::vector<io::CodeInPicture> codes = io::codes_in_picture(raster, 1);
    for (io::CodeInPicture& code : codes)
        for (std::size_t n = 0; n < 4; ++n)
            code.box[n] *= n % 2 ? double(cells[3]) / raster.rows : double(cells[2]) / raster.columns;
    return codes;
}

bool is_in(const io::LuminanceRaster& picture, const io::CodeInPicture& code) {
    return std::ranges::any_of(io::codes_in_picture(picture), [&](const io::CodeInPicture& found) {
        return found.kind == code.kind && found.content == code.content;
    });
}

}  // namespace

std::vector<PrintedCode> printed_codes(const JobPrediction& p, const io::TexturedMesh* picture) {
    const optics::Surface& surface = p.predicted.surface;
    const SlabCells slab(surface);
    std::vector<PrintedCode> codes;
    constexpr int sharp = 3;  // what was asked for needs no more patience, and most pages hold no code
    try {
        std::vector<io::CodeInPicture> all = io::codes_in_picture(slab.raster(p.target, slab.all()), sharp);
        if (const io::Texture* const given = upright_picture(picture))
            for (io::CodeInPicture& code : codes_of_picture(*given, slab.all()))
                if (std::ranges::none_of(all, [&](const io::CodeInPicture& other) {
                        return other.kind == code.kind && other.content == code.content;
                    }))
                    all.push_back(std::move(code));
        for (const io::CodeInPicture& asked : all) {
            PrintedCode& code = codes.emplace_back(PrintedCode{asked.kind, {}, 0, 0, false});
            code.width_mm = (asked.box[2] - asked.box[0]) * p.cell_um[0] / 1000;
            code.height_mm = (asked.box[3] - asked.box[1]) * p.cell_um[1] / 1000;
            const Frame frame = slab.around(asked.box);
            for (int row = int(asked.box[1]); row < std::min(slab.all()[3], int(asked.box[3]) + 1); ++row)
                for (int column = int(asked.box[0]); column < std::min(slab.all()[2], int(asked.box[2]) + 1); ++column)
                    if (row >= 0 && column >= 0 && slab.at(column, row) >= 0)
                        code.cells.push_back(std::uint32_t(slab.at(column, row)));
            code.is_read = is_in(slab.raster(p.predicted.rgb, frame), asked);
        }
    } catch (const Cancelled&) {
        throw;
    } catch (const Error&) {
        codes.clear();
    }
    std::erase_if(codes, [](const PrintedCode& code) { return code.cells.empty(); });
    return codes;
}

}  // namespace voxtone::slicer
