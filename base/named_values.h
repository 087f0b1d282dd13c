// SPDX-License-Identifier: GPL-3.0-or-later
//
// The values of an enum and what users call them, in one table: options are parsed, listed and printed by it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone {

template <class Enum>
struct Named {
    Enum value;
    std::string_view name;
};

/// To be specialised: `static constexpr auto table = std::to_array<Named<Enum>>({...})`, every value once, in the order
/// in which users read them.
template <class Enum>
struct NamesOf;

/// Of a value in the table.
template <class Enum>
[[nodiscard]] constexpr std::string_view name_of(Enum value) {
    for (const Named<Enum>& entry : NamesOf<Enum>::table)
        if (entry.value == value) return entry.name;
    return {};
}

/// Nothing where nothing has this name.
template <class Enum>
[[nodiscard]] constexpr std::optional<Enum> value_of(std::string_view name) {
    for (const Named<Enum>& entry : NamesOf<Enum>::table)
        if (entry.name == name) return entry.value;
    return std::nullopt;
}

template <class Enum>
[[nodiscard]] std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const Named<Enum>& entry : NamesOf<Enum>::table) names.emplace_back(entry.name);
    return names;
}

template <class Enum>
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Enum>& values) {
    std::vector<std::string> names;
    for (const Enum value : values) names.emplace_back(name_of(value));
    return names;
}

}  // namespace voxtone
