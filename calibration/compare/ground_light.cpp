// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/ground_light.h"
#include "optics/numerics/median.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace voxtone::calibration {

namespace {

constexpr double ground_gap = 0.06;        // of the print's longer side: shadows and glow of the print lie there
constexpr int blocks_along = 48;           // the longer side of the picture
constexpr double least_ground = 0.004;     // of full scale: less is noise and stray light
constexpr std::size_t least_blocks = 100;  // that count
constexpr double least_counted = 0.6;      // of the blocks
constexpr double uneven_ground = 0.04;     // relative deviation: more is no even ground

/// Inside the figure, or nearer to it than `reach`.
bool within(const PrintCorners& corners, const Eigen::Vector2d& p, double reach) {
    for (std::size_t c = 0; c < 4; ++c) {
        const Eigen::Vector2d along = (corners[(c + 1) % 4] - corners[c]).normalized(), off = p - corners[c];
        if (along.x() * off.y() - along.y() * off.x() < -reach) return false;
    }
    return true;
}

PrintCorners corners_of(const PrintPlace& place) {
    const Eigen::Vector2d s = place.size();
    return {place.to_px({0, 0}), place.to_px({s.x(), 0}), place.to_px(s), place.to_px({0, s.y()})};
}

double brightness(const LitSample& sample) { return sample.value.sum() / 3; }

}  // namespace

std::vector<LitSample> ground_samples(const io::Photograph& photo, const PrintPlace& place,
                                      const std::optional<PrintCorners>& hidden) {
    const PrintCorners print = corners_of(place);
    const double edge = std::max((print[1] - print[0]).norm(), (print[3] - print[0]).norm());
    const auto block = std::max(2u, std::max(photo.width_px, photo.height_px) / blocks_along);
    std::vector<LitSample> samples;
    for (std::uint32_t y = 0; y + block <= photo.height_px; y += block)
        for (std::uint32_t x = 0; x + block <= photo.width_px; x += block) {
            const Eigen::Vector2d middle(x + block / 2.0, y + block / 2.0);
            if (within(print, middle, ground_gap * edge + block) || (hidden && within(*hidden, middle, 2.0 * block)))
                continue;
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (std::uint32_t v = y; v < y + block; ++v)
                for (std::uint32_t u = x; u < x + block; ++u) sum += photo.pixels[photo.index(u, v)].cast<double>();
            samples.push_back({middle, sum / (double(block) * block), Eigen::Vector3d::Zero()});
        }
    return samples;
}

Eigen::Matrix<double, GroundLight::terms, 1> GroundLight::basis(const Eigen::Vector2d& px) const {
    const double u = 2 * px.x() / size_.x() - 1, v = 2 * px.y() / size_.x() - size_.y() / size_.x();
    return {1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v};
}

double GroundLight::at(const Eigen::Vector2d& px) const { return std::exp(of_log_.dot(basis(px))); }

std::optional<GroundLight> GroundLight::fit(const std::vector<LitSample>& ground, const io::Photograph& photo) {
    GroundLight light;
    light.size_ = {photo.width_px, photo.height_px};
    std::vector<LitSample> used;
    for (const LitSample& sample : ground)
        if (brightness(sample) >= least_ground) used.push_back(sample);
    if (used.size() < least_blocks || double(used.size()) < least_counted * double(ground.size())) return std::nullopt;
    std::vector<double> weight(used.size(), 1);
    std::vector<double> off(used.size());
    constexpr int rounds = 12;
    constexpr double tukey = 4.685, to_deviation = 1.4826;  // 95 % efficient; of the median of a normal one
    for (int round = 0; round < rounds; ++round) {
        Eigen::Matrix<double, terms, terms> normal = 1e-9 * Eigen::Matrix<double, terms, terms>::Identity();
        Eigen::Matrix<double, terms, 1> right = Eigen::Matrix<double, terms, 1>::Zero();
        for (std::size_t i = 0; i < used.size(); ++i) {
            const auto b = light.basis(used[i].px);
            normal += weight[i] * b * b.transpose();
            right += weight[i] * b * std::log(brightness(used[i]));
        }
        light.of_log_ = normal.ldlt().solve(right);
        for (std::size_t i = 0; i < used.size(); ++i)
            off[i] = std::abs(std::log(brightness(used[i])) - light.of_log_.dot(light.basis(used[i].px)));
        light.residual_ = std::max(to_deviation * optics::median(off), 1e-6);
        for (std::size_t i = 0; i < used.size(); ++i) {
            const double x = off[i] / (tukey * light.residual_);
            weight[i] = x < 1 ? std::pow(1 - x * x, 2) : 0;
        }
    }
    if (light.residual_ > uneven_ground) return std::nullopt;
    return light;
}

}  // namespace voxtone::calibration
