// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/png_pixels.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <exception>
#include <memory>
#include <string_view>

#include <fmt/core.h>
#include <png.h>

#include "base/error.h"

namespace voxtone::io {
namespace {

struct Source {
    std::span<const std::uint8_t> file;
    std::size_t at = 0;
    char fault[200] = "";
};

void on_error(png_structp png, png_const_charp message) {
    auto* const source = static_cast<Source*>(png_get_error_ptr(png));
    std::strncpy(source->fault, message, sizeof source->fault - 1);
    png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, png_size_t count) {
    auto* const source = static_cast<Source*>(png_get_io_ptr(png));
    if (count > source->file.size() - source->at) png_error(png, "the file ends too early");
    std::memcpy(out, source->file.data() + source->at, count);
    source->at += count;
}

/// Owns libpng's structures. libpng reports faults by longjmp, so the functions that call it hold nothing that would
/// have to be destroyed: they give false, and `source.fault` says why.
class PngDecoder {
public:
    explicit PngDecoder(Source& source)
        : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_error, on_warning)) {
        if (png_) info_ = png_create_info_struct(png_);
    }
    PngDecoder(const PngDecoder&) = delete;
    PngDecoder& operator=(const PngDecoder&) = delete;
    ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }

    bool read_header(Source& source, PngHeader& header) {
        if (!png_ || !info_ || setjmp(png_jmpbuf(png_))) return false;
        png_set_read_fn(png_, &source, on_read);
        png_set_user_limits(png_, 65535, 65535);
        png_set_chunk_malloc_max(png_, 1 << 20);
        png_set_chunk_cache_max(png_, 64);
        png_set_benign_errors(png_, 0);  // a wrong checksum is a fault, not a warning
        png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
        png_byte needed[] = "PLTE\0tRNS\0pHYs";
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_AS_DEFAULT, needed, 3);
        png_read_info(png_, info_);
        header.width_px = png_get_image_width(png_, info_);
        header.height_px = png_get_image_height(png_, info_);
        header.bit_depth = png_get_bit_depth(png_, info_);
        header.colour_type = png_get_color_type(png_, info_);
        header.interlaced = png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE;
        png_uint_32 x = 0, y = 0;
        int unit = 0;
        if (png_get_pHYs(png_, info_, &x, &y, &unit) && unit == PNG_RESOLUTION_METER) {
            header.x_per_metre = x;
            header.y_per_metre = y;
        }
        return true;
    }
    bool start_rows(std::size_t row_bytes) {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_set_expand(png_);
        png_set_strip_16(png_);
        png_set_gray_to_rgb(png_);
        png_set_add_alpha(png_, 0xff, PNG_FILLER_AFTER);
        png_read_update_info(png_, info_);
        if (png_get_rowbytes(png_, info_) != row_bytes) png_error(png_, "rows of an unexpected length");
        return true;
    }
    /// Samples as they are in the file.
    bool start_plain_rows(std::size_t row_bytes) {
        if (setjmp(png_jmpbuf(png_))) return false;
        if (png_get_rowbytes(png_, info_) != row_bytes) png_error(png_, "rows of an unexpected length");
        return true;
    }
    bool read_row(std::uint8_t* row) {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_read_row(png_, row, nullptr);
        return true;
    }
    bool read_end() {
        if (setjmp(png_jmpbuf(png_))) return false;
        png_read_end(png_, nullptr);
        return true;
    }

private:
    png_structp png_;
    png_infop info_ = nullptr;
};

[[noreturn]] void fail(const std::string& name, const Source& source) {
    constexpr std::size_t mark_bytes = 8;
    if (source.file.size() >= mark_bytes && png_sig_cmp(source.file.data(), 0, mark_bytes) != 0)
        throw InputError(
            fmt::format("{}: is no PNG file by its first bytes, whatever its name says; save it as PNG", name));
    throw InputError(fmt::format("{}: is no PNG file that can be read whole ({}); it may be cut short", name,
                                 source.fault[0] ? source.fault : "out of memory"));
}

