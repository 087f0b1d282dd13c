// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/laminate/laminate_options.h"

namespace voxtone::cli {

void add_laminate_resins_option(Verb& command, std::string& resins) {
    add_resins_option(command, resins, "; empty: that of the laminate file, else vero-opaque");
}

void add_named_laminate_options(Verb& command, scattering::NamedLaminateOptions& options) {
    add_laminate_resins_option(command, options.resins);
    command.add("--surface", options.surface, "on top: air, matched, auto; empty: as the laminate file says, else auto",
                {.unit = "WHAT"});
    command.add("--backing", options.backing,
                "below: black, white, air, or a profile file; empty: as the laminate file says, else black",
                {.unit = "WHAT"});
}

void add_detail_options(Verb& command, double& reach_mm, std::uint32_t& coefficients) {
    command.add("--reach", length(reach_mm), "radius of the disc that coefficients belong to, and of the profiles");
    command.add("--coefficients", coefficients, "per channel, from 4 to 1024; detail is reach / N");
}

void add_tracing_options(Verb& command, std::uint32_t& paths, std::uint64_t& seed) {
    command.add("--paths", paths, "per traced layer or laminate, and channel");
    command.add("--seed", seed, "seed of traced light");
}

}  // namespace voxtone::cli
