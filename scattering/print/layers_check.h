// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is wrong with a print of layers (`--show layered-profile`), known without a body.
#pragma once

#include <string>
#include <vector>

#include "io/profiles/profile_map.h"
#include "scattering/jobs/layered_options.h"
#include "slicer/part/job_colour.h"

namespace voxtone::scattering {

/// Throws InputError: no cluster, channels that are not those of the resins, one resin only, roles that are not loaded,
/// a resin without a profile beside measured ones.
void check_layers(const LayeredOptions& options, const io::ProfileMap& map, const slicer::LoadedResins& resins);

/// The measured profile of each loaded resin. Throws as check_layers does.
[[nodiscard]] std::vector<std::string> material_files(const LayeredOptions& options,
                                                      const slicer::LoadedResins& resins);

/// "R, G, B", "3 wavelengths (450, 550, 650 nm)", "4 channels of their own".
[[nodiscard]] std::string channels_in_full(const optics::Channels& channels);

}  // namespace voxtone::scattering
