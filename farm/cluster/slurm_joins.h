// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job of Slurm's waits for others by their numbers, all in one word of sbatch, and Linux gives one word 128 KiB. Of
// many jobs each thousand is joined in a job of its own, which has nothing to do, and that is waited for in their
// place.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace voxtone::farm {

inline constexpr std::size_t most_dependencies = 1000;

/// Numbers that stand for all of these, `most_dependencies` of them at most. `join(some)` submits a job that waits for
/// those, and gives back its number.
[[nodiscard]] inline std::vector<std::string> joined(
    std::vector<std::string> numbers, const std::function<std::string(std::span<const std::string>)>& join) {
    while (numbers.size() > most_dependencies) {
        std::vector<std::string> joins;
        for (std::size_t begin = 0; begin < numbers.size(); begin += most_dependencies) {
            const std::size_t count = std::min(most_dependencies, numbers.size() - begin);
            joins.push_back(join(std::span(numbers).subspan(begin, count)));
        }
        numbers = std::move(joins);
    }
    return numbers;
}

}  // namespace voxtone::farm
