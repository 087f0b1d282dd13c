// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a halftone of voxels is to light: the effective absorption and scattering of voxels of several resins, each
// filled by one of them.
//
// An ideal mixture averages sigma_a and sigma_s (Iser, Rittig, Wilkie 2025, Eq. 7). Voxels do not, because the light is
// not the same in all of them: where a resin absorbs, its voxels are darker than their surroundings. With a voxel's
// mean chord l = 4 V / S, its pitch p_z along the light's way and p_x, p_y across, and its slenderness
//
//   h = p_z / (sqrt(p_x p_y) + p_z / 2),
//
// the optical sizes of a voxel of resin i are
//
//   t_i = sigma_a,i l (1 + a (h - 0.4)),     u_i = sigma_s,i (1 - g) l,
//
// and with the shares f_i the model is
//
//   sigma_a* = sum_i f_i sigma_a,i phi_i,     sigma_s* = sum_i f_i sigma_s,i phi_i^q v_i / V
//
//   light in voxels of resin i / mean light    phi_i = w_i / W,  w_i = 1 / (1 + k t_i),  W = sum_j f_j w_j
//   what holds light back around a dark voxel  k = k_0 + k_1 u*,  u* = sum_i f_i u_i v_i / V
//   light that runs between scattering voxels  v_i = 1 / (1 + b u_i),  V = sum_j f_j v_j,  b = b_1 max(h - h_0, 0)
//
// 1 / (1 + t) is Wigner's rational approximation of how much less a lump of mean chord l absorbs than its volume would;
// the normalisation says that the lump lies in the effective medium itself: 1 + k t* is the harmonic mean of 1 + k t_i.
// q = 7/4 lies between 1 (scattered light that leaves its voxel as if it were not dark) and 2 (light scattered once,
// which has its way into the voxel and out of it). Flat voxels have b = 0: light that goes down has to go through them.
// One resin, equal resins and voxels of vanishing size give Eq. 7; a body that absorbs nothing stays so.
//
// Droplets run together before they are cured. How far is one number of the set, its dot spread s in [0, 1]: l above is
// (1 - s) times the voxel's, so that s = 0 are sharp voxels, on which the constants rest, and s = 1 is Eq. 7, to which
// measured mixtures of a J750 are nearer (data/resins/README.md).
//
// The constants are one set for all resins and printers, fitted to Monte Carlo of halftones of random resins by
// benchmarks/optics/media/halftone_departure.cpp. Errors, in units of L* of a channel read as a grey: 0.1 to 0.2 rms,
// against 0.7 to 1.3 by Eq. 7 (benchmarks/results/accuracy). They belong to the blue-noise screen.
//
// Units mm, mm^-1. Range: any fractions >= 0, sigma_t up to about 1 / l (40 per mm for J750's voxels), p_z between a
// fifth and two and a half times sqrt(p_x p_y). What it cannot see: anything but the mean over many voxels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "optics/media/resins.h"

namespace voxtone::optics {

/// Which way light falls on the voxels: a picture is seen from above, along z; a body from all sides, for which the
/// mean of the three axes is taken.
enum class SeenFrom { above, all_sides };

struct EffectiveMediumConstants {
    double k_0 = 0.57, k_1 = 0.40, a = 0.40, b_1 = 0.95, h_0 = 0.16;
};

class EffectiveMedium {
public:
    EffectiveMedium() = default;
    /// Pitch of the voxels, mm; all 0: ideal mixtures, Eq. 7. Contract: all above 0 or all 0.
    EffectiveMedium(const ResinSet& resins, const std::array<double, 3>& pitch_mm, SeenFrom seen = SeenFrom::above,
                    const EffectiveMediumConstants& constants = {});

    /// `fractions`: one per resin; they need not sum to 1 exactly.
    [[nodiscard]] Medium operator()(std::span<const double> fractions, std::size_t channel) const;
    /// The same with what its derivatives need.
    struct Point {
        Medium medium;
        double k = 0, u = 0, V = 0, W = 0, scattering_norm = 1;  ///< as above; u is u*, the norm is W^q V
        double W_k = 0, A_k = 0, S_k = 0;  ///< derivatives by k of W and of the sums over absorption and scattering
    };
    [[nodiscard]] Point at(std::span<const double> fractions, std::size_t channel) const;
    /// out[r] = by_absorption d sigma_a* / d f_r + by_scattering d sigma_s* / d f_r, every fraction taken as free.
    void gradient(const Point& point, std::size_t channel, double by_absorption, double by_scattering,
                  std::span<double> out) const;
    /// Derivatives of the medium by what the resins are: by ln sigma_a and ln sigma_s of each, and by the logarithm of
    /// the voxels' chord, which is that of 1 - dot_spread (0 of ideal mixtures).
    struct ByResins {
        std::vector<Medium> by_absorption, by_scattering;  ///< one per resin
        Medium by_chord;
    };
    void by_resins(const Point& point, std::span<const double> fractions, std::size_t channel, ByResins& out) const;

    [[nodiscard]] bool ideal() const { return ideal_; }
    /// No mixture absorbs or scatters more than this.
    [[nodiscard]] Medium bound(std::size_t channel) const;

private:
    struct Constants {
        double sigma_a, sigma_s, t, u, v;  ///< as above
    };
    [[nodiscard]] std::span<const Constants> constants(std::size_t channel) const {
        return {constants_.data() + channel * resins_, resins_};
    }
    std::size_t resins_ = 0;
    double k_0_ = 0, k_1_ = 0, b_ = 0;
    bool ideal_ = true;
    std::vector<Constants> constants_;  ///< [channel * resins + resin]
};

}  // namespace voxtone::optics
