// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bootstrapped calibration of Iser, Rittig, Wilkie 2025, Secs. 3.2 to 3.5: resins one after the other, each by a
// search in one or two dimensions that needs no start. One channel at a time.
//
//   Principle 1  albedo of a base from its square on itself (Eq. 4; without end, so that extinction does not matter)
//   Principle 2  extinction of each base from its square upon the other (Eq. 5), then of both by their mixtures too
//   Principle 3  albedo and extinction of any other resin from its squares on both bases, pure and diluted (Eq. 6)
//
// Slabs lit from behind are left to the joint fit. Searches run on grids in v and ln sigma_t (resin_coordinates.h),
// made finer around the least sum of absolute deviations. The deepest local minima of Eq. 6 on its grid, four at most,
// are handed on: a joint fit can tell which it is. Bases need no names: the lightest and the darkest play white and
// black, any with contrast will do. Clear resin (role T) neither absorbs nor scatters.
//
// Ten directions do for a start: rho within 1e-4, in a third of the time. What it cannot see: that a base has an end;
// the errors that one step hands to the next. Those are the joint refinement's (resin_fit.h).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "calibration/patches/patch_model.h"
#include "calibration/resins/resin_coordinates.h"

namespace voxtone::calibration {

/// Who is who in a table of patches.
struct TargetRoles {
    std::vector<std::string> roles;  ///< all resins: the bases, the lightest first, then the others as they come
    std::vector<std::size_t> bases;  ///< indices of resins that others lie upon
    std::vector<std::size_t> clear;  ///< indices of clear resins
    [[nodiscard]] bool is_base(std::size_t role) const;
    [[nodiscard]] bool is_clear(std::size_t role) const;
};

/// `expected`: resins that must have been measured; may be empty. `noise`: of a reflectance.
/// Throws InputError where a calibration is not possible, naming patch or resin: fewer than two resins or bases
/// (surfaces too), a base without a square on itself or on another base, bases without contrast, white (W) darker than
/// black (K), a resin that is missing.
[[nodiscard]] TargetRoles find_target_roles(const PatchTable& table, std::span<const std::string> expected,
                                            double noise);

struct ChannelStart {
    std::vector<ResinPoint> resins;                     ///< one per role
    std::vector<std::vector<ResinPoint>> alternatives;  ///< other local minima, the deepest first
};

class Principles {
public:
    /// `noise`: standard error of patches that carry none.
    Principles(const PatchTable& table, const TargetRoles& roles, const PatchModelOptions& options, double noise);
    [[nodiscard]] ChannelStart start(std::size_t channel) const;

private:
    class Search;
    using Resins = std::vector<ResinPoint>;  ///< one per role

    void find_base_albedos(std::size_t channel, Resins& at) const;
    void find_base_extinctions(std::size_t channel, Resins& at) const;
    void refine_base_extinctions(std::size_t channel, Resins& at) const;
    /// Gives the local minima that were not taken.
    [[nodiscard]] Resins find_resin(std::size_t role, std::size_t channel, Resins& at) const;

    const PatchTable* table_;
    const TargetRoles* roles_;
    PatchModelOptions options_;
    double noise_;
    std::shared_ptr<const optics::OrdinatePlan> plan_;
    ResinBounds bounds_;
    /// Patches that each step looks at, by role.
    struct Group {
        std::vector<Patch> patches;
        std::unique_ptr<PatchModel> model;
    };
    [[nodiscard]] Group group(const std::vector<std::size_t>& patches) const;
    std::vector<Group> self_, cross_, rest_;
    Group mixed_bases_;
};

}  // namespace voxtone::calibration
