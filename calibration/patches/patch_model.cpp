// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_model.h"

#include <algorithm>
#include <map>

#include "base/contracts.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::calibration {

using optics::Medium;

namespace {

// Index of a value in a list; it is appended where it is new.
template <class T>
std::size_t index_of(std::vector<T>& list, const T& value) {
    const auto found = std::find(list.begin(), list.end(), value);
    if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
    list.push_back(value);
    return list.size() - 1;
}

// One channel of a few resins as a set, for EffectiveMedium.
optics::ResinSet one_channel(std::span<const Medium> resins, const PatchModelOptions& options) {
    optics::ResinSet set;
    set.channels.wavelengths_nm = {500};
    set.g = options.g, set.dot_spread = options.dot_spread;
    for (const Medium& medium : resins) set.resins.push_back({"", "", {medium.sigma_t()}, {medium.albedo()}});
    return set;
}

// Of what is clear too there are slopes.
constexpr double least_per_mm = 1e-12;

}  // namespace

std::shared_ptr<const optics::OrdinatePlan> patch_plan(const PatchModelOptions& options, bool coarse) {
    return std::make_shared<const optics::OrdinatePlan>(coarse ? optics::directional_plan(options.g, options.eta, 3, 3)
                                                               : optics::directional_plan(options.g, options.eta));
}

PatchModel::PatchModel(std::span<const Patch> patches, std::vector<std::string> roles, const PatchModelOptions& options,
                       std::shared_ptr<const optics::OrdinatePlan> plan)
    : roles_(std::move(roles)), options_(options), plan_(plan ? std::move(plan) : patch_plan(options)) {
    for (const Patch& patch : patches) {
        Layer layer{{}, {}, patch.thickness_mm};
        for (const ResinShare& share : patch.top) {
            layer.resins.push_back(index_of_resin(share.role));
            layer.fractions.push_back(share.fraction);
        }
        patches_.push_back({index_of(layers_, layer), patch.lit ? 0 : add_base(patch), patch.lit});
    }
    of_layer_.resize(layers_.size());
    for (std::size_t p = 0; p < patches_.size(); ++p) of_layer_[patches_[p].layer].push_back(p);
}

std::size_t PatchModel::index_of_resin(const std::string& role) const {
    const auto found = std::ranges::find(roles_, role);
    VOXTONE_EXPECT(found != roles_.end());
    return static_cast<std::size_t>(found - roles_.begin());
}

std::size_t PatchModel::add_base(const Patch& patch) {
    if (patch.on) return index_of(bases_, Base{.surface = patch.on});
    if (!patch.is_laminate() && patch.base_mm == 0) return index_of(bases_, Base{index_of_resin(patch.backing)});
    std::size_t base = index_of(bases_, Base{.ends = patch.is_laminate() ? UnderBase::air : options_.under});
    if (!patch.is_laminate()) return index_of(bases_, Base{index_of_resin(patch.backing), patch.base_mm, base});
    for (auto layer = patch.under.rbegin(); layer != patch.under.rend(); ++layer)
        base = index_of(bases_, Base{index_of_resin(layer->role), layer->thickness_mm, base});
    return base;
}

PatchModel::Bases PatchModel::bases(std::span<const Medium> resins, bool with_derivatives, std::size_t channel) const {
    Bases laws;
    laws.reserve(bases_.size());
    std::map<std::pair<std::size_t, double>, std::shared_ptr<const optics::OrdinateSlab>> slabs;
    for (const Base& base : bases_) {
        if (base.surface) {
            VOXTONE_EXPECT(channel < base.surface->rho.size());
            laws.emplace_back(optics::admittance_of(*plan_, base.surface->kind, base.surface->rho[channel]));
        } else if (base.resin == nothing) {
            laws.emplace_back(base.ends == UnderBase::black ? optics::Admittance::black(*plan_)
                                                            : optics::Admittance::air(*plan_, false));
        } else if (base.below == nothing) {
            laws.emplace_back(*plan_, resins[base.resin], with_derivatives);
        } else {
            auto& slab = slabs[{base.resin, base.thickness_mm}];
            if (!slab)
                slab = std::make_shared<const optics::OrdinateSlab>(*plan_, resins[base.resin], base.thickness_mm,
                                                                    with_derivatives);
            laws.emplace_back(slab, laws[base.below]);
        }
    }
    return laws;
}

