// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `calibrate fit` and `calibrate check` have to be told of measured patches alike: white reference, base, voxels.
#pragma once

#include <string>

#include "calibration/fit/patch_map.h"
#include "calibration/patches/measured_patches.h"
#include "cli/program/common_options.h"

namespace voxtone::cli {

/// Words that the patch model is made of.
struct PatchOptions {
    std::string printer, pitch, illuminant, under = "black";
};

/// --white, --illuminant, --printable-only, --base, --under, --printer, --pitch.
void add_patch_options(Verb& command, PatchOptions& options, calibration::MeasuredPatchOptions& measured);

/// --target, --picture: where the patches of a page lie.
void add_patch_map_options(Verb& command, calibration::PatchMapFiles& files);

/// Sets what lies under the base, the voxels that mixtures are made of, and the resins that the printer has. Throws
/// UsageError, InputError.
void set_patch_model(const PatchOptions& options, calibration::PatchModelOptions& model,
                     calibration::MeasuredPatchOptions& measured);

}  // namespace voxtone::cli
