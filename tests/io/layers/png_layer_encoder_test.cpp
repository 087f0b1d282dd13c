// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/png_layer_encoder.h"

#include <png.h>
#include <zlib.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <string>

#include "io/layers/huffman_code.h"
#include "layer_samples.h"

using namespace voxtone;
using namespace voxtone::io;

namespace {

std::uint32_t u32(const std::uint8_t* at) {
    return std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 | at[3];
}

/// Walks the chunks by hand: every CRC must hold, zlib must inflate the stream to the last byte and find its Adler-32
/// right. Empty on any fault.
std::vector<std::uint8_t> inflate_by_hand(const std::vector<std::uint8_t>& file, std::size_t expected) {
    std::vector<std::uint8_t> stream;
    for (std::size_t at = 8; at < file.size();) {
        const std::uint32_t length = u32(&file[at]);
        if (u32(&file[at + 8 + length]) != crc32(0, &file[at + 4], length + 4)) return {};
        if (std::memcmp(&file[at + 4], "IDAT", 4) == 0)
            stream.insert(stream.end(), file.begin() + static_cast<std::ptrdiff_t>(at + 8),
                          file.begin() + static_cast<std::ptrdiff_t>(at + 8 + length));
        at += 12 + length;
    }
    std::vector<std::uint8_t> bytes(expected + 1);
    uLongf size = bytes.size();
    uLong used = stream.size();
    if (uncompress2(bytes.data(), &size, stream.data(), &used) != Z_OK || used != stream.size()) return {};
    bytes.resize(size);
    return bytes;
}

struct Decoded {
    std::uint32_t width = 0, height = 0, x_per_metre = 0, y_per_metre = 0;
    int bit_depth = 0, colour_type = 0, unit = 0;
    std::vector<std::uint8_t> rgba;
    std::string complaint;
};

/// libpng's opinion; its warnings count as complaints.
Decoded decode_with_libpng(const std::vector<std::uint8_t>& file) {
    Decoded result;
    struct Source {
        const std::vector<std::uint8_t>& file;
        std::size_t at;
    } source{file, 0};
    auto complain = [](png_structp png, png_const_charp text) {
        static_cast<Decoded*>(png_get_error_ptr(png))->complaint += text;
        png_longjmp(png, 1);
    };
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &result, complain, complain);
    png_infop info = png_create_info_struct(png);
    if (!setjmp(png_jmpbuf(png))) {
        png_set_read_fn(png, &source, [](png_structp p, png_bytep out, size_t n) {
            auto& from = *static_cast<Source*>(png_get_io_ptr(p));
            if (from.at + n > from.file.size()) png_error(p, "too short");
            std::memcpy(out, from.file.data() + from.at, n);
            from.at += n;
        });
        png_read_info(png, info);
        result.width = png_get_image_width(png, info);
        result.height = png_get_image_height(png, info);
        result.bit_depth = png_get_bit_depth(png, info);
        result.colour_type = png_get_color_type(png, info);
        png_get_pHYs(png, info, &result.x_per_metre, &result.y_per_metre, &result.unit);
        const std::size_t row = png_get_rowbytes(png, info);
        result.rgba.resize(row * result.height);
        for (std::uint32_t y = 0; y < result.height; ++y) png_read_row(png, result.rgba.data() + y * row, nullptr);
        png_read_end(png, info);
        if (source.at != file.size()) result.complaint += "bytes behind the end";
    }
    png_destroy_read_struct(&png, &info, nullptr);
    return result;
}

const std::vector<Rgb> cmykw = {{0, 0, 0}, {0, 174, 239}, {236, 0, 140}, {255, 242, 0}, {40, 40, 40}, {220, 222, 216}};

bool same_pixels(const LayerRuns& layer, const std::vector<Rgb>& palette) {
    const PngLayerEncoder encoder(palette, {42.333333, 84.666667});
    const auto file = encoder.encode(layer);
    const auto plain = plain_bitmap(layer, palette);
    return inflate_by_hand(file, plain.size()) == plain;
}

}  // namespace

