// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that people give for models and pictures and that are neither: CAD, scenes of other programs, archives, scans,
// drawings, web pages that a server sent instead. What they are is told by their first bytes where these say it, else
// by their names; marks are compared, nothing is parsed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace voxtone::io {

enum class Wanted : std::uint8_t { model_or_picture, picture, texture };  ///< no texture is an SVG drawing

/// One sentence, without its end: what the file is and what to do with it; empty where it may be what is wanted. A
/// model under the name of another kind, or of none, is told too, since models are read by their names. Of a file that
/// is not there its name is looked at. Throws nothing.
[[nodiscard]] std::string foreign_kind(const std::filesystem::path& file, Wanted wanted = Wanted::model_or_picture);

/// The same of a file's beginning (the first `kind_bytes` of it, or all) and its size.
[[nodiscard]] std::string foreign_kind(const std::string& name, std::span<const std::byte> beginning,
                                       std::uintmax_t size, Wanted wanted);
inline constexpr std::size_t kind_bytes = 4096;

}  // namespace voxtone::io
