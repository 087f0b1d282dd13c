// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers to test with: random halftones, shapes with a coloured skin, and the plain bitmap that a layer means.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"
#include "io/layers/layer_runs.h"
#include "io/layers/png_layer_encoder.h"

namespace voxtone::io {

inline std::uint32_t draw(RandomStream& random, std::uint32_t below) {
    return static_cast<std::uint32_t>(random.uniform() * below);
}

/// Pixels drawn one by one with these weights; from time to time a long run, a row like the one above, or a piece of
/// it.
inline LayerRuns random_layer(RandomStream& random, std::uint32_t width, std::uint32_t height,
                              std::span<const double> weights, double long_runs = 0.01, double rows_alike = 0.1) {
    LayerRuns layer(width, height);
    double sum = 0;
    for (const double w : weights) sum += w;
    auto material = [&] {
        double t = random.uniform() * sum;
        std::size_t m = 0;
        while (m + 1 < weights.size() && t >= weights[m]) t -= weights[m++];
        return static_cast<Material>(m);
    };
    std::vector<Material> above(width, 0), row(width, 0);
    for (std::uint32_t y = 0; y < height; ++y) {
        if (random.uniform() >= rows_alike || y == 0) {
            for (std::uint32_t x = 0; x < width;) {
                const Material m = material();
                std::uint32_t n = 1;
                if (random.uniform() < long_runs) n = 1 + draw(random, 600);
                if (y > 0 && random.uniform() < long_runs) {  // a piece of the row above, perhaps shifted
                    const std::uint32_t shift = draw(random, 3);
                    for (; n > 0 && x < width; --n, ++x) row[x] = above[x >= shift ? x - shift : 0];
                } else {
                    for (; n > 0 && x < width; --n, ++x) row[x] = m;
                }
            }
        }
        for (const Material m : row) layer.push(1, m);
        layer.end_row();
        above = row;
    }
    return layer;
}

/// An ellipse of material `core` with a halftoned skin of `skin` px, in air: what a slicer makes.
inline LayerRuns ring_layer(std::uint32_t width, std::uint32_t height, std::uint32_t skin,
                            std::span<const double> weights, Material core, std::uint64_t seed) {
    LayerRuns layer(width, height);
    auto half_width = [&](double y, double margin) {
        const double v = (std::abs(y) + margin / 2) / (0.48 * height);
        return v < 1 ? std::max(0.0, 0.48 * width * std::sqrt(1 - v * v) - margin) : 0.0;
    };
    for (std::uint32_t y = 0; y < height; ++y) {
        RandomStream random(seed, y);
        const double v = y + 0.5 - 0.5 * height;
        const auto outer = static_cast<std::uint32_t>(half_width(v, 0)),
                   inner = std::min(outer, static_cast<std::uint32_t>(half_width(v, skin)));
        const std::uint32_t middle = width / 2;
        layer.push(middle - outer, background);
        auto halftone = [&](std::uint32_t from, std::uint32_t to) {
            for (std::uint32_t x = from; x < to; ++x) {
                // The mixture drifts over the surface, as a texture does.
                const double drift = 1 + 0.5 * std::sin(0.01 * x) * std::cos(0.013 * y);
                double t = random.uniform();
                std::size_t m = 0;
                while (m + 1 < weights.size() && t >= weights[m] * drift) t -= weights[m++] * drift;
                layer.push(1, static_cast<Material>(m + 1));
            }
        };
        halftone(middle - outer, middle - inner);
        layer.push(2 * inner, core);
        halftone(middle + inner, middle + outer);
        layer.push(width - middle - outer, background);
        layer.end_row();
    }
    return layer;
}

/// The bytes that PNG compresses: per row a filter byte 0 and R, G, B, 255 per pixel.
inline std::vector<std::uint8_t> plain_bitmap(const LayerRuns& layer, std::span<const Rgb> palette) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve((std::size_t{4} * layer.width_px() + 1) * layer.height_px());
    for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
        bytes.push_back(0);
        for (const Run run : layer.row(y))
            for (std::uint32_t i = 0; i < run.length; ++i) {
                bytes.insert(bytes.end(), palette[run.material].begin(), palette[run.material].end());
                bytes.push_back(255);
            }
    }
    return bytes;
}

}  // namespace voxtone::io
