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
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

using Frame = std::array<int, 4>;  // left, top, right, bottom, cells; the last ones are not in it

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
                const double light =
                    i < 0 ? 1.0 : double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb[std::size_t(i)]));
                picture.grey.push_back(
                    std::uint8_t(std::lround(255 * optics::srgb_encode(std::clamp(light, 0.0, 1.0)))));
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

bool is_in(const io::LuminanceRaster& picture, const io::CodeInPicture& code) {
    return std::ranges::any_of(io::codes_in_picture(picture), [&](const io::CodeInPicture& found) {
        return found.kind == code.kind && found.content == code.content;
    });
}

}  // namespace

std::vector<PrintedCode> printed_codes(const JobPrediction& p) {
    const optics::Surface& surface = p.predicted.surface;
    const SlabCells slab(surface);
    std::vector<PrintedCode> codes;
    constexpr int sharp = 3;  // what was asked for needs no more patience, and most pages hold no code
    try {
        for (const io::CodeInPicture& asked : io::codes_in_picture(slab.raster(p.target, slab.all()), sharp)) {
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
