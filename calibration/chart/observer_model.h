// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colours of thick mixtures as a function of what is fitted: K channels whose weights to XYZ are found together
// with the resins.
//
//   A_c = sum_r f_r a_rc,  S_c = sum_r f_r s_rc      (Iser, Rittig, Wilkie 2025, Eq. 7; s of the white resin is 1)
//   XYZ_k / white_k = gain sum_c (w_ck / sum_j w_jk) (surface + rho(A_c, S_c))      (half_space_reflectance.h)
//
// Unknowns: ln a, ln s, ln w (the sum in the denominator makes a perfect diffuser white), a root of the surface's
// reflection and one for the gain, which stays within a tenth of 1: K (2 R - 1 + 3) + 2 of them for R resins. Colour of
// thick mixtures tells absorption relative to scattering alone: lengths come from elsewhere.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "voxtone/optics/layered/half_space_reflectance.h"
#include "voxtone/optics/media/resins.h"

namespace voxtone::calibration {

/// What the unknowns stand for.
struct ObserverParts {
    Eigen::MatrixXd a, s;      ///< resins x channels; s of the white resin is 1
    Eigen::MatrixX3d weights;  ///< channels x 3, columns sum to 1: XYZ relative to white
    double surface = 0, gain = 1;
};

/// The last 3 K + 2 unknowns, ln w, surface and gain, of parts whose `weights` have their size: read, written, and the
/// derivatives of a colour by them where the channels are seen as `seen`, gain and surface included.
void read_observer(const Eigen::Ref<const Eigen::VectorXd>& unknowns, ObserverParts& parts);
[[nodiscard]] Eigen::VectorXd observer_unknowns(const ObserverParts& parts);
void add_observer_derivatives(const ObserverParts& parts, const Eigen::VectorXd& seen,
                              Eigen::Ref<Eigen::Matrix3Xd> by_unknown);

class ObserverModel {
public:
    ObserverModel(Eigen::Index resins, Eigen::Index white, Eigen::Index channels, double g, double eta,
                  optics::MeasuringGeometry geometry);

    [[nodiscard]] Eigen::Index unknowns() const { return channels_ * (2 * resins_ + 2) + 2; }
    [[nodiscard]] Eigen::Index channels() const { return channels_; }
    [[nodiscard]] ObserverParts parts(const Eigen::VectorXd& unknowns) const;
    /// The inverse of `parts`.
    [[nodiscard]] Eigen::VectorXd unknowns_of(const ObserverParts& parts) const;

    /// XYZ / white of mixtures, one a row.
    [[nodiscard]] Eigen::MatrixX3d colours(const ObserverParts& parts, const Eigen::MatrixXd& shares) const;
    /// XYZ / white of one mixture and its derivatives by the unknowns.
    [[nodiscard]] Eigen::Vector3d colour(const ObserverParts& parts, const Eigen::RowVectorXd& shares,
                                         Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const;

private:
    Eigen::Index resins_, white_, channels_;
    optics::HalfSpaceReflectance reflectance_;
};

}  // namespace voxtone::calibration
