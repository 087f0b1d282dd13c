// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/screens/blue_noise_screen.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/contracts.h"
#include "halftone/screens/built_in_screens.h"
#include "halftone/screens/screen_data.h"
#include "halftone/screens/void_and_cluster.h"

namespace voxtone::halftone {
namespace {

constexpr std::size_t tile_voxels = std::size_t{BlueNoiseScreen::size} * BlueNoiseScreen::size * BlueNoiseScreen::size;
static_assert(BlueNoiseScreen::size == void_and_cluster_size);

bool same_ratios(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    const double scale = std::cbrt((a[0] * a[1] * a[2]) / (b[0] * b[1] * b[2]));
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (std::abs(a[axis] / (b[axis] * scale) - 1) > 0.005) return false;
    return true;
}

const std::uint16_t* find_built_in(const std::array<double, 3>& pitch_mm) {
    for (std::size_t n = 0; n < built_in_screens.size(); ++n)
        if (same_ratios(pitch_mm, built_in_screens[n].pitch_mm)) return screen_data() + n * tile_voxels;
    return nullptr;
}

/// With x and y exchanged: just as even where the pitches are exchanged.
std::shared_ptr<const std::uint16_t[]> turned(const std::uint16_t* tile) {
    constexpr std::size_t n = BlueNoiseScreen::size;
    auto made = std::make_shared<std::uint16_t[]>(tile_voxels);
    for (std::size_t z = 0; z < n; ++z)
        for (std::size_t y = 0; y < n; ++y)
            for (std::size_t x = 0; x < n; ++x) made[x + n * (y + n * z)] = tile[y + n * (x + n * z)];
    return made;
}

}  // namespace

BlueNoiseScreen::BlueNoiseScreen(const std::array<double, 3>& pitch_mm, const Progress* progress) {
    for (double pitch : pitch_mm) VOXTONE_EXPECT(pitch > 0 && std::isfinite(pitch));
    tile_ = find_built_in(pitch_mm);
    if (tile_) return;
    if (const std::uint16_t* const across = find_built_in({pitch_mm[1], pitch_mm[0], pitch_mm[2]})) {
        made_ = turned(across);
        tile_ = made_.get();
        return;
    }
    VoidAndClusterOptions options;
    options.pitch_mm = pitch_mm;
    const auto made = std::make_shared<std::uint16_t[]>(tile_voxels);
    const auto thresholds = void_and_cluster_thresholds(options, progress);
    std::copy(thresholds.begin(), thresholds.end(), made.get());
    made_ = made;
    tile_ = made_.get();
}

bool has_built_in_screen(const std::array<double, 3>& pitch_mm) { return find_built_in(pitch_mm) != nullptr; }

}  // namespace voxtone::halftone
