// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light on a photographed body, which nobody measured: what it has of low order is found from the body itself.
//
//   seen_c = rho_c T(theta) (sum_k l_ck D_k + l_c9 D_9)  +  l_c0 v F(theta) sum_k l_k Y_k(mirrored)
//   D_k = integral of the sky that a place sees, of Y_k cos / pi;  D_9: what the body's other parts cover of it
//
// Y_k: polynomials up to the second order of the direction, which is all of a sky that a diffuser tells to a few
// percent (R. Ramamoorthi, P. Hanrahan, "An efficient representation for irradiance environment maps", SIGGRAPH 2001);
// the transfer D is that of P.-P. Sloan, J. Kautz, J. Snyder, "Precomputed radiance transfer", SIGGRAPH 2002. F:
// Fresnel's mirrored share, T = 1 - F over that along the normal. Each channel has a light of its own, since light that
// goes far below the surface softens it; their mean, l, is mirrored with the strength v. All are found by iteratively
// reweighted least squares (Tukey's biweight) against the predicted colours.
//
// Cannot see: sharp highlights and edges of shadows, which stay off and are told by `highlight` and `on`; what a print
// is lighter, or of another colour, on all sides that look one way.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

inline constexpr std::size_t sky_terms = 9;
using SkyTerms = std::array<double, sky_terms>;
/// 1; x, y, z; xy, yz, zx, x2 - y2, 3 z2 - 1.
[[nodiscard]] SkyTerms sky_terms_of(const Eigen::Vector3d& direction);
/// What a diffuser that looks along `normal` into all of the sky has of each, over pi.
[[nodiscard]] SkyTerms diffuse_terms_of(const Eigen::Vector3d& normal);

/// One place of the body as it is photographed and predicted.
struct LitPlace {
    Eigen::Vector3d seen = Eigen::Vector3d::Zero(), predicted = Eigen::Vector3d::Zero();
    SkyTerms diffuse{}, mirrored{};
    double covered = 0;      ///< by other parts of the body: 0 none, 1 all
    double fresnel = 0;      ///< F of the view
    double transmitted = 1;  ///< 1 - F of it, over that along the normal
};

class BodyLight {
public:
    /// From places that are well seen.
    [[nodiscard]] static BodyLight fit(const std::vector<LitPlace>& places);

    /// On a place in each channel, 1 where nothing covers it and light comes from all sides alike.
    [[nodiscard]] Eigen::Vector3d on(const LitPlace& place) const;
    /// What the surface mirrors there.
    [[nodiscard]] Eigen::Vector3d veil(const LitPlace& place) const;
    /// The print's colours there: without veil, in even light, up to a gain of each channel.
    [[nodiscard]] Eigen::Vector3d colour(const LitPlace& place) const;
    /// As it should be seen.
    [[nodiscard]] Eigen::Vector3d model(const LitPlace& place) const;
    /// Brighter than it may be in all channels alike.
    [[nodiscard]] bool highlight(const LitPlace& place) const;

private:
    std::array<SkyTerms, 3> light_{};  ///< over the first of each channel
    Eigen::Vector3d of_body_ = Eigen::Vector3d::Zero(), gain_ = Eigen::Vector3d::Ones();
    double veil_ = 0;
};

}  // namespace voxtone::calibration
