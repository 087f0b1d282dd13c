// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bodies that are printed: of the models folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::loop_benchmark {

struct BodyTarget {
    std::string name;
    std::filesystem::path model;
    double size_mm = 0;
    bool held_out = false;
};

/// Those of benchmarks/sets.json. The sword has no colours: a checker of 1.5 mm is projected along x, written into the
/// work folder.
[[nodiscard]] std::vector<BodyTarget> body_targets(const std::filesystem::path& models,
                                                   const std::filesystem::path& work, const std::string& only,
                                                   std::vector<std::string>& missing);

}  // namespace voxtone::loop_benchmark
