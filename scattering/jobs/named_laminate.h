// SPDX-License-Identifier: GPL-3.0-or-later
//
// A laminate as a user names it, a laminate file or layers in words, with its light: what `laminate predict`, `laminate
// targets` and `laminate print` have in common.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/profiles/layer_sequence_file.h"
#include "scattering/jobs/laminate_setting.h"

namespace voxtone::scattering {

struct NamedLaminateOptions {
    /// Empty words: what the file says; else vero-opaque, auto, black. Materials are taken from the laminate.
    std::string resins{}, surface{}, backing{};
    double reach_mm = 10;
    std::uint32_t coefficients = 512;
};

/// `laminate`: a laminate file (.json), or layers as "W 0.3, K 0.1", top first. Throws FileError, InputError,
/// UsageError: also without a layer.
[[nodiscard]] io::LayerSequence read_named_sequence(const std::string& laminate, const NamedLaminateOptions& options);

struct NamedLaminate {
    io::LayerSequence sequence;
    LaminateSetting setting;
    std::vector<LaminateLayer> layers;  ///< by material of the setting
};
[[nodiscard]] NamedLaminate read_named_laminate(const std::string& laminate, const NamedLaminateOptions& options);

/// Layer by layer: of resins in all directions (optics/profiles/wave_laminates.h); of measured profiles, known by
/// diffuse light, by Kubelka and Munk's law with a surface as a layer of its own.
[[nodiscard]] optics::LaminateLight layered_light(const NamedLaminate& laminate,
                                                  const optics::LayerPathOptions& tracing, Progress& progress);
/// By Monte Carlo of the whole. Contract: setting.traceable().
[[nodiscard]] optics::LaminateLight traced_light(const NamedLaminate& laminate, const optics::LayerPathOptions& tracing,
                                                 Progress& progress);

/// Samples of a profile at 2 n + 1 distances up to the grid's reach, for a profile file, through a blur of 0.75 reach /
/// n.
[[nodiscard]] optics::RadialSamples profile_samples(const optics::HankelGrid& grid,
                                                    const std::vector<double>& coefficients);

}  // namespace voxtone::scattering
