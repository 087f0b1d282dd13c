// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where shards of one job put their layers, several at once, on several hosts that share a file system:
//   OUT/shards/0003-of-0016.json       the record of shard 3, published last: without it there is no shard 3
//   OUT/shards/job.json                the job, as the merged stack will have it beside its layers
//   OUT/shards/IDENTITY.prepared       the body as the first shard prepared it, for the others
//   OUT/shards/IDENTITY/layers/        layers of all shards, and resins/; IDENTITY: 16 digits of the job's
//   OUT/shards/IDENTITY/whole/         what is made of all layers together: 0003-of-0016.png, the topmost layers of
//   each
//                                      column as shard 3 knows them, and for a GCVF its preview
//   OUT/shards/.0003-of-0016.HOST.MAKER.part/   where a shard that runs makes its layers, under a lock of its own
// An old stack in OUT stays untouched until `merge` (merged_stack.h). The same shard made twice, also at once, gives
// the same files under the same names: whoever renames last changes nothing.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/shards/shard_record.h"

namespace voxtone::io {

[[nodiscard]] std::filesystem::path shards_folder(const std::filesystem::path& out);
[[nodiscard]] std::filesystem::path shard_file(const std::filesystem::path& out, const ShardNumber& number);
/// The folder under OUT/shards that layers of this job lie in.
[[nodiscard]] std::string shard_store(std::string_view job);

/// What shards of this job keep for one another until they are merged.
[[nodiscard]] std::filesystem::path prepared_file(const std::filesystem::path& out, std::string_view job);

/// Under that folder: the topmost layers as a shard knows them, and a GCVF's preview, which all shards know alike.
[[nodiscard]] std::filesystem::path shard_topmost_name(const ShardNumber& number);
inline constexpr std::string_view whole_folder_name = "whole", preview_mesh_name = "Mesh.stl",
                                  preview_box_name = "MeshBbx.ktn";

/// Numbers of the records that are there, by name; other files are passed over.
[[nodiscard]] std::vector<ShardNumber> shards_in(const std::filesystem::path& out);
/// The first file of a record that is not under `stack`, or of another size; nothing: all are there.
[[nodiscard]] std::optional<std::filesystem::path> missing_file(const ShardRecord& record,
                                                                const std::filesystem::path& stack);
/// Removes all that shards have published in `out`. Throws FileError.
void remove_shards(const std::filesystem::path& out);
/// Removes what killed shards left half made.
void sweep_shards(const std::filesystem::path& out);

class ShardFolder {
public:
    /// Makes OUT/shards and a folder in it for layers. Throws InputError where OUT is no folder, FileError where the
    /// system refuses or a link leads elsewhere.
    ShardFolder(std::filesystem::path out, const ShardNumber& number);
    ShardFolder(const ShardFolder&) = delete;
    ShardFolder& operator=(const ShardFolder&) = delete;
    /// Without `publish` nothing is left.
    ~ShardFolder();

    /// Where the layers are made.
    [[nodiscard]] const std::filesystem::path& staging() const;
    /// Says whose the folder is, before there is a shard; `job_file`: text of the job file.
    void claim(std::string_view job_file);
    /// Moves the layers to their place and publishes the record. Throws FileError, TryAgain.
    void publish(const ShardRecord& record);

private:
    struct Held;
    std::unique_ptr<Held> held_;
};

}  // namespace voxtone::io
