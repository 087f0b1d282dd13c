// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mixtures of resins as text: "C:10+W:90", shares in percent.
#pragma once

#include <string>
#include <string_view>

#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

/// "C:10+W:90" and back. Throws InputError.
[[nodiscard]] PatchMixture parse_mixture(std::string_view text);
[[nodiscard]] std::string mixture_text(const PatchMixture& mixture);

/// "C:10+W:90 on K", "C:10+W:90" where it is thick, "Y 0.08, W 0.8" of a laminate, for messages.
[[nodiscard]] std::string patch_name(const Patch& patch);

/// As tables name it in the place of a base: "light" from all sides, or a "beam".
[[nodiscard]] std::string light_name(optics::LightThrough light);

/// Throws InputError unless `role` can be one; `whole` is shown.
void check_role(std::string_view role, std::string_view whole);

}  // namespace voxtone::calibration
