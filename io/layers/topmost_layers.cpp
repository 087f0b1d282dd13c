// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/topmost_layers.h"

#include <algorithm>

#include "base/contracts.h"
#include "io/files/xxh64.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::io {

TopmostLayers::TopmostLayers(std::uint32_t width_px, std::uint32_t height_px)
    : width_px_(width_px),
      height_px_(height_px),
      rows_of_stripe_((height_px + stripes - 1) / stripes),
      indices_(std::size_t{width_px} * height_px, 0),
      locks_(std::make_unique<std::array<std::mutex, stripes>>()) {
    VOXTONE_EXPECT(width_px >= 1 && height_px >= 1);
}

bool TopmostLayers::fits(const LayerRuns& layer) const {
    return layer.width_px() == width_px_ && layer.height_px() == height_px_ && layer.rows() == height_px_;
}

void TopmostLayers::add(std::uint32_t index, const LayerRuns& layer) {
    VOXTONE_EXPECT(index < most_layers && fits(layer));
    const auto top = static_cast<std::uint16_t>(index);
    for (std::uint32_t begin = 0; begin < height_px_; begin += rows_of_stripe_) {
        const std::lock_guard lock((*locks_)[begin / rows_of_stripe_]);
        for (std::uint32_t y = begin; y < std::min(height_px_, begin + rows_of_stripe_); ++y) {
            std::uint16_t* column = indices_.data() + std::size_t{y} * width_px_;
            for (const Run run : layer.row(y)) {
                if (run.material != background)
                    for (std::uint32_t x = 0; x < run.length; ++x) column[x] = std::max(column[x], top);
                column += run.length;
            }
        }
    }
}

void TopmostLayers::raise(std::span<const std::uint16_t> indices) {
    VOXTONE_EXPECT(indices.size() == indices_.size());
    for (std::size_t p = 0; p < indices_.size(); ++p) indices_[p] = std::max(indices_[p], indices[p]);
}

std::vector<std::uint8_t> TopmostLayers::png() const { return grey16_png_bytes(width_px_, height_px_, indices_); }

std::uint64_t TopmostLayers::digest() const { return topmost_digest(indices_); }

std::uint64_t topmost_digest(std::span<const std::uint16_t> indices) {
    constexpr std::size_t at_once = 4096;
    std::array<std::uint8_t, 2 * at_once> bytes;
    Xxh64 digest;
    for (std::size_t begin = 0; begin < indices.size(); begin += at_once) {
        const auto some = indices.subspan(begin, std::min(at_once, indices.size() - begin));
        for (std::size_t i = 0; i < some.size(); ++i) {
            bytes[2 * i] = static_cast<std::uint8_t>(some[i] & 0xff);
            bytes[2 * i + 1] = static_cast<std::uint8_t>(some[i] >> 8);
        }
        digest.update(bytes.data(), 2 * some.size());
    }
    return digest.digest();
}

}  // namespace voxtone::io