/// Before the pixels: behind the mark of 8 bytes chunks of a length, a name, so many bytes and a check sum.
std::string colour_chunks_in(std::span<const std::uint8_t> file) {
    constexpr std::array<std::string_view, 5> known{"iCCP", "cICP", "gAMA", "cHRM", "sRGB"};
    constexpr std::size_t around = 12;
    std::string names;
    for (std::size_t at = 8; at + around <= file.size();) {
        std::size_t length = 0;
        for (std::size_t i = at; i < at + 4; ++i) length = length << 8 | file[i];
        const std::string_view name(reinterpret_cast<const char*>(file.data()) + at + 4, 4);
        if (name == "IDAT" || length > file.size() - at - around) break;
        if (std::ranges::find(known, name) != known.end() && names.find(name) == std::string::npos)
            names += (names.empty() ? "" : ", ") + std::string(name);
        at += around + length;
    }
    return names;
}

PngHeader checked_header(PngDecoder& decoder, Source& source, const std::string& name) {
    PngHeader header;
    if (!decoder.read_header(source, header)) fail(name, source);
    if (std::uint64_t{header.width_px} * header.height_px > most_png_pixels)
        throw InputError(
            fmt::format("{}: claims {} x {} px, more than any layer has", name, header.width_px, header.height_px));
    header.colour_chunks = colour_chunks_in(source.file);
    return header;
}

void check_plain(const PngHeader& header, const std::string& name) {
    if (header.interlaced)
        throw InputError(fmt::format("{}: is interlaced, which layers are not: save it without", name));
}

void read_to_end(PngDecoder& decoder, const Source& source, const std::string& name) {
    if (!decoder.read_end()) fail(name, source);
    if (source.at != source.file.size())
        throw InputError(fmt::format("{}: has {} bytes behind its end; something else was appended to it", name,
                                     source.file.size() - source.at));
}

}  // namespace

std::string png_kind(const PngHeader& header) {
    const char* type = "of an unknown kind";
    switch (header.colour_type) {
        case PNG_COLOR_TYPE_GRAY:
            type = "grey";
            break;
        case PNG_COLOR_TYPE_RGB:
            type = "RGB";
            break;
        case PNG_COLOR_TYPE_PALETTE:
            type = "indexed";
            break;
        case PNG_COLOR_TYPE_GRAY_ALPHA:
            type = "grey with alpha";
            break;
        case PNG_COLOR_TYPE_RGBA:
            type = "RGBA";
            break;
        default:
            break;
    }
    return fmt::format("{}-bit {} (colour type {})", header.bit_depth, type, header.colour_type);
}

PngHeader read_png_header(std::span<const std::uint8_t> file, const std::string& source_name) {
    Source source{file};
    PngDecoder decoder(source);
    return checked_header(decoder, source, source_name);
}

PngHeader read_png(std::span<const std::uint8_t> file, const std::string& source_name,
                   const std::function<void(std::uint32_t, std::span<const std::uint8_t>)>& on_row) {
    Source source{file};
    PngDecoder decoder(source);
    const PngHeader header = checked_header(decoder, source, source_name);
    check_plain(header, source_name);
    std::vector<std::uint8_t> row(std::size_t{4} * header.width_px);
    if (!decoder.start_rows(row.size())) fail(source_name, source);
    for (std::uint32_t y = 0; y < header.height_px; ++y) {
        if (!decoder.read_row(row.data())) fail(source_name, source);
        on_row(y, row);
    }
    read_to_end(decoder, source, source_name);
    return header;
}

GreyPicture read_grey_png(std::span<const std::uint8_t> file, const std::string& source_name) {
    Source source{file};
    PngDecoder decoder(source);
    const PngHeader header = checked_header(decoder, source, source_name);
    check_plain(header, source_name);
    if (header.colour_type != PNG_COLOR_TYPE_GRAY || (header.bit_depth != 8 && header.bit_depth != 16))
        throw InputError(
            fmt::format("{}: is {}, but a picture of numbers is 8- or 16-bit grey", source_name, png_kind(header)));
    GreyPicture picture{header.width_px, header.height_px, {}};
    picture.samples.reserve(std::size_t{header.width_px} * header.height_px);
    const std::size_t bytes = static_cast<std::size_t>(header.bit_depth) / 8;
    std::vector<std::uint8_t> row(bytes * header.width_px);
    if (!decoder.start_plain_rows(row.size())) fail(source_name, source);
    for (std::uint32_t y = 0; y < header.height_px; ++y) {
        if (!decoder.read_row(row.data())) fail(source_name, source);
        for (std::size_t i = 0; i < row.size(); i += bytes)
            picture.samples.push_back(static_cast<std::uint16_t>(bytes == 1 ? row[i] : row[i] << 8 | row[i + 1]));
    }
    read_to_end(decoder, source, source_name);
    return picture;
}

}  // namespace voxtone::io
