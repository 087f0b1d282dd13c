// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/io/decoders/picture_bytes.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <stdexcept>

#include <jpeglib.h>
#include <lcms2.h>
#include <png.h>
#include <tiffio.h>

#include "io/files/read_bytes.h"
#include "tests/io/files/temporary_folder.h"

namespace voxtone::test {

namespace {

Bytes png_bytes(const PngKind& kind, std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t> samples) {
    Bytes out;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &out,
        [](png_structp p, png_bytep data, png_size_t size) {
            auto* const bytes = static_cast<Bytes*>(png_get_io_ptr(p));
            const auto* const first = reinterpret_cast<const std::byte*>(data);
            bytes->insert(bytes->end(), first, first + size);
        },
        nullptr);
    png_set_IHDR(png, info, width, height, kind.bits, kind.colour_type,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    std::vector<png_color> palette(std::size_t{1} << std::min(kind.bits, 8));
    std::vector<png_byte> alphas;
    for (std::size_t i = 0; i < palette.size(); ++i) {
        palette[i] = {png_byte(i * 37), png_byte(255 - i * 11), png_byte(i * i)};
        if (i < palette.size() / 2 + 1) alphas.push_back(png_byte(i * 53));
    }
    if (kind.colour_type == PNG_COLOR_TYPE_PALETTE) {
        png_set_PLTE(png, info, palette.data(), int(palette.size()));
        if (kind.keyed) png_set_tRNS(png, info, alphas.data(), int(alphas.size()), nullptr);
    } else if (kind.keyed) {
        png_color_16 key{};
        png_set_tRNS(png, info, nullptr, 0, &key);
    }
    png_write_info(png, info);
    for (const PngChunk& chunk : kind.chunks)
        png_write_chunk(png, reinterpret_cast<png_const_bytep>(chunk.name.data()),
                        reinterpret_cast<png_const_bytep>(chunk.data.data()), chunk.data.size());
    const std::size_t row_bytes = png_get_rowbytes(png, info);
    samples.resize(row_bytes * height);
    std::vector<png_bytep> rows;
    for (std::uint32_t y = 0; y < height; ++y) rows.push_back(samples.data() + y * row_bytes);
    png_write_image(png, rows.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return out;
}

/// In this machine's order.
std::vector<std::uint8_t> sample_bytes(std::uint16_t sample, int bits) {
    const double number = sample / 65535.0;
    const auto narrow = static_cast<float>(number);
    std::vector<std::uint8_t> bytes(std::size_t(bits / 8));
    std::memcpy(bytes.data(),
                bits == 64   ? static_cast<const void*>(&number)
                : bits == 32 ? static_cast<const void*>(&narrow)
                             : &sample,
                bytes.size());
    return bytes;
}

}  // namespace

Bytes png_of_kind(const PngKind& kind, std::uint32_t width, std::uint32_t height) {
    std::mt19937 random(static_cast<unsigned>(kind.colour_type * 100 + kind.bits));
    std::vector<std::uint8_t> samples(std::size_t{8} * width * height);
    for (std::uint8_t& s : samples) s = random() % 4 == 0 ? 0 : static_cast<std::uint8_t>(random());
    std::fill_n(samples.begin(), 8, 0);  // the key colour, at least once
    return png_bytes(kind, width, height, samples);
}

Bytes png_of_colour(const Eigen::Vector3d& codes, const std::vector<PngChunk>& chunks) {
    std::vector<std::uint8_t> samples;
    for (int i = 0; i < 4; ++i)
        for (const double code : codes) {
            const auto value = static_cast<unsigned>(std::lround(code));
            samples.push_back(static_cast<std::uint8_t>(value >> 8));
            samples.push_back(static_cast<std::uint8_t>(value & 255));
        }
    return png_bytes({.colour_type = PNG_COLOR_TYPE_RGB, .bits = 16, .chunks = chunks}, 2, 2, samples);
}

Bytes jpeg_of_kind(const JpegKind& kind, std::uint32_t width, std::uint32_t height) {
    const int components = std::abs(kind.components);
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &memory, &size);
    info.image_width = width;
    info.image_height = height;
    info.input_components = components;
    info.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, kind.quality, TRUE);
    if (kind.progressive) jpeg_simple_progression(&info);
    info.restart_in_rows = kind.restart_rows;
    info.density_unit = 2;
    info.X_density = 100;
    info.Y_density = 50;
    if (!kind.app1.empty()) info.write_JFIF_header = FALSE;
    info.write_Adobe_marker = kind.components != -4 && components == 4;
    jpeg_start_compress(&info, TRUE);
    if (!kind.app1.empty()) jpeg_write_marker(&info, JPEG_APP0 + 1, kind.app1.data(), unsigned(kind.app1.size()));
    if (!kind.profile.empty()) jpeg_write_icc_profile(&info, kind.profile.data(), unsigned(kind.profile.size()));
    std::vector<std::uint8_t> row(std::size_t(components) * width);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x)
            for (int c = 0; c < components; ++c)
                row[std::size_t(components) * x + std::size_t(c)] =
                    static_cast<std::uint8_t>(127.5 + 120 * std::sin(0.31 * (c + 1) * x + 0.17 * y * (4 - c)));
        JSAMPROW rows = row.data();
        jpeg_write_scanlines(&info, &rows, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    const auto* const first = reinterpret_cast<const std::byte*>(memory);
    Bytes out(first, first + size);
    std::free(memory);
    return out;
}

