// SPDX-License-Identifier: GPL-3.0-or-later
//
// setup.json: every figure of the bench on which edge profiles are measured, and of the scene that stands for it
// (optics/edge/edge_assembly.h; format "voxtone-edge-setup", version 1, data/schema/edge-setup.schema.json).
//
// What a file does not say is as in Elek et al. 2017, supplement, Secs. 4 and 5. The sheet's reflectances are those of
// its base, as the paper uses them. Gel is 0.03 mm thick on both sides by default: the paper says "minimal".
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "optics/edge/edge_assembly.h"
#include "optics/edge/edge_response.h"

namespace voxtone::calibration {

struct EdgeSetup {
    optics::EdgeAssembly assembly;
    std::array<double, 3> white{0.985, 0.972, 0.971}, black{0.024, 0.023, 0.026};  ///< of the sheet: R, G, B
    double thickness_error = 0.02;                                                 ///< relative standard error of slabs
    double gel_error_mm = 0.012;  ///< standard error of each layer of gel
    double level_error = 0.003;   ///< relative standard error of a photograph's white point
    double width_mm = 10;         ///< of a profile across the edge, which is in its middle
    double pitch_mm = 0.0276;     ///< of its samples: Canon EOS 700D (4.3 um), 135 mm, at 1 m
    double blur_mm = 0;           ///< standard deviation of the camera's blur on the sheet

    [[nodiscard]] optics::EdgeSheet sheet(std::size_t channel) const { return {black[channel], white[channel]}; }
    /// Middles of samples across the edge, symmetric about 0.
    [[nodiscard]] std::vector<double> positions() const;
    /// Tells scenes apart whose light paths differ: without the sheet's reflectances, camera and errors.
    [[nodiscard]] std::uint64_t scene_digest() const;
};

/// Throws InputError that names file, key and rule.
[[nodiscard]] EdgeSetup parse_edge_setup(std::string_view text, std::string source);
/// All defaults for an empty name. Throws FileError, InputError.
[[nodiscard]] EdgeSetup read_edge_setup(const std::string& file);
/// With every key.
[[nodiscard]] std::string edge_setup_text(const EdgeSetup& setup);

}  // namespace voxtone::calibration
