// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a shard says of the layers that it made: OUT/shards/0003-of-0016.json (data/schema/shard.schema.json is its
// schema). A stack is merged from these records without another look at a bitmap: they hold every layer's digest, the
// size of every file, and what the report needs. The last key, `shard_sha256`, is the SHA-256 of the text without it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/layers/layer_stack_writer.h"
#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "io/report/viewer.h"
#include "io/shards/shard_number.h"

namespace voxtone::io {

/// What was measured and counted while the layers were made. Seconds of the parts are summed over threads.
struct ShardFigures {
    std::uint64_t body_voxels = 0, shell_voxels = 0, thin_voxels = 0;
    double solid_s = 0, shell_s = 0, colour_s = 0, screen_s = 0, runs_s = 0, encode_s = 0;
    double layers_s = 0, total_s = 0;  ///< by the clock
    std::uint64_t peak_memory_bytes = 0;
};

struct ShardRecord {
    ShardNumber number;
    std::uint32_t first_task = 1;  ///< number of shard 1 among a scheduler's tasks
    std::string program;           ///< "voxtone 0.2.0 build 0123456789abcdef": another build may make other bits
    std::string job;               ///< identity: SHA-256 of all that decides the stack
    std::string host;              ///< that made it
    StackDescription stack;        ///< of all shards together, as written; without contents
    ResinBitmaps resin_bitmaps = ResinBitmaps::none;
    bool gcvf = false, png = false;             ///< as StackOutputs has them
    std::uint64_t topmost_digest = 0;           ///< TopmostLayers::digest of its layers, counted as the stack does
    std::uint32_t first_layer = 0, layers = 0;  ///< number of the first one, as the stack counts; 0: an empty shard
    WrittenLayers written;
    ShardFigures figures;
    std::vector<ReportLayer> pictures;  ///< of layers, for the report
    ViewerLayers viewer;                ///< layers that the report's viewer may carry
};

[[nodiscard]] std::string shard_json(const ShardRecord& record);
/// Throws FileError where it cannot be read, InputError where it is none, or was changed since.
[[nodiscard]] ShardRecord read_shard(const std::filesystem::path& file);

}  // namespace voxtone::io
