// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/resin_bitmap.h"

#include <algorithm>
#include <csetjmp>
#include <cstring>

#include <png.h>
#include <tiffio.h>

#include "base/contracts.h"
#include "base/error.h"
#include "io/layers/png_layer_encoder.h"

namespace voxtone::io {
namespace {

/// One row of bits, first pixel highest.
void fill_bits(std::span<const Run> row, Material material, std::vector<std::uint8_t>& bits) {
    std::fill(bits.begin(), bits.end(), std::uint8_t{0});
    std::uint32_t x = 0;
    for (const Run run : row) {
        if (run.material == material)
            for (std::uint32_t end = x + run.length; x < end; ++x)
                bits[x / 8] |= static_cast<std::uint8_t>(0x80 >> (x % 8));
        else
            x += run.length;
    }
}

void fill_bytes(std::span<const Run> row, std::vector<std::uint8_t>& bytes) {
    std::uint8_t* at = bytes.data();
    for (const Run run : row) {
        std::memset(at, run.material, run.length);
        at += run.length;
    }
}

/// `row(y)` fills and gives one packed row.
template <class RowOf>
bool write_png(std::vector<std::uint8_t>& out, const LayerRuns& layer, int depth, int type,
               std::span<const png_color> colours, std::array<std::uint32_t, 2> per_metre, RowOf&& row) {
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, [](png_structp, png_const_charp) {});
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info || setjmp(png_jmpbuf(png))) {  // out of memory: nothing else can go wrong
        png_destroy_write_struct(&png, &info);
        return false;
    }
    png_set_write_fn(
        png, &out,
        [](png_structp p, png_bytep bytes, png_size_t n) {
            auto& to = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
            to.insert(to.end(), bytes, bytes + n);
        },
        nullptr);
    png_set_user_limits(png, 65535, 65535);
    png_set_compression_level(png, 6);
    png_set_filter(png, 0, PNG_FILTER_NONE);
    png_set_IHDR(png, info, layer.width_px(), layer.height_px(), depth, type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_pHYs(png, info, per_metre[0], per_metre[1], PNG_RESOLUTION_METER);
    if (!colours.empty()) png_set_PLTE(png, info, colours.data(), static_cast<int>(colours.size()));
    png_write_info(png, info);
    for (std::uint32_t y = 0; y < layer.height_px(); ++y) png_write_row(png, row(y));
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return true;
}

/// A file in memory, for libtiff.
struct Memory {
    std::vector<std::uint8_t> bytes;
    std::size_t at = 0;
};

tmsize_t memory_read(thandle_t handle, void* to, tmsize_t n) {
    auto& m = *static_cast<Memory*>(handle);
    const std::size_t count = std::min(static_cast<std::size_t>(n), m.bytes.size() - std::min(m.at, m.bytes.size()));
    std::memcpy(to, m.bytes.data() + m.at, count);
    m.at += count;
    return static_cast<tmsize_t>(count);
}
tmsize_t memory_write(thandle_t handle, void* from, tmsize_t n) {
    auto& m = *static_cast<Memory*>(handle);
    const auto count = static_cast<std::size_t>(n);
    if (m.bytes.size() < m.at + count) m.bytes.resize(m.at + count);
    std::memcpy(m.bytes.data() + m.at, from, count);
    m.at += count;
    return n;
}
toff_t memory_seek(thandle_t handle, toff_t offset, int whence) {
    auto& m = *static_cast<Memory*>(handle);
    const std::size_t base = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? m.at : m.bytes.size();
    m.at = base + static_cast<std::size_t>(offset);
    return m.at;
}
int memory_close(thandle_t) { return 0; }
toff_t memory_size(thandle_t handle) { return static_cast<Memory*>(handle)->bytes.size(); }
int memory_map(thandle_t, void**, toff_t*) { return 0; }
void memory_unmap(thandle_t, void*, toff_t) {}

}  // namespace

std::vector<std::uint8_t> encode_png1(const LayerRuns& layer, Material material, std::array<double, 2> pitch_um) {
    VOXTONE_EXPECT(layer.rows() == layer.height_px());
    std::vector<std::uint8_t> out, bits((layer.width_px() + 7) / 8);
    const auto row = [&](std::uint32_t y) {
        fill_bits(layer.row(y), material, bits);
        return bits.data();
    };
    if (!write_png(out, layer, 1, PNG_COLOR_TYPE_GRAY, {}, pixels_per_metre(pitch_um), row))
        throw ResourceError("Out of memory while writing a PNG layer.");
    return out;
}

std::vector<std::uint8_t> encode_png8(const LayerRuns& layer, std::span<const Rgb> palette,
                                      std::array<double, 2> pitch_um) {
    VOXTONE_EXPECT(layer.rows() == layer.height_px());
    std::vector<png_color> colours;
    for (const auto& [r, g, b] : palette) colours.push_back({r, g, b});
    std::vector<std::uint8_t> out, bytes(layer.width_px());
    const auto row = [&](std::uint32_t y) {
        fill_bytes(layer.row(y), bytes);
        return bytes.data();
    };
    if (!write_png(out, layer, 8, PNG_COLOR_TYPE_PALETTE, colours, pixels_per_metre(pitch_um), row))
        throw ResourceError("Out of memory while writing a PNG layer.");
    return out;
}

std::vector<std::uint8_t> encode_tiff1(const LayerRuns& layer, Material material, std::array<double, 2> pitch_um) {
    VOXTONE_EXPECT(layer.rows() == layer.height_px());
    Memory memory;
    TIFF* const tiff = TIFFClientOpen("layer", "wl", &memory, memory_read, memory_write, memory_seek, memory_close,
                                      memory_size, memory_map, memory_unmap);
    if (!tiff) throw ResourceError("Out of memory while writing a TIFF layer.");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, layer.width_px());
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, layer.height_px());
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 1);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layer.height_px());
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_CCITTFAX4);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISWHITE);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_FILLORDER, FILLORDER_MSB2LSB);
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 25400.0 / pitch_um[0]);
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 25400.0 / pitch_um[1]);
    std::vector<std::uint8_t> bits((layer.width_px() + 7) / 8);
    bool good = true;
    for (std::uint32_t y = 0; y < layer.height_px() && good; ++y) {
        fill_bits(layer.row(y), material, bits);
        good = TIFFWriteScanline(tiff, bits.data(), y) == 1;
    }
    TIFFClose(tiff);
    if (!good) throw ResourceError("Out of memory while writing a TIFF layer.");
    return std::move(memory.bytes);
}

}  // namespace voxtone::io
