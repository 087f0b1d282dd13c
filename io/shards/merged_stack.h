// SPDX-License-Identifier: GPL-3.0-or-later
//
// Shards of one job laid together to the stack that an unsharded job would have made, bit for bit, from their records:
// no bitmap is read. The layers move to their place by one rename of their folder, with the swap of stack_folder.h
// around it, so that a kill at any moment leaves the old stack and all shards, or the new stack.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_record.h"

namespace voxtone::io {

/// All shards of one job.
struct ShardSet {
    std::vector<ShardRecord> records;  ///< by number
    StackDescription stack;            ///< merged: with contents

    [[nodiscard]] const std::string& job() const { return records.front().job; }
};

/// Which shards there are known to be: by whoever waited for their makers.
struct KnownShards {
    std::uint32_t count = 0;  ///< 0: what lies in the folder is all that is known
    double patience_s = 60;   ///< for one that is not there yet
};

/// Reads the records in OUT/shards. Throws InputError where there is none, one is broken, one is missing (named as a
/// scheduler takes it: --array=3,7-9), they are of several jobs or versions, or do not tile the stack.
///
/// Where their number is known none is looked for in a listing, which a network file system may give as it was a minute
/// ago: each is opened by its name, which asks the server, and a late one is waited for. Then throws TryAgain for what
/// is still missing; Cancelled.
[[nodiscard]] ShardSet read_shards(const std::filesystem::path& out, const KnownShards& known = {},
                                   const Progress* progress = nullptr);

/// Whether OUT holds the stack of these shards already, every file in its size.
[[nodiscard]] bool is_merged(const std::filesystem::path& out, const ShardSet& shards);

/// Throws InputError where a file of a shard is not in OUT/shards, or of another size.
void expect_files(const std::filesystem::path& out, const ShardSet& shards);

/// Puts the stack in place, with its GCVF where the shards are of a job that asked for one, and with its printer's
/// folder where there is a page for it; the records stay. Throws InputError where what a shard knows of that is not
/// there, FileError, TryAgain, Cancelled.
void merge_shards(StackFolder& folder, const ShardSet& shards, std::string_view job_file,
                  const PageOfStack& how_to_print = {}, Progress* progress = nullptr);

/// Whether the stack was merged without a page, so that its printer's folder may still be made.
[[nodiscard]] bool waits_for_page(const std::filesystem::path& out, const ShardSet& shards);

/// The printer's folder of such a stack, whole or not there. Throws as merge_shards.
void add_printer_folder(const StackFolder& folder, const ShardSet& shards, const PageOfStack& how_to_print,
                        const Progress* progress = nullptr);

}  // namespace voxtone::io
