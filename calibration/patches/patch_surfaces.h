// SPDX-License-Identifier: GPL-3.0-or-later
//
// Surfaces that patches lie on and that were there before: paper, a tile, a card half white and half black. How they
// reflect bare says a row of the table, by the instrument that measured the patches and in their channels; how they
// take resin, its words:
//
//   bare:matt  bare:smooth  bare:mirror      and +gap where the squares lie on air (optics/layered/known_surface.h)
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/patches/patch_table.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

/// "matt", "smooth+gap"; throws InputError.
[[nodiscard]] optics::KnownSurface parse_surface_kind(std::string_view text);
[[nodiscard]] std::string surface_kind_text(const optics::KnownSurface& kind);
/// The same behind "bare:"; nothing where the text does not begin so.
[[nodiscard]] std::optional<optics::KnownSurface> bare_kind(std::string_view text);
[[nodiscard]] std::string bare_text(const optics::KnownSurface& kind);

/// Takes the bare rows from a table and lays patches on what they name. Throws InputError: a surface that is there
/// twice, or has the name of a resin.
void lay_on_surfaces(PatchTable& table);
/// The bare rows of a table's surfaces.
[[nodiscard]] std::vector<Patch> bare_patches(const PatchTable& table);
/// Surfaces belong to all patches on them: they are replaced.
void change_surfaces(PatchTable& table, const std::function<void(PatchSurface&)>& change);

/// The table with surfaces as they are in the set's channels: between wavelengths straight lines, R, G and B from
/// any. Throws InputError where the set knows more than the table does.
[[nodiscard]] PatchTable in_channels_of(const optics::ResinSet& set, PatchTable table);

}  // namespace voxtone::calibration
