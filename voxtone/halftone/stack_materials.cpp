// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/stack_materials.h"

#include <fmt/format.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/optics/resin_profile.h"

namespace voxtone::halftone {

StackMaterial resin_material(const optics::ResinSet& set, std::size_t resin, double known_mm, const optics::HankelGrid& grid,
                             const optics::LayerPathOptions& options, const Progress* progress) {
    VOXTONE_EXPECT(resin < set.resins.size() && known_mm > 0);
    StackMaterial material;
    for (std::size_t c = 0; c < set.channels.size(); ++c)
        material.push_back(
            optics::resin_profile(set.resins[resin].medium(c), set.g, known_mm, grid, options, progress).layer());
    return material;
}

MeasuredMaterial measured_material(const std::string& name, std::span<const optics::MeasuredProfile> by_channel,
                                   const optics::HankelGrid& grid) {
    MeasuredMaterial made;
    for (std::size_t c = 0; c < by_channel.size(); ++c) try {
            made.material.push_back(optics::measured_layer(by_channel[c], grid, made.summary.emplace_back()));
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}, channel {}: {}", name, c + 1, error.what()));
        }
    return made;
}

}  // namespace voxtone::halftone
