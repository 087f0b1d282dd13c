// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Monte Carlo reference of a case: two independent halves, for the first cell of every group.
//
// How many paths a group gets is decided by a pilot of 1000 paths per channel, which is not used for anything else:
// from its standard errors the noise in CIEDE2000, and from that the paths that the wanted noise takes, in powers of
// two. Dark cells need more than light ones.
#pragma once

#include <memory>

#include "optics/scene/boundary.h"
#include "reference_file.h"

namespace voxtone::accuracy {

/// All cases of the suite, those of quick references first. `models`: the folder of the photographs; without it they
/// are left out.
[[nodiscard]] std::vector<SuiteCase> suite_cases(const std::filesystem::path& models);

/// `effort` multiplies the number of paths.
[[nodiscard]] Reference make_reference(SuiteCase c, std::uint64_t seed, double effort);

}  // namespace voxtone::accuracy
