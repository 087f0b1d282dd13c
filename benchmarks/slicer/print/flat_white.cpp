// SPDX-License-Identifier: GPL-3.0-or-later
#include "flat_white.h"

#include <algorithm>

#include "base/contracts.h"

namespace voxtone::loop_benchmark {
namespace {

constexpr double share_of_the_way = 0.25, most_mm = 1.5;

/// Window mean along one axis of `n` values that lie `stride` apart.
void smooth_line(float* first, std::size_t n, std::size_t stride, double cell_mm) {
    std::vector<double> sum(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) sum[i + 1] = sum[i] + static_cast<double>(first[i * stride]);
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t to_border = std::min(i, n - 1 - i);
        const auto reach =
            static_cast<std::size_t>(std::min(share_of_the_way * static_cast<double>(to_border), most_mm / cell_mm));
        first[i * stride] =
            static_cast<float>((sum[i + reach + 1] - sum[i - reach]) / static_cast<double>(2 * reach + 1));
    }
}

}  // namespace

void smooth_flat_white(std::vector<float>& value, std::size_t columns, std::size_t rows, std::size_t channels,
                       double cell_mm, bool mirrored_x, bool mirrored_y) {
    VOXTONE_EXPECT(value.size() == columns * rows * channels);
    const auto at = [&](std::size_t x, std::size_t y, std::size_t c) -> float& {
        return value[(y * columns + x) * channels + c];
    };
    for (std::size_t c = 0; c < channels; ++c) {
        if (mirrored_x)
            for (std::size_t y = 0; y < rows; ++y)
                for (std::size_t x = 0; x < columns / 2; ++x)
                    at(x, y, c) = at(columns - 1 - x, y, c) = (at(x, y, c) + at(columns - 1 - x, y, c)) / 2;
        if (mirrored_y)
            for (std::size_t y = 0; y < rows / 2; ++y)
                for (std::size_t x = 0; x < columns; ++x)
                    at(x, y, c) = at(x, rows - 1 - y, c) = (at(x, y, c) + at(x, rows - 1 - y, c)) / 2;
        for (std::size_t y = 0; y < rows; ++y) smooth_line(&at(0, y, c), columns, channels, cell_mm);
        for (std::size_t x = 0; x < columns; ++x) smooth_line(&at(x, 0, c), rows, columns * channels, cell_mm);
    }
}

}  // namespace voxtone::loop_benchmark
