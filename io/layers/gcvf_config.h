// SPDX-License-Identifier: GPL-3.0-or-later
//
// ConfigFile.xml of a GCVF container: what the layers are and which colour stands for which resin. There is no public
// specification; the fields are those that public readers and writers agree on.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/layers/manifest.h"

namespace voxtone::io {

struct GcvfMaterial {
    std::string name;
    std::array<std::uint8_t, 4> rgba{};
    std::uint64_t voxels = 0;
    friend bool operator==(const GcvfMaterial&, const GcvfMaterial&) = default;
};

/// Besides the background, as ConfigFile.xml says.
inline constexpr int most_gcvf_colours = 6;

struct GcvfConfig {
    /// Of every GCVF that is known; as they stand there, empty: missing.
    std::string version = "2", bit_depth = "4", most_colours = std::to_string(most_gcvf_colours),
                semantics = "Materials";
    double x_dpi = 0, y_dpi = 0;
    std::uint64_t slice_thickness_nm = 0;
    std::uint32_t width_px = 0, height_px = 0;
    std::uint32_t start_index = 0, slices = 0;
    std::string prefix = "layer_";
    std::array<std::uint8_t, 4> background{0, 0, 0, 255};
    std::vector<GcvfMaterial> materials;
    friend bool operator==(const GcvfConfig&, const GcvfConfig&) = default;
};

[[nodiscard]] GcvfConfig gcvf_config(const StackDescription& stack);
[[nodiscard]] std::string gcvf_config_text(const GcvfConfig& config);
/// Throws InputError, beginning with `source`, that names the element and the rule.
[[nodiscard]] GcvfConfig parse_gcvf_config(std::string_view xml, const std::string& source);
/// What in it differs from every GCVF that is known, so that its layers may be refused or mean something else; for the
/// user, one text each.
[[nodiscard]] std::vector<std::string> unknown_in(const GcvfConfig& config);

/// What a container can hold: six resins (MaxNumberOfColors) and TopmostLayers::most_layers. Throws InputError that
/// says what to do instead.
void expect_gcvf(const StackDescription& stack);
/// For the user, of a container of so many bytes and entries; empty: there is nothing to say. Beyond 4 GiB, or 65,535
/// entries, ZIP needs its later form, ZIP64.
[[nodiscard]] std::string gcvf_size_note(std::uint64_t bytes, std::uint64_t entries);

/// The resin's own name where the maker writes it so in a GCVF ("VeroCY-V"; "VeroMgnt" for VeroMagenta), else the
/// maker's for its role where one is known, else its own.
[[nodiscard]] std::string gcvf_material_name(const StackResin& resin);

/// The role of what the maker calls so in a GCVF, of either white; empty: not known.
[[nodiscard]] std::string_view role_of_gcvf_material(std::string_view name);

}  // namespace voxtone::io
