// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of a layer stack: what of it is ours, and making it ready for a new one.
#pragma once

#include <filesystem>
#include <string_view>

namespace voxtone::io {

inline constexpr std::string_view manifest_name = "manifest.json";
/// Lies in the folder from the first file written to the manifest.
inline constexpr std::string_view unfinished_name = ".voxtone-unfinished";
inline constexpr std::string_view gcvf_name = "stack.gcvf";
inline constexpr std::string_view vdb_name = "volume.vdb";
inline constexpr std::string_view sheet_text_name = "resin-assignment.txt";
inline constexpr std::string_view sheet_page_name = "resin-assignment.html";
inline constexpr std::string_view resin_folder_name = "resins";

/// Whether `out` may be made a folder to write a stack into; changes nothing. Throws InputError for a folder with other
/// things than a stack of ours in it (unless `overwrite`), FileError where the system refuses, and where `out` or what
/// would be written in it is a link that leads elsewhere.
void require_usable_folder(const std::filesystem::path& out, bool overwrite);

/// Makes `out` a folder to write a stack into: created if it is not there; a stack of ours in it (whole or unfinished)
/// is removed, file by file, nothing else is. Refuses what `require_usable_folder` refuses.
void prepare_stack_folder(const std::filesystem::path& out, bool overwrite);

}  // namespace voxtone::io
