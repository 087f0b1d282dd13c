// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/layer_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

// A layer of T = 0 has no finite K, one of R = 1 no finite S: these are as near as both stay finite for any thickness
// in use.
constexpr double least_transmission = 1e-300;
constexpr double largest_reflection = 1 - 0x1p-50;

// What goes back and forth between two layers is repeated this often. A reflection of 1 from both sides lets nothing in
// between.
double echoes(double R_bottom, double R_top) {
    const double lost = 1 - R_bottom * R_top;
    return lost > 0 ? 1 / lost : 0;
}

double in_unit(double x) { return std::clamp(x, 0.0, 1.0); }

// tanh(z) / z.
double tanh_ratio(double z) { return z > 1e-4 ? std::tanh(z) / z : 1 - z * z / 3; }

// atanh(u) / u, given 1 - u^2 besides, which says more than u where u is close to 1.
double atanh_ratio(double u, double one_minus_u2) {
    return u > 1e-4 ? (std::log1p(u) - 0.5 * std::log(one_minus_u2)) / u : 1 + u * u / 3;
}

// 1 / cosh^2(z).
double sech2(double z) {
    const double e = std::exp(-2 * z);
    return 4 * e / ((1 + e) * (1 + e));
}

}  // namespace

LayerProfile no_layer(std::size_t coefficients) {
    return {std::vector<double>(coefficients, 1.0), std::vector<double>(coefficients, 0.0),
            std::vector<double>(coefficients, 0.0)};
}

LayerProfile laminate(const LayerProfile& upper, const LayerProfile& lower) {
    const std::size_t n = upper.size();
    for (const LayerProfile* layer : {&upper, &lower})
        VOXTONE_EXPECT(layer->T.size() == n && layer->R_top.size() == n && layer->R_bottom.size() == n);
    LayerProfile both{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
    for (std::size_t i = 0; i < n; ++i) {
        const double T_1 = upper.T[i], T_2 = lower.T[i];
        const double repeated = echoes(upper.R_bottom[i], lower.R_top[i]);
        both.T[i] = in_unit(T_1 * T_2 * repeated);
        both.R_top[i] = in_unit(upper.R_top[i] + T_1 * T_1 * lower.R_top[i] * repeated);
        both.R_bottom[i] = in_unit(lower.R_bottom[i] + T_2 * T_2 * upper.R_bottom[i] * repeated);
    }
    return both;
}

HomogeneousLayer::HomogeneousLayer(std::span<const double> T, std::span<const double> R, double thickness_mm)
    : K_(T.size()), S_(T.size()) {
    VOXTONE_EXPECT(T.size() == R.size());
    VOXTONE_EXPECT(thickness_mm > 0 && std::isfinite(thickness_mm));
    for (std::size_t i = 0; i < T.size(); ++i) {
        VOXTONE_EXPECT(std::isfinite(T[i]) && std::isfinite(R[i]));
        double t = in_unit(T[i]), r = in_unit(R[i]);
        if (t + r > 1) {
            const double sum = t + r;
            t /= sum;
            r /= sum;
        }
        clamped_ = std::max({clamped_, std::abs(t - T[i]), std::abs(r - R[i])});
        t = std::max(t, least_transmission);
        r = std::min(r, largest_reflection);
        const double alike = 1 + t + r, opposed = 1 + t - r;
        const double x = std::max(0.0, 1 - t - r) / alike, y = (1 - t + r) / opposed;
        const double scale = atanh_ratio(std::sqrt(x * y), 4 * t / (alike * opposed)) / thickness_mm;
        K_[i] = 2 * x * scale;
        S_[i] = 4 * r / (alike * opposed) * scale;
    }
}

LayerProfile HomogeneousLayer::of_thickness(double mm) const {
    VOXTONE_EXPECT(mm >= 0);
    const std::size_t n = K_.size();
    LayerProfile layer{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
    for (std::size_t i = 0; i < n; ++i) {
        const double K = K_[i], S = S_[i], gamma = std::sqrt(K) * std::sqrt(K + 2 * S);
        if (K + S == 0) {  // clear, however thick
            layer.T[i] = 1;
            continue;
        }
        if (std::isinf(mm)) {
            layer.R_top[i] = in_unit(S / (K + S + gamma));
        } else {
            const double z = 0.5 * gamma * mm, half = 0.5 * mm * tanh_ratio(z);
            const double x = K * half, y = (K + 2 * S) * half;
            const double scale = 1 / ((1 + x) * (1 + y));
            layer.T[i] = in_unit(sech2(z) * scale);
            layer.R_top[i] = in_unit(2 * S * half * scale);
        }
        layer.R_bottom[i] = layer.R_top[i];
    }
    return layer;
}

}  // namespace voxtone::optics