Bytes tiff_of(const std::vector<TiffPage>& pages, std::uint32_t width, std::uint32_t height) {
    const io::TemporaryFolder folder;
    const std::string path = (folder.path() / "made.tif").string();
    TIFF* const file = TIFFOpen(path.c_str(), "w");
    for (const TiffPage& page : pages) {
        const std::uint32_t w = page.smaller_copy ? width / 2 : width, h = page.smaller_copy ? height / 2 : height;
        const auto samples = static_cast<int>(page.pixel.size());
        TIFFSetField(file, TIFFTAG_IMAGEWIDTH, w);
        TIFFSetField(file, TIFFTAG_IMAGELENGTH, h);
        TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, samples);
        TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, page.bits);
        TIFFSetField(file, TIFFTAG_PHOTOMETRIC, page.photometric);
        TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        if (page.pixel_aspect > 0) {
            TIFFSetField(file, TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE);
            TIFFSetField(file, TIFFTAG_XRESOLUTION, page.pixel_aspect);
            TIFFSetField(file, TIFFTAG_YRESOLUTION, 1.0f);
        }
        if (page.bits > 16) TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
        if (!page.profile.empty())
            TIFFSetField(file, TIFFTAG_ICCPROFILE, std::uint32_t(page.profile.size()), page.profile.data());
        if (page.smaller_copy) TIFFSetField(file, TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE);
        const int colours = page.photometric == PHOTOMETRIC_SEPARATED ? 4 : 3;
        const std::vector<std::uint16_t> extra(std::size_t(std::max(samples - colours, 0)), page.extra);
        if (page.is_signed) TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_INT);
        if (!page.white.empty()) TIFFSetField(file, TIFFTAG_WHITEPOINT, page.white.data());
        if (!extra.empty()) TIFFSetField(file, TIFFTAG_EXTRASAMPLES, int(extra.size()), extra.data());
        if (page.tile) {
            TIFFSetField(file, TIFFTAG_TILEWIDTH, page.tile);
            TIFFSetField(file, TIFFTAG_TILELENGTH, page.tile);
        }
        const std::size_t row_pixels = page.tile ? std::size_t(page.tile) * std::size_t(page.tile) : w;
        std::vector<std::uint8_t> bytes;
        for (std::size_t x = 0; x < row_pixels; ++x)
            for (const std::uint16_t sample : x % 2 == 1 && !page.second.empty() ? page.second : page.pixel)
                for (const std::uint8_t byte : sample_bytes(sample, page.bits)) bytes.push_back(byte);
        if (page.tile)
            for (std::uint32_t t = 0; t < TIFFNumberOfTiles(file); ++t)
                TIFFWriteEncodedTile(file, t, bytes.data(), tmsize_t(bytes.size()));
        else
            for (std::uint32_t y = 0; y < h; ++y) TIFFWriteScanline(file, bytes.data(), y);
        TIFFWriteDirectory(file);
    }
    TIFFClose(file);
    return io::read_bytes(path, 1 << 24);
}

namespace {

/// With sRGB's white and curve.
std::vector<std::uint8_t> rgb_profile(const cmsCIExyYTRIPLE& primaries) {
    const cmsCIExyY white{0.3127, 0.329, 1};
    const cmsFloat64Number srgb[] = {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
    cmsToneCurve* const curve = cmsBuildParametricToneCurve(nullptr, 4, srgb);
    cmsToneCurve* const curves[] = {curve, curve, curve};
    cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves);
    cmsUInt32Number size = 0;
    cmsSaveProfileToMem(profile, nullptr, &size);
    std::vector<std::uint8_t> out(size);
    cmsSaveProfileToMem(profile, out.data(), &size);
    cmsCloseProfile(profile);
    cmsFreeToneCurve(curve);
    return out;
}

}  // namespace

std::vector<std::uint8_t> swapped_profile() { return rgb_profile({{0.15, 0.06, 1}, {0.3, 0.6, 1}, {0.64, 0.33, 1}}); }

std::vector<std::uint8_t> display_p3_profile() {
    return rgb_profile({{0.68, 0.32, 1}, {0.265, 0.69, 1}, {0.15, 0.06, 1}});
}

}  // namespace voxtone::test
