// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/eye_filter.h"

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"
#include "optics/numerics/portable_math.h"
#include "optics/scene/surface_smoothing.h"

namespace voxtone::halftone {
namespace {

struct Gaussian {
    double weight, spread_degrees;
};

/// Scaled to the sum 1.
std::vector<Gaussian> gaussians(std::size_t channel, EyeSurround surround) {
    static const std::array<std::vector<Gaussian>, 3> table{{{{0.921, 0.0283}, {0.105, 0.133}, {-0.108, 4.336}},
                                                             {{0.531, 0.0392}, {0.330, 0.494}},
                                                             {{0.488, 0.0536}, {0.371, 0.386}}}};
    std::vector<Gaussian> of_channel = table[channel];
    if (surround == EyeSurround::none) std::erase_if(of_channel, [](const Gaussian& g) { return g.weight < 0; });
    double sum = 0;
    for (const Gaussian& g : of_channel) sum += g.weight;
    for (Gaussian& g : of_channel) g.weight /= sum;
    return of_channel;
}

constexpr double least_light = 1e-4;  // keeps the slope of Lab from being that at black alone

/// Y of linear sRGB, 1 for white.
const Eigen::Vector3f& luminance_row() {
    static const Eigen::Vector3f row = optics::xyz_from_linear_srgb_matrix().row(1).transpose().cast<float>();
    return row;
}

constexpr float knee = 216.0f / 24389;  // CIE 15: below it lightness is straight, and so for negative light
float lightness_of(float luminance) {
    return luminance > knee ? 116 * portable::cbrt(luminance) - 16 : 24389.0f / 27 * luminance;
}
/// d L / d luminance where lightness is `lightness`.
float lightness_slope(float lightness) {
    const float root = (lightness + 16) / 116;
    return lightness > 8 ? 116 / (3 * root * root) : 24389.0f / 27;
}

}  // namespace

struct EyeFilter::Data {
    struct Wide {
        std::size_t channel;
        float weight;
        double spread_mm;
        std::unique_ptr<optics::SurfaceSmoothing> smoothing{};
    };
    std::vector<optics::SurfacePoint> points;
    std::unique_ptr<optics::SurfaceSmoothing> narrow;
    std::array<float, 3> narrow_weight{};  ///< of what the first smoothing gives, per channel
    std::vector<Wide> wide;
    std::size_t gaussians = 1;  ///< all that the filter has, were they made or not
    Eigen::Matrix3f to_opponent, from_opponent;
    bool as_light = false;  ///< colour too

