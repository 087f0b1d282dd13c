// SPDX-License-Identifier: GPL-3.0-or-later
//
// What laminates are made of and what they border on, from what a user writes: the part that `laminate search` and
// `laminate predict` have in common.
//
// Materials are roles of a resin set or files of measured profiles, never both.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/named_values.h"
#include "base/progress.h"
#include "io/profiles/profile_file.h"
#include "optics/numerics/hankel.h"
#include "optics/profiles/resin_laminate.h"
#include "scattering/design/laminate_search.h"

namespace voxtone::scattering {

/// What lies above a laminate.
enum class LaminateSurface {
    automatic,  ///< air for resins, matched for measured profiles, which were measured with whatever surface they have
    air,        ///< smooth, to air
    matched,    ///< none
};

/// What the lowest layer is in contact with.
enum class LaminateBacking {
    black,
    white,    ///< sends all light back where it arrives
    air,      ///< a smooth surface
    profile,  ///< what reflects as the R of a profile file: its name stands for the word
};

struct LaminateSettingOptions {
    std::vector<std::string> materials;
    std::string resins = "vero-opaque";
    std::string surface = "auto", backing = "black";  ///< words, or the file of the backing's profile (.json)
    double reach_mm = 10;                             ///< of the grid, in [0.1, 1000]
    std::uint32_t coefficients = 64;                  ///< in [4, 1024]
};

class LaminateSetting {
public:
    /// Throws UsageError, InputError, FileError: unknown roles or words, materials of several kinds, channels that
    /// differ.
    explicit LaminateSetting(const LaminateSettingOptions& options);

    [[nodiscard]] const optics::HankelGrid& grid() const { return grid_; }
    [[nodiscard]] const optics::Channels& channels() const { return channels_; }
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    /// Never automatic.
    [[nodiscard]] LaminateSurface surface() const { return surface_; }
    [[nodiscard]] std::string surface_name() const { return std::string(name_of(surface_)); }
    /// A word, or the file of a profile.
    [[nodiscard]] std::string backing_name() const;
    /// Of resins, resin m being material m; absent for measured profiles.
    [[nodiscard]] const std::optional<optics::ResinSet>& resins() const { return set_; }
    /// Share of diffuse light that the surface above turns back.
    [[nodiscard]] double turned_back() const { return turned_back_; }
    /// What the backing reflects; empty: black.
    [[nodiscard]] const ChannelProfiles& backing_reflection() const { return backing_reflection_; }
    /// Whether light can be traced through a laminate: of resins, on a backing that is no measured profile.
    [[nodiscard]] bool traceable() const { return set_ && backing_ != LaminateBacking::profile; }
    [[nodiscard]] const optics::LaminateEnds& ends() const { return ends_; }

    /// Profiles of all materials. Resins are known at this thickness, 0: at the one that fits laminates of `most_mm`
    /// best. Warns of measured profiles that are noisy or cut short.
    [[nodiscard]] std::vector<LaminateMaterial> materials(double known_mm, double most_mm,
                                                          const optics::LayerPathOptions& tracing,
                                                          Progress& progress) const;
    /// Coefficients of a wanted reflection. Throws InputError: channels that differ, unusable profiles. Warns as above.
    [[nodiscard]] ChannelProfiles target(const io::ProfileFile& profile, const std::string& file,
                                         Progress& progress) const;
    [[nodiscard]] std::vector<optics::ResinLayer> resin_layers(std::span<const LaminateLayer> layers) const;
    /// "R", "G", "B" or the wavelength.
    [[nodiscard]] std::string channel_name(std::size_t channel) const;
    [[nodiscard]] std::vector<std::string> channel_names() const;

private:
    optics::HankelGrid grid_;
    optics::Channels channels_;
    std::vector<std::string> names_;
    LaminateSurface surface_;
    LaminateBacking backing_;
    std::string backing_file_;
    std::optional<optics::ResinSet> set_;
    std::vector<io::ProfileFile> files_;
    double turned_back_ = 0;
    ChannelProfiles backing_reflection_;
    optics::LaminateEnds ends_;

    void put_between(double eta);
};

/// Throws UsageError below two: one path has no standard error.
void check_paths(std::uint32_t paths);

}  // namespace voxtone::scattering

namespace voxtone {

template <>
struct NamesOf<scattering::LaminateSurface> {
    using E = scattering::LaminateSurface;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::automatic, "auto"}, {E::air, "air"}, {E::matched, "matched"}});
};
template <>
struct NamesOf<scattering::LaminateBacking> {
    using E = scattering::LaminateBacking;
    static constexpr auto table = std::to_array<Named<E>>({{E::black, "black"}, {E::white, "white"}, {E::air, "air"}});
};

}  // namespace voxtone
