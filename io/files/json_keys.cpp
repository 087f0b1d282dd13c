// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/json_keys.h"

#include <algorithm>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace voxtone::io {

namespace {

/// Optimal string alignment: insertions, deletions, replacements and swaps of neighbours cost 1 each.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before_last.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
    }
    return row[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
    constexpr std::size_t longest = 200;  // a longer name is no slip of the keyboard
    std::string nearest;
    if (name.size() > longest) return nearest;
    std::size_t smallest = longest;
    for (const std::string& candidate : known) {
        const bool one_begins_the_other =
            name.size() >= 3 && (candidate.starts_with(name) || name.starts_with(candidate));
        const std::size_t distance = one_begins_the_other ? 1 : edit_distance(name, candidate);
        // More than that of the shorter word written otherwise, it is another word.
        const std::size_t most = std::max<std::size_t>(1, 2 * std::min(name.size(), candidate.size()) / 5);
        if (distance <= most && distance < smallest) {
            smallest = distance;
            nearest = candidate;
        }
    }
    return nearest;
}

std::string unknown_key_message(std::string_view key, std::span<const std::string> known) {
    constexpr std::size_t shown = 80;
    const std::string name = key.size() > shown ? std::string(key.substr(0, shown)) + "..." : std::string(key);
    const std::string nearest = nearest_name(key, known);
    if (!nearest.empty()) return fmt::format("unknown key '{}'; did you mean '{}'?", name, nearest);
    return fmt::format("unknown key '{}'; known keys are {}", name, fmt::join(known, ", "));
}

}  // namespace voxtone::io
