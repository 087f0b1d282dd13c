// SPDX-License-Identifier: GPL-3.0-or-later
//
// Targets A, B and C (Iser, Rittig, Wilkie 2025, Sec. 3.5) as patch tables, and their measurement by the model itself
// with Gaussian noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "base/random.h"
#include "calibration/patches/patch_model.h"
#include "optics/media/resins.h"

namespace voxtone::calibration::testing {

/// Squares of layout 'A', 'B' or 'C' for these roles on a white and a black base; no values yet.
inline PatchTable target(char layout, const std::vector<std::string>& colours, const std::string& white = "W",
                         const std::string& black = "K", double base_mm = 0) {
    PatchTable table;
    table.source.assign(1, layout);
    const auto add = [&](const PatchMixture& top) {
        for (const std::string& backing : {white, black})
            table.patches.push_back({top, backing, 0.675, base_mm, {}, {}, {}});
    };
    const auto percent = [&](const std::string& role, double of, const std::string& rest) {
        add({{role, of / 100}, {rest, 1 - of / 100}});
    };
    add({{white, 1}}), add({{black, 1}});
    for (const auto& colour : colours) add({{colour, 1}});
    if (layout == 'A') return table;
    percent(black, 10, white), percent(black, 90, white);
    const std::vector<double> shares = layout == 'B' ? std::vector<double>{10} : std::vector<double>{5, 10, 25, 50};
    for (const auto& colour : colours)
        for (const double share : shares) percent(colour, share, white);
    return table;
}

/// A standard normal number at an address (Box, Muller 1958).
inline double normal(std::uint64_t seed, std::uint64_t address) {
    RandomStream random(seed, address, 17);
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
    return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

/// Fills in what the patches reflect if they are made of these resins.
inline void measure(PatchTable& table, const optics::ResinSet& truth, double noise, std::uint64_t seed,
                    PatchModelOptions options = {}) {
    options.g = truth.g, options.eta = truth.eta;
    table.channels = truth.channels;
    std::vector<std::string> roles;
    for (const auto& resin : truth.resins) roles.push_back(resin.role);
    const PatchModel model(table.patches, roles, options);
    for (Patch& patch : table.patches) patch.rho.clear();
    for (std::size_t c = 0; c < truth.channels.size(); ++c) {
        std::vector<optics::Medium> media;
        for (const auto& resin : truth.resins) media.push_back(resin.medium(c));
        const std::vector<double> rho = model.rho(media);
        for (std::size_t p = 0; p < rho.size(); ++p)
            table.patches[p].rho.push_back(rho[p] + noise * normal(seed, p * 1000 + c));
    }
}

}  // namespace voxtone::calibration::testing
