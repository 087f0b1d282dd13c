// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/ready_component.h"

#include <cctype>
#include <numeric>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"

namespace voxtone::slicer {

namespace {

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace

std::uint64_t ReadyComponent::all_voxels() const {
    return std::accumulate(voxels.begin(), voxels.end(), std::uint64_t{0});
}

std::optional<std::size_t> loaded_resin(const LoadedResins& resins, const std::string& name) {
    for (std::size_t r = 0; r < resins.entries.size(); ++r)
        if (lower(resins.entries[r].name) == lower(name) || lower(resins.set.resins[r].name) == lower(name)) return r;
    for (std::size_t r = 0; r < resins.entries.size(); ++r)
        if (lower(resins.entries[r].role) == lower(name)) return r;
    return std::nullopt;
}

void refuse_resin(const std::string& name, const LoadedResins& resins) {
    std::vector<std::string> loaded, roles;
    for (const io::StackResin& entry : resins.entries)
        loaded.push_back(fmt::format("{} ({})", entry.name, entry.role)), roles.push_back(entry.role);
    throw InputError(
        fmt::format("is of {}, which is not loaded: loaded are {}; say \"load\" beside \"parts\" (or --load {}) with "
                    "its role, if the "
                    "printer has room for it",
                    name, fmt::join(loaded, ", "), fmt::join(roles, ",")));
}

}  // namespace voxtone::slicer
