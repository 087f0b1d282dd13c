// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/spectral_colour.h"

#include <algorithm>
#include <array>

#include "base/contracts.h"
#include "optics/colour/colour.h"

namespace voxtone::optics {

namespace {

constexpr std::size_t samples = 81;  // of the tables below: 380 to 780 nm
constexpr double first_nm = 380, step_nm = 5;

// CIE 1931 2-degree standard observer (CIE 018:2019), dimensionless, every fifth value of the 1 nm table as the
// colour-science library holds it (colour/colorimetry/datasets/cmfs.py, BSD-3-Clause).
constexpr std::array<double, samples> xbar = {
    0.001368,     0.002236,     0.004243,     0.00765,      0.01431,      0.02319,     0.04351,      0.07763,
    0.13438,      0.21477,      0.2839,       0.3285,       0.34828,      0.34806,     0.3362,       0.3187,
    0.2908,       0.2511,       0.19536,      0.1421,       0.09564,      0.05795001,  0.03201,      0.0147,
    0.0049,       0.0024,       0.0093,       0.0291,       0.06327,      0.1096,      0.1655,       0.2257499,
    0.2904,       0.3597,       0.4334499,    0.5120501,    0.5945,       0.6784,      0.7621,       0.8425,
    0.9163,       0.9786,       1.0263,       1.0567,       1.0622,       1.0456,      1.0026,       0.9384,
    0.8544499,    0.7514,       0.6424,       0.5419,       0.4479,       0.3608,      0.2835,       0.2187,
    0.1649,       0.1212,       0.0874,       0.0636,       0.04677,      0.0329,      0.0227,       0.01584,
    0.01135916,   0.008110916,  0.005790346,  0.004109457,  0.002899327,  0.00204919,  0.001439971,  0.0009999493,
    0.0006900786, 0.0004760213, 0.0003323011, 0.0002348261, 0.0001661505, 0.000117413, 8.307527e-05, 5.870652e-05,
    4.150994e-05};
constexpr std::array<double, samples> ybar = {
    3.9e-05,  6.4e-05,   0.00012,  0.000217, 0.000396, 0.00064,   0.00121,   0.00218,   0.004,    0.0073,    0.0116,
    0.01684,  0.023,     0.0298,   0.038,    0.048,    0.06,      0.0739,    0.09098,   0.1126,   0.13902,   0.1693,
    0.20802,  0.2586,    0.323,    0.4073,   0.503,    0.6082,    0.71,      0.7932,    0.862,    0.9148501, 0.954,
    0.9803,   0.9949501, 1,        0.995,    0.9786,   0.952,     0.9154,    0.87,      0.8163,   0.757,     0.6949,
    0.631,    0.5668,    0.503,    0.4412,   0.381,    0.321,     0.265,     0.217,     0.175,    0.1382,    0.107,
    0.0816,   0.061,     0.04458,  0.032,    0.0232,   0.017,     0.01192,   0.00821,   0.005723, 0.004102,  0.002929,
    0.002091, 0.001484,  0.001047, 0.00074,  0.00052,  0.0003611, 0.0002492, 0.0001719, 0.00012,  8.48e-05,  6e-05,
    4.24e-05, 3e-05,     2.12e-05, 1.499e-05};
constexpr std::array<double, samples> zbar = {0.006450001, 0.01054999,  0.02005001,
                                              0.03621,     0.06785001,  0.1102,
                                              0.2074,      0.3713,      0.6456,
                                              1.0390501,   1.3856,      1.62296,
                                              1.74706,     1.7826,      1.77211,
                                              1.7441,      1.6692,      1.5281,
                                              1.28764,     1.0419,      0.8129501,
                                              0.6162,      0.46518,     0.3533,
                                              0.272,       0.2123,      0.1582,
                                              0.1117,      0.07824999,  0.05725001,
                                              0.04216,     0.02984,     0.0203,
                                              0.0134,      0.008749999, 0.005749999,
                                              0.0039,      0.002749999, 0.0021,
                                              0.0018,      0.001650001, 0.0014,
                                              0.0011,      0.001,       0.0008,
                                              0.0006,      0.00034,     0.00024,
                                              0.00019,     0.0001,      4.999999e-05,
                                              3e-05,       2e-05,       1e-05,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0,
                                              0,           0,           0};

// Relative spectral power, 100 at 560 nm: CIE 15 and CIE 204 as the colour-science library holds them
// (colour/colorimetry/datasets/illuminants/sds.py, BSD-3-Clause).
constexpr std::array<double, samples> power_d65 = {
    49.9755, 52.3118, 54.6482, 68.7015, 82.7549, 87.1204, 91.486,  92.4589, 93.4318, 90.057,  86.6823, 95.7736,
    104.865, 110.936, 117.008, 117.41,  117.812, 116.336, 114.861, 115.392, 115.923, 112.367, 108.811, 109.082,
    109.354, 108.578, 107.802, 106.296, 104.79,  106.239, 107.689, 106.047, 104.405, 104.225, 104.046, 102.023,
    100,     98.1671, 96.3342, 96.0611, 95.788,  92.2368, 88.6856, 89.3459, 90.0062, 89.8026, 89.5991, 88.6489,
    87.6987, 85.4936, 83.2886, 83.4939, 83.6992, 81.863,  80.0268, 80.1207, 80.2146, 81.2462, 82.2778, 80.281,
    78.2842, 74.0027, 69.7213, 70.6652, 71.6091, 72.979,  74.349,  67.9765, 61.604,  65.7448, 69.8856, 72.4863,
    75.087,  69.3398, 63.5927, 55.0054, 46.4182, 56.6118, 66.8054, 65.0941, 63.3828};
constexpr std::array<double, samples> power_d50 = {
    24.488, 27.179, 29.871, 39.589, 49.308, 52.91,  56.513,  58.273,  60.034,  58.926,  57.818,  66.321,
    74.825, 81.036, 87.247, 88.93,  90.612, 90.99,  91.368,  93.238,  95.109,  93.536,  91.963,  93.843,
    95.724, 96.169, 96.613, 96.871, 97.129, 99.614, 102.099, 101.427, 100.755, 101.536, 102.317, 101.159,
    100,    98.868, 97.735, 98.327, 98.918, 96.208, 93.499,  95.593,  97.688,  98.478,  99.269,  99.155,
    99.042, 97.382, 95.722, 97.29,  98.857, 97.262, 95.667,  96.929,  98.19,   100.597, 103.003, 101.068,
    99.133, 93.257, 87.381, 89.492, 91.604, 92.246, 92.889,  84.872,  76.854,  81.683,  86.511,  89.546,
    92.58,  85.405, 78.23,  67.961, 57.692, 70.307, 82.923,  80.599,  78.274};
constexpr std::array<double, samples> power_a = {
    9.7951,  10.8996, 12.0853, 13.3543, 14.708,  16.148,  17.6753, 19.2907, 20.995,  22.7883, 24.6709, 26.6425,
    28.7027, 30.8508, 33.0859, 35.4068, 37.8121, 40.3002, 42.8693, 45.5174, 48.2423, 51.0418, 53.9132, 56.8539,
    59.8611, 62.932,  66.0635, 69.2525, 72.4959, 75.7903, 79.1326, 82.5193, 85.947,  89.4124, 92.912,  96.4423,
    100,     103.582, 107.184, 110.803, 114.436, 118.08,  121.731, 125.386, 129.043, 132.697, 136.346, 139.988,
    143.618, 147.235, 150.836, 154.418, 157.979, 161.516, 165.028, 168.51,  171.963, 175.383, 178.769, 182.118,
    185.429, 188.701, 191.931, 195.118, 198.261, 201.359, 204.409, 207.411, 210.365, 213.268, 216.12,  218.92,
    221.667, 224.361, 227,     229.585, 232.115, 234.589, 237.008, 239.37,  241.675};

const std::array<double, samples>& power_of(Illuminant illuminant) {
    switch (illuminant) {
        case Illuminant::d65:
            return power_d65;
        case Illuminant::d50:
            return power_d50;
        case Illuminant::a:
            return power_a;
    }
    VOXTONE_EXPECT(!"an illuminant that is known");
    return power_d65;
}

}  // namespace

Eigen::Matrix3Xd xyz_weights(std::span<const double> wavelengths_nm, Illuminant illuminant) {
    VOXTONE_EXPECT(!wavelengths_nm.empty() && std::is_sorted(wavelengths_nm.begin(), wavelengths_nm.end()));
    const std::array<double, samples>& power = power_of(illuminant);
    Eigen::Matrix3Xd weights = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(wavelengths_nm.size()));
    double white = 0;
    for (std::size_t k = 0; k < samples; ++k) {
        const double nm = first_nm + step_nm * static_cast<double>(k);
        const Eigen::Vector3d response = power[k] * Eigen::Vector3d(xbar[k], ybar[k], zbar[k]);
        white += response[1];
        const auto next = std::upper_bound(wavelengths_nm.begin(), wavelengths_nm.end(), nm) - wavelengths_nm.begin();
        if (next == 0) {
            weights.col(0) += response;
        } else if (next == weights.cols()) {
            weights.col(next - 1) += response;
        } else {
            const double left = wavelengths_nm[static_cast<std::size_t>(next - 1)];
            const double t = (nm - left) / (wavelengths_nm[static_cast<std::size_t>(next)] - left);
            weights.col(next - 1) += (1 - t) * response;
            weights.col(next) += t * response;
        }
    }
    return weights / white;
}

Eigen::Vector3d xyz_from_spectrum(std::span<const double> wavelengths_nm, std::span<const double> reflectance,
                                  Illuminant illuminant) {
    VOXTONE_EXPECT(wavelengths_nm.size() == reflectance.size());
    return xyz_weights(wavelengths_nm, illuminant) *
           Eigen::Map<const Eigen::VectorXd>(reflectance.data(), static_cast<Eigen::Index>(reflectance.size()));
}

Eigen::Matrix3Xd linear_srgb_weights(std::span<const double> wavelengths_nm) {
    if (wavelengths_nm.empty()) return Eigen::Matrix3d::Identity();
    Eigen::Matrix3Xd weights = xyz_weights(wavelengths_nm, Illuminant::d65);
    const Eigen::Vector3d white = weights.rowwise().sum();
    for (Eigen::Index c = 0; c < weights.cols(); ++c)
        weights.col(c) = linear_srgb_from_xyz(adapt_white(weights.col(c), white, d65_white()));
    return weights;
}

Eigen::Vector3d spectral_white(Illuminant illuminant) {
    const double anywhere = 560;
    return xyz_weights(std::span(&anywhere, 1), illuminant).col(0);
}

}  // namespace voxtone::optics
