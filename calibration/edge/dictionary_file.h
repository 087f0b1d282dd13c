// SPDX-License-Identifier: GPL-3.0-or-later
//
// A dictionary of edge profiles as a file (format "voxtone-edge-dictionary", version 1): a line of JSON (setup, grid,
// number of records), then the records, each by itself: index of the run, length, XXH64 of what follows, and kernels as
// 16-bit parts of their largest value, compressed. A file that was cut off, or is a shard, has fewer records; what is
// there is whole, or is told apart by its checksum.
//
// Rounding: 1.6e-5 of the largest value of a kernel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/edge/edge_dictionary.h"

namespace voxtone::calibration {

[[nodiscard]] std::vector<std::uint8_t> dictionary_header(const EdgeSetup& setup, const EdgeGrid& grid);
[[nodiscard]] std::vector<std::uint8_t> dictionary_record(std::size_t run, const EdgeRecord& record);

/// All records that are there and whole. `cut_off`: a file may end within a record, as one does that was being written;
/// else that is an InputError, as is what a checksum finds.
[[nodiscard]] EdgeDictionary read_dictionary(const std::filesystem::path& file, bool cut_off = false);
/// Header and records in the grid's order.
[[nodiscard]] std::vector<std::uint8_t> dictionary_bytes(const EdgeDictionary& dictionary);
/// Runs that have no record yet.
[[nodiscard]] std::vector<std::size_t> missing_runs(const EdgeDictionary& dictionary);

}  // namespace voxtone::calibration
