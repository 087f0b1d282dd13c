// SPDX-License-Identifier: GPL-3.0-or-later
#include "screen_analysis.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "base/random.h"

namespace voxtone::halftone::test {
namespace {

constexpr int size = 64;
constexpr int mask = size - 1;
constexpr int voxels = size * size * size;
using Complex = std::complex<float>;

/// In-place discrete Fourier transform of 64 values with a stride, by the definition with a table (64^2 products).
void transform_line(Complex* data, std::size_t stride, const std::array<Complex, size>& root) {
    // Radix 8 x 8: 64 = 8 * 8 keeps it short and fast enough.
    std::array<Complex, size> in, mid;
    for (std::size_t n = 0; n < size; ++n) in[n] = data[n * stride];
    for (std::size_t a = 0; a < 8; ++a)
        for (std::size_t k = 0; k < 8; ++k) {
            Complex sum = 0;
            for (std::size_t b = 0; b < 8; ++b) sum += in[a + 8 * b] * root[(8 * b * k) & mask];
            mid[a * 8 + k] = sum * root[(a * k) & mask];
        }
    for (std::size_t k = 0; k < 8; ++k)
        for (std::size_t l = 0; l < 8; ++l) {
            Complex sum = 0;
            for (std::size_t a = 0; a < 8; ++a) sum += mid[a * 8 + k] * root[(8 * a * l) & mask];
            data[(k + 8 * l) * stride] = sum;
        }
}

}  // namespace

double worst_cube_error(const Tile& tile) {
    // Voxel by voxel in the order of thresholds: the extremes of a cube's error lie just before and just after it gains
    // a voxel. The expected count is rounded down for the highest and up for the lowest error, so the result is an
    // upper bound within 2 voxels; equal thresholds in a fixed order only make it larger. 16-bit numbers, for speed.
    std::vector<int> order(voxels);
    for (int v = 0; v < voxels; ++v) order[static_cast<std::size_t>(v)] = v;
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return tile[static_cast<std::size_t>(a)] < tile[static_cast<std::size_t>(b)];
    });
    std::vector<std::int16_t> count(voxels, 0), least(voxels, 0), most(voxels, 0);
    for (int n = 0; n < voxels; ++n) {
        const int v = order[static_cast<std::size_t>(n)];
        const int x = ((v & mask) - 15) & mask, y = (v / size) & mask, z = v / (size * size);
        const int head = std::min(16, size - x);
        const auto before = static_cast<std::int16_t>((n + 63) / 64), after = static_cast<std::int16_t>((n + 1) / 64);
        const auto gain = [&](int first, int length) {
            std::int16_t* c = &count[static_cast<std::size_t>(first)];
            std::int16_t* low = &least[static_cast<std::size_t>(first)];
            std::int16_t* high = &most[static_cast<std::size_t>(first)];
            for (int i = 0; i < length; ++i) {
                low[i] = std::min(low[i], static_cast<std::int16_t>(c[i] - before));
                ++c[i];
                high[i] = std::max(high[i], static_cast<std::int16_t>(c[i] - after));
            }
        };
        for (int dz = 0; dz < 16; ++dz)
            for (int dy = 0; dy < 16; ++dy) {
                const int row = (((z - dz) & mask) * size + ((y - dy) & mask)) * size;
                gain(row + x, head);
                if (head < 16) gain(row, 16 - head);
            }
    }
    int worst = 0;
    for (std::size_t v = 0; v < voxels; ++v) worst = std::max(worst, most[v] - least[v]);
    return worst;
}

Tile shuffled(Tile tile, std::uint64_t seed) {
    RandomStream random(seed, 0);
    for (std::size_t n = tile.size(); n > 1; --n)
        std::swap(tile[n - 1], tile[static_cast<std::size_t>(random.uniform() * static_cast<double>(n))]);
    return tile;
}

Spectrum::Spectrum(const Tile& tile, const std::array<double, 3>& pitch_mm, int first, int last) : power_(tile.size()) {
    for (std::size_t a = 0; a < 3; ++a) step_[a] = 1 / (size * pitch_mm[a]);
    const double share = (last - first) / 65536.0;
    std::vector<Complex> field(tile.size());
    for (std::size_t v = 0; v < tile.size(); ++v)
        field[v] = static_cast<float>((tile[v] >= first && tile[v] < last ? 1.0 : 0.0) - share);
    std::array<Complex, size> root;
    for (std::size_t n = 0; n < size; ++n)
        root[n] = Complex(std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(n) / size));
    const std::array<std::size_t, 3> stride{1, size, std::size_t{size} * size};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t line = 0; line < std::size_t{size} * size; ++line) {
            const std::size_t u = line % size, w = line / size;
            const std::size_t start = u * stride[(a + 1) % 3] + w * stride[(a + 2) % 3];
            transform_line(&field[start], stride[a], root);
        }
    const double white = voxels * share * (1 - share);
    for (std::size_t v = 0; v < tile.size(); ++v) power_[v] = static_cast<float>(std::norm(field[v]) / white);
}

double Spectrum::mean(const std::function<bool(const std::array<double, 3>&)>& selected) const {
    double sum = 0;
    int count = 0;
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                if (x == 0 && y == 0 && z == 0) continue;
                const auto folded = [](int k) { return k < size / 2 ? k : k - size; };
                if (!selected({folded(x) * step_[0], folded(y) * step_[1], folded(z) * step_[2]})) continue;
                sum += static_cast<double>(power_[static_cast<std::size_t>(x + size * (y + size * z))]);
                ++count;
            }
    return count > 0 ? sum / count : -1;
}

}  // namespace voxtone::halftone::test
