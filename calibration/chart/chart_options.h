// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a fit of a chart is asked for, and how one choice of channels does.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/patches/patch_table.h"
#include "calibration/resins/resin_prior.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct ChartFitOptions {
    std::string name;
    int channels = 0;      ///< 3 to 12; 0: as many as cross-validation finds best
    bool residual = true;  ///< keep what physics leaves
    optics::MeasuringGeometry geometry = optics::MeasuringGeometry::directional_45_0;
    double g = 0.4, eta = 1.5;
    std::array<double, 3> pitch_mm{};  ///< of the voxels: their dot spread is fitted; 0: Eq. 7
    int folds = 10;                    ///< of the last cross-validation, >= 2; of laminates 0 is none
    optics::ResinSet lengths_from =
        {};                   ///< whose white's scattering gives mm, or starts what squares and edges tell of it
    PatchTable squares = {};  ///< thin squares of the same resins, read by another instrument; empty: none
    ResinPrior edges = {};    ///< edge profiles of the same resins, at the same g and eta; empty: none
    std::vector<std::string> expected = {};  ///< roles that must be there; empty: those of the table
};

/// A number of channels, and where their weights to XYZ come from.
struct ObserverChoice {
    int channels = 0;
    bool of_spectra = false;  ///< bands of the spectra that were measured (observer_bands.h); else fitted
    friend bool operator==(const ObserverChoice&, const ObserverChoice&) = default;
};

/// Cross-validation of a choice: mean CIEDE2000 of mixtures left out.
struct ChannelChoice {
    ObserverChoice observer;
    double physics = 0, with_residual = 0;
};

}  // namespace voxtone::calibration
