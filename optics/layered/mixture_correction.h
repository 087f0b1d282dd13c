// SPDX-License-Identifier: GPL-3.0-or-later
//
// A set's residual at the places of a print: how each place's colour, as physics predicts it, is corrected for the
// mixture that light sees there (scene/surface_mixtures.h), and the white that it is relative to for white resin:
//
//   rgb' = K(mixture) rgb,   K(f) = diag(1 / (C(white) 1)) C(f),   C: FlatColour::correction
//
// for media-relative linear sRGB (K(white) leaves white white), K = C for absolute colours. On flat mixtures this is
// the residual; where mixtures change it changes with them, smoothly. A ratio near 1 is all that a residual of flat
// colours can say beside an edge: what light does there is the model's.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "optics/layered/flat_colour.h"
#include "optics/media/resin_volume.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

class MixtureCorrection {
public:
    /// `white_resin`: index in the set of what colours are relative to; -1: absolute colours. Does nothing for a set
    /// without a residual.
    MixtureCorrection(const ResinSet& set, int white_resin, const std::array<double, 3>& pitch_mm = {});

    [[nodiscard]] bool any() const { return flat_.corrects(); }
    [[nodiscard]] Eigen::Matrix3d of(std::span<const double> shares) const;
    /// One matrix for each place of this print.
    [[nodiscard]] std::vector<Eigen::Matrix3f> of_surface(const ResinVolume& print, const Surface& surface,
                                                          const Progress* progress = nullptr) const;

    /// About one place of a volume, mm from its corner; the identity where nothing solid is near.
    [[nodiscard]] Eigen::Matrix3f at(const ResinVolume& print, const std::array<float, 3>& place_mm) const;

private:
    FlatColour flat_;
    std::size_t resins_;
    Eigen::Vector3d white_ = Eigen::Vector3d::Ones();  ///< C(white) 1
};

/// rgb' = K rgb, cell by cell; and its transpose, for derivatives by colour.
void correct_colours(std::span<const Eigen::Matrix3f> corrections, std::span<Eigen::Vector3f> rgb);
void correct_derivatives(std::span<const Eigen::Matrix3f> corrections, std::span<Eigen::Vector3f> by_rgb);

}  // namespace voxtone::optics
