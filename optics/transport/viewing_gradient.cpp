// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_gradient.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::optics {
namespace {

std::uint16_t upper_half(float v) {
    return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(v) + 0x8000u) >> 16);
}
float from_upper_half(std::uint16_t v) { return std::bit_cast<float>(std::uint32_t{v} << 16); }

using Pair = std::array<double, 2>;
constexpr std::uint32_t alone = 0x80000000u;

/// d (sigma_t, sigma_s of the transport medium) / d sigma_a and d sigma_s, by differences of a smooth function.
std::array<Pair, 2> medium_derivatives(const TransportMedia& media_of, const Medium& middle) {
    const double step = 1e-3 * std::max(middle.sigma_t(), 1e-3);
    std::array<Pair, 2> out{};
    for (std::size_t k = 0; k < 2; ++k) {
        const auto moved = [&](double s) {
            return media_of.exact({middle.sigma_a + (k == 0 ? s : 0), middle.sigma_s + (k == 1 ? s : 0)});
        };
        const double down = std::min(step, k == 0 ? middle.sigma_a : middle.sigma_s);
        const std::array<double, 3> ahead = moved(step), behind = moved(-down);
        for (std::size_t i = 0; i < 2; ++i) out[k][i] = (ahead[i] - behind[i]) / (step + down);
    }
    return out;
}

}  // namespace

ViewingGradient::ViewingGradient(const ViewingGrid& grid, const SeenMedium& seen, std::size_t channels)
    : grid_(grid),
      resins_(seen.resins.resins.size()),
      channels_(channels),
      by_medium_(grid.cells() * channels),
      first_row_(grid.mixtures.size()) {
    const auto& view = grid.view_voxels;
    std::uint32_t rows = 0;
    for (std::size_t m = 1; m < grid.mixtures.size(); ++m) {
        const bool one = grid.mixtures[m].holds.size() == 1;
        first_row_[m] = rows | (one ? alone : 0);
        rows +=
            static_cast<std::uint32_t>(one ? view[0] + view[1] + view[2] : *std::max_element(view.begin(), view.end()));
    }
    table_.resize(rows * resins_ * channels);
    for (std::size_t a = 0; a < 2; ++a)  // sqrt(3) standard deviations
        spread_step_[a] =
            static_cast<int>(std::lround(std::sqrt(3.0) / 2 * static_cast<double>(grid.spread.draw_voxels()[a])));
}

std::size_t ViewingGradient::row(std::size_t mixture, const ViewingGrid::Home& home) const {
    const std::uint32_t first = first_row_[mixture];
    if (!(first & alone)) return first + std::size_t{home.layer};
    const auto& view = grid_.view_voxels;
    return (first & ~alone) + static_cast<std::size_t>((home.axis > 0 ? view[0] : 0) + (home.axis > 1 ? view[1] : 0)) +
           home.layer;
}

void ViewingGradient::add(std::size_t channel, const TransportMedia& media_of, const SeenMedium& seen,
                          std::span<const float> by_sigma_t, std::span<const float> by_sigma_s) {
    VOXTONE_EXPECT(by_sigma_t.size() == grid_.cells() && by_sigma_s.size() == grid_.cells());
    parallel_ranges(0, grid_.cells(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell)
            by_medium_[cell * channels_ + channel] = {upper_half(by_sigma_t[cell]), upper_half(by_sigma_s[cell])};
    });
    const auto& view = grid_.view_voxels;
    parallel_ranges(1, grid_.mixtures.size(), 1 << 8, [&](std::size_t begin, std::size_t end) {
        std::vector<Pair> by_share;
        for (std::size_t m = begin; m < end; ++m) {
            const Mixture& mixture = grid_.mixtures[m];
            const std::array<Pair, 2> by = medium_derivatives(media_of, seen(mixture, channel));
            std::size_t at = (first_row_[m] & ~alone) * resins_ * channels_ + channel;
            const bool one = first_row_[m] & alone;
            for (std::size_t axis = one ? 0 : mixture.axis; axis < (one ? 3 : mixture.axis + 1u); ++axis) {
                // Mixtures in eighths, which know no layers, may be met along any axis.
                const auto layers =
                    static_cast<std::size_t>(one ? view[axis] : *std::max_element(view.begin(), view.end()));
                by_share.resize(layers * resins_);
                seen.derivatives(mixture, channel, axis, layers, by_share);
                for (const auto& [a, s] : by_share) {
                    table_[at] = {static_cast<float>(by[0][0] * a + by[1][0] * s),
                                  static_cast<float>(by[0][1] * a + by[1][1] * s)};
                    at += channels_;
                }
            }
        }
    });
}

/// Where resin runs sideways it is jetted here and counts there: the derivatives of 3 x 3 voxels around, as Gauss and
/// Hermite weigh them (moments of a Gaussian to the fifth); what would run out of the body stays.
void ViewingGradient::take(const std::array<int, 3>& voxel, std::size_t first_resin, std::span<float> out) const {
    VOXTONE_EXPECT(first_resin + out.size() <= resins_);
    std::fill(out.begin(), out.end(), 0.0f);
    const ViewingGrid::Home own = grid_.home_of(voxel);
    if (own.cell < 0) return;
    if (!grid_.spread.any()) return add_from(own, first_resin, 1, out);
    constexpr std::array<float, 3> weight{1.0f / 6, 2.0f / 3, 1.0f / 6};
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            const ViewingGrid::Home there =
                grid_.home_of({voxel[0] + i * spread_step_[0], voxel[1] + j * spread_step_[1], voxel[2]});
            add_from(there.cell < 0 ? own : there, first_resin,
                     weight[static_cast<std::size_t>(i + 1)] * weight[static_cast<std::size_t>(j + 1)], out);
        }
}

void ViewingGradient::add_from(const ViewingGrid::Home& home, std::size_t first_resin, float weight,
                               std::span<float> out) const {
    const auto cell = static_cast<std::size_t>(home.cell);
    const auto* const by_medium = by_medium_.data() + cell * channels_;
    const auto* by_share = table_.data() + (row(grid_.medium[cell], home) * resins_ + first_resin) * channels_;
    for (float& to : out) {
        float sum = 0;
        for (std::size_t c = 0; c < channels_; ++c, ++by_share)
            sum +=
                from_upper_half(by_medium[c][0]) * (*by_share)[0] + from_upper_half(by_medium[c][1]) * (*by_share)[1];
        to += weight * (home.share * sum);
    }
}

float ViewingGradient::at(const std::array<int, 3>& voxel, std::size_t resin) const {
    float out = 0;
    take(voxel, resin, {&out, 1});
    return out;
}

void ViewingGradient::all_at(const std::array<int, 3>& voxel, std::span<float> out) const { take(voxel, 0, out); }

std::size_t ViewingGradient::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(by_medium_) + of(first_row_) + of(table_);
}

}  // namespace voxtone::optics