PatchModel::Mixed PatchModel::mix(const Layer& layer, std::span<const Medium> resins, bool with_derivatives) const {
    Mixed mixed;
    for (const std::size_t r : layer.resins)
        mixed.parts.push_back({std::max(resins[r].sigma_a, least_per_mm), std::max(resins[r].sigma_s, least_per_mm)});
    const bool pure = mixed.parts.size() == 1;
    const optics::EffectiveMedium law(one_channel(mixed.parts, options_),
                                      pure ? std::array<double, 3>{} : options_.pitch_mm, optics::SeenFrom::above,
                                      options_.dither);
    const optics::EffectiveMedium::Point point = law.at(layer.fractions, 0);
    mixed.medium = point.medium;
    if (with_derivatives) law.by_resins(point, layer.fractions, 0, mixed.by);
    return mixed;
}

void PatchModel::run(std::span<const Medium> resins, const Bases& laws, std::span<double> rho,
                     Eigen::MatrixXd* by_resin) const {
    VOXTONE_EXPECT(resins.size() == roles_.size() && rho.size() == patches_.size() && laws.size() == bases_.size());
    if (by_resin)
        by_resin->setZero(static_cast<Eigen::Index>(patches_.size()), static_cast<Eigen::Index>(2 * resins.size() + 1));
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        const Mixed mixed = mix(layers_[l], resins, by_resin != nullptr);
        const double mm = layers_[l].thickness_mm;
        std::optional<optics::OrdinateLayer> layer;
        for (const std::size_t p : of_layer_[l]) {
            optics::LayerReflectance result;
            if (const auto lit = patches_[p].lit; lit && by_resin) {
                const auto [value, by] = optics::slab_transmission_slopes(*plan_, mixed.medium, mm, *lit);
                result = {value, by, {}, {}};
            } else if (lit) {
                result.rho = optics::slab_transmission(*plan_, mixed.medium, mm, *lit);
            } else {
                if (!layer) layer.emplace(*plan_, mixed.medium, mm, by_resin != nullptr);
                result = layer->upon(laws[patches_[p].base]);
            }
            rho[p] = result.rho;
            if (!by_resin) continue;
            auto row = by_resin->row(static_cast<Eigen::Index>(p));
            const auto slope = [&](const Medium& by) {
                return result.by_layer.sigma_a * by.sigma_a + result.by_layer.sigma_s * by.sigma_s;
            };
            for (std::size_t k = 0; k < mixed.parts.size(); ++k) {
                const auto at = static_cast<Eigen::Index>(2 * layers_[l].resins[k]);
                row[at] += slope(mixed.by.by_absorption[k]) / mixed.parts[k].sigma_a;
                row[at + 1] += slope(mixed.by.by_scattering[k]) / mixed.parts[k].sigma_s;
            }
            row[row.size() - 1] += slope(mixed.by.by_chord);
            if (patches_[p].lit) continue;
            for (std::size_t at = patches_[p].base; bases_[at].resin != nothing; at = bases_[at].below) {
                const Medium by_base = at == patches_[p].base ? result.by_base : laws[at].slopes(result.under);
                const auto base = static_cast<Eigen::Index>(2 * bases_[at].resin);
                row[base] += by_base.sigma_a;
                row[base + 1] += by_base.sigma_s;
                if (bases_[at].below == nothing) break;
            }
        }
    }
}

void PatchModel::evaluate(std::span<const Medium> resins, const Bases& bases, std::span<double> rho) const {
    run(resins, bases, rho, nullptr);
}

void PatchModel::evaluate(std::span<const Medium> resins, const Bases& bases, std::span<double> rho,
                          Eigen::MatrixXd& by_resin) const {
    run(resins, bases, rho, &by_resin);
}

std::vector<double> PatchModel::rho(std::span<const Medium> resins, std::size_t channel) const {
    std::vector<double> result(patches_.size());
    evaluate(resins, bases(resins, false, channel), result);
    return result;
}

}  // namespace voxtone::calibration
