// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measured charts drawn by a known set: four channels of its own, colours of which some lie outside sRGB.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "calibration/patches/patch_table.h"
#include "optics/colour/colour.h"
#include "optics/layered/flat_colour.h"
#include "optics/layered/half_space_reflectance.h"

namespace voxtone::testing {

inline optics::ResinSet wide_gamut_set() {
    optics::ResinSet set;
    set.name = "wide";
    set.dot_spread = 1;
    const Eigen::Vector3d white = optics::d50_white();
    const std::vector<std::array<double, 3>> shares{
        {0.12, 0.02, 0.93}, {0.03, 0.33, 0.06}, {0.30, 0.47, 0.01}, {0.55, 0.18, 0}};
    for (const auto& share : shares)
        set.channels.xyz.push_back({share[0] * white[0], share[1] * white[1], share[2] * white[2]});
    set.resins = {{"C", "C", {6, 5, 8, 14}, {0.985, 0.96, 0.7, 0.12}},
                  {"M", "M", {5, 9, 11, 4}, {0.9, 0.25, 0.15, 0.995}},
                  {"Y", "Y", {13, 6, 4, 4}, {0.1, 0.93, 0.9985, 0.9988}},
                  {"K", "K", {6, 6, 6, 6}, {0.35, 0.35, 0.35, 0.35}},
                  {"W", "W", {18, 12, 9, 7}, {0.9985, 0.9992, 0.9993, 0.9994}}};
    set.measured = {optics::MeasuringGeometry::directional_45_0, 0.008, 0.97};
    return set;
}

/// Shares of five resins, few of them in most mixtures, white in many.
inline std::vector<double> drawn_shares(std::uint64_t seed, std::uint64_t patch) {
    RandomStream random(seed, patch);
    std::vector<double> shares(5);
    double sum = 0;
    for (std::size_t r = 0; r < shares.size(); ++r) {
        const double u = random.uniform(), kept = random.uniform();
        shares[r] = kept < (r == 4 ? 0.8 : 0.5) ? -std::log(1 - u) : 0;
        sum += shares[r];
    }
    if (sum == 0) shares[4] = sum = 1;
    for (double& share : shares) share /= sum;
    return shares;
}

/// Patches of the solids and of drawn mixtures as a colorimeter reads them; `noise` in units of L*.
inline calibration::PatchTable drawn_chart(const optics::ResinSet& set, std::size_t count, std::uint64_t seed,
                                           double noise) {
    calibration::PatchTable table;
    table.source = "drawn";
    table.is_chart = true;
    table.channels = optics::colorimetric_channels(set.channels.illuminant);
    const optics::FlatColour flat(set);
    for (std::size_t p = 0; p < count; ++p) {
        std::vector<double> shares(5);
        if (p < 5)
            shares[p] = 1;
        else
            shares = drawn_shares(seed, p);
        RandomStream random(seed, p, 1);
        Eigen::Vector3d roots = optics::lab_roots(flat.xyz(shares), flat.white());
        for (Eigen::Index k = 0; k < 3; ++k) roots[k] += noise / 116 * std::sqrt(12.0) * (random.uniform() - 0.5);
        const Eigen::Vector3d xyz = optics::xyz_of_roots(roots, flat.white()).cwiseQuotient(flat.white());
        calibration::Patch patch;
        for (std::size_t r = 0; r < 5; ++r)
            if (shares[r] > 0) patch.top.push_back({set.resins[r].role, shares[r]});
        patch.rho = {xyz[0], xyz[1], xyz[2]};
        table.patches.push_back(patch);
    }
    return table;
}

/// The same of resins whose spectra are smooth curves, measured from 400 to 700 nm; `noise` in units of reflectance.
inline calibration::PatchTable drawn_spectra(std::size_t count, std::uint64_t seed, double noise) {
    calibration::PatchTable table;
    table.source = "spectra";
    table.is_chart = true;
    for (int nm = 400; nm <= 700; nm += 10) table.channels.wavelengths_nm.push_back(nm);
    const optics::HalfSpaceReflectance reflectance(0.4, 1.5, optics::MeasuringGeometry::directional_45_0);
    const auto bell = [](double nm, double middle, double width) {
        return std::exp(-0.5 * (nm - middle) * (nm - middle) / (width * width));
    };
    const std::string roles = "CMYKW";
    for (std::size_t p = 0; p < count; ++p) {
        std::vector<double> shares(5);
        if (p < 5)
            shares[p] = 1;
        else
            shares = drawn_shares(seed, p);
        calibration::Patch patch;
        for (std::size_t r = 0; r < 5; ++r)
            if (shares[r] > 0) patch.top.push_back({roles.substr(r, 1), shares[r]});
        RandomStream random(seed, p, 1);
        for (const double nm : table.channels.wavelengths_nm) {
            const double absorbs[] = {9 * bell(nm, 640, 45) + 3 * bell(nm, 580, 30) + 0.1,
                                      5 * bell(nm, 565, 18) + 4 * bell(nm, 525, 22) + 0.8 * bell(nm, 410, 30) + 0.05,
                                      14 / (1 + std::exp((nm - 488) / 9)) + 0.01, 6.0, 0.01 + 0.2 * bell(nm, 390, 12)};
            const double white = 16 * std::pow(550 / nm, 1.2);
            optics::Medium medium;
            for (std::size_t r = 0; r < 5; ++r) {
                medium.sigma_a += shares[r] * absorbs[r];
                medium.sigma_s += shares[r] * white * (r == 4 ? 1 : r == 3 ? 0.3 : 0.5);
            }
            patch.rho.push_back(0.97 * (0.008 + reflectance(medium)) +
                                noise * std::sqrt(12.0) * (random.uniform() - 0.5));
        }
        table.patches.push_back(patch);
    }
    return table;
}

}  // namespace voxtone::testing
