// SPDX-License-Identifier: GPL-3.0-or-later
//
// OpenEXR stores a part of a picture, or more than it shows: pixels of its data window are laid into its display
// window.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxtone::io {

struct PixelWindow {
    std::int64_t x = 0, y = 0, width = 0, height = 0;

    bool operator==(const PixelWindow&) const = default;
    [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
};

/// RGBA of one window, rows from the top, as that of another; where there is nothing, black and `outside_alpha`.
template <class Value>
[[nodiscard]] std::vector<Value> in_window(const std::vector<Value>& rgba, const PixelWindow& from,
                                           const PixelWindow& to, Value outside_alpha) {
    std::vector<Value> out(4 * to.pixels());
    for (std::size_t i = 3; i < out.size(); i += 4) out[i] = outside_alpha;
    const std::int64_t left = std::max(from.x, to.x), right = std::min(from.x + from.width, to.x + to.width);
    const std::int64_t top = std::max(from.y, to.y), bottom = std::min(from.y + from.height, to.y + to.height);
    for (std::int64_t y = top; y < bottom && left < right; ++y)
        std::copy_n(rgba.begin() + 4 * ((y - from.y) * from.width + left - from.x), 4 * (right - left),
                    out.begin() + 4 * ((y - to.y) * to.width + left - to.x));
    return out;
}

}  // namespace voxtone::io
