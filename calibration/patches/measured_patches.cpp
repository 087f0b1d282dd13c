// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/measured_patches.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"

namespace voxtone::calibration {

PatchTable read_measured_patches(const std::string& file, const MeasuredPatchOptions& options,
                                 const PatchModelOptions& model, Progress& progress, PatchTable* checkers) {
    PatchTable table = read_patches(file, options.reading);
    for (const std::string& note : table.notes) progress.warn(named_warning("assumed", note));
    apply_white_reference(table, options.white);
    if (options.base_mm)
        for (Patch& patch : table.patches)
            if (!patch.lit && !patch.on && !patch.is_laminate()) patch.base_mm = *options.base_mm;
    if (checkers) {
        *checkers = {.source = table.source, .channels = table.channels, .patches = {}};
        std::ranges::copy_if(table.patches, std::back_inserter(checkers->patches), &Patch::is_checker);
    }
    std::erase_if(table.patches, [](const Patch& patch) { return patch.is_checker(); });
    if (table.patches.empty())
        throw InputError(fmt::format(
            "{}: holds checkers alone, which say how far resin runs once resins are known; put the squares beside them "
            "into the same table.",
            table.source));
    const bool mixed =
        !table.is_chart && std::ranges::any_of(table.patches, [](const Patch& patch) { return patch.top.size() > 1; });
    if (mixed && model.ideal_mixtures())
        progress.warn(named_warning(
            "ideal-mixtures",
            "mixtures are taken as ideal, as a J750's droplets make them, which run together; where voxels stay sharp, "
            "extinctions come out up to a third wrong: give --printer or --pitch there, and --dot-spread"));
    return table;
}

}  // namespace voxtone::calibration
