// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much is printed and how large it is, from the bitmaps of a stack and what manifest.json says of them, read by
// nothing of the program's.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace voxtone::test {

struct StackVoxels {
    std::uint64_t solid = 0;          ///< voxels of any resin
    std::array<double, 3> size_mm{};  ///< of the box around them: columns, rows, layers
    double volume_mm3 = 0;
    /// Share of each resin, by role, among the uppermost voxels of the middle fifth of columns and rows.
    std::map<std::string, double> top;
};

/// Of OUT. Throws std::runtime_error.
[[nodiscard]] StackVoxels stack_voxels(const std::filesystem::path& folder);

}  // namespace voxtone::test
