// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/screens/error_diffusion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/contracts.h"
#include "base/random.h"

namespace voxtone::halftone {
namespace {

/// What counts when resins are compared is the debt plus this part of the share. With the whole share, as the plain
/// method has it, a rare resin is owed a good part of a voxel everywhere before it is first laid, and a slab would lose
/// that; with a fifth the mean debt of rare and common resins is near 0.
constexpr float share_weight = 0.2f;
constexpr std::uint32_t noise_stream = 1, start_stream = 2;

/// Shares of 1 from the cumulative bounds.
std::array<float, max_resins> shares_of(const CumulativeMixture& mixture, int resins) {
    std::array<float, max_resins> share{};
    int below = 0;
    for (std::size_t r = 0; r < static_cast<std::size_t>(resins); ++r) {
        const int bound =
            mixture.bound[r] < 65535 && r + 1 < static_cast<std::size_t>(resins) ? mixture.bound[r] : 65536;
        share[r] = static_cast<float>(bound - below) * 0x1p-16f;
        below = bound;
    }
    return share;
}

std::uint64_t address(int x, int y, int k) {
    return static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << 21 | static_cast<std::uint64_t>(k) << 42;
}

}  // namespace

ErrorDiffusion::ErrorDiffusion(int width, int height, int resins, const ErrorDiffusionOptions& options)
    : width_(width), height_(height), resins_(resins), options_(options) {
    VOXTONE_EXPECT(width >= 1 && height >= 1 && width < (1 << 21) && height < (1 << 21));
    VOXTONE_EXPECT(resins >= 1 && resins <= max_resins);
    VOXTONE_EXPECT(options.noise >= 0 && options.noise <= 1);
    for (double pitch : options.pitch_mm) VOXTONE_EXPECT(pitch > 0 && std::isfinite(pitch));
    constexpr std::array<std::array<int, 3>, 9> offsets{
        {{1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {-1, 0, 1}, {1, 0, 1}, {0, -1, 1}, {0, 1, 1}}};
    for (const auto& o : offsets) {
        const double d = std::hypot(o[0] * options.pitch_mm[0], o[1] * options.pitch_mm[1], o[2] * options.pitch_mm[2]);
        neighbours_.push_back(
            {o[0], o[1], o[2], static_cast<float>(options.pitch_mm[0] * options.pitch_mm[0] / (d * d))});
    }
    here_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(resins),
                 0);
    above_ = here_;
}

float* ErrorDiffusion::owed(int x, int y, int dz) {
    const std::size_t voxel =
        static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
    return (dz == 0 ? here_ : above_).data() + voxel * static_cast<std::size_t>(resins_);
}

void ErrorDiffusion::visit(int x, int y, int k, int dx, int dy, std::span<const CumulativeMixture> mixtures,
                           std::span<const std::uint8_t> body, std::span<std::uint8_t> resin) {
    const auto voxel = [&](int u, int v) {
        return static_cast<std::size_t>(u) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(v);
    };
    const auto resins = static_cast<std::size_t>(resins_);
    const Shares share = shares_of(mixtures[voxel(x, y)], resins_);
    const float* debt = owed(x, y, 0);

    // Debts of resins that are not here are forgotten; the others bear the difference, so that debts sum to 0.
    Shares wanted{};
    float sum = 0, present = 0;
    for (std::size_t r = 0; r < resins; ++r)
        if (share[r] > 0) {
            wanted[r] = share[r] + debt[r];
            sum += debt[r];
            present += 1;
        }
    if (present == 1) {  // one resin only: nothing to decide, nothing owed
        for (std::size_t r = 0; r < resins; ++r)
            if (share[r] > 0) resin[voxel(x, y)] = static_cast<std::uint8_t>(r);
        return;
    }
    RandomStream random(options_.seed, address(x, y, k), noise_stream);
    std::size_t chosen = 0;
    float most = -1e30f;
    for (std::size_t r = 0; r < resins; ++r) {
        if (share[r] <= 0) continue;
        wanted[r] -= sum / present;
        const float compared = wanted[r] - (1 - share_weight) * share[r] +
                               options_.noise * (static_cast<float>(random.bits() >> 8) * 0x1p-24f - 0.5f);
        if (compared > most) {
            most = compared;
            chosen = r;
        }
    }
    resin[voxel(x, y)] = static_cast<std::uint8_t>(chosen);
    wanted[chosen] -= 1;

    float total = 0;
    std::array<float*, 9> target{};
    for (std::size_t n = 0; n < neighbours_.size(); ++n) {
        const Neighbour& to = neighbours_[n];
        const int u = x + dx * to.dx, v = y + dy * to.dy;
        if (u < 0 || v < 0 || u >= width_ || v >= height_) continue;
        if (to.dz == 0 && !body[voxel(u, v)]) continue;
        target[n] = owed(u, v, to.dz);
        total += to.weight;
    }
    if (total <= 0) return;
    for (std::size_t n = 0; n < neighbours_.size(); ++n) {
        if (!target[n]) continue;
        const float part = neighbours_[n].weight / total;
        for (std::size_t r = 0; r < resins; ++r) target[n][r] += part * wanted[r];
    }
}

void ErrorDiffusion::layer(int k, std::span<const CumulativeMixture> mixtures, std::span<const std::uint8_t> body,
                           std::span<std::uint8_t> resin) {
    const auto voxels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    VOXTONE_EXPECT(mixtures.size() == voxels && body.size() == voxels && resin.size() == voxels);
    const bool first = k % slab_layers == 0;
    VOXTONE_EXPECT(k >= 0 && (first || k == next_k_));
    next_k_ = k + 1;
    std::fill(above_.begin(), above_.end(), 0.0f);
    if (first) {
        // As if a resin drawn by the shares had been laid before each voxel, and half of the debt had come here.
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const std::size_t v =
                    static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
                float* debt = owed(x, y, 0);
                if (!body[v]) continue;
                const Shares share = shares_of(mixtures[v], resins_);
                RandomStream random(options_.seed, address(x, y, k), start_stream);
                const int drawn = select_resin(mixtures[v], static_cast<std::uint16_t>(random.bits() >> 16), resins_);
                for (int r = 0; r < resins_; ++r)
                    debt[r] = 0.5f * (share[static_cast<std::size_t>(r)] - (r == drawn ? 1.0f : 0.0f));
            }
    }
    const int dy = k % 2 == 0 ? 1 : -1;
    for (int row = 0; row < height_; ++row) {
        const int y = dy > 0 ? row : height_ - 1 - row;
        const int dx = row % 2 == 0 ? 1 : -1;
        for (int column = 0; column < width_; ++column) {
            const int x = dx > 0 ? column : width_ - 1 - column;
            const std::size_t v =
                static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
            if (body[v]) visit(x, y, k, dx, dy, mixtures, body, resin);
        }
    }
    std::swap(here_, above_);
}

}  // namespace voxtone::halftone
