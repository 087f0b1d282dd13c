// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/labelled_copies.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/options/label_template.h"

namespace voxtone::slicer {

namespace {

std::string folder_name(const std::filesystem::path& out) {
    const std::filesystem::path path = out.lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
}

void fill_in(std::vector<std::string>& labels, const TemplateValues& values, const std::string& place) try {
    for (std::string& label : labels) label = with_values(label, values);
} catch (const UsageError& error) {
    throw InputError(fmt::format("{}: {}", place, error.what()));
}

}  // namespace

void label_copies(TrayPlan& plan) {
    std::vector<TrayPart> parts;
    for (TrayPart& part : plan.parts) {
        TemplateValues values = part.values;
        values.insert({"part", part.name});
        if (!plan.common.out.empty()) values.insert({"job", folder_name(plan.common.out)});
        const bool differ = part.copies > 1 && std::ranges::any_of(part.options.labels, [](const std::string& label) {
                                return names_value(label, "copy");
                            });
        for (int copy = 1; copy <= (differ ? part.copies : 1); ++copy) {
            TrayPart& one = parts.emplace_back(part);
            if (differ) {
                one.copies = 1;
                one.has_own_name = false;
                if (!part.at_mm.empty()) one.at_mm = {part.at_mm[std::size_t(copy - 1)]};
            }
            values.insert_or_assign("copy", fmt::format("{}", copy));
            fill_in(one.options.labels, values, part.place);
        }
        if (differ)
            plan.notes.push_back(
                fmt::format("{}: its {} copies have labels of their own, and so a loop each", part.name, part.copies));
    }
    plan.parts = std::move(parts);
}

}  // namespace voxtone::slicer
