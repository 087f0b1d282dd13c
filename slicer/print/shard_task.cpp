// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/shard_task.h"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include <fmt/core.h>

#include "base/error.h"
#include "io/shards/shard_folder.h"

namespace voxtone::slicer {

namespace {

std::optional<std::uint32_t> environment_number(const char* name) {
    const char* const text = std::getenv(name);
    if (!text) return std::nullopt;
    const std::string_view digits = text;
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size())
        throw UsageError(fmt::format("--shard: {} is '{}', which is no number", name, digits));
    return value;
}

/// How the shards that are there are numbered; nothing where they do not say.
std::optional<ShardTask> numbering_in(const std::filesystem::path& out) {
    if (out.empty()) return std::nullopt;
    const std::vector<io::ShardNumber> numbers = io::shards_in(out);
    for (const io::ShardNumber& number : numbers) {
        if (number.of != numbers.front().of) return std::nullopt;
        try {
            return ShardTask{{1, number.of}, io::read_shard(io::shard_file(out, number)).first_task};
        } catch (const Error&) {
            // `merge` says what is wrong with it.
        }
    }
    return std::nullopt;
}

}  // namespace

ShardTask task_of_scheduler(const std::filesystem::path& shards) {
    const auto id = environment_number("SLURM_ARRAY_TASK_ID"), count = environment_number("SLURM_ARRAY_TASK_COUNT"),
               first = environment_number("SLURM_ARRAY_TASK_MIN"), last = environment_number("SLURM_ARRAY_TASK_MAX");
    if (!id || !count || *count == 0)
        throw UsageError(
            "--shard: this is no task of a Slurm array (SLURM_ARRAY_TASK_ID and SLURM_ARRAY_TASK_COUNT are not set): "
            "say which part of how many, such as --shard 3/16");
    if (const auto before = numbering_in(shards); before && before->number.of != *count) {
        const std::uint32_t shard = *id - before->first_task + 1;
        if (*id >= before->first_task && shard <= before->number.of)
            return {{shard, before->number.of}, before->first_task};
    }
    const std::uint32_t begin = first.value_or(1), end = last.value_or(begin + *count - 1);
    if (*id < begin || *id > end || end - begin + 1 != *count)
        throw UsageError(fmt::format(
            "--shard: task {} of an array of {} from {} to {} cannot be numbered: its tasks are not in one row; number "
            "them 1 to N, or say which part of how many: --shard {}/N",
            *id, *count, begin, end, *id));
    return {{*id - begin + 1, *count}, begin};
}

}  // namespace voxtone::slicer
