// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/effective_medium.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"

namespace voxtone::optics {

namespace {

// w^q with q = 7/4, and its derivative by w.
double power(double w) { return w * std::sqrt(w) * std::sqrt(std::sqrt(w)); }
constexpr double q = 1.75;

}  // namespace

EffectiveMedium::EffectiveMedium(const ResinSet& resins, const std::array<double, 3>& pitch_mm, SeenFrom seen,
                                 const EffectiveMediumConstants& constants)
    : resins_(resins.resins.size()), k_0_(constants.k_0), k_1_(constants.k_1) {
    const auto [least, most] = std::minmax_element(pitch_mm.begin(), pitch_mm.end());
    VOXTONE_EXPECT(*least > 0 || (*least == 0 && *most == 0));
    const double sharp = 1 - resins.dot_spread;
    ideal_ = *least == 0 || sharp == 0;
    double chord = 0, absorbing = 0;
    if (!ideal_) {
        chord = sharp * 2 / (1 / pitch_mm[0] + 1 / pitch_mm[1] + 1 / pitch_mm[2]);
        const std::size_t first = seen == SeenFrom::above ? 2 : 0;
        const double share = 1.0 / static_cast<double>(3 - first);
        for (std::size_t up = first; up < 3; ++up) {
            const double along = pitch_mm[up], across = std::sqrt(pitch_mm[(up + 1) % 3] * pitch_mm[(up + 2) % 3]);
            const double h = along / (across + 0.5 * along);
            absorbing += share * chord * (1 + constants.a * (h - 0.4));
            b_ += share * constants.b_1 * std::max(h - constants.h_0, 0.0);
        }
    }
    for (std::size_t c = 0; c < resins.channels.size(); ++c)
        for (const Resin& resin : resins.resins) {
            const Medium m = resin.medium(c);
            const double t = absorbing * m.sigma_a, u = chord * (1 - resins.g) * m.sigma_s;
            constants_.push_back({m.sigma_a, m.sigma_s, t, u, 1 / (1 + b_ * u)});
        }
}

Medium EffectiveMedium::operator()(std::span<const double> f, std::size_t channel) const {
    return at(f, channel).medium;
}

EffectiveMedium::Point EffectiveMedium::at(std::span<const double> f, std::size_t channel) const {
    VOXTONE_EXPECT(f.size() == resins_);
    const std::span<const Constants> of = constants(channel);
    Point p;
    if (ideal()) {
        for (std::size_t r = 0; r < f.size(); ++r) {
            p.medium.sigma_a += f[r] * of[r].sigma_a;
            p.medium.sigma_s += f[r] * of[r].sigma_s;
        }
        return p;
    }
    double U = 0;
    for (std::size_t r = 0; r < f.size(); ++r) {
        p.V += f[r] * of[r].v;
        U += f[r] * of[r].v * of[r].u;
    }
    p.u = U / p.V;
    p.k = k_0_ + k_1_ * p.u;
    double A = 0, S = 0;
    for (std::size_t r = 0; r < f.size(); ++r) {
        const double w = 1 / (1 + p.k * of[r].t);
        const double fw = f[r] * w, fa = fw * of[r].sigma_a, fs = f[r] * power(w) * of[r].v * of[r].sigma_s;
        const double slope = -of[r].t * w;  // d ln w / d k
        p.W += fw, A += fa, S += fs;
        p.W_k += fw * slope, p.A_k += fa * slope, p.S_k += q * fs * slope;
    }
    p.scattering_norm = power(p.W) * p.V;
    p.medium = {A / p.W, S / p.scattering_norm};
    return p;
}

void EffectiveMedium::gradient(const Point& p, std::size_t channel, double by_absorption, double by_scattering,
                               std::span<double> out) const {
    VOXTONE_EXPECT(out.size() == resins_);
    const std::span<const Constants> of = constants(channel);
    if (ideal()) {
        for (std::size_t r = 0; r < resins_; ++r)
            out[r] = by_absorption * of[r].sigma_a + by_scattering * of[r].sigma_s;
        return;
    }
    for (std::size_t r = 0; r < resins_; ++r) {
        const double w = 1 / (1 + p.k * of[r].t), v = of[r].v;
        const double dk = k_1_ * (of[r].u - p.u) * v / p.V;
        const double dW = w + p.W_k * dk;
        const double d_sigma_a = (w * of[r].sigma_a + p.A_k * dk - p.medium.sigma_a * dW) / p.W;
        const double d_sigma_s = (power(w) * v * of[r].sigma_s + p.S_k * dk) / p.scattering_norm -
                                 p.medium.sigma_s * (q * dW / p.W + v / p.V);
        out[r] = by_absorption * d_sigma_a + by_scattering * d_sigma_s;
    }
}

void EffectiveMedium::by_resins(const Point& p, std::span<const double> f, std::size_t channel, ByResins& out) const {
    VOXTONE_EXPECT(f.size() == resins_);
    const std::span<const Constants> of = constants(channel);
    out.by_absorption.assign(resins_, {}), out.by_scattering.assign(resins_, {});
    out.by_chord = {};
    if (ideal()) {
        for (std::size_t r = 0; r < resins_; ++r) {
            out.by_absorption[r].sigma_a = f[r] * of[r].sigma_a;
            out.by_scattering[r].sigma_s = f[r] * of[r].sigma_s;
        }
        return;
    }
    const auto step = [&](double dA, double dW, double dS, double dV) {
        return Medium{(dA - p.medium.sigma_a * dW) / p.W,
                      dS / p.scattering_norm - p.medium.sigma_s * (q * dW / p.W + dV / p.V)};
    };
    Medium chord;
    for (std::size_t r = 0; r < resins_; ++r) {
        const auto& [sigma_a, sigma_s, t, u, v] = of[r];
        const double w = 1 / (1 + p.k * t), wq = power(w);
        // t_i by a step of its logarithm: absorption's own, and half of what a longer chord does.
        const double dw = -p.k * t * w * w;
        const Medium by_t = step(f[r] * dw * sigma_a, f[r] * dw, f[r] * q * wq / w * dw * v * sigma_s, 0);
        const Medium by_a = step(f[r] * w * sigma_a, 0, 0, 0);
        out.by_absorption[r] = {by_t.sigma_a + by_a.sigma_a, by_t.sigma_s + by_a.sigma_s};
        // u_i by a step of its logarithm: it moves v_i and, for all resins, k.
        const double dv = -b_ * u * v * v, dV = f[r] * dv;
        const double dk = k_1_ * (f[r] * (dv + v) * u - p.u * dV) / p.V;
        const Medium by_u = step(p.A_k * dk, p.W_k * dk, p.S_k * dk + f[r] * wq * dv * sigma_s, dV);
        const Medium by_s = step(0, 0, f[r] * wq * v * sigma_s, 0);
        out.by_scattering[r] = {by_u.sigma_a + by_s.sigma_a, by_u.sigma_s + by_s.sigma_s};
        chord.sigma_a += by_t.sigma_a + by_u.sigma_a, chord.sigma_s += by_t.sigma_s + by_u.sigma_s;
    }
    out.by_chord = chord;
}

Medium EffectiveMedium::bound(std::size_t channel) const {
    Medium most;
    double t = 0, u = 0;
    for (const Constants& resin : constants(channel)) {
        most.sigma_a = std::max(most.sigma_a, resin.sigma_a);
        most.sigma_s = std::max(most.sigma_s, resin.sigma_s);
        t = std::max(t, resin.t);
        u = std::max(u, resin.u);
    }
    // f phi <= 1 and phi <= 1 / w; v / V <= 1 / min v is met where f v / V <= 1.
    if (!ideal()) most.sigma_s *= std::pow(1 + (k_0_ + k_1_ * u) * t, q - 1);
    return most;
}

}  // namespace voxtone::optics
