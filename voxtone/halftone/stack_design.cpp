// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/stack_design.h"

#include "voxtone/base/contracts.h"
#include "voxtone/halftone/stack_refinement.h"
#include "voxtone/halftone/whole_layers.h"
#include "voxtone/optics/surfaced_reflection.h"

namespace voxtone::halftone {
namespace {

template <class Map>
ChannelProfiles mapped(ChannelProfiles profiles, Map&& map) {
    for (auto& channel : profiles)
        for (double& value : channel) value = map(value);
    return profiles;
}

// wanted + modelled - judged
ChannelProfiles corrected(ChannelProfiles wanted, const ChannelProfiles& modelled, const ChannelProfiles& judged) {
    for (std::size_t c = 0; c < wanted.size(); ++c)
        for (std::size_t i = 0; i < wanted[c].size(); ++i) wanted[c][i] += modelled[c][i] - judged[c][i];
    return wanted;
}

std::vector<StackLayer> to_print(const FoundStack& found, std::span<const StackMaterial> materials,
                                 const ChannelProfiles& target, const StackDesignOptions& options) {
    std::vector<StackLayer> layers = found.layers;
    if (options.refine) layers = refine_stack(materials, layers, target, options.search).layers;
    if (options.layer_mm > 0) layers = whole_layers(layers, options.layer_mm, options.search.clear_top_mm);
    return layers;
}

}  // namespace

StackDesign design_stack(const StackSearch& search, std::span<const StackMaterial> materials,
                         const ChannelProfiles& wanted, const StackDesignOptions& options, const StackJudge& judge) {
    VOXTONE_EXPECT(options.turned_back >= 0 && options.turned_back < 1 && options.rounds >= 1);
    const auto behind = [s = options.turned_back](double seen) { return optics::behind_surface(seen, s); };
    const auto seen = [s = options.turned_back](double R) { return optics::seen_through_surface(R, s); };
    const ChannelProfiles wanted_behind = mapped(wanted, behind);
    ChannelProfiles target = wanted_behind;
    StackDesign best;
    std::vector<double> judged_by_round;
    double outside = 0;
    for (int round = 0; round < (judge ? options.rounds : 1); ++round) {
        StackDesign next;
        next.round = round;
        next.found = search.find(target);
        if (round == 0) outside = next.found.outside;
        next.layers = to_print(next.found, materials, target, options);
        const ChannelProfiles within = stack_reflection(materials, next.layers, options.search.backing);
        next.modelled = mapped(within, seen);
        next.modelled_distance = profile_distance(next.modelled, wanted, options.search.dc_weight);
        if (judge) {
            next.judged = judge(next.layers);
            next.judged_distance = profile_distance(next.judged, wanted, options.search.dc_weight);
            judged_by_round.push_back(next.judged_distance);
            target = corrected(wanted_behind, within, mapped(next.judged, behind));
        }
        if (round == 0 || next.judged_distance < best.judged_distance) best = std::move(next);
    }
    best.outside = outside;
    best.judged_by_round = std::move(judged_by_round);
    return best;
}

}  // namespace voxtone::halftone
