// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/lamp.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "base/contracts.h"
#include "optics/colour/cie_tables.h"
#include "optics/colour/colour.h"

namespace voxtone::optics {

namespace {

static_assert(lamp_samples == cie::samples && lamp_first_nm == cie::first_nm && lamp_step_nm == cie::step_nm);

// Fluorescent lamps 2 (cool white) and 11 (three narrow bands), LEDs of phosphor of 2,733 and 4,103 K: CIE 15:2018 as
// the colour-science library holds them (colour/colorimetry/datasets/illuminants/sds.py, BSD-3-Clause).
constexpr LampPower power_fl2 = {1.18,  1.48,  1.84,  2.15,  3.44,  15.69, 3.85,  3.74,  4.19,  4.62,  5.06,  34.98,
                                 11.81, 6.27,  6.63,  6.93,  7.19,  7.4,   7.54,  7.62,  7.65,  7.62,  7.62,  7.45,
                                 7.28,  7.15,  7.05,  7.04,  7.16,  7.47,  8.04,  8.88,  10.01, 24.88, 16.64, 14.59,
                                 16.16, 17.56, 18.62, 21.47, 22.79, 19.29, 18.66, 17.73, 16.54, 15.21, 13.8,  12.36,
                                 10.95, 9.65,  8.4,   7.32,  6.31,  5.43,  4.68,  4.02,  3.45,  2.96,  2.55,  2.19,
                                 1.89,  1.64,  1.53,  1.27,  1.1,   0.99,  0.88,  0.76,  0.68,  0.61,  0.56,  0.54,
                                 0.51,  0.47,  0.47,  0.43,  0.46,  0.47,  0.4,   0.33,  0.27};
constexpr LampPower power_fl11 = {
    0.91,  0.63, 0.46, 0.37, 1.29,  12.68, 1.59,  1.79,  2.46,  3.33, 4.49, 33.94, 12.13, 6.95,  7.19,  7.12,  6.72,
    6.13,  5.46, 4.79, 5.66, 14.29, 14.96, 8.97,  4.72,  2.33,  1.47, 1.1,  0.89,  0.83,  1.18,  4.9,   39.59, 72.84,
    32.61, 7.52, 2.83, 1.96, 1.67,  4.43,  11.28, 14.76, 12.73, 9.74, 7.33, 9.72,  55.27, 42.58, 13.18, 13.16, 12.26,
    5.11,  2.07, 2.34, 3.58, 3.01,  2.48,  2.14,  1.54,  1.33,  1.46, 1.94, 2,     1.2,   1.35,  4.1,   5.58,  2.51,
    0.57,  0.27, 0.23, 0.21, 0.24,  0.24,  0.2,   0.24,  0.32,  0.26, 0.16, 0.12,  0.09};
constexpr LampPower power_led_b1 = {
    0,     0.01,  0.01,  0.02,  0.04,  0.07,  0.15,  0.28,  0.53,  0.92,  1.54, 2.52, 4.16,  6.39,  7.89,  7.57,  6.25,
    5.16,  4.37,  3.84,  3.7,   3.88,  4.26,  4.79,  5.41,  6.05,  6.7,   7.34, 7.98, 8.64,  9.31,  10.02, 10.76, 11.53,
    12.38, 13.28, 14.23, 15.2,  16.2,  17.19, 18.14, 19.02, 19.78, 20.38, 20.8, 21,   20.97, 20.71, 20.23, 19.56, 18.76,
    17.82, 16.78, 15.66, 14.49, 13.31, 12.15, 11.02, 9.95,  8.93,  7.98,  7.1,  6.3,  5.57,  4.89,  4.26,  3.72,  3.25,
    2.83,  2.47,  2.15,  1.87,  1.63,  1.42,  1.25,  1.1,   0.97,  0.86,  0.76, 0.68, 0.61};
constexpr LampPower power_led_b3 = {0,     0,     0.01,  0.02,  0.05,  0.11,  0.25,  0.56,  1.2,   2.37,  4.24,  7.17,
                                    12.11, 17.7,  18.87, 14.58, 9.9,   7.53,  6.02,  5.11,  5.17,  5.82,  6.77,  7.88,
                                    8.94,  9.82,  10.52, 11.06, 11.51, 11.93, 12.37, 12.83, 13.31, 13.79, 14.26, 14.68,
                                    15.08, 15.42, 15.72, 15.97, 16.18, 16.37, 16.5,  16.55, 16.5,  16.32, 16,    15.54,
                                    14.96, 14.27, 13.48, 12.62, 11.71, 10.78, 9.85,  8.93,  8.04,  7.2,   6.42,  5.69,
                                    5.02,  4.42,  3.88,  3.39,  2.95,  2.56,  2.22,  1.92,  1.65,  1.43,  1.23,  1.06,
                                    0.91,  0.78,  0.68,  0.58,  0.5,   0.43,  0.37,  0.32,  0.28};

constexpr std::array<std::pair<std::string_view, const LampPower*>, 7> lamps_by_name{{{"A", &cie::power_a},
                                                                                      {"D50", &cie::power_d50},
                                                                                      {"D65", &cie::power_d65},
                                                                                      {"F2", &power_fl2},
                                                                                      {"F11", &power_fl11},
                                                                                      {"LED-B1", &power_led_b1},
                                                                                      {"LED-B3", &power_led_b3}}};

std::string in_capitals(std::string_view text) {
    std::string capitals(text);
    for (char& c : capitals)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return capitals;
}

double sample_nm(std::size_t k) { return lamp_first_nm + lamp_step_nm * static_cast<double>(k); }

/// Half of the way to the neighbours on both sides; of the first and last as if there were one more as far off.
double width_of(std::span<const double> nm, std::size_t i) {
    const double below = i > 0 ? nm[i] - nm[i - 1] : nm[1] - nm[0];
    const double above = i + 1 < nm.size() ? nm[i + 1] - nm[i] : nm[i] - nm[i - 1];
    return (below + above) / 2;
}

}  // namespace

std::optional<LampPower> known_lamp(std::string_view name) {
    const std::string word = in_capitals(name);
    for (const auto& [known_name, power] : lamps_by_name)
        if (word == known_name) return *power;
    double kelvin = 0;
    const char* const end = word.data() + word.size();
    const auto [rest, status] = std::from_chars(word.data(), end, kelvin);
    if (status != std::errc{} || rest + 1 != end || *rest != 'K' || !(kelvin >= 500 && kelvin <= 1e5))
        return std::nullopt;
    return black_body(kelvin);
}

std::vector<std::string> lamp_names() {
    std::vector<std::string> names;
    for (const auto& lamp : lamps_by_name) names.emplace_back(lamp.first);
    return names;
}

LampPower black_body(double kelvin) {
    VOXTONE_EXPECT(kelvin >= 500 && kelvin <= 1e5);
    constexpr double c2_nm_k = 1.4388e7, at_nm = 560;
    const auto radiance = [&](double nm) { return std::pow(at_nm / nm, 5) / std::expm1(c2_nm_k / (nm * kelvin)); };
    LampPower power{};
    for (std::size_t k = 0; k < lamp_samples; ++k) power[k] = 100 * radiance(sample_nm(k)) / radiance(at_nm);
    return power;
}

LampPower sampled_lamp(std::span<const double> nm, std::span<const double> given) {
    VOXTONE_EXPECT(nm.size() >= 2 && nm.size() == given.size());
    LampPower power{};
    for (std::size_t k = 0; k < lamp_samples; ++k) {
        const double at = sample_nm(k);
        if (at < nm.front() || at > nm.back()) continue;
        const auto above = static_cast<std::size_t>(std::upper_bound(nm.begin(), nm.end(), at) - nm.begin());
        const std::size_t left = std::min(above, nm.size() - 1) - 1;
        if (nm[left + 1] - nm[left] > lamp_step_nm) {
            const double t = (at - nm[left]) / (nm[left + 1] - nm[left]);
            power[k] = (1 - t) * given[left] + t * given[left + 1];
            continue;
        }
        double sum = 0, weights = 0;
        for (std::size_t i = 0; i < nm.size(); ++i) {
            const double weight = std::max(0.0, 1 - std::abs(nm[i] - at) / lamp_step_nm) * width_of(nm, i);
            sum += weight * given[i], weights += weight;
        }
        power[k] = sum / weights;
    }
    return power;
}

Eigen::Matrix3Xd xyz_weights(std::span<const double> wavelengths_nm, const LampPower& power) {
    return cie::xyz_weights(wavelengths_nm, power);
}

Eigen::Matrix3d guessed_colours(Illuminant illuminant, const LampPower& power) {
    constexpr Eigen::Index n = lamp_samples;
    std::vector<double> nm;
    for (std::size_t k = 0; k < lamp_samples; ++k) nm.push_back(sample_nm(k));
    const Eigen::Matrix3Xd known = xyz_weights(nm, illuminant);
    // Least slope where known * rho is given: Lagrange's equations.
    Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(n + 3, n + 3);
    for (Eigen::Index k = 0; k + 1 < n; ++k) {
        ++equations(k, k), ++equations(k + 1, k + 1);
        --equations(k, k + 1), --equations(k + 1, k);
    }
    equations.topRightCorner(n, 3) = known.transpose();
    equations.bottomLeftCorner(3, n) = known;
    Eigen::MatrixXd given = Eigen::MatrixXd::Zero(n + 3, 3);
    given.bottomRows(3).setIdentity();
    const Eigen::MatrixXd spectra = equations.partialPivLu().solve(given).topRows(n);
    return xyz_weights(nm, power) * spectra;
}

Channels seen_under(const Channels& channels, const LampPower& power) {
    Eigen::Matrix3Xd weights;
    if (channels.is_spectral()) {
        weights = xyz_weights(channels.wavelengths_nm, power);
    } else {
        weights = xyz_from_linear_srgb_matrix();
        if (channels.is_own()) weights.resize(3, static_cast<Eigen::Index>(channels.size()));
        for (std::size_t c = 0; c < channels.xyz.size(); ++c)
            weights.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::Vector3d>(channels.xyz[c].data());
        weights = guessed_colours(channels.is_own() ? channels.illuminant : Illuminant::d65, power) * weights;
    }
    const Eigen::Vector3d white = weights.rowwise().sum();
    Channels seen;
    seen.illuminant = Illuminant::d65;
    for (Eigen::Index c = 0; c < weights.cols(); ++c) {
        const Eigen::Vector3d xyz = adapt_white(weights.col(c), white, d65_white());
        seen.xyz.push_back({xyz[0], xyz[1], xyz[2]});
    }
    return seen;
}

}  // namespace voxtone::optics
