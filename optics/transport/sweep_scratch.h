// SPDX-License-Identifier: GPL-3.0-or-later
//
// The memory that an iteration works in, 48 bytes a cell. Its two halves take 16 of them in turns.
//
//   sweep        `up`, `down`        phi and J of the light that runs up, and down
//   correction   `vector(0 .. 3)`    over `down`: the four vectors of the conjugate gradients
//   both         `equations`         of the corrections, made once for all of a channel
//
// What a half wrote is gone once the other half has written over it: the correction reads `down` before it writes a
// vector.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include "optics/transport/transport_sweep.h"
#include "optics/transport/viewing_diffusion.h"

namespace voxtone::optics {

class SweepScratch {
public:
    /// Room for so many cells, a multiple of 64. What it holds then is anything.
    void resize(std::size_t cells) {
        if (cells > room_) {
            for (Bytes& bytes : bytes_) bytes.reset();
            for (Bytes& bytes : bytes_) bytes = make(cells);
            room_ = cells;
        }
        cells_ = cells;
    }

    [[nodiscard]] std::span<Moments> up() { return {as<Moments>(bytes_[0]), cells_}; }
    [[nodiscard]] std::span<Moments> down() { return {as<Moments>(bytes_[1]), cells_}; }
    [[nodiscard]] std::span<BlockStencil<4>> equations() { return {as<BlockStencil<4>>(bytes_[2]), cells_ / 64}; }
    [[nodiscard]] std::span<float> vector(std::size_t i) { return {as<float>(bytes_[1]) + i * cells_, cells_}; }
    [[nodiscard]] std::size_t memory_bytes() const { return bytes_.size() * room_ * sizeof(Moments); }

private:
    static_assert(sizeof(BlockStencil<4>) == 64 * sizeof(Moments) && sizeof(Moments) == 4 * sizeof(float));
    static_assert(alignof(BlockStencil<4>) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);
    // Bytes, in which objects of all these plain types begin to live when they are written.
    using Bytes = std::unique_ptr<std::byte[]>;
    static Bytes make(std::size_t cells) {
        return std::make_unique_for_overwrite<std::byte[]>(cells * sizeof(Moments));
    }
    template <class T>
    static T* as(const Bytes& bytes) {
        return std::launder(reinterpret_cast<T*>(bytes.get()));
    }

    std::size_t cells_ = 0, room_ = 0;
    std::array<Bytes, 3> bytes_;
};

}  // namespace voxtone::optics
