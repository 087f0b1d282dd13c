// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/xxh64.h"

#define XXH_STATIC_LINKING_ONLY  // the size of a state
#include <xxhash.h>

namespace voxtone::io {

struct Xxh64::State {
    XXH64_state_t state;
};

std::uint64_t xxh64(std::span<const std::uint8_t> bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

Xxh64::Xxh64() : state_(std::make_unique<State>()) { XXH64_reset(&state_->state, 0); }
Xxh64::~Xxh64() = default;

void Xxh64::update(const void* data, std::size_t size) {
    if (size > 0) XXH64_update(&state_->state, data, size);
}

std::uint64_t Xxh64::digest() const { return XXH64_digest(&state_->state); }

}  // namespace voxtone::io
