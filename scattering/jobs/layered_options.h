// SPDX-License-Identifier: GPL-3.0-or-later
//
// The options of prints of layers that show how light spreads (`--show layered-profile`), and their values.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/named_values.h"
#include "slicer/options/resolved_job.h"
#include "slicer/options/table_of_shows.h"

namespace voxtone::scattering {

/// What --show says.
inline constexpr const char* layered_show = "layered-profile";

/// Where on a mesh a map of profiles lies.
enum class ProfilePlacement {
    uv,   ///< by texture coordinates
    box,  ///< projected along the main axis of the normal
};

/// Rounds of corrected searches, 0 to 20; "auto": nothing. Throws UsageError, as those below do.
[[nodiscard]] std::optional<int> parse_laminate_rounds(const std::string& text);

/// Measured profile of a resin.
struct LaminateMaterialFile {
    std::string role, file;
};
/// "ROLE=FILE" each, no role twice.
[[nodiscard]] std::vector<LaminateMaterialFile> parse_laminate_materials(const std::vector<std::string>& entries);

/// How far from the top of any laminate a resin stays.
struct ClearTop {
    std::string role;
    double mm = 0;
};
/// "ROLE=LENGTH" each.
[[nodiscard]] std::vector<ClearTop> parse_clear_top(const std::vector<std::string>& entries);

/// Layers of a map of profiles.
struct LayeredOptions final : slicer::OtherOptions {
    std::string profiles;  ///< file of the map
    ProfilePlacement placement = ProfilePlacement::uv;
    std::string base = "K";                       ///< role of the resin below the laminates
    double thickness_mm = 5;                      ///< most, of a laminate; in (0, 50]
    std::uint32_t steps = 64, blocks = 6;         ///< of the search; 1 to 4096, 1 to 16
    std::optional<int> rounds;                    ///< of corrected searches; nothing: by the number of clusters
    std::vector<LaminateMaterialFile> materials;  ///< measured; empty: resins are computed
    double dc_weight = 1;                         ///< of the total reflectance against the profile's shape; in (0, 1e6]
    std::vector<ClearTop> clear_top;
    double smoothing_mm = 0;  ///< standard deviation, along the surface; 0 to 100
    bool surfaces = false;
    double surface_cell_mm = 0.1;  ///< of the meshes of `surfaces`; 0.01 to 5

    [[nodiscard]] double depth_mm() const override { return thickness_mm; }
    [[nodiscard]] const std::string& core() const override { return base; }
    [[nodiscard]] const char* core_option() const override { return "base"; }
};

/// As the option table has them.
[[nodiscard]] slicer::OtherShow layered_show_options();

/// Of a job that shows layers; null: of another.
[[nodiscard]] const LayeredOptions* layered_options(const slicer::ResolvedJob& job);

}  // namespace voxtone::scattering

namespace voxtone {

template <>
struct NamesOf<scattering::ProfilePlacement> {
    using E = scattering::ProfilePlacement;
    static constexpr auto table = std::to_array<Named<E>>({{E::uv, "uv"}, {E::box, "box"}});
};

}  // namespace voxtone