    /// That so many values, cell by cell, are of: 1 or 2.
    [[nodiscard]] std::size_t pictures(std::size_t values) const {
        VOXTONE_EXPECT(values == points.size() || values == 2 * points.size());
        return values == points.size() ? 1 : 2;
    }
};

const Eigen::Matrix3d& opponent_from_xyz_matrix(OpponentSpace space) {
    static const Eigen::Matrix3d neutral =
        (Eigen::Matrix3d() << 0.0556, 0.9981, -0.0254, 0.9510, -0.9038, 0, 0.0386, 1.0822, -1.0276).finished();
    static const Eigen::Matrix3d published =
        (Eigen::Matrix3d() << 0.279, 0.72, -0.107, -0.449, 0.29, -0.077, 0.086, -0.59, 0.501).finished();
    VOXTONE_EXPECT(space != OpponentSpace::cielab);
    return space == OpponentSpace::neutral ? neutral : published;
}

EyeFilter::EyeFilter(const optics::Surface& surface, double viewing_distance_mm, EyeSurround surround,
                     OpponentSpace space, EyeParts parts)
    : data_(std::make_unique<Data>()) {
    if (!(viewing_distance_mm > 0) || !std::isfinite(viewing_distance_mm))
        throw InputError(fmt::format("the viewing distance is {} mm; it must be above 0", viewing_distance_mm));
    Data& d = *data_;
    d.as_light = space != OpponentSpace::cielab;
    if (d.as_light) {
        const Eigen::Matrix3d to_opponent = opponent_from_xyz_matrix(space) * optics::xyz_from_linear_srgb_matrix();
        d.to_opponent = to_opponent.cast<float>();
        d.from_opponent = to_opponent.inverse().cast<float>();
    }
    if (surface.cells.empty()) return;
    d.points = optics::surface_points(surface);
    const double point_mm = optics::typical_edge_mm(d.points);
    const double mm_per_degree = viewing_distance_mm * std::numbers::pi / 180;  // along the arc
    const double first = gaussians(0, surround).front().spread_degrees * mm_per_degree;
    for (std::size_t c = 0; c < 3; ++c)
        for (const Gaussian& g : gaussians(c, surround)) {
            const auto weight = static_cast<float>(g.weight);
            if (c == 0 && d.narrow_weight[0] == 0) {
                d.narrow_weight[0] = weight;
                continue;
            }
            ++d.gaussians;
            if (parts == EyeParts::all) d.wide.push_back({c, weight, g.spread_degrees * mm_per_degree});
        }
    parallel_for(0, d.wide.size() + 1, 1, [&](std::size_t k) {
        if (k == 0)
            d.narrow = std::make_unique<optics::SurfaceSmoothing>(d.points, first, 0.0, point_mm);
        else
            d.wide[k - 1].smoothing =
                std::make_unique<optics::SurfaceSmoothing>(d.points, d.wide[k - 1].spread_mm, first, point_mm);
    });
}

EyeFilter::~EyeFilter() = default;
EyeFilter::EyeFilter(EyeFilter&&) noexcept = default;
EyeFilter& EyeFilter::operator=(EyeFilter&&) noexcept = default;

EyeFilter::Channels EyeFilter::channels_of(std::span<const Eigen::Vector3f> near) const {
    const Data& d = *data_;
    Channels channels;
    for (std::vector<float>& channel : channels) channel.resize(near.size());
    parallel_for(0, near.size(), 1024, [&](std::size_t i) {
        Eigen::Vector3f of;
        if (d.as_light) {
            of = d.to_opponent * near[i];
        } else {
            of = optics::lab_from_linear_srgb(near[i].cast<double>().cwiseMax(0)).cast<float>();
            of[0] = luminance_row().dot(near[i]);
        }
        for (std::size_t c = 0; c < 3; ++c) channels[c][i] = of[static_cast<Eigen::Index>(c)];
    });
    return channels;
}

EyeFilter::Channels EyeFilter::through(const Channels& channels) const {
    const Data& d = *data_;
    VOXTONE_EXPECT(d.wide.size() + 1 == d.gaussians);
    const std::size_t count = channels[0].size();
    Channels sum = channels;
    for (std::size_t c = 0; c < 3; ++c)
        for (float& value : sum[c]) value *= d.narrow_weight[c];
    std::vector<float> part(count);
    for (const Data::Wide& w : d.wide) {
        w.smoothing->apply(channels[w.channel], part, d.pictures(count));
        parallel_for(0, count, 4096, [&](std::size_t i) { sum[w.channel][i] += w.weight * part[i]; });
    }
    return sum;
}

std::vector<Eigen::Vector3f> EyeFilter::lab_of(std::span<const Eigen::Vector3f> near) const {
    const Channels seen = through(channels_of(near));
    std::vector<Eigen::Vector3f> lab(near.size());
    parallel_for(0, near.size(), 1024, [&](std::size_t i) {
        const Eigen::Vector3f of(seen[0][i], seen[1][i], seen[2][i]);
        lab[i] =
            data_->as_light
                ? optics::lab_from_linear_srgb((data_->from_opponent * of).cast<double>().cwiseMax(0)).cast<float>()
                : Eigen::Vector3f(lightness_of(of[0]), of[1], of[2]);
    });
    return lab;
}

EyeFilter::Views EyeFilter::views(std::span<const Eigen::Vector3f> rgb) const {
    std::vector<Eigen::Vector3f> near = smoothed(rgb), lab = lab_of(near);
    return {std::move(lab), std::move(near)};
}

std::array<EyeFilter::Views, 2> EyeFilter::views(std::span<const Eigen::Vector3f> first,
                                                 std::span<const Eigen::Vector3f> second) const {
    const std::size_t count = data_->points.size();
    VOXTONE_EXPECT(first.size() == count && second.size() == count);
    std::vector<Eigen::Vector3f> both(2 * count);
    parallel_for(0, count, 4096, [&](std::size_t i) { both[2 * i] = first[i], both[2 * i + 1] = second[i]; });
    const std::vector<Eigen::Vector3f> near = smoothed(both), lab = lab_of(near);
    std::array<Views, 2> views;
    for (std::size_t p = 0; p < 2; ++p) {
        views[p].lab.resize(count), views[p].smoothed.resize(count);
        parallel_for(0, count, 4096,
                     [&](std::size_t i) { views[p].lab[i] = lab[2 * i + p], views[p].smoothed[i] = near[2 * i + p]; });
    }
    return views;
}

std::vector<Eigen::Vector3f> EyeFilter::filter(std::span<const Eigen::Vector3f> rgb) const {
    const Channels seen = through(channels_of(smoothed(rgb)));
    std::vector<Eigen::Vector3f> out(rgb.size());
    parallel_for(0, out.size(), 1024, [&](std::size_t i) {
        const Eigen::Vector3f of(seen[0][i], seen[1][i], seen[2][i]);
        out[i] = data_->as_light
                     ? Eigen::Vector3f(data_->from_opponent * of)
                     : optics::linear_srgb_from_lab(Eigen::Vector3d(lightness_of(of[0]), of[1], of[2])).cast<float>();
    });
    return out;
}

std::vector<Eigen::Vector3f> EyeFilter::by_smoothed(std::span<const Eigen::Vector3f> by_lab, const Views& views) const {
    const std::size_t count = by_lab.size();
    VOXTONE_EXPECT(views.lab.size() == count && views.smoothed.size() == count && !data_->as_light);
    Channels channels;
    for (std::vector<float>& channel : channels) channel.resize(count);
    parallel_for(0, count, 1024, [&](std::size_t i) {
        channels[0][i] = by_lab[i][0] * lightness_slope(views.lab[i][0]);
        channels[1][i] = by_lab[i][1], channels[2][i] = by_lab[i][2];
    });
    channels = through(channels);
    std::vector<Eigen::Vector3f> out(count);
    parallel_for(0, count, 1024, [&](std::size_t i) {
        const Eigen::Matrix3f slope =
            optics::lab_derivative(views.smoothed[i].cast<double>().cwiseMax(least_light)).cast<float>();
        out[i] = channels[0][i] * luminance_row() + channels[1][i] * slope.row(1).transpose() +
                 channels[2][i] * slope.row(2).transpose();
    });
    return out;
}

std::vector<Eigen::Vector3f> EyeFilter::smoothed(std::span<const Eigen::Vector3f> rgb) const {
    const Data& d = *data_;
    std::vector<Eigen::Vector3f> out(rgb.size());
    if (out.empty()) {
        VOXTONE_EXPECT(d.points.empty());
        return out;
    }
    d.narrow->apply({rgb.front().data(), 3 * rgb.size()}, {out.front().data(), 3 * out.size()},
                    3 * d.pictures(rgb.size()));
    return out;
}

}  // namespace voxtone::halftone
