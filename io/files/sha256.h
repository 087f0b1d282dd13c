// SPDX-License-Identifier: GPL-3.0-or-later
//
// SHA-256 (FIPS 180-4) of nettle, for digests that are written into files.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace voxtone::io {

class Sha256 {
public:
    Sha256();
    ~Sha256();
    void update(std::span<const std::uint8_t> bytes);
    /// The digest of all that was given; 64 lower-case hexadecimal digits. Once.
    [[nodiscard]] std::string finish();

private:
    struct Context;
    std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string sha256(std::span<const std::uint8_t> bytes);

}  // namespace voxtone::io
