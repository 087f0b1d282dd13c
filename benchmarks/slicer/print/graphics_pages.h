// SPDX-License-Identifier: GPL-3.0-or-later
//
// What bureaus print all day, drawn here: solids on white, on black and on grey, a logo, type, hairlines, QR
// and bar codes, a colour checker with thin gaps, a photograph with a border and a caption. Sizes in mm; half for
// fitting, half held out (benchmarks/sets.json, "pages").
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "targets.h"

namespace voxtone::loop_benchmark {

/// Writes the pages whose name contains `only`; a photograph that is not in the folder is left out and named in
/// `missing`.
[[nodiscard]] std::vector<Target> make_graphics(const std::filesystem::path& models, const std::filesystem::path& work,
                                                const std::string& only, std::vector<std::string>& missing);

}  // namespace voxtone::loop_benchmark
