// SPDX-License-Identifier: GPL-3.0-or-later
//
// What stacks are made of and what they border on, from what a user writes: the part that `stack search` and `stack
// predict` have in common.
//
// Materials are roles of a resin set or files of measured profiles, never both. Surface: "air" (smooth, to air above),
// "matched" (none), "auto" (air for resins, matched for measured profiles, which were measured with whatever surface
// they have). Backing, in contact with the lowest layer: "black", "white" (sends all back where it arrives), "air" (a
// smooth surface), or the file of a profile whose R is meant.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/halftone/stacks/stack_search.h"
#include "voxtone/io/profiles/profile_file.h"
#include "voxtone/optics/numerics/hankel.h"
#include "voxtone/optics/profiles/resin_stack.h"

namespace voxtone::slicer {

struct StackSettingOptions {
    std::vector<std::string> materials;
    std::string resins = "vero-opaque";
    std::string surface = "auto", backing = "black";
    double reach_mm = 10;             ///< of the grid, in [0.1, 1000]
    std::uint32_t coefficients = 64;  ///< in [4, 1024]
};

class StackSetting {
public:
    /// Throws UsageError, InputError, FileError: unknown roles or words, materials of several kinds, channels that
    /// differ.
    explicit StackSetting(const StackSettingOptions& options);

    [[nodiscard]] const optics::HankelGrid& grid() const { return grid_; }
    [[nodiscard]] const optics::Channels& channels() const { return channels_; }
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    [[nodiscard]] const std::string& surface() const { return surface_; }
    [[nodiscard]] const std::string& backing() const { return backing_; }
    /// Of resins, resin m being material m; absent for measured profiles.
    [[nodiscard]] const std::optional<optics::ResinSet>& resins() const { return set_; }
    /// Share of diffuse light that the surface above turns back.
    [[nodiscard]] double turned_back() const { return turned_back_; }
    /// What the backing reflects; empty: black.
    [[nodiscard]] const halftone::ChannelProfiles& backing_reflection() const { return backing_reflection_; }
    /// Whether light can be traced through a stack: of resins, on a backing that is no measured profile.
    [[nodiscard]] bool traceable() const { return set_ && !measured_backing_; }
    [[nodiscard]] const optics::StackEnds& ends() const { return ends_; }

    /// Profiles of all materials. Resins are known at this thickness, 0: at the one that fits stacks of `most_mm` best.
    /// Warns of measured profiles that are noisy or cut short.
    [[nodiscard]] std::vector<halftone::StackMaterial> materials(double known_mm, double most_mm,
                                                                 const optics::LayerPathOptions& tracing,
                                                                 Progress& progress) const;
    /// Coefficients of a wanted reflection. Throws InputError: channels that differ, unusable profiles. Warns as above.
    [[nodiscard]] halftone::ChannelProfiles target(const io::ProfileFile& profile, const std::string& file,
                                                   Progress& progress) const;
    [[nodiscard]] std::vector<optics::ResinLayer> resin_layers(std::span<const halftone::StackLayer> layers) const;
    /// "R", "G", "B" or the wavelength.
    [[nodiscard]] std::string channel_name(std::size_t channel) const;
    [[nodiscard]] std::vector<std::string> channel_names() const;

private:
    optics::HankelGrid grid_;
    optics::Channels channels_;
    std::vector<std::string> names_;
    std::string surface_, backing_;
    std::optional<optics::ResinSet> set_;
    std::vector<io::ProfileFile> files_;
    double turned_back_ = 0;
    bool measured_backing_ = false;
    halftone::ChannelProfiles backing_reflection_;
    optics::StackEnds ends_;
};

/// Throws UsageError below two: one path has no standard error.
void check_paths(std::uint32_t paths);

}  // namespace voxtone::slicer
