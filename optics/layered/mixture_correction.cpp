// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/mixture_correction.h"

#include <algorithm>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/scene/surface_mixtures.h"

namespace voxtone::optics {

MixtureCorrection::MixtureCorrection(const ResinSet& set, int white_resin, const std::array<double, 3>& pitch_mm)
    : flat_(set, pitch_mm), resins_(set.resins.size()) {
    if (white_resin < 0) return;
    std::vector<double> white(resins_);
    white[static_cast<std::size_t>(white_resin)] = 1;
    white_ = flat_.correction(white) * Eigen::Vector3d::Ones();
}

Eigen::Matrix3d MixtureCorrection::of(std::span<const double> shares) const {
    return white_.cwiseInverse().asDiagonal() * flat_.correction(shares);
}

std::vector<Eigen::Matrix3f> MixtureCorrection::of_surface(const ResinVolume& print, const Surface& surface,
                                                           const Progress* progress) const {
    const std::vector<float> mixtures = surface_mixtures(print, surface, resins_, progress);
    std::vector<Eigen::Matrix3f> corrections(surface.cells.size());
    parallel_for(
        0, corrections.size(), 64,
        [&](std::size_t i) {
            const float* const cell = mixtures.data() + i * resins_;
            const std::vector<double> shares(cell, cell + resins_);
            corrections[i] = of(shares).cast<float>();
        },
        progress);
    return corrections;
}

Eigen::Matrix3f MixtureCorrection::at(const ResinVolume& print, const std::array<float, 3>& place_mm) const {
    std::vector<float> mixture(resins_);
    mixture_at(print, place_mm, mixture);
    const std::vector<double> shares(mixture.begin(), mixture.end());
    if (std::ranges::all_of(shares, [](double share) { return share == 0; })) return Eigen::Matrix3f::Identity();
    return of(shares).cast<float>();
}

void correct_colours(std::span<const Eigen::Matrix3f> corrections, std::span<Eigen::Vector3f> rgb) {
    VOXTONE_EXPECT(corrections.size() == rgb.size());
    parallel_for(0, rgb.size(), 4096, [&](std::size_t i) { rgb[i] = Eigen::Vector3f(corrections[i] * rgb[i]); });
}

void correct_derivatives(std::span<const Eigen::Matrix3f> corrections, std::span<Eigen::Vector3f> by_rgb) {
    VOXTONE_EXPECT(corrections.size() == by_rgb.size());
    parallel_for(0, by_rgb.size(), 4096,
                 [&](std::size_t i) { by_rgb[i] = Eigen::Vector3f(corrections[i].transpose() * by_rgb[i]); });
}

}  // namespace voxtone::optics
