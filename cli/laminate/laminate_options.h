// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that the steps of `voxtone laminate` share: what a laminate borders on, how finely its light is told, how it
// is traced.
#pragma once

#include <cstdint>
#include <string>

#include "cli/program/common_options.h"
#include "scattering/jobs/named_laminate.h"

namespace voxtone::cli {

/// --resins of a laminate that may name its own.
void add_laminate_resins_option(Verb& command, std::string& resins);
/// --surface, --backing of such a laminate, and --resins.
void add_named_laminate_options(Verb& command, scattering::NamedLaminateOptions& options);
/// --reach, --coefficients.
void add_detail_options(Verb& command, double& reach_mm, std::uint32_t& coefficients);
/// --paths, --seed.
void add_tracing_options(Verb& command, std::uint32_t& paths, std::uint64_t& seed);

}  // namespace voxtone::cli
