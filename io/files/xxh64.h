// SPDX-License-Identifier: GPL-3.0-or-later
//
// XXH64 (xxHash specification 0.1.1, 64 bits, seed 0) of libxxhash: tells one job's data from another's and sees
// corruption, at the speed of memory; no protection against someone who wants two contents of one digest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace voxtone::io {

[[nodiscard]] std::uint64_t xxh64(std::span<const std::uint8_t> bytes);

/// The same, piece by piece.
class Xxh64 {
public:
    Xxh64();
    ~Xxh64();
    void update(const void* data, std::size_t size);
    /// Of all that was given so far.
    [[nodiscard]] std::uint64_t digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace voxtone::io
