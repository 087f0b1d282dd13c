// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/printed_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/error.h"
#include "io/lettering/make_code.h"
#include "io/pictures/codes_in_picture.h"
#include "io/pictures/texture.h"
#include "slicer/colour/slab_picture.h"

namespace voxtone::slicer {

namespace {

using Frame = SlabCells::Frame;

Frame around(const Frame& all, const std::array<double, 4>& code) {
    const double more = std::max(code[2] - code[0], code[3] - code[1]) / 6;
    return {std::clamp(int(code[0] - more), 0, all[2]), std::clamp(int(code[1] - more), 0, all[3]),
            std::clamp(int(code[2] + more) + 1, 0, all[2]), std::clamp(int(code[3] + more) + 1, 0, all[3])};
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
    for (io::CodeInPicture& code : codes) {
        for (std::size_t n = 0; n < 4; ++n)
            code.box[n] *= n % 2 ? double(cells[3]) / raster.rows : double(cells[2]) / raster.columns;
        code.module *= double(cells[2]) / raster.columns;
    }
    return codes;
}

bool is_in(const io::LuminanceRaster& picture, const io::CodeInPicture& code) {
    return std::ranges::any_of(io::codes_in_picture(picture), [&](const io::CodeInPicture& found) {
        return found.kind == code.kind && found.content == code.content;
    });
}

double module_of(const io::CodeInPicture& code, const PrintedCode& of) {
    const bool is_qr = code.kind == "QR code";
    if (!is_qr && code.kind != "Data Matrix") return 0;
    try {
        const io::CodeSymbol symbol = io::make_code(is_qr ? io::CodeKind::qr : io::CodeKind::data_matrix, code.content);
        return std::sqrt(of.width_mm * of.height_mm / (double(symbol.columns) * symbol.rows));
    } catch (const InputError&) {
        return 0;  // bytes that are no text
    }
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
            PrintedCode& code = codes.emplace_back(PrintedCode{asked.kind, {}, 0, 0, 0, false});
            code.width_mm = (asked.box[2] - asked.box[0]) * p.cell_um[0] / 1000;
            code.height_mm = (asked.box[3] - asked.box[1]) * p.cell_um[1] / 1000;
            code.module_mm = asked.module > 0 ? asked.module * p.cell_um[0] / 1000 : module_of(asked, code);
            const Frame frame = around(slab.all(), asked.box);
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
