// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/table_observer.h"

#include "optics/colour/colour.h"
#include "optics/colour/spectral_colour.h"

namespace voxtone::calibration {

using optics::Illuminant;

TableObserver table_observer(const optics::Channels& channels, Illuminant of_spectra) {
    if (channels.is_own()) {
        TableObserver own{channels.illuminant, optics::colorimetric_white(channels.illuminant), {}};
        own.weights.resize(3, static_cast<Eigen::Index>(channels.size()));
        for (std::size_t c = 0; c < channels.size(); ++c)
            own.weights.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::Vector3d>(channels.xyz[c].data());
        return own;
    }
    if (channels.is_rgb()) return {Illuminant::d65, optics::d65_white(), optics::xyz_from_linear_srgb_matrix()};
    TableObserver spectral{of_spectra, optics::colorimetric_white(of_spectra),
                           optics::xyz_weights(channels.wavelengths_nm, of_spectra)};
    const Eigen::Vector3d summed = spectral.weights.rowwise().sum();
    for (Eigen::Index k = 0; k < 3; ++k) spectral.weights.row(k) *= spectral.white[k] / summed[k];
    return spectral;
}

}  // namespace voxtone::calibration
