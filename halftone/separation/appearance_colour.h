// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour of a coloured shell: its appearance relative to that of white resin, as linear sRGB, with derivatives. The
// set's observer makes colours of both, and these are divided (optics/colour/observed_colour.h).
#pragma once

#include <span>

#include <Eigen/Core>

#include "voxtone/halftone/separation/mixture.h"
#include "voxtone/optics/colour/channels.h"
#include "voxtone/optics/layered/shell_appearance.h"

namespace voxtone::halftone {

class AppearanceColour {
public:
    /// d rgb / d fractions: rows R, G, B.
    using Gradient = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor, 3, max_resins>;

    /// `appearance` must outlive this. `channels`: what its channels are. Throws InputError if their number differs.
    AppearanceColour(const optics::ShellAppearance& appearance, const optics::Channels& channels);

    [[nodiscard]] const optics::ShellAppearance& appearance() const { return appearance_; }
    [[nodiscard]] Eigen::Vector3d rgb(std::span<const double> fractions) const;
    [[nodiscard]] Eigen::Vector3d rgb(std::span<const double> fractions, Gradient& gradient) const;

private:
    const optics::ShellAppearance& appearance_;
    Eigen::Matrix3Xd from_channels_;  ///< of absolute values; empty for R, G, B, whose values are divided themselves
};

}  // namespace voxtone::halftone
