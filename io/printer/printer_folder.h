// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the printer's computer takes of a stack, and nothing else, with one page that says how to print it:
//   OUT/printer/HOW-TO-PRINT.html
//   OUT/printer/layers/slice_00000.png ...   or stack.gcvf, or resins/, by the formats that the job writes
// The files are those of the stack itself (hard links, so that they take no room twice), or copies where the file
// system has no links. The page carries the manifest, so that the folder can be verified alone, wherever it was copied.
//
// The same folder, one ZIP file of it, or its GCVF file alone may be put elsewhere too: whole or not there, like all
// that is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"

namespace voxtone::io {

inline constexpr std::string_view printer_folder_name = "printer", how_to_print_name = "HOW-TO-PRINT.html";
/// Of a stack, and of its printer's folder.
inline constexpr std::string_view layers_name = "layers", gcvf_name = "stack.gcvf", resin_folder_name = "resins";
inline constexpr std::uint64_t most_how_to_print_bytes = std::uint64_t{64} << 20;

/// Whether files of this folder can have a second name in it. Tries it.
[[nodiscard]] bool has_hard_links(const std::filesystem::path& folder);

/// Puts these files, which lie under `from`, into the folder `into` too, by the same names. Throws FileError, TryAgain,
/// Cancelled.
void link_files(const std::filesystem::path& from, std::span<const std::filesystem::path> files,
                const std::filesystem::path& into, const Progress* progress = nullptr);
/// The same, and the page.
void make_printer_folder(const std::filesystem::path& from, std::span<const std::filesystem::path> files,
                         const std::filesystem::path& into, std::string_view page, const Progress* progress = nullptr);

/// The manifest's text in a page, as `manifest_in_page` finds it: for the end of the page.
[[nodiscard]] std::string manifest_for_page(std::string_view manifest);
/// Nothing where the page has none.
[[nodiscard]] std::optional<std::string> manifest_in_page(std::string_view page);

/// Before time is spent: whether OUT/printer may be put to `target` (a folder, or a file whose name ends in .zip or
/// .gcvf). What is there already may be what `out` holds now; else with `overwrite` a printer's folder or file, and
/// never anything else. Throws InputError.
void expect_printer_target(const std::filesystem::path& out, const std::filesystem::path& target, bool overwrite);

/// Puts OUT/printer to `target`; false: it is there already. Throws as expect_printer_target, FileError, TryAgain,
/// Cancelled.
bool hand_to_printer(const std::filesystem::path& out, const std::filesystem::path& target, bool overwrite,
                     const Progress* progress);

}  // namespace voxtone::io
