// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measured laminates whose order and thickness are known: each is seen from above, the first layer on top, the
// last one the base, with nothing but darkness under it.
//
// Read from CSV, and from the calibration files of ChromaPrint3D (JSON: "palette", "entries" of {"recipe", "lab"}):
//
//   layers,L,a,b
//   "Y 0.08, W 0.08, W 0.8",92.9,-7.4,18.0        thickness in mm behind each resin's role
//
// Colours are CIELAB of the 2 degree observer, D50 unless told otherwise.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "optics/colour/spectral_colour.h"

namespace voxtone::calibration {

struct ChartLayer {
    std::size_t resin = 0;  ///< in LayerChart::roles
    double thickness_mm = 0;
    friend auto operator<=>(const ChartLayer&, const ChartLayer&) = default;
};

/// Top first.
using LayerLaminate = std::vector<ChartLayer>;

struct LayerChart {
    std::string source;
    std::vector<std::string> roles;
    optics::Illuminant illuminant = optics::Illuminant::d50;
    std::vector<LayerLaminate> laminates;
    Eigen::MatrixX3d lab;            ///< one a laminate
    std::vector<std::string> notes;  ///< what was assumed, one sentence each
};

[[nodiscard]] bool is_layer_chart(std::string_view text);
/// Throws InputError that names the line or entry.
[[nodiscard]] LayerChart parse_layer_chart(std::string_view text, std::string source,
                                           std::optional<optics::Illuminant> illuminant = {});
/// The chart in a file, nothing where it holds something else. At most 64 MB. Throws FileError, InputError.
[[nodiscard]] std::optional<LayerChart> read_layer_chart(const std::filesystem::path& file,
                                                         std::optional<optics::Illuminant> illuminant = {});

/// "Y 0.08, W 0.08, W 0.8"
[[nodiscard]] std::string laminate_text(const LayerChart& chart, std::size_t laminate);
/// The laminates `keep` alone.
[[nodiscard]] LayerChart chart_laminates(const LayerChart& chart, const std::vector<std::size_t>& keep);

}  // namespace voxtone::calibration
