// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour of a coloured shell: its appearance relative to the core's, as linear sRGB, with derivatives. For a set
// with wavelengths the relative spectrum is seen under D65 by the CIE 1931 observer; white is adapted to (1, 1, 1)
// (Bradford).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "voxtone/halftone/separation/mixture.h"
#include "voxtone/optics/layered/shell_appearance.h"

namespace voxtone::halftone {

class AppearanceColour {
public:
    /// d rgb / d fractions: rows R, G, B.
    using Gradient = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor, 3, max_resins>;

    /// `appearance` must outlive this. `wavelengths_nm` (rising) name its channels; empty: R, G, B. Throws InputError
    /// if their number differs.
    AppearanceColour(const optics::ShellAppearance& appearance, std::span<const double> wavelengths_nm);

    [[nodiscard]] const optics::ShellAppearance& appearance() const { return appearance_; }
    [[nodiscard]] Eigen::Vector3d rgb(std::span<const double> fractions) const;
    [[nodiscard]] Eigen::Vector3d rgb(std::span<const double> fractions, Gradient& gradient) const;

private:
    const optics::ShellAppearance& appearance_;
    Eigen::Matrix3Xd from_spectrum_;  ///< empty for RGB
};

}  // namespace voxtone::halftone
