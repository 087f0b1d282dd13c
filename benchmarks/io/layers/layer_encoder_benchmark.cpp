// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layer encoder against libpng (zlib) and libdeflate on layers of 3310 x 1772 px. Argument 0 is air, 1 to 3 are a
// body with a halftoned skin of about 2.2, 1.5 and 0.8 bits per pixel over a uniform core, 4 is all halftone (1.5
// bits). bytes_per_second counts the plain bitmap (4 bytes a pixel), halftone/s the pixels in runs shorter than 24 px.
#include <benchmark/benchmark.h>
#include <png.h>

#include "io/layers/layer_digest.h"
#include "io/layers/run_matcher.h"
#include "tests/io/layers/layer_samples.h"

#ifdef VOXTONE_HAVE_LIBDEFLATE
#include <libdeflate.h>
#endif

using namespace voxtone;
using namespace voxtone::io;

namespace {

const std::vector<Rgb> palette = {{0, 0, 0},     {0, 174, 239}, {236, 0, 140},
                                  {255, 242, 0}, {40, 40, 40},  {220, 222, 216}};
constexpr std::uint32_t width = 3310, height = 1772;

const LayerRuns& sample(std::int64_t which) {
    static const auto layers = [] {
        std::vector<LayerRuns> made;
        LayerRuns air(width, height);
        for (std::uint32_t y = 0; y < height; ++y) {
            air.push(width, background);
            air.end_row();
        }
        made.push_back(std::move(air));
        const std::array<std::array<double, 5>, 3> mixtures = {
            {{.2, .2, .2, .1, .3}, {.1, .12, .08, .02, .68}, {.04, .04, .03, .01, .88}}};
        for (const auto& weights : mixtures) made.push_back(ring_layer(width, height, 60, weights, 5, 6));
        made.push_back(ring_layer(width, height, 2 * width, mixtures[1], 5, 6));
        return made;
    }();
    return layers[static_cast<std::size_t>(which)];
}

void count(benchmark::State& state, const LayerRuns& layer, std::size_t file_bytes) {
    std::size_t halftone = 0;
    for (std::uint32_t y = 0; y < layer.rows(); ++y)
        for (const Run run : layer.row(y))
            if (run.length < 24) halftone += run.length;
    const auto rounds = static_cast<double>(state.iterations());
    state.SetBytesProcessed(state.iterations() * (4 * std::int64_t{width} + 1) * height);
    state.counters["voxels/s"] = benchmark::Counter(rounds * width * height, benchmark::Counter::kIsRate);
    state.counters["halftone/s"] =
        benchmark::Counter(rounds * static_cast<double>(halftone), benchmark::Counter::kIsRate);
    state.counters["file_bytes"] = static_cast<double>(file_bytes);
}

void ours(benchmark::State& state) {
    const LayerRuns& layer = sample(state.range(0));
    const PngLayerEncoder encoder(palette, {42.333333, 84.666667});
    std::size_t bytes = 0;
    for (auto _ : state) bytes = encoder.encode(layer).size();
    count(state, layer, bytes);
}

void match_only(benchmark::State& state) {
    const LayerRuns& layer = sample(state.range(0));
    RunMatcher matcher;
    for (auto _ : state) benchmark::DoNotOptimize(matcher.match(layer).words().data());
    count(state, layer, 0);
}

void adler_only(benchmark::State& state) {
    const LayerRuns& layer = sample(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(adler32_of_layer(layer, palette));
    count(state, layer, 0);
}

void digest_only(benchmark::State& state) {
    const LayerRuns& layer = sample(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(layer_digest(layer));
    count(state, layer, 0);
}

void with_libpng(benchmark::State& state) {
    const LayerRuns& layer = sample(state.range(0));
    const auto plain = plain_bitmap(layer, palette);
    std::vector<std::uint8_t> out;
    for (auto _ : state) {
        out.clear();
        png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
        png_infop info = png_create_info_struct(png);
        png_set_write_fn(
            png, &out,
            [](png_structp p, png_bytep bytes, png_size_t n) {
                auto& to = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
                to.insert(to.end(), bytes, bytes + n);
            },
            nullptr);
        png_set_compression_level(png, static_cast<int>(state.range(1)));
        png_set_filter(png, 0, PNG_FILTER_NONE);
        png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                     PNG_FILTER_TYPE_DEFAULT);
        png_write_info(png, info);
        for (std::size_t y = 0; y < height; ++y)
            png_write_row(png, plain.data() + y * (4 * std::size_t{width} + 1) + 1);
        png_write_end(png, info);
        png_destroy_write_struct(&png, &info);
    }
    count(state, layer, out.size());
}

#ifdef VOXTONE_HAVE_LIBDEFLATE
void with_libdeflate(benchmark::State& state) {
    const LayerRuns& layer = sample(state.range(0));
    const auto plain = plain_bitmap(layer, palette);
    std::vector<std::uint8_t> out(plain.size());
    std::size_t bytes = 0;
    libdeflate_compressor* const compressor = libdeflate_alloc_compressor(static_cast<int>(state.range(1)));
    for (auto _ : state)
        bytes = libdeflate_zlib_compress(compressor, plain.data(), plain.size(), out.data(), out.size());
    libdeflate_free_compressor(compressor);
    count(state, layer, bytes);
}
BENCHMARK(with_libdeflate)->ArgsProduct({{0, 2, 4}, {1, 6}})->Unit(benchmark::kMillisecond);
#endif

BENCHMARK(ours)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(match_only)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(adler_only)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(digest_only)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(with_libpng)->ArgsProduct({{0, 1, 2, 3, 4}, {1, 6}})->Unit(benchmark::kMillisecond);

}  // namespace
