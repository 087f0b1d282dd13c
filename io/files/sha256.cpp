// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/sha256.h"

#include <array>

#include <fmt/core.h>
#include <nettle/sha2.h>

namespace voxtone::io {

struct Sha256::Context {
    sha256_ctx state;
};

Sha256::Sha256() : context_(std::make_unique<Context>()) { sha256_init(&context_->state); }
Sha256::~Sha256() = default;

void Sha256::update(std::span<const std::uint8_t> bytes) {
    sha256_update(&context_->state, bytes.size(), bytes.data());
}

std::string Sha256::finish() {
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest;
    sha256_digest(&context_->state, digest.size(), digest.data());
    std::string hex;
    for (const std::uint8_t byte : digest) hex += fmt::format("{:02x}", byte);
    return hex;
}

std::string sha256(std::span<const std::uint8_t> bytes) {
    Sha256 digest;
    digest.update(bytes);
    return digest.finish();
}

}  // namespace voxtone::io
