// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a set of resins predicts of patches, against what was measured: Iser, Rittig, Wilkie 2025, Sec. 6.1.
//
// Each side's own channels make its colours (optics/colour/channels.h): R, G, B are linear sRGB, spectra go through the
// CIE 1931 observer under D65, channels of a printer's own through theirs; differences are CIEDE2000. So any set can be
// checked by any table. Where both have the same channels, errors of single values are those of reflectances by
// channel, else those of linear sRGB.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/patches/patch_model.h"
#include "calibration/patches/patch_table.h"
#include "optics/colour/colour.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct CheckedPatch {
    std::vector<double> predicted;  ///< rho per channel of the set
    std::vector<double> off;        ///< predicted - measured, per channel of `compared_in`
    Eigen::Vector3d measured_rgb = Eigen::Vector3d::Zero(), predicted_rgb = Eigen::Vector3d::Zero();  ///< linear sRGB
    double difference = 0;                                                                            ///< CIEDE2000
    double worst = 0;                                                                                 ///< largest |off|
};

struct PatchCheck {
    std::vector<CheckedPatch> patches;      ///< in the order of the table
    optics::DifferenceSummary differences;  ///< CIEDE2000
    optics::Channels compared_in;           ///< those of set and table where they are the same, else R, G, B
    double rms = 0;                         ///< of `off`, over patches and channels
};

/// Compares predictions, [patch][channel], with a table. `channels`: what the predictions are in.
[[nodiscard]] PatchCheck compare_patches(const PatchTable& table, const std::vector<std::vector<double>>& predicted,
                                         const optics::Channels& channels);

/// Thin squares upon a base by the patch model, thick mixtures by optics::FlatColour with the set's residual; g and eta
/// and dot spread are the set's. Throws InputError where a resin is not in the set.
[[nodiscard]] PatchCheck check_resins(const optics::ResinSet& set, const PatchTable& table, PatchModelOptions options);

/// Places of a list, those of its largest values first; of equal ones in their order.
[[nodiscard]] std::vector<std::size_t> largest_first(const std::vector<double>& values);
/// The same of the differences of a check.
[[nodiscard]] std::vector<std::size_t> largest_first(const PatchCheck& check);

}  // namespace voxtone::calibration
