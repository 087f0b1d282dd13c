// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a set of resins predicts of patches, against what was measured: Iser, Rittig, Wilkie 2025, Sec. 6.1.
//
// Colours are those of the reflectances under D65: R, G, B taken as linear sRGB, spectra through the CIE 1931 observer
// (optics/colour/channels.h), and those of a printer's own channels likewise; differences are CIEDE2000.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "voxtone/calibration/patches/patch_model.h"
#include "voxtone/calibration/patches/patch_table.h"
#include "voxtone/optics/colour/colour.h"
#include "voxtone/optics/media/resins.h"

namespace voxtone::calibration {

struct CheckedPatch {
    std::vector<double> predicted;  ///< rho per channel of the set
    Eigen::Vector3d measured_rgb = Eigen::Vector3d::Zero(), predicted_rgb = Eigen::Vector3d::Zero();  ///< linear sRGB
    double difference = 0;                                                                            ///< CIEDE2000
    double worst = 0;  ///< largest |predicted - measured| over the channels; of linear sRGB where these differ
};

struct PatchCheck {
    std::vector<CheckedPatch> patches;      ///< in the order of the table
    optics::DifferenceSummary differences;  ///< CIEDE2000
    double rms = 0;                         ///< of predicted - measured, over patches and channels
};

/// Compares predictions, [patch][channel], with a table; `channels`: of the predictions, where they are not the table's.
[[nodiscard]] PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted);
[[nodiscard]] PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted,
                                         const optics::Channels& channels);

/// Thin squares upon a base by the patch model, thick mixtures by optics::FlatColour with the set's residual. g and eta
/// are the set's; its channels need not be the table's, since each has a colour by its own observer. Throws InputError
/// where a resin is not in the set, or where some patches of a table are thick and others not.
[[nodiscard]] PatchCheck check_resins(const optics::ResinSet& set, const PatchTable& table, PatchModelOptions options);

}  // namespace voxtone::calibration
