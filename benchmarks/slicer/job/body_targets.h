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
};

/// spot and fox at 60 mm, ycb_banana at 100 mm, and sword at 100 mm (its blade is 0.3 to 0.6 mm thick), which has no
/// colours: a checker of 1.5 mm is projected along x, written into the work folder.
[[nodiscard]] std::vector<BodyTarget> body_targets(const std::filesystem::path& models,
                                                   const std::filesystem::path& work, const std::string& only,
                                                   std::vector<std::string>& missing);

}  // namespace voxtone::loop_benchmark
