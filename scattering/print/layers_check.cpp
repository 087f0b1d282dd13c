// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layers_check.h"

#include <algorithm>
#include <filesystem>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "scattering/local_profiles/luminance_channel.h"

namespace voxtone::scattering {

std::string channels_in_full(const optics::Channels& channels) {
    if (!channels.is_spectral()) return optics::channels_text(channels);
    return fmt::format("{} wavelengths ({:g} nm)", channels.size(), fmt::join(channels.wavelengths_nm, ", "));
}

std::vector<std::string> material_files(const LayeredOptions& options, const slicer::LoadedResins& resins) {
    const std::vector<LaminateMaterialFile>& named = options.materials;
    for (const auto& [role, file] : named)
        if (resins.set.find(role) < 0)
            throw InputError(fmt::format(
                "--laminate-materials {}={}: no resin of this role is loaded; leave it out or load it (--load)", role,
                file));
    std::vector<std::string> files;
    for (const optics::Resin& resin : resins.set.resins) {
        const auto found = std::find_if(named.begin(), named.end(), [&](const LaminateMaterialFile& entry) {
            return resins.set.find(entry.role) == resins.set.find(resin.role);
        });
        if (found == named.end())
            throw InputError(
                fmt::format("--laminate-materials: the loaded resin {} has no profile; a stack is made of one kind, "
                            "measured or computed: give it one, or "
                            "do not load it (--load)",
                            resin.role));
        if (std::filesystem::path(found->file).extension() != ".json")
            throw InputError(
                fmt::format("--laminate-materials {}={}: is no profile file (.json)", found->role, found->file));
        files.push_back(found->file);
    }
    return files;
}

void check_layers(const LayeredOptions& options, const io::ProfileMap& map, const slicer::LoadedResins& resins) {
    if (map.target.empty())
        throw InputError(fmt::format(
            "{}: has no clusters, so there is nothing to arrange; give a map with at least one", options.profiles));
    if (options.materials.empty() && !is_luminance(map.channels) && map.channels != resins.set.channels)
        throw InputError(fmt::format(
            "{}: its profiles are for {}, those of the resins {} for {}; the search compares channel by channel: make "
            "the map with the channels of the resins or of luminance (laminate factor --luminance), or choose another "
            "--resins",
            options.profiles, channels_in_full(map.channels), resins.set.name, channels_in_full(resins.set.channels)));
    if (resins.set.resins.size() < 2)
        throw InputError(
            "--show layered-profile: only one resin is loaded, so there are no layers to choose; load at least two, "
            "such as --load W,K");
    if (!options.materials.empty()) (void)material_files(options, resins);
    for (const ClearTop& clear : options.clear_top)
        if (resins.set.find(clear.role) < 0)
            throw InputError(fmt::format("--clear-top {}: no resin of this role is loaded", clear.role));
}

}  // namespace voxtone::scattering
