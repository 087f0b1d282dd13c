// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part of a tray that is no model (plans/tray_component.h), ready to be laid into its print: its voxels are its own,
// and nothing is looped or predicted.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slicer/layers/layer_source.h"
#include "slicer/part/job_colour.h"
#include "slicer/plate/nesting.h"

namespace voxtone::slicer {

struct ReadyComponent {
    std::shared_ptr<const LayerSource> layers;
    Outline outline;
    std::vector<std::uint64_t> voxels;  ///< of each loaded resin
    std::vector<std::string> files;     ///< on whose contents it depends
    bool is_one_mixture = false;        ///< throughout

    [[nodiscard]] std::uint64_t all_voxels() const;
};

/// By its name to the printer or in its set, or by role; in any case of letters.
[[nodiscard]] std::optional<std::size_t> loaded_resin(const LoadedResins& resins, const std::string& name);
/// Throws InputError.
[[noreturn]] void refuse_resin(const std::string& name, const LoadedResins& resins);

}  // namespace voxtone::slicer