TEST_CASE("a layer is an 8-bit RGBA PNG of its own size and resolution", "[png]") {
    RandomStream random(1, 0);
    const std::array<double, 6> weights = {1, 1, 1, 1, 1, 3};
    const auto layer = random_layer(random, 317, 41, weights);
    const auto file = PngLayerEncoder(cmykw, {42.333333, 84.666667}).encode(layer);
    const auto png = decode_with_libpng(file);
    REQUIRE(png.complaint.empty());
    CHECK(png.width == 317);
    CHECK(png.height == 41);
    CHECK(png.bit_depth == 8);
    CHECK(png.colour_type == PNG_COLOR_TYPE_RGBA);
    CHECK(png.unit == PNG_RESOLUTION_METER);
    CHECK(png.x_per_metre == 23622);  // 600 dpi
    CHECK(png.y_per_metre == 11811);  // 300 dpi
    const auto plain = plain_bitmap(layer, cmykw);
    for (std::size_t y = 0; y < 41; ++y)
        REQUIRE(std::memcmp(&png.rgba[y * 317 * 4], &plain[y * (317 * 4 + 1) + 1], 317 * 4) == 0);
}

TEST_CASE("what is decoded is what the runs say, for thousands of random layers", "[png]") {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        RandomStream random(2, i);
        // One to all materials, from even to one very rare.
        std::vector<double> weights(1 + draw(random, max_materials));
        const double skew = 8 * random.uniform();
        for (auto& w : weights) w = std::exp(-skew * random.uniform());
        std::vector<Rgb> palette(weights.size());
        for (auto& colour : palette)
            for (auto& value : colour) value = static_cast<std::uint8_t>(draw(random, 256));
        const std::uint32_t width = 1 + draw(random, random.uniform() < 0.2 ? 3000 : 150);
        const std::uint32_t height = 1 + draw(random, random.uniform() < 0.5 ? 60 : 6);
        const auto layer =
            random_layer(random, width, height, weights, 0.1 * random.uniform() * random.uniform(), random.uniform());
        INFO("layer " << i << ", " << width << " x " << height << ", " << weights.size() << " materials");
        REQUIRE(same_pixels(layer, palette));
    }
}

TEST_CASE("uniform layers of all sizes", "[png]") {
    for (std::uint32_t width = 1; width <= 300; ++width)
        for (const std::uint32_t height : {1u, 2u, 3u, 7u, 70u}) {
            LayerRuns layer(width, height);
            for (std::uint32_t y = 0; y < height; ++y) {
                layer.push(width, 5);
                layer.end_row();
            }
            INFO(width << " x " << height);
            REQUIRE(same_pixels(layer, cmykw));
        }
}

TEST_CASE("two runs of all lengths, with the edge at rest and moving", "[png]") {
    for (std::uint32_t width = 2; width <= 400; width += 1 + width / 40)
        for (std::uint32_t edge = 1; edge < width; edge += 1 + width / 20)
            for (const bool moving : {false, true}) {
                LayerRuns layer(width, 5);
                for (std::uint32_t y = 0; y < 5; ++y) {
                    const std::uint32_t at = moving ? 1 + (edge + 37 * y) % (width - 1) : edge;
                    layer.push(at, y == 3 ? 2 : 0);
                    layer.push(width - at, 1);
                    layer.end_row();
                }
                INFO(width << " px, edge at " << edge << (moving ? ", moving" : ""));
                REQUIRE(same_pixels(layer, cmykw));
            }
}

TEST_CASE("widths around the reach of deflate and the largest", "[png]") {
    const std::array<double, 6> weights = {1, 1, 1, 1, 1, 5};
    for (const std::uint32_t width : {8190u, 8191u, 8192u, 8193u, 16384u, 32768u, 65534u, 65535u}) {
        RandomStream random(3, width);
        INFO(width);
        CHECK(same_pixels(random_layer(random, width, 5, weights, 0.01, 0.3), cmykw));
        LayerRuns uniform(width, 3);
        for (int y = 0; y < 3; ++y) {
            uniform.push(width, 1);
            uniform.end_row();
        }
        CHECK(same_pixels(uniform, cmykw));
    }
    // The tallest, narrow: the 16-bit marks of where pixels were seen wrap many times.
    RandomStream random(4, 0);
    CHECK(same_pixels(random_layer(random, 3, 65535, weights, 0, 0.1), cmykw));
}

