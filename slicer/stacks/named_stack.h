// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stack of layers as a user names it, a stack file or layers in words, with its light: what `stack predict`, `stack
// targets` and `stack print` have in common.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/profiles/layer_sequence_file.h"
#include "slicer/stacks/stack_setting.h"

namespace voxtone::slicer {

struct NamedStackOptions {
    /// Empty words: what the file says; else vero-opaque, auto, black. Materials are taken from the stack.
    std::string resins{}, surface{}, backing{};
    double reach_mm = 10;
    std::uint32_t coefficients = 512;
};

/// `stack`: a stack file (.json), or layers as "W 0.3, K 0.1", top first. Throws FileError, InputError, UsageError:
/// also without a layer.
[[nodiscard]] io::LayerSequence read_named_sequence(const std::string& stack, const NamedStackOptions& options);

struct NamedStack {
    io::LayerSequence sequence;
    StackSetting setting;
    std::vector<halftone::StackLayer> layers;  ///< by material of the setting
};
[[nodiscard]] NamedStack read_named_stack(const std::string& stack, const NamedStackOptions& options);

/// By layer profiles: resins each at its own thickness, the first together with the surface; measured ones by Kubelka
/// and Munk's law, with a surface as a layer of its own.
[[nodiscard]] optics::StackLight layered_light(const NamedStack& stack, const optics::LayerPathOptions& tracing,
                                               Progress& progress);
/// By Monte Carlo of the whole. Contract: setting.traceable().
[[nodiscard]] optics::StackLight traced_light(const NamedStack& stack, const optics::LayerPathOptions& tracing,
                                              Progress& progress);

/// Samples of a profile at 2 n + 1 distances up to the grid's reach, for a profile file, through a blur of 0.75 reach /
/// n.
[[nodiscard]] optics::RadialSamples profile_samples(const optics::HankelGrid& grid,
                                                    const std::vector<double>& coefficients);

}  // namespace voxtone::slicer
