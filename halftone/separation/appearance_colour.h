// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour of a coloured shell: its appearance relative to that of white resin, as linear sRGB, with derivatives. The
// set's observer makes colours of both, and these are divided (optics/colour/observed_colour.h). Where the set has a
// residual, the colour is corrected for the shell's mixture (optics/layered/mixture_correction.h); derivatives take the
// correction as fixed: it changes by a hundredth where the mixture changes by a tenth, and only guides the steps.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "halftone/separation/mixture.h"
#include "optics/colour/channels.h"
#include "optics/layered/mixture_correction.h"
#include "optics/layered/shell_appearance.h"

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
    [[nodiscard]] Eigen::Vector3d physics(std::span<const double> fractions) const;
    [[nodiscard]] Eigen::Vector3d physics(std::span<const double> fractions, Gradient& gradient) const;

    const optics::ShellAppearance& appearance_;
    std::optional<optics::MixtureCorrection> correction_;  ///< of a set with a residual
    Eigen::Matrix3Xd from_channels_;  ///< of absolute values; empty for R, G, B, whose values are divided themselves
};

}  // namespace voxtone::halftone
