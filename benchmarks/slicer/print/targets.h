// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is printed: photographs of the models folder (benchmarks/sets.json), and pages made here.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::loop_benchmark {

struct Target {
    std::string name;
    std::filesystem::path picture;  ///< PNG in the work folder
    double width_mm = 0, height_mm = 0;
    bool gratings = false;
    bool held_out = false;  ///< benchmarks/sets.h; of the pages made here, fine_print
};

struct Crop {
    double width_mm = 0, height_mm = 0;  ///< 0: the whole; else this much of the middle
};

/// Writes the pictures of those targets whose name contains `only`; photographs that are not in the folder are left out
/// and named in `missing`.
[[nodiscard]] std::vector<Target> make_targets(const std::filesystem::path& models, const std::filesystem::path& work,
                                               const std::string& only, const Crop& crop,
                                               std::vector<std::string>& missing);

}  // namespace voxtone::loop_benchmark
