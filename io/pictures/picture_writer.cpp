// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/picture_writer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <png.h>

#include "base/contracts.h"
#include "base/parallel.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

constexpr std::size_t rows_per_task = 32;

/// Calls encode(pixel, code) for every pixel.
template <class Encode>
Picture8 encode_pixels(const LinearPicture& picture, std::uint32_t channels, Encode encode) {
    VOXTONE_EXPECT(picture.pixels.size() == std::size_t{picture.width_px} * picture.height_px);
    Picture8 result{picture.width_px, picture.height_px, channels, {}};
    result.codes.resize(picture.pixels.size() * channels);
    parallel_ranges(0, picture.pixels.size(), rows_per_task * picture.width_px,
                    [&](std::size_t first, std::size_t last) {
                        for (std::size_t i = first; i < last; ++i)
                            encode(picture.pixels[i], &result.codes[i * channels]);
                    });
    return result;
}

/// libpng's errors become exceptions of ours: every fault here is a bug, the sizes having been checked.
[[noreturn]] void on_png_error(png_structp, png_const_charp message) { throw std::logic_error(message); }
void on_png_warning(png_structp, png_const_charp) {}

void append(png_structp png, png_bytep data, png_size_t size) {
    auto& bytes = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
    bytes.insert(bytes.end(), data, data + size);
}

/// Owns libpng's two structures.
struct PngWriter {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_png_error, on_png_warning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    PngWriter() = default;
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

}  // namespace

Picture8 encode_over(const LinearPicture& picture, const Eigen::Vector3f& background) {
    return encode_pixels(picture, 3, [&](const Eigen::Vector4f& pixel, std::uint8_t* code) {
        const float coverage = std::clamp(pixel[3], 0.0f, 1.0f);
        for (int c = 0; c < 3; ++c) code[c] = linear_to_srgb8(coverage * pixel[c] + (1 - coverage) * background[c]);
    });
}

Picture8 encode_transparent(const LinearPicture& picture) {
    return encode_pixels(picture, 4, [](const Eigen::Vector4f& pixel, std::uint8_t* code) {
        code[3] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(pixel[3], 0.0f, 1.0f)));
        for (int c = 0; c < 3; ++c) code[c] = code[3] ? linear_to_srgb8(pixel[c]) : std::uint8_t{0};
    });
}

std::vector<std::uint8_t> png_bytes(const Picture8& picture, std::array<double, 2> px_per_mm,
                                    const std::string& comment) {
    VOXTONE_EXPECT(picture.channels == 3 || picture.channels == 4);
    VOXTONE_EXPECT(picture.width_px >= 1 && picture.height_px >= 1);
    const std::size_t row_bytes = std::size_t{picture.width_px} * picture.channels;
    VOXTONE_EXPECT(picture.codes.size() == row_bytes * picture.height_px);
    std::vector<std::uint8_t> bytes;
    const PngWriter writer;
    VOXTONE_ENSURE(writer.png && writer.info);
    png_set_write_fn(writer.png, &bytes, append, nullptr);
    png_set_IHDR(writer.png, writer.info, picture.width_px, picture.height_px, 8,
                 picture.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_RELATIVE);
    if (px_per_mm[0] > 0 && px_per_mm[1] > 0)
        png_set_pHYs(writer.png, writer.info, static_cast<png_uint_32>(std::lround(1000 * px_per_mm[0])),
                     static_cast<png_uint_32>(std::lround(1000 * px_per_mm[1])), PNG_RESOLUTION_METER);
    std::string key = "Comment", text = comment;
    png_text note{};
    note.compression = PNG_TEXT_COMPRESSION_NONE;
    note.key = key.data();
    note.text = text.data();
    note.text_length = text.size();
    if (!comment.empty()) png_set_text(writer.png, writer.info, &note, 1);
    png_write_info(writer.png, writer.info);
    for (std::uint32_t y = 0; y < picture.height_px; ++y)
        png_write_row(writer.png, picture.codes.data() + y * row_bytes);
    png_write_end(writer.png, nullptr);
    return bytes;
}

namespace {

/// `wide`: of 16 bits, else of 8.
std::vector<std::uint8_t> grey_png_bytes(std::uint32_t width_px, std::uint32_t height_px,
                                         std::span<const std::uint16_t> numbers, bool wide) {
    std::vector<std::uint8_t> bytes, row;
    const PngWriter writer;
    VOXTONE_ENSURE(writer.png && writer.info);
    png_set_write_fn(writer.png, &bytes, append, nullptr);
    png_set_IHDR(writer.png, writer.info, width_px, height_px, wide ? 16 : 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(writer.png, writer.info);
    for (std::uint32_t y = 0; y < height_px; ++y) {
        row.clear();
        for (const std::uint16_t number : numbers.subspan(std::size_t{y} * width_px, width_px)) {
            if (wide) row.push_back(static_cast<std::uint8_t>(number >> 8));
            row.push_back(static_cast<std::uint8_t>(number & 0xff));
        }
        png_write_row(writer.png, row.data());
    }
    png_write_end(writer.png, nullptr);
    return bytes;
}

}  // namespace

std::vector<std::uint8_t> number_png_bytes(std::uint32_t width_px, std::uint32_t height_px,
                                           std::span<const std::uint16_t> numbers) {
    VOXTONE_EXPECT(width_px >= 1 && height_px >= 1 && numbers.size() == std::size_t{width_px} * height_px);
    return grey_png_bytes(width_px, height_px, numbers, *std::max_element(numbers.begin(), numbers.end()) > 255);
}

std::vector<std::uint8_t> grey16_png_bytes(std::uint32_t width_px, std::uint32_t height_px,
                                           std::span<const std::uint16_t> numbers) {
    VOXTONE_EXPECT(width_px >= 1 && height_px >= 1 && numbers.size() == std::size_t{width_px} * height_px);
    return grey_png_bytes(width_px, height_px, numbers, true);
}

}  // namespace voxtone::io
