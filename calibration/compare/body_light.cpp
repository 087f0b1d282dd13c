// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/body_light.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "optics/numerics/median.h"

namespace voxtone::calibration {

namespace {

constexpr double dark_place = 0.05;  // of white: what is darker weighs as this

Eigen::Vector3d diffuse_of(const LitPlace& place) { return place.predicted * place.transmitted; }

/// Of both sides of an equation: a twentieth of white is as much of black as of grey.
double weight_of(double predicted) { return 1 / (std::max(predicted, 0.0) + dark_place); }

}  // namespace

SkyTerms sky_terms_of(const Eigen::Vector3d& d) {
    const double x = d.x(), y = d.y(), z = d.z();
    return {1, x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1};
}

SkyTerms diffuse_terms_of(const Eigen::Vector3d& normal) {
    SkyTerms terms = sky_terms_of(normal);
    for (std::size_t k = 1; k < 4; ++k) terms[k] *= 2.0 / 3;
    for (std::size_t k = 4; k < sky_terms; ++k) terms[k] *= 0.25;
    return terms;
}

Eigen::Vector3d BodyLight::on(const LitPlace& place) const {
    Eigen::Vector3d on = of_body_ * place.covered;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < sky_terms; ++k) on[Eigen::Index(c)] += light_[c][k] * place.diffuse[k];
    return on;
}

Eigen::Vector3d BodyLight::veil(const LitPlace& place) const {
    double sky = 0;
    for (const SkyTerms& light : light_)
        for (std::size_t k = 0; k < sky_terms; ++k) sky += light[k] * place.mirrored[k] / 3;
    return gain_ * veil_ * place.fresnel * std::max(sky, 0.0);
}

Eigen::Vector3d BodyLight::model(const LitPlace& place) const {
    return gain_.cwiseProduct(diffuse_of(place)).cwiseProduct(on(place)) + veil(place);
}

Eigen::Vector3d BodyLight::colour(const LitPlace& place) const {
    return (place.seen - veil(place)).cwiseQuotient(on(place).cwiseMax(1e-3)) / place.transmitted;
}

bool BodyLight::highlight(const LitPlace& place) const {
    constexpr double least = 0.06, share = 0.2, alike = 0.5;
    const Eigen::Vector3d as = model(place).cwiseQuotient(gain_), more = place.seen.cwiseQuotient(gain_) - as;
    return more.minCoeff() > std::max(least, share * as.mean()) && more.minCoeff() > alike * more.maxCoeff();
}

BodyLight BodyLight::fit(const std::vector<LitPlace>& places) {
    constexpr Eigen::Index n = sky_terms + 1;
    constexpr double tukey = 4.685, to_deviation = 1.4826;  // 95 % efficient; of the median of a normal one
    constexpr double as_body = 0.5;  // what the body's parts send to each other, of the sky's, where nothing tells it
    BodyLight light;
    for (std::size_t c = 0; c < 3; ++c) {
        light.light_[c][0] = 1;
        std::vector<double> ratios;
        for (const LitPlace& p : places)
            if (p.predicted[Eigen::Index(c)] > dark_place)
                ratios.push_back(p.seen[Eigen::Index(c)] / p.predicted[Eigen::Index(c)]);
        if (!ratios.empty()) light.gain_[Eigen::Index(c)] = std::max(optics::median(std::move(ratios)), 1e-6);
    }
    std::vector<double> weight(places.size(), 1), off(places.size());
    const auto weight_of_channel = [&](std::size_t i, Eigen::Index c) {
        return weight[i] * std::pow(weight_of(places[i].predicted[c]), 2);
    };
    constexpr int rounds = 16;
    for (int round = 0; round < rounds; ++round) {
        // The light, with the veil as it is; what no place tells stays even.
        const BodyLight before = light;
        for (Eigen::Index c = 0; c < 3; ++c) {
            Eigen::Matrix<double, n, n> normal = Eigen::Matrix<double, n, n>::Zero();
            Eigen::Matrix<double, n, 1> right = Eigen::Matrix<double, n, 1>::Zero(), row;
            for (std::size_t i = 0; i < places.size(); ++i) {
                const LitPlace& p = places[i];
                for (std::size_t k = 0; k < sky_terms; ++k) row[Eigen::Index(k)] = p.diffuse[k];
                row[n - 1] = p.covered;
                row *= diffuse_of(p)[c];
                const double w = weight_of_channel(i, c);
                normal += w * row * row.transpose();
                right += w * row * (p.seen[c] - before.veil(p)[c]);
            }
            const double prior = 1e-4 * normal(0, 0);
            for (Eigen::Index k = 1; k < n; ++k) normal(k, k) += prior;
            right[n - 1] += prior * as_body * before.gain_[c];
            const Eigen::Matrix<double, n, 1> solved = normal.ldlt().solve(right);
            light.gain_[c] = std::max(solved[0], 1e-6);
            for (std::size_t k = 0; k < sky_terms; ++k)
                light.light_[std::size_t(c)][k] = solved[Eigen::Index(k)] / light.gain_[c];
            light.of_body_[c] = solved[n - 1] / light.gain_[c];
        }
        // The veil.
        double above = 0, below = 1e-12;
        light.veil_ = 1;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const LitPlace& p = places[i];
            const Eigen::Vector3d veil = light.veil(p), diffuse = light.model(p) - veil;
            for (Eigen::Index c = 0; c < 3; ++c) {
                const double w = weight_of_channel(i, c) / (light.gain_[c] * light.gain_[c]);
                above += w * veil[c] * (p.seen[c] - diffuse[c]);
                below += w * veil[c] * veil[c];
            }
        }
        light.veil_ = std::clamp(above / below, 0.0, 2.0);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const LitPlace& p = places[i];
            const Eigen::Vector3d misfit = (p.seen - light.model(p)).cwiseQuotient(light.gain_);
            off[i] = 0;
            for (Eigen::Index c = 0; c < 3; ++c)
                off[i] = std::max(off[i], std::abs(misfit[c]) * weight_of(p.predicted[c]));
        }
        const double scale = std::max(to_deviation * optics::median(off), 1e-6);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double x = off[i] / (tukey * scale);
            weight[i] = x < 1 ? std::pow(1 - x * x, 2) : 0;
        }
    }
    return light;
}

}  // namespace voxtone::calibration
