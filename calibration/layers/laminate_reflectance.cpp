// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/laminate_reflectance.h"

#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "base/contracts.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::calibration {

namespace {

constexpr std::size_t nothing = std::numeric_limits<std::size_t>::max();

}  // namespace

LaminateReflectance::LaminateReflectance(std::span<const LayerLaminate> laminates, double g, double eta, int directions)
    : plan_(optics::directional_plan(g, eta, directions, directions)), dark_(optics::Admittance::air(plan_, false)) {
    std::map<std::tuple<std::size_t, ChartLayer>, std::size_t> known;
    for (const LayerLaminate& laminate : laminates) {
        std::size_t below = nothing;
        for (auto layer = laminate.rbegin(); layer != laminate.rend(); ++layer) {
            VOXTONE_EXPECT(layer->resin < 64);
            const auto [at, is_new] = known.try_emplace({below, *layer}, nodes_.size());
            if (is_new)
                nodes_.push_back(
                    {below, *layer, (below == nothing ? 0 : nodes_[below].holds) | std::uint64_t{1} << layer->resin});
            below = at->second;
        }
        top_.push_back(below);
    }
}

LaminateReflectance::Laws LaminateReflectance::laws(std::vector<optics::Medium> media) const {
    Laws laws{std::move(media), {}, {}};
    for (const optics::Medium& medium : laws.media) laws.modes.emplace_back(plan_, medium);
    for (const Node& node : nodes_)
        laws.of_node.push_back(laws.modes[node.layer.resin].over(
            node.below == nothing ? dark_ : laws.of_node[node.below], node.layer.thickness_mm));
    return laws;
}

double LaminateReflectance::seen(const optics::Admittance& top) const {
    return optics::reflectance_factor(plan_, top, std::numbers::sqrt2 / 2, 1.0);
}

std::vector<double> LaminateReflectance::rho(const Laws& laws) const {
    std::vector<double> result;
    for (const std::size_t top : top_) result.push_back(seen(laws.of_node[top]));
    return result;
}

std::vector<double> LaminateReflectance::rho(const Laws& laws, std::size_t resin, const optics::Medium& medium) const {
    const optics::LayerModes changed(plan_, medium);
    std::vector<optics::Admittance> law(nodes_.size());
    const auto law_of = [&](std::size_t node) -> const optics::Admittance& {
        if (node == nothing) return dark_;
        return nodes_[node].holds >> resin & 1 ? law[node] : laws.of_node[node];
    };
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (!(nodes_[n].holds >> resin & 1)) continue;
        const ChartLayer& layer = nodes_[n].layer;
        law[n] = (layer.resin == resin ? changed : laws.modes[layer.resin])
                     .over(law_of(nodes_[n].below), layer.thickness_mm);
    }
    std::vector<double> result;
    for (const std::size_t top : top_) result.push_back(seen(law_of(top)));
    return result;
}

}  // namespace voxtone::calibration
