// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/decode_webp.h"

#include <algorithm>
#include <cstdint>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <webp/decode.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/decoders/picture_samples.h"
#include "io/decoders/webp_chunks.h"

namespace voxtone::io {

namespace {

using Bytes = std::span<const std::uint8_t>;

[[noreturn]] void fail(const std::string& name, VP8StatusCode status) {
    if (status == VP8_STATUS_OUT_OF_MEMORY) throw std::bad_alloc();
    throw InputError(
        fmt::format("the picture {} cannot be decoded; it is a WebP picture that is damaged or cut short", name));
}

void append(std::vector<std::uint8_t>& bytes, std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// A frame of an animation as a file of its own: libwebp takes no other where coverage stands beside colours.
std::vector<std::uint8_t> as_file(const WebpFrame& frame) {
    const auto name = [](std::vector<std::uint8_t>& bytes, const char* four) {
        bytes.insert(bytes.end(), four, four + 4);
    };
    constexpr std::uint32_t has_alpha = 0x10, head_bytes = 10;
    std::vector<std::uint8_t> file;
    file.reserve(frame.chunks.size() + 30);
    name(file, "RIFF");
    append(file, static_cast<std::uint32_t>(frame.chunks.size() + 22), 4);
    name(file, "WEBP");
    name(file, "VP8X");
    append(file, head_bytes, 4);
    append(file, has_alpha, 4);
    append(file, frame.width_px - 1, 3);
    append(file, frame.height_px - 1, 3);
    file.insert(file.end(), frame.chunks.begin(), frame.chunks.end());
    return file;
}

/// RGBA from the top, into `rgba` from pixel (0, 0) on, rows of `row_px`. `width_px` and `height_px`: what was declared
/// before, and memory was taken for.
void decode_into(Bytes file, std::uint32_t width_px, std::uint32_t height_px, std::uint8_t* rgba, std::size_t row_px,
                 const std::string& name) {
    WebPDecoderConfig config;
    if (!WebPInitDecoderConfig(&config)) fail(name, VP8_STATUS_INVALID_PARAM);
    if (const VP8StatusCode status = WebPGetFeatures(file.data(), file.size(), &config.input); status != VP8_STATUS_OK)
        fail(name, status);
    if (config.input.width != int(width_px) || config.input.height != int(height_px))
        fail(name, VP8_STATUS_BITSTREAM_ERROR);
    config.output.colorspace = MODE_RGBA;
    config.output.is_external_memory = 1;
    config.output.u.RGBA.rgba = rgba;
    config.output.u.RGBA.stride = int(4 * row_px);
    config.output.u.RGBA.size = 4 * (row_px * (height_px - 1) + width_px);
    const VP8StatusCode status = WebPDecode(file.data(), file.size(), &config);
    WebPFreeDecBuffer(&config.output);
    if (status != VP8_STATUS_OK) fail(name, status);
}

void read_still(Bytes file, PictureSamples& samples, const std::string& name, const DecodeOptions& options) {
    WebPBitstreamFeatures features;
    if (const VP8StatusCode status = WebPGetFeatures(file.data(), file.size(), &features); status != VP8_STATUS_OK)
        fail(name, status);
    samples.width_px = static_cast<std::uint32_t>(features.width);
    samples.height_px = static_cast<std::uint32_t>(features.height);
    check_picture_size(samples.width_px, samples.height_px, name, options);
    samples.bytes.resize(4 * samples.pixels());
    decode_into(file, samples.width_px, samples.height_px, samples.bytes.data(), samples.width_px, name);
}

void read_first_frame(const WebpFacts& facts, PictureSamples& samples, const std::string& name,
                      const DecodeOptions& options) {
    const WebpFrame& frame = facts.first;
    samples.width_px = facts.canvas_width_px;
    samples.height_px = facts.canvas_height_px;
    check_picture_size(samples.width_px, samples.height_px, name, options);
    if (frame.chunks.empty() || frame.width_px > samples.width_px || frame.height_px > samples.height_px ||
        frame.x_px > samples.width_px - frame.width_px || frame.y_px > samples.height_px - frame.height_px)
        fail(name, VP8_STATUS_BITSTREAM_ERROR);
    samples.bytes.resize(4 * samples.pixels());
    const std::size_t from = std::size_t{frame.y_px} * samples.width_px + frame.x_px;
    decode_into(as_file(frame), frame.width_px, frame.height_px, samples.bytes.data() + 4 * from, samples.width_px,
                name);
    samples.warnings.push_back(named_warning(
        "several-pictures", fmt::format("The picture {} is an animation; its first frame was taken.", name)));
}

}  // namespace

DecodedImage decode_webp(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    const Bytes file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    const WebpFacts facts = webp_facts(bytes);
    PictureSamples samples;
    if (facts.is_animation)
        read_first_frame(facts, samples, name, options);
    else
        read_still(file, samples, name, options);
    samples.icc_profile.assign(facts.icc_profile.begin(), facts.icc_profile.end());
    samples.orientation = facts.exif.orientation;
    samples.dpi_x = facts.exif.dpi_x;
    samples.dpi_y = facts.exif.dpi_y;
    return to_texels(std::move(samples), name, options);
}

}  // namespace voxtone::io
