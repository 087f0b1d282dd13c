// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/layer_fields.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::scattering {

namespace {

/// std::floor is a call into the library on the plainest processors.
std::int64_t below(double x) {
    const auto i = static_cast<std::int64_t>(x);
    return i - (static_cast<double>(i) > x);
}

/// The pixel of the map that stands at an index beyond its edges.
std::int64_t pixel(std::int64_t i, std::int64_t size, MapEdge edge) {
    if (i >= 0 && i < size) return i;
    if (edge == MapEdge::extend) return std::clamp<std::int64_t>(i, 0, size - 1);
    const std::int64_t period = edge == MapEdge::mirror ? 2 * size : size;
    const std::int64_t in_period = (i % period + period) % period;
    return in_period < size ? in_period : period - 1 - in_period;
}

std::vector<float> gaussian(double sigma_px) {
    const auto reach = static_cast<std::int64_t>(std::ceil(3 * sigma_px));
    std::vector<float> kernel;
    double sum = 0;
    for (std::int64_t i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * double(i * i) / (sigma_px * sigma_px));
    for (std::int64_t i = -reach; i <= reach; ++i)
        kernel.push_back(float(std::exp(-0.5 * double(i * i) / (sigma_px * sigma_px)) / sum));
    return kernel;
}

}  // namespace

LayerFields::LayerFields(const LaminateMap& map, const AlignedLaminates& laminates)
    : material_(laminates.material),
      width_(map.width_px),
      height_(map.height_px),
      per_mm_x_(map.width_px / map.width_mm),
      per_mm_y_(map.height_px / map.height_mm),
      edge_(map.edge),
      laminate_(map.laminate.begin(), map.laminate.end()) {
    VOXTONE_EXPECT(map.width_px > 0 && map.height_px > 0 && map.width_mm > 0 && map.height_mm > 0 &&
                   map.smoothing_mm >= 0);
    VOXTONE_EXPECT(map.laminate.size() == std::size_t{map.width_px} * map.height_px && layers() <= max_layers);
    if (layers() == 0) return;
    const std::size_t n = layers();
    std::vector<float> of_laminate(laminates.thickness_mm.size());
    for (std::size_t s = 0; s < of_laminate.size() / n; ++s) {
        double depth = 0;
        for (std::size_t l = 0; l < n; ++l) of_laminate[s * n + l] = float(depth += laminates.thickness_mm[s * n + l]);
    }
    bottom_.resize(map.laminate.size() * n);
    for (std::size_t p = 0; p < map.laminate.size(); ++p) {
        VOXTONE_EXPECT((map.laminate[p] + 1u) * n <= of_laminate.size());
        std::copy_n(of_laminate.begin() + std::ptrdiff_t(map.laminate[p] * n), n,
                    bottom_.begin() + std::ptrdiff_t(p * n));
    }
    if (map.smoothing_mm > 0) smooth(map.smoothing_mm * per_mm_x_, map.smoothing_mm * per_mm_y_);
    for (std::size_t p = 0; p < map.laminate.size(); ++p) most_depth_ = std::max(most_depth_, bottom_[p * n + n - 1]);
}

// Depths instead of thicknesses are smoothed: it is the same, and weights >= 0 in a fixed order keep equal ones equal.
void LayerFields::smooth(double sigma_x_px, double sigma_y_px) {
    const std::size_t n = layers(), row = std::size_t(width_) * n;
    const auto pass = [&](const std::vector<float>& kernel, auto&& index) {
        const std::int64_t reach = std::int64_t(kernel.size()) / 2;
        std::vector<float> out(bottom_.size(), 0.0f);
        parallel_for(0, std::size_t(height_), 8, [&](std::size_t y) {
            for (std::int64_t x = 0; x < width_; ++x)
                for (std::int64_t d = -reach; d <= reach; ++d) {
                    const float* from = bottom_.data() + index(x, std::int64_t(y), d);
                    for (std::size_t l = 0; l < n; ++l)
                        out[y * row + std::size_t(x) * n + l] += kernel[std::size_t(d + reach)] * from[l];
                }
        });
        bottom_ = std::move(out);
    };
    pass(gaussian(sigma_x_px), [&](std::int64_t x, std::int64_t y, std::int64_t d) {
        return std::size_t(y) * row + std::size_t(pixel(x + d, width_, edge_)) * n;
    });
    pass(gaussian(sigma_y_px), [&](std::int64_t x, std::int64_t y, std::int64_t d) {
        return std::size_t(pixel(y + d, height_, edge_)) * row + std::size_t(x) * n;
    });
}

LayerFields::Corners LayerFields::corners(double x_mm, double y_mm) const {
    const double x = x_mm * per_mm_x_ - 0.5, y = double(height_) - 0.5 - y_mm * per_mm_y_;
    const std::int64_t left = below(x), top = below(y);
    const float across = float(x - double(left)), down = float(y - double(top));
    Corners c{};
    for (int k = 0; k < 4; ++k) {
        const std::int64_t i = pixel(left + (k & 1), width_, edge_), j = pixel(top + (k >> 1), height_, edge_);
        c.at[k] = bottom_.data() + std::size_t(j * width_ + i) * layers();
        c.weight[k] = (k & 1 ? across : 1 - across) * (k >> 1 ? down : 1 - down);
    }
    return c;
}

void LayerFields::bottoms(double x_mm, double y_mm, std::span<float> out) const {
    VOXTONE_DEBUG_EXPECT(out.size() == layers());
    if (layers() == 0) return;
    const Corners c = corners(x_mm, y_mm);
    for (std::size_t l = 0; l < layers(); ++l) out[l] = c.mix(l);
}

std::size_t LayerFields::layer_at(double x_mm, double y_mm, float depth_mm) const {
    if (depth_mm >= most_depth_) return layers();
    const Corners c = corners(x_mm, y_mm);
    std::size_t l = 0;
    while (l < layers() && depth_mm >= c.mix(l)) ++l;
    return l;
}

std::size_t LayerFields::laminate_at(double x_mm, double y_mm) const {
    const auto i = pixel(below(x_mm * per_mm_x_), width_, edge_);
    const auto j = pixel(below(double(height_) - y_mm * per_mm_y_), height_, edge_);
    return laminate_[std::size_t(j * width_ + i)];
}

float LayerFields::depth_mm(double x_mm, double y_mm) const {
    return layers() == 0 ? 0 : corners(x_mm, y_mm).mix(layers() - 1);
}

}  // namespace voxtone::scattering
