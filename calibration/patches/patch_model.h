// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the patches of a target reflect, rho(45 -> 0), for given resins, one channel at a time, with exact derivatives
// by every resin's absorption and scattering.
//
// A patch is a layer of a mixture upon a base (optics/layered/layer_on_base.h). Squares of one mixture and thickness
// share the modes of their layer, squares on one base share its law, laminates that of the lower layers they have in
// common. Of slabs lit from behind: what comes through (optics/layered/slab_transmission.h), slopes by differences.
// Mixtures are ideal (Iser, Rittig, Wilkie 2025, Eq. 7) or, where the pitch of the voxels is given, halftones
// (optics/media/effective_medium.h). A base of unknown thickness has no end; one of known thickness ends at what is
// `under` it, a laminate at air. A surface that is known (optics/layered/known_surface.h) is a base without slopes.
//
// Units mm, mm^-1. Error of rho with the 15 directions used: 1e-6 for patches of 0.675 mm; with the eight of a
// laminates' plan 1e-3. Time: docs/benchmarks.md.
// What it cannot see: the sides of a square (light that leaves it sideways), rough surfaces.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/patches/patch_table.h"
#include "optics/layered/layer_on_base.h"
#include "optics/media/effective_medium.h"

namespace voxtone::calibration {

/// What lies under a base of known thickness.
enum class UnderBase {
    black,  ///< a perfect absorber in optical contact
    air,    ///< a smooth lower surface to air, and nothing or a black sheet that does not touch
};

/// A target's mixtures are dithered by a random choice per voxel, whose lumps are larger than those of the blue-noise
/// screen that EffectiveMedium's constants belong to: k_0 and k_1 are 1.25 times theirs. The factor is fitted to Monte
/// Carlo of the dithers of target B (Vero, J750) and holds for other resins and shares:
/// benchmarks/calibration/printed_target.
inline constexpr optics::EffectiveMediumConstants random_dither{.k_0 = 0.7125, .k_1 = 0.5};

struct PatchModelOptions {
    double g = 0.4;
    double eta = 1.5;
    UnderBase under = UnderBase::black;
    std::array<double, 3> pitch_mm{};  ///< of the voxels that mixtures are made of; 0: ideal mixtures
    optics::EffectiveMediumConstants dither = random_dither;
    double dot_spread = 0;  ///< of the voxels (optics/media/effective_medium.h); ideal mixtures have 1
    [[nodiscard]] bool ideal_mixtures() const { return pitch_mm[0] == 0; }
};

/// The same for all channels and for models of parts of a target: what depends on g and eta alone. `coarse`: of eight
/// directions.
[[nodiscard]] std::shared_ptr<const optics::OrdinatePlan> patch_plan(const PatchModelOptions& options,
                                                                     bool coarse = false);

class PatchModel {
    static constexpr std::size_t nothing = std::numeric_limits<std::size_t>::max();

public:
    /// `roles`: the resins, in the order in which evaluate() takes them. Contract: every resin of `patches` is among
    /// them.
    PatchModel(std::span<const Patch> patches, std::vector<std::string> roles, const PatchModelOptions& options,
               std::shared_ptr<const optics::OrdinatePlan> plan = {});

    [[nodiscard]] std::size_t patches() const { return patches_.size(); }
    [[nodiscard]] const std::vector<std::string>& roles() const { return roles_; }

    /// The laws of all bases for these resins; to be kept while only others change.
    using Bases = std::vector<optics::OrdinateBase>;
    /// `channel`: of the surfaces that patches lie on; contract: given where there are some.
    [[nodiscard]] Bases bases(std::span<const optics::Medium> resins, bool with_derivatives,
                              std::size_t channel = nothing) const;

    /// rho of every patch.
    void evaluate(std::span<const optics::Medium> resins, const Bases& bases, std::span<double> rho) const;
    /// And its derivatives, mm: column 2 r by sigma_a of resin r, column 2 r + 1 by its sigma_s; the last by the
    /// logarithm of the voxels' chord.
    void evaluate(std::span<const optics::Medium> resins, const Bases& bases, std::span<double> rho,
                  Eigen::MatrixXd& by_resin) const;

    [[nodiscard]] std::vector<double> rho(std::span<const optics::Medium> resins, std::size_t channel = nothing) const;

private:
    struct Layer {
        std::vector<std::size_t> resins;
        std::vector<double> fractions;
        double thickness_mm;
        friend bool operator==(const Layer&, const Layer&) = default;
    };
    struct Base {
        std::size_t resin = nothing;        ///< nothing: `ends` there
        double thickness_mm = 0;            ///< 0: without end
        std::size_t below = nothing;        ///< another one, which stands before it
        UnderBase ends = UnderBase::black;  ///< counts where there is no resin and no
        std::shared_ptr<const PatchSurface> surface = {};
        friend bool operator==(const Base&, const Base&) = default;
    };
    [[nodiscard]] std::size_t add_base(const Patch& patch);
    [[nodiscard]] std::size_t index_of_resin(const std::string& role) const;
    struct Place {
        std::size_t layer, base;
        std::optional<optics::LightThrough> lit = {};  ///< then there is no base
    };
    /// A mixture and its derivatives by the logarithms of what its resins are.
    struct Mixed {
        std::vector<optics::Medium> parts;
        optics::Medium medium;
        optics::EffectiveMedium::ByResins by;
    };
    [[nodiscard]] Mixed mix(const Layer& layer, std::span<const optics::Medium> resins, bool with_derivatives) const;
    void run(std::span<const optics::Medium> resins, const Bases& bases, std::span<double> rho,
             Eigen::MatrixXd* by_resin) const;

    std::vector<std::string> roles_;
    PatchModelOptions options_;
    std::shared_ptr<const optics::OrdinatePlan> plan_;
    std::vector<Layer> layers_;
    std::vector<Base> bases_;
    std::vector<Place> patches_;
    std::vector<std::vector<std::size_t>> of_layer_;  ///< patches of each layer
};

}  // namespace voxtone::calibration
