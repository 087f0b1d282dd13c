// SPDX-License-Identifier: GPL-3.0-or-later
//
// What constants may be fitted on, and what judges them: benchmarks/sets.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::benchmarks {

struct SetEntry {
    std::string name;
    std::filesystem::path file;  ///< in the folder of models
    bool held_out = false;       ///< nothing was chosen by looking at it
    double size_mm = 0;          ///< of a body: its longest extent
};

/// Throws InputError where the file is not as it should be.
[[nodiscard]] std::vector<SetEntry> pictures();
[[nodiscard]] std::vector<SetEntry> bodies();

/// Of a page that a benchmark draws itself. Throws InputError for one that is not named.
[[nodiscard]] bool is_held_out_page(const std::string& name);

}  // namespace voxtone::benchmarks
