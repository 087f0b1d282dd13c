// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/laminate/laminate_options.h"

namespace voxtone::cli {

void add_laminate_resins_option(CLI::App& command, std::string& resins) {
    add_resins_option(command, resins, "; empty: that of the laminate file, else vero-opaque");
}

void add_named_laminate_options(CLI::App& command, scattering::NamedLaminateOptions& options) {
    add_laminate_resins_option(command, options.resins);
    command
        .add_option("--surface", options.surface,
                    "on top: air, matched, auto; empty: as the laminate file says, else auto")
        ->type_name("WHAT");
    command
        .add_option("--backing", options.backing,
                    "below: black, white, air, or a profile file; empty: as the laminate file says, else black")
        ->type_name("WHAT");
}

void add_detail_options(CLI::App& command, LengthOptions& lengths, double& reach_mm, std::uint32_t& coefficients) {
    lengths.add(command, "--reach", reach_mm, "radius of the disc that coefficients belong to, and of the profiles");
    add_count(command, "--coefficients", coefficients, "per channel, from 4 to 1024; detail is reach / N");
}

void add_tracing_options(CLI::App& command, std::uint32_t& paths, std::uint64_t& seed) {
    add_count(command, "--paths", paths, "per traced layer or laminate, and channel");
    add_seed_option(command, seed, "seed of traced light");
}

}  // namespace voxtone::cli
