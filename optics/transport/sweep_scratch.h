// SPDX-License-Identifier: GPL-3.0-or-later
//
// The memory that the two halves of an iteration take in turns, 32 bytes a cell.
//
//   sweep        `up`, `down`        phi and J of the light that runs up, and down
//   correction   `vector(0 .. 3)`    over `down`: the four vectors of the conjugate gradients
//                `equations`         over `up`
//
// What a half wrote is gone once the other half has written over it: the correction reads `down` before it writes a
// vector, and `up` before it makes the equations.
#pragma once

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
            first_.reset();
            second_.reset();
            first_ = make(cells);
            second_ = make(cells);
            room_ = cells;
        }
        cells_ = cells;
    }

    [[nodiscard]] std::span<Moments> up() { return {as<Moments>(first_), cells_}; }
    [[nodiscard]] std::span<Moments> down() { return {as<Moments>(second_), cells_}; }
    [[nodiscard]] std::span<BlockStencil<4>> equations() { return {as<BlockStencil<4>>(first_), cells_ / 64}; }
    [[nodiscard]] std::span<float> vector(std::size_t i) { return {as<float>(second_) + i * cells_, cells_}; }
    [[nodiscard]] std::size_t memory_bytes() const { return 2 * room_ * sizeof(Moments); }

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
    Bytes first_, second_;
};

}  // namespace voxtone::optics
