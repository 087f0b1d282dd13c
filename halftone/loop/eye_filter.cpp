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
    return space == OpponentSpace::neutral ? neutral : published;
}

EyeFilter::EyeFilter(const optics::Surface& surface, double viewing_distance_mm, EyeSurround surround,
                     OpponentSpace space, EyeParts parts)
    : data_(std::make_unique<Data>()) {
    if (!(viewing_distance_mm > 0) || !std::isfinite(viewing_distance_mm))
        throw InputError(fmt::format("the viewing distance is {} mm; it must be above 0", viewing_distance_mm));
    Data& d = *data_;
    const Eigen::Matrix3d to_opponent = opponent_from_xyz_matrix(space) * optics::xyz_from_linear_srgb_matrix();
    d.to_opponent = to_opponent.cast<float>();
    d.from_opponent = to_opponent.inverse().cast<float>();
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

std::vector<Eigen::Vector3f> EyeFilter::filter(std::span<const Eigen::Vector3f> rgb) const {
    return through(data_->to_opponent, data_->from_opponent, smoothed(rgb));
}

EyeFilter::Views EyeFilter::views(std::span<const Eigen::Vector3f> rgb) const {
    std::vector<Eigen::Vector3f> near = smoothed(rgb), far = through(data_->to_opponent, data_->from_opponent, near);
    return {std::move(far), std::move(near)};
}

std::array<EyeFilter::Views, 2> EyeFilter::views(std::span<const Eigen::Vector3f> first,
                                                 std::span<const Eigen::Vector3f> second) const {
    const std::size_t count = data_->points.size();
    VOXTONE_EXPECT(first.size() == count && second.size() == count);
    std::vector<Eigen::Vector3f> both(2 * count);
    parallel_for(0, count, 4096, [&](std::size_t i) { both[2 * i] = first[i], both[2 * i + 1] = second[i]; });
    const std::vector<Eigen::Vector3f> near = smoothed(both),
                                       far = through(data_->to_opponent, data_->from_opponent, near);
    std::array<Views, 2> views;
    for (std::size_t p = 0; p < 2; ++p) {
        views[p].filtered.resize(count), views[p].smoothed.resize(count);
        parallel_for(0, count, 4096, [&](std::size_t i) {
            views[p].filtered[i] = far[2 * i + p], views[p].smoothed[i] = near[2 * i + p];
        });
    }
    return views;
}

std::vector<Eigen::Vector3f> EyeFilter::transposed(std::span<const Eigen::Vector3f> by_seen) const {
    return through(data_->from_opponent.transpose(), data_->to_opponent.transpose(), smoothed(by_seen));
}

std::vector<Eigen::Vector3f> EyeFilter::through(const Eigen::Matrix3f& from, const Eigen::Matrix3f& into,
                                                std::span<const Eigen::Vector3f> first) const {
    const Data& d = *data_;
    VOXTONE_EXPECT(d.wide.size() + 1 == d.gaussians);
    const std::size_t count = first.size();
    std::array<std::vector<float>, 3> opponent, sum;
    for (std::size_t c = 0; c < 3; ++c) {
        opponent[c].resize(count);
        sum[c].resize(count);
    }
    parallel_for(0, count, 4096, [&](std::size_t i) {
        const Eigen::Vector3f o = from * first[i];
        for (std::size_t c = 0; c < 3; ++c) {
            opponent[c][i] = o[static_cast<Eigen::Index>(c)];
            sum[c][i] = d.narrow_weight[c] * opponent[c][i];
        }
    });
    std::vector<float> part(count);
    for (const Data::Wide& w : d.wide) {
        w.smoothing->apply(opponent[w.channel], part, d.pictures(count));
        parallel_for(0, count, 4096, [&](std::size_t i) { sum[w.channel][i] += w.weight * part[i]; });
    }
    std::vector<Eigen::Vector3f> out(count);
    parallel_for(0, count, 4096,
                 [&](std::size_t i) { out[i] = into * Eigen::Vector3f(sum[0][i], sum[1][i], sum[2][i]); });
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
