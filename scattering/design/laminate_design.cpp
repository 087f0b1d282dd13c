// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_design.h"

#include "base/contracts.h"
#include "optics/profiles/saunderson.h"
#include "scattering/design/laminate_refinement.h"
#include "scattering/design/whole_layers.h"

namespace voxtone::scattering {
namespace {

template <class Map>
ChannelProfiles mapped(ChannelProfiles profiles, Map&& map) {
    for (auto& channel : profiles)
        for (double& value : channel) value = map(value);
    return profiles;
}

ChannelProfiles sum_of(ChannelProfiles a, const ChannelProfiles& b, double sign) {
    for (std::size_t c = 0; c < b.size(); ++c)
        for (std::size_t i = 0; i < b[c].size(); ++i) a[c][i] += sign * b[c][i];
    return a;
}

/// R_model - g(R_judged). `modelled`: within, without the surface.
ChannelProfiles model_error(const ChannelProfiles& modelled, const ChannelProfiles& judged, double turned_back) {
    return sum_of(modelled, mapped(judged, [&](double seen) { return optics::behind_surface(seen, turned_back); }), -1);
}

class Designer {
public:
    Designer(std::span<const LaminateMaterial> materials, const ChannelProfiles& wanted,
             const LaminateDesignOptions& options, const LaminateJudge& judge)
        : materials_(materials), wanted_(wanted), options_(options), judge_(judge) {
        wanted_behind_ = mapped(wanted, [&](double seen) { return optics::behind_surface(seen, options.turned_back); });
        target_ = wanted_behind_;
    }

    [[nodiscard]] const ChannelProfiles& target() const { return target_; }

    /// Refines layers for the corrected target, judges them as they are printed and corrects the target anew.
    [[nodiscard]] std::vector<LaminateLayer> step(std::vector<LaminateLayer> layers, const FoundLaminate& found) {
        if (options_.refine && !layers.empty())
            layers = refine_laminate(materials_, layers, target_, options_.search).layers;
        LaminateDesign next;
        next.found = found;
        next.layers = options_.layer_mm > 0
                          ? settled_layers(materials_, layers, options_.layer_mm, target_, options_.search)
                          : layers;
        const ChannelProfiles within = laminate_reflection(materials_, next.layers, options_.search.backing);
        next.modelled = mapped(within, [&](double R) { return optics::seen_through_surface(R, options_.turned_back); });
        next.modelled_distance = profile_distance(next.modelled, wanted_, options_.search.weights());
        if (judge_) {
            next.judged = judge_(next.layers);
            next.judged_distance = profile_distance(next.judged, wanted_, options_.search.weights());
            distances_.push_back(next.judged_distance);
            target_ = sum_of(wanted_behind_, model_error(within, next.judged, options_.turned_back), 1);
        }
        if (!any_ || next.judged_distance < best_.judged_distance) best_ = std::move(next);
        any_ = true;
        return layers;
    }

    [[nodiscard]] LaminateDesign best() {
        best_.judged_distances = std::move(distances_);
        return std::move(best_);
    }

private:
    std::span<const LaminateMaterial> materials_;
    const ChannelProfiles& wanted_;
    const LaminateDesignOptions& options_;
    const LaminateJudge& judge_;
    ChannelProfiles wanted_behind_, target_;
    LaminateDesign best_;
    std::vector<double> distances_;
    bool any_ = false;
};

}  // namespace

LaminateDesign design_laminate(const LaminateSearch& search, std::span<const LaminateMaterial> materials,
                               const ChannelProfiles& wanted, const LaminateDesignOptions& options,
                               const LaminateJudge& judge) {
    VOXTONE_EXPECT(options.turned_back >= 0 && options.turned_back < 1 && options.rounds >= 1 &&
                   options.corrections >= 0);
    Designer designer(materials, wanted, options, judge);
    double outside = 0;
    for (int round = 0; round < (judge ? options.rounds : 1); ++round) {
        const FoundLaminate found = search.find(designer.target());
        if (round == 0) outside = found.outside;
        std::vector<LaminateLayer> layers = designer.step(found.layers, found);
        for (int i = 0; judge && options.refine && i < options.corrections && !layers.empty(); ++i)
            layers = designer.step(std::move(layers), found);
    }
    LaminateDesign design = designer.best();
    design.outside = outside;
    return design;
}

}  // namespace voxtone::scattering