TEST_CASE("a marked pixel lands at its place", "[png]") {
    // An encoder that drops, doubles or mirrors something must not pass: this is the sibling that is wrong by one
    // pixel.
    LayerRuns right(90, 3), wrong(90, 3);
    for (std::uint32_t y = 0; y < 3; ++y) {
        right.push(30, 0), right.push(1, 2), right.push(59, 0), right.end_row();
        wrong.push(31, 0), wrong.push(1, 2), wrong.push(58, 0), wrong.end_row();
    }
    const PngLayerEncoder encoder(cmykw, {42.333333, 84.666667});
    const auto plain = plain_bitmap(right, cmykw);
    CHECK(inflate_by_hand(encoder.encode(right), plain.size()) == plain);
    CHECK(inflate_by_hand(encoder.encode(wrong), plain.size()) != plain);
    CHECK(plain[90 * 4 + 1 + 1 + 30 * 4] == 236);
}

TEST_CASE("Adler-32 in closed form is zlib's", "[png]") {
    const std::array<double, 6> weights = {1, 2, 3, 4, 5, 6};
    for (std::uint64_t i = 0; i < 50; ++i) {
        RandomStream random(5, i);
        const auto layer = random_layer(random, 1 + draw(random, 5000), 1 + draw(random, 30), weights, 0.02, 0.2);
        const auto plain = plain_bitmap(layer, cmykw);
        REQUIRE(adler32_of_layer(layer, cmykw) == adler32_z(1, plain.data(), plain.size()));
    }
    // The largest sums there are: a white row of the largest width, many times.
    LayerRuns white(65535, 40);
    for (int y = 0; y < 40; ++y) {
        white.push(65535, 1);
        white.end_row();
    }
    const std::vector<Rgb> palette = {{0, 0, 0}, {255, 255, 255}};
    const auto plain = plain_bitmap(white, palette);
    CHECK(adler32_of_layer(white, palette) == adler32_z(1, plain.data(), plain.size()));
}

TEST_CASE("about as small as zlib level 6 on layers with a halftoned skin", "[png]") {
    const std::array<std::array<double, 5>, 3> mixtures = {
        {{.2, .2, .2, .1, .3}, {.1, .12, .08, .02, .68}, {.04, .04, .03, .01, .88}}};
    for (const auto& weights : mixtures) {
        const auto layer = ring_layer(1600, 800, 60, weights, 5, 6);
        const auto plain = plain_bitmap(layer, cmykw);
        uLongf size = compressBound(plain.size());
        std::vector<std::uint8_t> packed(size);
        REQUIRE(compress2(packed.data(), &size, plain.data(), plain.size(), 6) == Z_OK);
        const auto ours = PngLayerEncoder(cmykw, {42.333333, 84.666667}).encode(layer).size();
        INFO("ours " << ours << " bytes, zlib " << size);
        // Measured: 3 % less to 2.5 % more, by mixture; zlib searches 128 places per byte, this 4 per pixel.
        CHECK(static_cast<double>(ours) <= 1.03 * static_cast<double>(size));
    }
}

TEST_CASE("code lengths are optimal under their limit", "[png]") {
    // Fibonacci counts make the deepest trees: without a limit the rarest would get 29 bits.
    std::vector<std::uint64_t> counts = {1, 1};
    while (counts.size() < 30) counts.push_back(counts[counts.size() - 1] + counts[counts.size() - 2]);
    for (const int limit : {5, 7, 15}) {
        const auto lengths = huffman_lengths(counts, limit);
        double kraft = 0;
        for (const auto l : lengths) {
            CHECK(l >= 1);
            CHECK(l <= limit);
            kraft += std::ldexp(1.0, -l);
        }
        CHECK(kraft == 1.0);
    }
    // By hand: weights 1 1 2 4 have the unique optimum 3 3 2 1, and under a limit of 2 all get 2.
    const std::vector<std::uint64_t> small = {1, 4, 1, 2};
    CHECK(huffman_lengths(small, 15) == std::vector<std::uint8_t>{3, 1, 3, 2});
    CHECK(huffman_lengths(small, 2) == std::vector<std::uint8_t>{2, 2, 2, 2});
}
