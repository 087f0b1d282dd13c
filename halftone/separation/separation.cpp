// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/separation.h"

#include <array>

#include "halftone/separation/lattice_lookup.h"
#include "optics/colour/colour.h"

namespace voxtone::halftone {

Separation::Separation(const optics::ShellAppearance& appearance, const SeparationOptions& options)
    : colour_(appearance, options.channels), resins_(appearance.resins()), lattice_(colour_, options) {}

void Separation::mixtures(const float* red, const float* green, const float* blue, std::size_t n,
                          CumulativeMixture* out) const {
    lattice_mixtures(lattice_.view(), red, green, blue, n, out);
}

std::vector<double> Separation::fractions(const Eigen::Vector3f& rgb) const {
    std::array<float, max_resins> shares;
    lattice_shares(lattice_.view(), rgb.x(), rgb.y(), rgb.z(), shares.data());
    std::vector<double> fractions(resins_);
    double sum = 0;
    for (std::size_t r = 0; r < resins_; ++r) sum += fractions[r] = double(shares[r]);
    for (double& f : fractions) f /= sum;
    return fractions;
}

Eigen::Vector3d Separation::predicted(const Eigen::Vector3f& rgb) const { return colour_.rgb(fractions(rgb)); }

double Separation::gamut_distance(const Eigen::Vector3f& rgb) const {
    return optics::ciede2000(optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0).cwiseMin(1)),
                             optics::lab_from_linear_srgb(predicted(rgb)));
}

}  // namespace voxtone::halftone
