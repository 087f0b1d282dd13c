// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/part_about.h"

#include <algorithm>

#include <fmt/core.h>

#include "slicer/options/mark_words.h"

namespace voxtone::slicer {

std::string about_part(const TrayPart& part) {
    std::string about;
    const auto add = [&](const std::string& text) { about += (about.empty() ? "" : "; ") + text; };
    for (const auto& [name, value] : part.values) add(name + " " + value);
    for (const std::string& label : part.options.labels)
        for (const auto& [key, value] : split_mark(MarkFamily::label, label)) {
            if (!is_mark_subject(key) || key == "file") continue;
            std::string line = value;
            std::ranges::replace(line, '\n', ' ');
            add(fmt::format("{} \"{}\"", key == "text" ? "label" : key, line));
        }
    return about;
}

std::string customer_of(const TrayPart& part) {
    for (const auto& [name, value] : part.values)
        if (name == "customer") return value;
    return {};
}

}  // namespace voxtone::slicer
