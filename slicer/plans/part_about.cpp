// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/part_about.h"

#include <algorithm>
#include <filesystem>

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

std::string name_for(const std::string& name, const std::string& customer) {
    return customer.empty() ? name : fmt::format("{} (for {})", name, customer);
}

std::string fault_at_place(const TrayPart& part, const std::string& fault) {
    if (fault.find(part.place) != std::string::npos) return fault;
    const std::string& file = part.component ? part.component->path : part.options.model;
    const std::string name = std::filesystem::path(file).filename().string();
    const bool named = name.empty() || part.place.ends_with(name) || fault.find(name) != std::string::npos;
    return fmt::format("{}{}: {}", part.place, named ? "" : ": " + name, fault);
}

}  // namespace voxtone::slicer
