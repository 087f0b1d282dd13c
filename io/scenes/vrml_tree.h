// SPDX-License-Identifier: GPL-3.0-or-later
//
// The nodes of a VRML97 file (ISO/IEC 14772-1:1997, annex A): types, fields, values; what they mean is parse_vrml.h's.
// A field is known by its name alone, and what stands behind it by how it looks, so that nodes of any type are read.
// Nodes lie in one array; where USE names one again it is the same entry, and none is part of itself. What declares
// prototypes is passed over, as routes and the interface of scripts are.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

struct VrmlField {
    std::string_view name;
    std::vector<double> numbers;  ///< TRUE is 1, FALSE 0
    std::vector<std::string> strings;
    std::vector<std::uint32_t> nodes;
};

struct VrmlNode {
    std::string_view type, name;  ///< name: behind DEF; empty: none
    std::size_t line = 0;
    std::vector<VrmlField> fields;

    /// The last of that name; null: there is none.
    [[nodiscard]] const VrmlField* field(std::string_view wanted) const;
    [[nodiscard]] double number(std::string_view wanted, double otherwise) const;
    /// Empty where it is not there.
    [[nodiscard]] const std::vector<double>& numbers(std::string_view wanted) const;
};

struct VrmlScene {
    std::vector<VrmlNode> nodes;
    std::vector<std::uint32_t> roots;

    /// What stands first in a field of nodes; null: nothing.
    [[nodiscard]] const VrmlNode* node(const VrmlNode& parent, std::string_view field) const;
};

/// Deeper nested files are refused.
inline constexpr int most_vrml_levels = 400;

/// `text` is pointed into. Throws InputError, which begins with `file` and the line; for a node of a prototype, too.
[[nodiscard]] VrmlScene read_vrml(std::string_view text, const std::string& file);

}  // namespace voxtone::io
