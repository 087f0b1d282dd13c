// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/drawings/draw_svg.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <cairo.h>
#include <fmt/format.h>
#include <librsvg/rsvg.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/units.h"
#include "io/drawings/svg_facts.h"
#include "io/files/deflate.h"

namespace voxtone::io {

namespace {

/// Of the px that librsvg counts in.
constexpr double css_px_per_inch = 96;

using Handle = std::unique_ptr<RsvgHandle, decltype(&g_object_unref)>;
using Stream = std::unique_ptr<GInputStream, decltype(&g_object_unref)>;
using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Pen = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

[[noreturn]] void refuse(const std::string& name, GError* error) {
    const std::string why = error ? printable(error->message) : std::string("nothing says why");
    g_clear_error(&error);
    throw InputError(
        fmt::format("{} is an SVG drawing that cannot be drawn ({}); open it in the program that made it, or in "
                    "Inkscape, and save it as plain SVG or as PNG",
                    name, why));
}

Handle opened(std::string_view text, const std::string& name) {
    // libxml2 takes no text of more than 10 MB, as pictures in a drawing are, unless its guard against entities that
    // multiply is off, too.
    const bool may_multiply = text.find("<!ENTITY") != std::string_view::npos;
    const Stream stream(g_memory_input_stream_new_from_data(text.data(), static_cast<gssize>(text.size()), nullptr),
                        &g_object_unref);
    GError* error = nullptr;
    Handle handle(
        rsvg_handle_new_from_stream_sync(
            stream.get(), nullptr, may_multiply ? RSVG_HANDLE_FLAGS_NONE : RSVG_HANDLE_FLAG_UNLIMITED, nullptr, &error),
        &g_object_unref);
    if (!handle) refuse(name, error);
    rsvg_handle_set_dpi(handle.get(), css_px_per_inch);
    return handle;
}

/// In px of 1/96 inch, unless the file counts in px of its own.
struct Length {
    double px = 0;
    bool is_physical = false;
};

Length length_of(const RsvgLength& length) {
    switch (length.unit) {
        case RSVG_UNIT_IN:
            return {length.length * css_px_per_inch, true};
        case RSVG_UNIT_CM:
            return {length.length * css_px_per_inch / 2.54, true};
        case RSVG_UNIT_MM:
            return {length.length * css_px_per_inch / mm_per_inch, true};
        case RSVG_UNIT_PT:
            return {length.length * css_px_per_inch / 72, true};
        case RSVG_UNIT_PC:
            return {length.length * css_px_per_inch / 6, true};
        case RSVG_UNIT_PX:
            return {length.length, false};
        default:  // shares and heights of letters of what is not known here
            return {};
    }
}

/// What is drawn, in the file's px.
struct Sheet {
    double left = 0, top = 0, width = 0, height = 0;
    bool is_physical = false;  ///< it says how large it is, and not only in px
};

Sheet sheet_of(RsvgHandle* handle, const std::string& name) {
    gboolean has_width = FALSE, has_height = FALSE, has_box = FALSE;
    RsvgLength width{}, height{};
    RsvgRectangle box{};
    rsvg_handle_get_intrinsic_dimensions(handle, &has_width, &width, &has_height, &height, &has_box, &box);
    if ((has_width && !(width.length > 0)) || (has_height && !(height.length > 0))) return {};  // not to be drawn
    const Length w = has_width ? length_of(width) : Length{}, h = has_height ? length_of(height) : Length{};
    const bool ratio = has_box && box.width > 0 && box.height > 0;
    if (w.px > 0 && h.px > 0) return {0, 0, w.px, h.px, w.is_physical || h.is_physical};
    if (w.px > 0 && ratio) return {0, 0, w.px, w.px * box.height / box.width, w.is_physical};
    if (h.px > 0 && ratio) return {0, 0, h.px * box.width / box.height, h.px, h.is_physical};
    if (ratio) return {0, 0, box.width, box.height, false};
    const RsvgRectangle any{0, 0, 1000, 1000};
    RsvgRectangle ink{};
    GError* error = nullptr;
    if (!rsvg_handle_get_geometry_for_layer(handle, nullptr, &any, &ink, nullptr, &error)) refuse(name, error);
    return {ink.x, ink.y, ink.width, ink.height, false};
}

struct Raster {
    std::uint32_t width_px = 0, height_px = 0;
};

/// Pixels no wider than the print's places, fewer where there would be too many.
Raster raster_of(double width_mm, double height_mm, double pitch_mm, std::uint64_t max_pixels) {
    constexpr double longest_of_cairo = 32767;
    const double pixels = width_mm * height_mm / (pitch_mm * pitch_mm);
    const double fewer = std::min(
        {1.0, std::sqrt(double(max_pixels) / pixels), longest_of_cairo * pitch_mm / std::max(width_mm, height_mm)});
    const auto count = [&](double mm) {
        const double exact = mm * fewer / pitch_mm;
        return static_cast<std::uint32_t>(std::max(1.0, fewer < 1 ? std::floor(exact) : std::ceil(exact - 1e-6)));
    };
    return {count(width_mm), count(height_mm)};
}

/// What cairo leaves in memory (B, G, R times alpha, and alpha) as R, G, B, alpha. Whether all is opaque, and whether
/// something is there.
struct Coverage {
    bool any = false, all = true;
};

Coverage straighten(std::vector<std::uint8_t>& pixels) {
    Coverage coverage;
    for (std::size_t i = 0; i < pixels.size(); i += 4) {
        const std::uint32_t alpha = pixels[i + 3];
        coverage.any = coverage.any || alpha > 0;
        coverage.all = coverage.all && alpha == 255;
        std::swap(pixels[i], pixels[i + 2]);
        if (alpha == 0 || alpha == 255) continue;
        for (std::size_t c = i; c < i + 3; ++c)
            pixels[c] = static_cast<std::uint8_t>(std::min(255u, (pixels[c] * 255u + alpha / 2) / alpha));
    }
    return coverage;
}

std::vector<std::uint8_t> drawn(RsvgHandle* handle, const Sheet& sheet, const Raster& raster, const std::string& name) {
    std::vector<std::uint8_t> pixels(std::size_t{4} * raster.width_px * raster.height_px);
    const auto columns = static_cast<int>(raster.width_px), rows = static_cast<int>(raster.height_px);
    const Surface surface(
        cairo_image_surface_create_for_data(pixels.data(), CAIRO_FORMAT_ARGB32, columns, rows, 4 * columns),
        &cairo_surface_destroy);
    const Pen pen(cairo_create(surface.get()), &cairo_destroy);
    cairo_set_tolerance(pen.get(), 0.01);  // of a pixel: curves are drawn as lines
    cairo_scale(pen.get(), raster.width_px / sheet.width, raster.height_px / sheet.height);
    cairo_translate(pen.get(), -sheet.left, -sheet.top);
    const RsvgRectangle viewport{0, 0, sheet.width, sheet.height};
    GError* error = nullptr;
    if (!rsvg_handle_render_document(handle, pen.get(), &viewport, &error)) refuse(name, error);
    if (const cairo_status_t status = cairo_status(pen.get()); status == CAIRO_STATUS_NO_MEMORY)
        throw std::bad_alloc();
    else if (status != CAIRO_STATUS_SUCCESS)
        throw InputError(fmt::format("{} cannot be drawn: {}", name, cairo_status_to_string(status)));
    cairo_surface_flush(surface.get());
    return pixels;
}

/// "12.3 x 4 mm"
std::string in_mm(double width_mm, double height_mm) { return fmt::format("{:.3g} x {:.3g} mm", width_mm, height_mm); }

}  // namespace

DecodedImage draw_svg(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    const DrawingRaster& wanted = options.drawing;
    VOXTONE_EXPECT(wanted.pitch_mm > 0);
    constexpr std::size_t most_bytes = std::size_t{256} << 20;
    std::vector<std::byte> unpacked;
    if (bytes.size() > 1 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b})
        bytes = unpacked = gunzipped(bytes, most_bytes);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());

    const Handle handle = opened(text, name);
    const Sheet sheet = sheet_of(handle.get(), name);
    const double mm_per_px =
        mm_per_inch / (sheet.is_physical || !(wanted.px_per_inch > 0) ? css_px_per_inch : wanted.px_per_inch);
    const double own_mm = sheet.width * mm_per_px, ratio = sheet.height / sheet.width;
    constexpr double most_ratio = 1e4;
    if (!(ratio * most_ratio >= 1 && ratio <= most_ratio && own_mm > 0 && std::isfinite(own_mm)))
        throw InputError(
            fmt::format("{} is an SVG drawing of {}, on which nothing can be seen; look at its width, "
                        "height and viewBox",
                        name, in_mm(own_mm, sheet.height * mm_per_px)));
    const double width_mm = wanted.width_mm > 0    ? wanted.width_mm
                            : wanted.height_mm > 0 ? wanted.height_mm / ratio
                            : wanted.size_mm > 0   ? wanted.size_mm / std::max(1.0, ratio)
                                                   : own_mm;
    const Raster raster = raster_of(width_mm, width_mm * ratio, wanted.pitch_mm, options.max_pixels);

    DecodedImage image;
    image.texels.width_px = raster.width_px;
    image.texels.height_px = raster.height_px;
    image.is_drawing = true;
    image.dpi_x = raster.width_px / own_mm * mm_per_inch;
    image.pixel_aspect = ratio * raster.width_px / raster.height_px;
    image.dpi_y = image.dpi_x / image.pixel_aspect;
    image.texels.srgb8 = drawn(handle.get(), sheet, raster, name);
    const Coverage coverage = straighten(image.texels.srgb8);
    if (!coverage.any)
        throw InputError(fmt::format(
            "{} is an SVG drawing of {} on which nothing is drawn: what it holds lies beside its viewBox, is hidden, "
            "or "
            "in a file of its own; open it in Inkscape, fit the page to what is drawn, and save it as plain SVG",
            name, in_mm(own_mm, own_mm * ratio)));
    image.has_alpha = !coverage.all;
    add_svg_facts(text, name, image);
    return image;
}

}  // namespace voxtone::io
