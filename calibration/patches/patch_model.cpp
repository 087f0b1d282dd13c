// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_model.h"

#include <algorithm>

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
    set.g = options.g, set.eta = options.eta, set.dot_spread = options.dot_spread;
    for (const Medium& medium : resins) set.resins.push_back({"", "", {medium.sigma_t()}, {medium.albedo()}});
    return set;
}

}  // namespace

std::shared_ptr<const optics::OrdinatePlan> patch_plan(const PatchModelOptions& options) {
    return std::make_shared<const optics::OrdinatePlan>(optics::directional_plan(options.g, options.eta));
}

PatchModel::PatchModel(std::span<const Patch> patches, std::vector<std::string> roles, const PatchModelOptions& options,
                       std::shared_ptr<const optics::OrdinatePlan> plan)
    : roles_(std::move(roles)), options_(options), plan_(plan ? std::move(plan) : patch_plan(options)) {
    below_ =
        options_.under == UnderBase::black ? optics::Admittance::black(*plan_) : optics::Admittance::air(*plan_, false);
    const auto resin = [&](const std::string& role) {
        const auto found = std::ranges::find(roles_, role);
        VOXTONE_EXPECT(found != roles_.end());
        return static_cast<std::size_t>(found - roles_.begin());
    };
    for (const Patch& patch : patches) {
        Layer layer{{}, {}, patch.thickness_mm};
        for (const ResinShare& share : patch.top) {
            layer.resins.push_back(resin(share.role));
            layer.fractions.push_back(share.fraction);
        }
        patches_.push_back({index_of(layers_, layer), index_of(bases_, Base{resin(patch.backing), patch.base_mm})});
    }
    of_layer_.resize(layers_.size());
    for (std::size_t p = 0; p < patches_.size(); ++p) of_layer_[patches_[p].layer].push_back(p);
}

PatchModel::Bases PatchModel::bases(std::span<const Medium> resins, bool with_derivatives) const {
    Bases laws;
    laws.reserve(bases_.size());
    for (const Base& base : bases_) {
        if (base.thickness_mm > 0)
            laws.emplace_back(*plan_, resins[base.resin], base.thickness_mm, below_, with_derivatives);
        else
            laws.emplace_back(*plan_, resins[base.resin], with_derivatives);
    }
    return laws;
}

PatchModel::Mixed PatchModel::mix(const Layer& layer, std::span<const Medium> resins, bool with_derivatives) const {
    Mixed mixed;
    const bool ideal = options_.ideal_mixtures() || layer.resins.size() == 1;
    if (ideal) {
        for (std::size_t k = 0; k < layer.resins.size(); ++k) {
            const double f = layer.fractions[k];
            mixed.medium.sigma_a += f * resins[layer.resins[k]].sigma_a;
            mixed.medium.sigma_s += f * resins[layer.resins[k]].sigma_s;
            if (with_derivatives) mixed.by_resin.push_back({Medium{f, 0}, Medium{0, f}});
        }
        return mixed;
    }
    std::vector<Medium> parts;
    for (const std::size_t r : layer.resins) parts.push_back(resins[r]);
    const auto effective = [&] {
        return optics::EffectiveMedium(one_channel(parts, options_), options_.pitch_mm, optics::SeenFrom::above,
                                       options_.dither)(layer.fractions, 0);
    };
    mixed.medium = effective();
    if (!with_derivatives) return mixed;
    // The effective medium is smooth and costs nothing: central differences.
    for (Medium& part : parts) {
        auto& by = mixed.by_resin.emplace_back();
        for (int s = 0; s < 2; ++s) {
            double& value = s == 0 ? part.sigma_a : part.sigma_s;
            const double kept = value, step = 1e-4 * std::max(part.sigma_t(), 1e-3), low = std::min(step, kept);
            value = kept + step;
            const Medium above = effective();
            value = kept - low;
            const Medium below = effective();
            value = kept;
            by[static_cast<std::size_t>(s)] = {(above.sigma_a - below.sigma_a) / (step + low),
                                               (above.sigma_s - below.sigma_s) / (step + low)};
        }
    }
    return mixed;
}

void PatchModel::run(std::span<const Medium> resins, const Bases& laws, std::span<double> rho,
                     Eigen::MatrixXd* by_resin) const {
    VOXTONE_EXPECT(resins.size() == roles_.size() && rho.size() == patches_.size() && laws.size() == bases_.size());
    if (by_resin)
        by_resin->setZero(static_cast<Eigen::Index>(patches_.size()), static_cast<Eigen::Index>(2 * resins.size()));
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        const Mixed mixed = mix(layers_[l], resins, by_resin != nullptr);
        const optics::OrdinateLayer layer(*plan_, mixed.medium, layers_[l].thickness_mm, by_resin != nullptr);
        for (const std::size_t p : of_layer_[l]) {
            const optics::LayerReflectance result = layer.upon(laws[patches_[p].base]);
            rho[p] = result.rho;
            if (!by_resin) continue;
            auto row = by_resin->row(static_cast<Eigen::Index>(p));
            for (std::size_t k = 0; k < layers_[l].resins.size(); ++k)
                for (std::size_t s = 0; s < 2; ++s) {
                    const Medium& by = mixed.by_resin[k][s];
                    row[static_cast<Eigen::Index>(2 * layers_[l].resins[k] + s)] +=
                        result.by_layer.sigma_a * by.sigma_a + result.by_layer.sigma_s * by.sigma_s;
                }
            const auto base = static_cast<Eigen::Index>(2 * bases_[patches_[p].base].resin);
            row[base] += result.by_base.sigma_a;
            row[base + 1] += result.by_base.sigma_s;
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

std::vector<double> PatchModel::rho(std::span<const Medium> resins) const {
    std::vector<double> result(patches_.size());
    evaluate(resins, bases(resins, false), result);
    return result;
}

}  // namespace voxtone::calibration
