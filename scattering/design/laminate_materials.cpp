// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_materials.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "optics/profiles/resin_profile.h"

namespace voxtone::scattering {

double fitting_known_mm(const optics::Medium& medium, double g, double most_mm) {
    VOXTONE_EXPECT(most_mm > 0);
    constexpr double free_paths = 1.6, least_mm = 0.1;
    const double most = 0.5 * most_mm, transport = medium.sigma_a + (1 - g) * medium.sigma_s;
    return transport * most <= free_paths ? most : std::min(most, std::max(least_mm, free_paths / transport));
}

LaminateMaterial resin_material(const optics::ResinSet& set, std::size_t resin, std::span<const double> known_mm,
                                const optics::HankelGrid& grid, const optics::LayerPathOptions& options,
                                const Progress* progress) {
    VOXTONE_EXPECT(resin < set.resins.size() && (known_mm.size() == 1 || known_mm.size() == set.channels.size()));
    LaminateMaterial material;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const double mm = known_mm[known_mm.size() == 1 ? 0 : c];
        material.push_back(
            optics::resin_profile(set.resins[resin].medium(c), set.g, mm, grid, options, progress).layer());
    }
    return material;
}

MeasuredMaterial measured_material(const std::string& name, std::span<const optics::MeasuredProfile> by_channel,
                                   const optics::HankelGrid& grid) {
    MeasuredMaterial made;
    for (std::size_t c = 0; c < by_channel.size(); ++c) {
        try {
            made.material.push_back(optics::measured_layer(by_channel[c], grid, made.summary.emplace_back()));
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}, channel {}: {}", name, c + 1, error.what()));
        }
    }
    return made;
}

}  // namespace voxtone::scattering
