// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colours of thick mixtures as a function of what is fitted: K channels whose weights to XYZ are found together
// with the resins.
//
//   sigma_a,rc = S_c a_rc,  sigma_s,rc = S_c s_rc      (s of the white resin is 1: S_c is its scattering, mm^-1)
//   A_c, S_c of a mixture                              (Iser, Rittig, Wilkie 2025, Eq. 7, or effective_medium.h)
//   XYZ_k / white_k = gain sum_c (w_ck / sum_j w_jk) (surface + rho(A_c, S_c))      (half_space_reflectance.h)
//
// Unknowns: ln a, ln s, ln w (the sum in the denominator makes a perfect diffuser white), a root of the surface's
// reflection and one for the gain, which stays within a tenth of 1: K (2 R - 1 + 3) + 2 of them for R resins. Where the
// pitch of the voxels is known, one more for the dot spread; where spectra give the observer, 3 K fewer; where thin
// squares tell lengths (square_colours.h), K more for ln S_c. Without either, S_c plays no part: colour of thick ideal
// mixtures tells ratios alone.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "optics/layered/half_space_reflectance.h"
#include "optics/media/effective_medium.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

/// What the unknowns stand for.
struct ObserverParts {
    Eigen::MatrixXd a, s;      ///< resins x channels; s of the white resin is 1
    Eigen::MatrixX3d weights;  ///< channels x 3, columns sum to 1: XYZ relative to white
    double surface = 0, gain = 1;
    Eigen::VectorXd scattering;  ///< of white, mm^-1, one per channel; empty: not known
    double dot_spread = 1;       ///< effective_medium.h
};

/// A set of these resins and channels, without a name. Without known scattering `a` and `s` are per mm.
[[nodiscard]] optics::ResinSet set_of_parts(const std::vector<std::string>& roles, const ObserverParts& parts,
                                            optics::Illuminant illuminant);

struct ObserverModelOptions {
    double g = 0.4, eta = 1.5;
    optics::MeasuringGeometry geometry = optics::MeasuringGeometry::directional_45_0;
    std::array<double, 3> pitch_mm{};  ///< of the voxels that mixtures are made of; 0: Eq. 7
    bool lengths = false;              ///< fit the scattering of white too
    bool known_observer = false;       ///< weights are known, not fitted
};

/// The last unknowns, ln w where they are fitted, surface and gain, of parts whose `weights` have their size: read,
/// written, and the derivatives of a colour by them where the channels are seen as `seen`, gain and surface included.
void read_observer(const Eigen::Ref<const Eigen::VectorXd>& unknowns, ObserverParts& parts);
[[nodiscard]] Eigen::VectorXd observer_unknowns(const ObserverParts& parts, bool with_weights);
void add_observer_derivatives(const ObserverParts& parts, const Eigen::VectorXd& seen,
                              Eigen::Ref<Eigen::Matrix3Xd> by_unknown);

class ObserverModel {
public:
    /// `white`: whose s is 1; `resins`: no one's.
    ObserverModel(Eigen::Index resins, Eigen::Index white, Eigen::Index channels, const ObserverModelOptions& options);

    [[nodiscard]] Eigen::Index unknowns() const {
        return observer_at() + (options_.known_observer ? 0 : 3 * channels_) + 2;
    }
    [[nodiscard]] Eigen::Index resins() const { return resins_; }
    [[nodiscard]] Eigen::Index channels() const { return channels_; }
    [[nodiscard]] const ObserverModelOptions& options() const { return options_; }
    [[nodiscard]] bool fits_spread() const { return options_.pitch_mm[0] > 0; }
    /// `known`: parts whose `scattering`, dot spread and weights hold where they are not fitted.
    [[nodiscard]] ObserverParts parts(const Eigen::VectorXd& unknowns, const ObserverParts& known) const;
    /// The inverse of `parts`.
    [[nodiscard]] Eigen::VectorXd unknowns_of(const ObserverParts& parts) const;

    /// How resins make mixtures. Contract: where the pitch is known, `parts.scattering` is too.
    [[nodiscard]] optics::EffectiveMedium law(const ObserverParts& parts) const;
    /// XYZ / white of mixtures, one a row.
    [[nodiscard]] Eigen::MatrixX3d colours(const ObserverParts& parts, const Eigen::MatrixXd& shares) const;
    /// XYZ / white of one mixture and its derivatives by the unknowns.
    [[nodiscard]] Eigen::Vector3d colour(const ObserverParts& parts, const optics::EffectiveMedium& law,
                                         const Eigen::RowVectorXd& shares,
                                         Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const;

    /// Where the unknowns stand: ln a of resin and channel; ln s, of all but white; ln S; dot spread; ln w on.
    [[nodiscard]] Eigen::Index absorption_at(Eigen::Index resin, Eigen::Index channel) const {
        return resin * channels_ + channel;
    }
    [[nodiscard]] Eigen::Index scattering_at(Eigen::Index resin, Eigen::Index channel) const;
    [[nodiscard]] Eigen::Index length_at(Eigen::Index channel) const {
        return (2 * resins_ - (white_ < resins_ ? 1 : 0)) * channels_ + channel;
    }
    [[nodiscard]] Eigen::Index spread_at() const { return length_at(options_.lengths ? channels_ : 0); }
    [[nodiscard]] Eigen::Index observer_at() const { return spread_at() + (fits_spread() ? 1 : 0); }
    [[nodiscard]] const optics::HalfSpaceReflectance& reflectance() const { return reflectance_; }
    [[nodiscard]] bool is_white(Eigen::Index resin) const { return resin == white_; }
    /// Derivative of the dot spread by its unknown.
    [[nodiscard]] static double spread_by_unknown(const ObserverParts& parts);

private:
    Eigen::Index resins_, white_, channels_;
    ObserverModelOptions options_;
    optics::HalfSpaceReflectance reflectance_;
};

}  // namespace voxtone::calibration
