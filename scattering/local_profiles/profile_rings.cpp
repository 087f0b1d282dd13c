// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/profile_rings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/contracts.h"

namespace voxtone::scattering {

std::vector<ProfileRing> profile_rings(std::uint32_t radius) {
    VOXTONE_EXPECT(radius >= 1);
    std::map<int, std::vector<optics::PointOffset>> by_square;
    for (const optics::PointOffset& offset : optics::half_window(radius)) {
        auto& ring = by_square[offset.x * offset.x + offset.y * offset.y];
        ring.push_back(offset);
        if (offset != optics::PointOffset{}) ring.push_back({-offset.x, -offset.y});
    }
    std::vector<ProfileRing> rings;
    for (auto& [square, offsets] : by_square) {
        ProfileRing ring;
        ring.radius = std::sqrt(static_cast<double>(square));
        ring.knot = std::min(static_cast<std::size_t>(ring.radius), std::size_t{radius} - 1);
        ring.low_share = 1 - (ring.radius - static_cast<double>(ring.knot));
        ring.offsets = std::move(offsets);
        rings.push_back(std::move(ring));
    }
    return rings;
}

std::vector<std::size_t> rings_of_half_window(std::span<const ProfileRing> rings, std::uint32_t radius) {
    std::vector<std::size_t> of_offset;
    for (const optics::PointOffset& offset : optics::half_window(radius)) {
        const auto holds = [&](const ProfileRing& ring) {
            return std::find(ring.offsets.begin(), ring.offsets.end(), offset) != ring.offsets.end();
        };
        of_offset.push_back(static_cast<std::size_t>(std::find_if(rings.begin(), rings.end(), holds) - rings.begin()));
    }
    return of_offset;
}

void sum_over_ring(const PointGrid& grid, const ProfileRing& ring, std::span<const double> image, std::uint32_t row,
                   std::span<double> sum) {
    const int width = static_cast<int>(grid.width), height = static_cast<int>(grid.height);
    std::fill(sum.begin(), sum.end(), 0.0);
    for (const optics::PointOffset& offset : ring.offsets) {
        const int y = static_cast<int>(row) + offset.y;
        if (y < 0 || y >= height) continue;
        const int first = std::max(0, -offset.x), end = std::min(width, width - offset.x);
        const double* from = image.data() + static_cast<std::ptrdiff_t>(y) * width + offset.x;
        double* to = sum.data();
        for (int x = first; x < end; ++x) to[x] += from[x];
    }
}

}  // namespace voxtone::scattering
