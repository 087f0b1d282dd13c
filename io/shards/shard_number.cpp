// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shards/shard_number.h"

#include <fmt/core.h>

namespace voxtone::io {

std::string shard_text(const ShardNumber& number) { return fmt::format("{}/{}", number.shard, number.of); }

std::string shard_name(const ShardNumber& number) { return fmt::format("{:04}-of-{:04}", number.shard, number.of); }

}  // namespace voxtone::io
