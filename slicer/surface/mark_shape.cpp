// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/mark_shape.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/lettering/font_file.h"
#include "io/lettering/make_code.h"
#include "io/lettering/set_text.h"
#include "io/pictures/picture.h"

namespace voxtone::slicer {

namespace {

constexpr int pixels_a_module = 8;
constexpr char gs1_separator = '\x1d';
/// Of a ground, around the ink, in ems.
constexpr double ground_margin = 0.25;

io::CodeKind code_kind(MarkKind kind) {
    switch (kind) {
        case MarkKind::qr:
            return io::CodeKind::qr;
        case MarkKind::gs1_data_matrix:
            return io::CodeKind::gs1_data_matrix;
        case MarkKind::gs1_qr:
            return io::CodeKind::gs1_qr;
        case MarkKind::gs1_128:
            return io::CodeKind::gs1_128;
        default:
            return io::CodeKind::data_matrix;
    }
}

io::Coverage ink_of_code(const MarkOptions& mark) {
    const io::CodeSymbol code = io::make_code(code_kind(mark.kind), mark.text);
    // A Data Matrix may be a rectangle: its modules are as large as those of a square of as many.
    const double edge_modules = code.is_bars ? code.columns : std::sqrt(double(code.columns) * code.rows);
    io::Coverage ink{(code.columns + 2 * code.quiet_columns) * pixels_a_module,
                     (code.rows + 2 * code.quiet_rows) * pixels_a_module,
                     mark.size_mm / (edge_modules * pixels_a_module),
                     {}};
    const auto is_dark = [&](int column, int row) {
        return column >= 0 && row >= 0 && column < code.columns && row < code.rows &&
               code.dark[std::size_t(row * code.columns + column)];
    };
    for (int y = 0; y < ink.height_px; ++y)
        for (int x = 0; x < ink.width_px; ++x)
            ink.ink.push_back(
                is_dark(x / pixels_a_module - code.quiet_columns, y / pixels_a_module - code.quiet_rows) ? 255 : 0);
    return ink;
}

io::Coverage padded(const io::Coverage& ink, int pixels) {
    io::Coverage wide{ink.width_px + 2 * pixels, ink.height_px + 2 * pixels, ink.pixel_mm, {}};
    wide.ink.resize(std::size_t(wide.width_px) * std::size_t(wide.height_px));
    for (int y = 0; y < ink.height_px; ++y)
        std::copy_n(ink.ink.begin() + std::ptrdiff_t(y) * ink.width_px, ink.width_px,
                    wide.ink.begin() + std::ptrdiff_t(y + pixels) * wide.width_px + pixels);
    return wide;
}

io::Coverage ink_of_text(const MarkOptions& mark) {
    io::Coverage ink = io::set_text(mark.text, io::find_font(mark.font), mark.size_mm);
    if (mark.ground_rgb) ink = padded(ink, int(std::lround(ground_margin * mark.size_mm / ink.pixel_mm)));
    return ink;
}

/// Of one that lies where texture coordinates say, only the texture knows how large that is.
io::DrawingRaster raster_of(const MarkOptions& mark, double pitch_mm) {
    constexpr double pixels_by_uv = 2048;
    if (std::holds_alternative<UvRectangle>(mark.place)) return {.pitch_mm = 1 / pixels_by_uv, .size_mm = 1};
    return {.pitch_mm = pitch_mm, .width_mm = mark.size_mm};
}

MarkShape shape_of_picture(const MarkOptions& mark, io::ReadOptions reading, double pitch_mm) {
    reading.drawing = raster_of(mark, pitch_mm);
    io::DecodedImage image = io::read_picture_with_alpha(mark.file, reading);
    io::show_if_invisible(image, std::filesystem::path(mark.file).filename().string());
    MarkShape shape;
    for (const std::string& warning : image.warnings) shape.warnings.push_back(mark.said + ": " + warning);
    if (!image.lost_colour.empty())
        shape.warnings.push_back(mark.said + ": " + named_warning("lost-colour", image.lost_colour));
    shape.pixels = std::make_shared<const io::AlphaPicture>(image.texels);
    shape.width_mm = mark.size_mm > 0 ? mark.size_mm : 1;
    shape.height_mm = shape.width_mm * image.texels.height_px / image.texels.width_px * image.pixel_aspect;
    shape.ink = {int(image.texels.width_px), int(image.texels.height_px), shape.width_mm / image.texels.width_px, {}};
    for (std::size_t i = 0; i < image.texels.pixels(); ++i)
        shape.ink.ink.push_back(std::uint8_t(std::lround(255 * image.texels.alpha(i))));
    return shape;
}

}  // namespace

MarkShape shape_of(const MarkOptions& mark, const io::ReadOptions& reading, double pitch_mm) {
    try {
        if (mark.kind == MarkKind::picture) return shape_of_picture(mark, reading, pitch_mm);
        MarkShape shape;
        shape.ink = mark.kind == MarkKind::text ? ink_of_text(mark) : ink_of_code(mark);
        shape.width_mm = shape.ink.width_mm();
        shape.height_mm = shape.ink.height_mm();
        if (is_code(mark.kind)) shape.module_mm = shape.ink.pixel_mm * pixels_a_module;
        if (is_code(mark.kind) && !is_gs1(mark.kind) && mark.text.find(gs1_separator) != std::string::npos)
            shape.notes.push_back(
                fmt::format("{}: holds the separator of GS1, and is none of its codes, for no FNC1 stands in front: "
                            "gs1=(01)... or gs1-qr=(01)... makes one",
                            mark.said));
        return shape;
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", mark.said, error.what()));
    } catch (const FileError& error) {
        throw FileError(fmt::format("{}: {}", mark.said, error.what()));
    }
}

std::shared_ptr<const io::AlphaPicture> coloured(const MarkShape& shape, const Eigen::Vector3f* ink_rgb,
                                                 const std::optional<Eigen::Vector3f>& ground_rgb) {
    std::vector<io::AlphaPicture::Pixel> pixels(shape.ink.ink.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        Eigen::Vector4f over = Eigen::Vector4f::Zero();
        if (shape.pixels) {
            const io::AlphaPicture::Pixel& p = shape.pixels->pixels()[i];
            over = Eigen::Vector4f(p[0], p[1], p[2], p[3]) / 65535.0f;
        } else if (ink_rgb) {
            const float ink = shape.ink.ink[i] / 255.0f;
            over << ink * *ink_rgb, ink;
        }
        if (ground_rgb) over += (1 - over[3]) * (Eigen::Vector4f() << *ground_rgb, 1).finished();
        for (std::size_t c = 0; c < 4; ++c)
            pixels[i][c] = std::uint16_t(std::lround(std::clamp(over[Eigen::Index(c)], 0.0f, 1.0f) * 65535));
    }
    return std::make_shared<const io::AlphaPicture>(std::uint32_t(shape.ink.width_px),
                                                    std::uint32_t(shape.ink.height_px), std::move(pixels));
}

}  // namespace voxtone::slicer
