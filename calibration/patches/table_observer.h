// SPDX-License-Identifier: GPL-3.0-or-later
//
// XYZ of a table's values under the illuminant that its colours are told in. Spectra have none: they are seen by the
// CIE observer under the illuminant that is asked for, a perfect diffuser white for any choice of wavelengths.
#pragma once

#include <Eigen/Core>

#include "optics/colour/channels.h"

namespace voxtone::calibration {

struct TableObserver {
    optics::Illuminant illuminant = optics::Illuminant::d65;
    Eigen::Vector3d white;     ///< XYZ of a perfect diffuser
    Eigen::Matrix3Xd weights;  ///< XYZ = weights * rho
};

[[nodiscard]] TableObserver table_observer(const optics::Channels& channels, optics::Illuminant of_spectra);

}  // namespace voxtone::calibration
