// SPDX-License-Identifier: GPL-3.0-or-later
//
// FBX files put together, for the tests of their reader.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace voxtone::test {

/// A record: its values are written already (fbx_number and its like).
struct FbxRecord {
    std::string name;
    std::vector<std::string> values = {};
    std::vector<FbxRecord> children = {};
};

[[nodiscard]] std::string fbx_number(std::int64_t value);
[[nodiscard]] std::string fbx_number(double value);
[[nodiscard]] std::string fbx_text(const std::string& value);
/// Packed by zlib where `packed`.
[[nodiscard]] std::string fbx_reals(const std::vector<double>& values, bool packed = false);
[[nodiscard]] std::string fbx_indices(const std::vector<std::int32_t>& values, bool packed = false);
/// "P": a property of numbers, or of a text.
[[nodiscard]] FbxRecord fbx_property(const std::string& name, const std::vector<double>& values);
[[nodiscard]] FbxRecord fbx_word(const std::string& name, const std::string& value);
/// An object of a class, with properties and what it holds besides.
[[nodiscard]] FbxRecord fbx_object(const std::string& type, std::int64_t id, const std::string& name,
                                   const std::string& kind, const std::vector<FbxRecord>& properties,
                                   std::vector<FbxRecord> children = {});
/// "C": a child hangs on its parent, or on a property of it.
[[nodiscard]] FbxRecord fbx_link(std::int64_t child, std::int64_t parent, const std::string& property = "");

[[nodiscard]] std::string fbx_file(const std::vector<FbxRecord>& records, std::uint32_t version = 7400);
/// Settings, objects and connections, in a file of that version.
[[nodiscard]] std::string fbx_scene(const std::vector<FbxRecord>& settings, const std::vector<FbxRecord>& objects,
                                    const std::vector<FbxRecord>& links, std::uint32_t version = 7400);

}  // namespace voxtone::test
