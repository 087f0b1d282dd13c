// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace voxtone::io {

/// Which of how many, from 1.
struct ShardNumber {
    static constexpr std::uint32_t most = 100'000;
    std::uint32_t shard = 1, of = 1;
    friend bool operator==(const ShardNumber&, const ShardNumber&) = default;
};

/// "3/16", as users write it.
[[nodiscard]] std::string shard_text(const ShardNumber& number);
/// "0003-of-0016", as files are named.
[[nodiscard]] std::string shard_name(const ShardNumber& number);

}  // namespace voxtone::io
