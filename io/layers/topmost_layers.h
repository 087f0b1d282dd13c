// SPDX-License-Identifier: GPL-3.0-or-later
//
// The topmost filled layer of each column of a stack, as Zbuffer.png of a GCVF has it: 16-bit grey, as large as a
// layer, the index of the topmost layer with material, 0 where there is none (and where layer 0 alone has some: the
// form does not tell them apart). Memory: 2 bytes a pixel. The same for any order of the layers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "io/layers/layer_runs.h"

namespace voxtone::io {

class TopmostLayers {
public:
    /// The index of a layer is a number of 16 bits.
    static constexpr std::uint32_t most_layers = 65535;

    TopmostLayers(std::uint32_t width_px, std::uint32_t height_px);

    /// Whether it has the size of the layers.
    [[nodiscard]] bool fits(const LayerRuns& layer) const;
    /// Layer `index` in [0, most_layers) from the bottom; contract: it fits. From any thread.
    void add(std::uint32_t index, const LayerRuns& layer);

    /// What was seen of other layers. Contract: of as many pixels. Not while `see` runs.
    void raise(std::span<const std::uint16_t> indices);

    /// Rows from the top. Not while `see` runs, as all below.
    [[nodiscard]] std::span<const std::uint16_t> indices() const { return indices_; }
    [[nodiscard]] std::vector<std::uint8_t> png() const;
    /// See topmost_digest.
    [[nodiscard]] std::uint64_t digest() const;

private:
    static constexpr std::uint32_t stripes =
        64;  // of rows, each with a lock: layers that come together pass each other

    std::uint32_t width_px_, height_px_, rows_of_stripe_;
    std::vector<std::uint16_t> indices_;
    std::unique_ptr<std::array<std::mutex, stripes>> locks_;
};

/// XXH64 of the indices, low byte first.
[[nodiscard]] std::uint64_t topmost_digest(std::span<const std::uint16_t> indices);

}  // namespace voxtone::io
