// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces of photographs, printed 20 mm wide, separated and screened as `slice` does it.
#pragma once

#include <filesystem>

#include "compare.h"
#include "suite_case.h"

namespace voxtone::accuracy {

/// Without those whose picture is not in the folder.
[[nodiscard]] std::vector<SuiteCase> photo_cases(const std::filesystem::path& models);

/// The colours that were asked for, per cell of the surface; empty for a case that is no photograph or lacks its
/// picture.
[[nodiscard]] std::vector<Rgb> photo_target(const std::filesystem::path& models, const std::string& name,
                                            const optics::Surface& surface);

}  // namespace voxtone::accuracy
