// SPDX-License-Identifier: GPL-3.0-or-later
//
// A table of patches together with what it does not say of itself, ready for a fit or a check.
#pragma once

#include <optional>
#include <string>

#include "base/progress.h"
#include "calibration/patches/patch_file.h"
#include "calibration/patches/patch_model.h"
#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

struct MeasuredPatchOptions {
    double white = 1;               ///< reflectance of the white reference that the values were divided by, in (0, 1]
    std::optional<double> base_mm;  ///< thickness of the base under all squares; none: what the table says
    PatchReading reading = {};      ///< how the file is read
};

/// Without a target's checkers, which are `checkers` then: how far resin runs says what they show (fit/spread_fit.h).
/// Throws InputError, FileError. Warns of what was assumed, and where `model` takes the mixtures of a target as ideal.
[[nodiscard]] PatchTable read_measured_patches(const std::string& file, const MeasuredPatchOptions& options,
                                               const PatchModelOptions& model, Progress& progress,
                                               PatchTable* checkers = nullptr);

}  // namespace voxtone::calibration
