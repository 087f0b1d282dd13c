// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `calibrate fit` and `calibrate check` have to be told of measured patches alike: white reference, base, voxels.
#pragma once

#include <string>

#include "voxtone/base/progress.h"
#include "voxtone/calibration/patches/patch_model.h"
#include "voxtone/calibration/patches/patch_table.h"

namespace CLI {
class App;
}

namespace voxtone::cli {

struct PatchOptions {
    std::string printer, pitch, base, under = "black";
    double white = 1;
};

/// --white, --base, --under, --printer, --pitch.
void add_patch_options(CLI::App& command, PatchOptions& options);

/// Reads the table and applies white reference and base; sets what lies under it and the voxels in `model`. Warns where
/// mixtures would be taken as ideal. Throws UsageError, InputError, FileError.
[[nodiscard]] calibration::PatchTable read_patches(const std::string& file, const PatchOptions& options,
                                                   calibration::PatchModelOptions& model, Progress& progress);

}  // namespace voxtone::cli
