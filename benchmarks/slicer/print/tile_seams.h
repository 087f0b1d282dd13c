// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is lost where a body is cut into tiles: the loop's predictor asked for the same prints as a whole and in tiles.
#pragma once

#include <filesystem>
#include <string>

namespace voxtone::loop_benchmark {

/// A table: CIEDE2000 between both, media-relative, of all cells and of those within 1 mm of a cut: of a first
/// prediction of the stack in the folder, of the next ones, and of the same body all of white after it, a harder change
/// than any that a loop makes.
[[nodiscard]] std::string tile_seams(const std::filesystem::path& stack, std::size_t tile_cells);

}  // namespace voxtone::loop_benchmark
