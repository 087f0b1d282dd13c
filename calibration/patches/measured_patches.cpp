// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/measured_patches.h"

#include <algorithm>

#include "base/warning.h"

namespace voxtone::calibration {

PatchTable read_measured_patches(const std::string& file, const MeasuredPatchOptions& options,
                                 const PatchModelOptions& model, Progress& progress) {
    PatchTable table = read_patches(file, options.reading);
    for (const std::string& note : table.notes) progress.warn(named_warning("assumed", note));
    apply_white_reference(table, options.white);
    if (options.base_mm)
        for (Patch& patch : table.patches) patch.base_mm = *options.base_mm;
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
