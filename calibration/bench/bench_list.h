// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which photograph shows what, as a CSV beside the photographs; lines that begin with # are comments:
//
//   file,shows,resin,thickness_mm
//   checker.tif,checker,,
//   paper.tif,paper,,              a white sheet over all of the picture: tells how even the light is
//   sheet.tif,sheet,,              the printed edge without a slab
//   W-0.5-1.tif,slab,W,0.5         two or more photographs of one slab are joined
//
// Files are named relative to the list.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::calibration {

struct SlabPhotograph {
    std::string file, resin;
    double thickness_mm = 0;
};

struct BenchList {
    std::string checker, paper, sheet;  ///< paper: empty where there is none
    std::vector<SlabPhotograph> slabs;  ///< those of one slab beside each other
};

/// Throws InputError that names file, line and column.
[[nodiscard]] BenchList parse_bench_list(std::string_view text, const std::string& source);
/// Its files with the list's folder before them. Throws FileError, InputError.
[[nodiscard]] BenchList read_bench_list(const std::filesystem::path& file);
[[nodiscard]] std::string bench_list_text(const BenchList& list);

}  // namespace voxtone::calibration
