// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points are taken in groups of one box; who may be near is gathered from memory once for the group, and sixteen points
// at a time look at all of them: each lane adds up its own point, so no sum depends on the vectors' width.
#include "optics/scene/gaussian_gather.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/scene/point_bins.h"

// This file is compiled once per target; what the targets share is seen only once.
#ifndef VOXTONE_GAUSSIAN_GATHER_SHARED
#define VOXTONE_GAUSSIAN_GATHER_SHARED
namespace voxtone::optics {
namespace {

constexpr float reach_spreads = 2.8F;   // exp(-7.84) = 4e-4
constexpr float least_cosine = 0.342F;  // of 70 degrees
constexpr std::size_t lanes = 16;

constexpr std::size_t most_channels = 6;

struct Candidate {
    SurfacePoint point;
    std::array<float, most_channels> value;
};

struct Kernel {
    float per_spread2, reach2, slack2;
};

/// Sixteen points and their sums.
struct Lanes {
    alignas(64) std::array<float, lanes> x, y, z, nx, ny, nz, weight;
    alignas(64) std::array<std::array<float, lanes>, most_channels> sum;
};

}  // namespace
}  // namespace voxtone::optics
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/scene/gaussian_gather.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::optics::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, lanes>;
using Vector = hn::Vec<Tag>;

/// exp(-t) for t in [0, 8], relative error below 3e-4: the eighth power of the Taylor polynomial of exp(-t / 8) about
/// t = 4.
HWY_INLINE Vector decay(Vector t) {
    const Tag d;
    const auto y = hn::Sub(hn::Mul(t, hn::Set(d, 0.125F)), hn::Set(d, 0.5F));
    auto e = hn::Set(d, -1.0F / 120);
    for (const float c : {1.0F / 24, -1.0F / 6, 0.5F, -1.0F, 1.0F}) e = hn::Add(hn::Mul(e, y), hn::Set(d, c));
    e = hn::Mul(e, hn::Set(d, 0.60653066F));  // exp(-1/2)
    e = hn::Mul(e, e);
    e = hn::Mul(e, e);
    return hn::Mul(e, e);
}

template <std::size_t Channels>
HWY_INLINE void accumulate_channels(const Kernel& kernel, const std::vector<Candidate>& near, Lanes& q) {
    const Tag d;
    for (std::size_t l = 0; l < lanes; l += hn::Lanes(d)) {
        const auto x = hn::Load(d, &q.x[l]), y = hn::Load(d, &q.y[l]), z = hn::Load(d, &q.z[l]);
        const auto nx = hn::Load(d, &q.nx[l]), ny = hn::Load(d, &q.ny[l]), nz = hn::Load(d, &q.nz[l]);
        auto weight = hn::Zero(d), s0 = hn::Zero(d), s1 = hn::Zero(d), s2 = hn::Zero(d), s3 = hn::Zero(d),
             s4 = hn::Zero(d), s5 = hn::Zero(d);
        for (const Candidate& c : near) {
            const SurfacePoint& p = c.point;
            const auto dx = hn::Sub(hn::Set(d, p.at[0]), x), dy = hn::Sub(hn::Set(d, p.at[1]), y),
                       dz = hn::Sub(hn::Set(d, p.at[2]), z);
            const auto r2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
            const auto within = hn::Le(r2, hn::Set(d, kernel.reach2));
            if (hn::AllFalse(d, within)) continue;
            const auto mx = hn::Set(d, p.normal[0]), my = hn::Set(d, p.normal[1]), mz = hn::Set(d, p.normal[2]);
            const auto cosine = hn::Add(hn::Add(hn::Mul(mx, nx), hn::Mul(my, ny)), hn::Mul(mz, nz));
            const auto off_plane = hn::Add(hn::Add(hn::Mul(dx, hn::Add(mx, nx)), hn::Mul(dy, hn::Add(my, ny))),
                                           hn::Mul(dz, hn::Add(mz, nz)));
            const auto seen = hn::And(hn::And(within, hn::Gt(cosine, hn::Set(d, least_cosine))),
                                      hn::Le(hn::Mul(off_plane, off_plane), hn::Add(r2, hn::Set(d, kernel.slack2))));
            const auto t = hn::Min(hn::Mul(r2, hn::Set(d, kernel.per_spread2)), hn::Set(d, 8.0F));
            const auto w = hn::IfThenElseZero(seen, hn::Mul(hn::Mul(hn::Set(d, p.area), cosine), decay(t)));
            weight = hn::Add(weight, w);
            s0 = hn::Add(s0, hn::Mul(w, hn::Set(d, c.value[0])));
            if constexpr (Channels >= 2) s1 = hn::Add(s1, hn::Mul(w, hn::Set(d, c.value[1])));
            if constexpr (Channels >= 3) s2 = hn::Add(s2, hn::Mul(w, hn::Set(d, c.value[2])));
            if constexpr (Channels == 6) {
                s3 = hn::Add(s3, hn::Mul(w, hn::Set(d, c.value[3])));
                s4 = hn::Add(s4, hn::Mul(w, hn::Set(d, c.value[4])));
                s5 = hn::Add(s5, hn::Mul(w, hn::Set(d, c.value[5])));
            }
        }
        hn::Store(weight, d, &q.weight[l]);
        hn::Store(s0, d, &q.sum[0][l]);
        if constexpr (Channels >= 2) hn::Store(s1, d, &q.sum[1][l]);
        if constexpr (Channels >= 3) hn::Store(s2, d, &q.sum[2][l]);
        if constexpr (Channels == 6) {
            hn::Store(s3, d, &q.sum[3][l]);
            hn::Store(s4, d, &q.sum[4][l]);
            hn::Store(s5, d, &q.sum[5][l]);
        }
    }
}

void accumulate(const Kernel& kernel, const std::vector<Candidate>& near, std::size_t channels, Lanes& q) {
    switch (channels) {
        case 1:
            return accumulate_channels<1>(kernel, near, q);
        case 2:
            return accumulate_channels<2>(kernel, near, q);
        case 3:
            return accumulate_channels<3>(kernel, near, q);
        default:
            return accumulate_channels<6>(kernel, near, q);
    }
}

}  // namespace voxtone::optics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::optics {
HWY_EXPORT(accumulate);

GaussianGather::GaussianGather(std::span<const SurfacePoint> points, double spread_mm, double slack_mm)
    : GaussianGather(points, points, {}, spread_mm, slack_mm) {}

GaussianGather::GaussianGather(std::span<const SurfacePoint> from, std::span<const SurfacePoint> to,
                               std::span<const std::uint32_t> fallback, double spread_mm, double slack_mm)
    : to_(to),
      fallback_(fallback),
      same_(fallback.empty()),
      spread_(static_cast<float>(spread_mm)),
      slack_(static_cast<float>(slack_mm)) {
    VOXTONE_EXPECT(spread_mm > 0);
    VOXTONE_EXPECT(same_ ? from.data() == to.data() && from.size() == to.size() : fallback.size() == to.size());
    // Boxes as large as the reach: fewer of a group's sixteen lanes stay empty than with smaller ones, and the boxes
    // beside it hold all that is near. Of 0.5, 0.7, 1 and 1.4 reaches 1 takes the least time (docs/decisions/009).
    const float edge = reach_spreads * spread_;
    BinnedPoints near = sort_into_bins(from.size(), [&](std::size_t i) { return bin_of(from[i].at, edge); });
    BinnedPoints others;
    if (!same_) others = sort_into_bins(to.size(), [&](std::size_t i) { return bin_of(to[i].at, edge); });
    BinnedPoints& groups = same_ ? near : others;
    constexpr std::int64_t around = 1;
    ranges_begin_.push_back(0);
    for (std::size_t k = 0; k < groups.bins.size(); ++k) {
        const BoxPlace g = place_of(to[groups.order[groups.begin[k]]].at, edge);
        for (std::int64_t z = g.z - around; z <= g.z + around; ++z)
            for (std::int64_t y = g.y - around; y <= g.y + around; ++y) {
                const auto first = std::lower_bound(near.bins.begin(), near.bins.end(), bin_of({z, y, g.x - around}));
                const auto last = std::upper_bound(first, near.bins.end(), bin_of({z, y, g.x + around}));
                if (first == last) continue;
                ranges_.emplace_back(near.begin[static_cast<std::size_t>(first - near.bins.begin())],
                                     near.begin[static_cast<std::size_t>(last - near.bins.begin())]);
            }
        ranges_begin_.push_back(static_cast<std::uint32_t>(ranges_.size()));
    }
    from_sorted_.reserve(from.size());
    for (const std::uint32_t i : near.order) from_sorted_.push_back(from[i]);
    group_begin_ = std::move(groups.begin);
    from_order_ = std::move(near.order);
    to_order_ = std::move(others.order);
}

void GaussianGather::apply(std::span<const float> in, std::span<float> out, std::size_t channels) const {
    VOXTONE_EXPECT(in.size() == from_order_.size() * channels && out.size() == to_.size() * channels);
    VOXTONE_EXPECT(channels == 1 || channels == 2 || channels == 3 || channels == most_channels);
    if (channels == 1)
        apply_channels<1>(in.data(), out.data());
    else if (channels == 2)
        apply_channels<2>(in.data(), out.data());
    else if (channels == 3)
        apply_channels<3>(in.data(), out.data());
    else
        apply_channels<6>(in.data(), out.data());
}

template <int Channels>
void GaussianGather::apply_channels(const float* in, float* out) const {
    constexpr std::size_t n = Channels;
    const std::span<const std::uint32_t> to_order = this->to_order();
    const float reach = reach_spreads * spread_;
    const Kernel kernel{1 / (spread_ * spread_), reach * reach, 4 * slack_ * slack_};
    const auto work = [&](std::size_t first_group, std::size_t last_group) {
        std::vector<Candidate> near;
        for (std::size_t g = first_group; g < last_group; ++g) {
            const std::uint32_t begin = group_begin_[g], end = group_begin_[g + 1];
            std::array<float, 3> low = to_[to_order[begin]].at, high = low;
            for (std::uint32_t i = begin; i < end; ++i)
                for (std::size_t a = 0; a < 3; ++a) {
                    low[a] = std::min(low[a], to_[to_order[i]].at[a] - reach);
                    high[a] = std::max(high[a], to_[to_order[i]].at[a] + reach);
                }
            near.clear();
            for (std::uint32_t r = ranges_begin_[g]; r < ranges_begin_[g + 1]; ++r)
                for (std::uint32_t i = ranges_[r].first; i < ranges_[r].second; ++i) {
                    const SurfacePoint& p = from_sorted_[i];
                    if (p.at[0] < low[0] || p.at[0] > high[0] || p.at[1] < low[1] || p.at[1] > high[1] ||
                        p.at[2] < low[2] || p.at[2] > high[2])
                        continue;
                    const std::uint32_t j = from_order_[i];
                    near.push_back({p, {}});
                    for (std::size_t c = 0; c < n; ++c) near.back().value[c] = in[j * n + c];
                }
            for (std::uint32_t i = begin; i < end; i += lanes) {
                const std::size_t used = std::min<std::size_t>(lanes, end - i);
                Lanes q;
                for (std::size_t l = 0; l < lanes; ++l) {
                    const SurfacePoint& p = to_[to_order[i + std::min(l, used - 1)]];
                    q.x[l] = p.at[0], q.y[l] = p.at[1], q.z[l] = p.at[2];
                    q.nx[l] = p.normal[0], q.ny[l] = p.normal[1], q.nz[l] = p.normal[2];
                }
                HWY_DYNAMIC_DISPATCH(accumulate)(kernel, near, n, q);
                for (std::size_t l = 0; l < used; ++l) {
                    const std::uint32_t t = to_order[i + l], instead = same_ ? t : fallback_[t];
                    for (std::size_t c = 0; c < n; ++c)
                        out[t * n + c] = q.weight[l] > 0 ? q.sum[c][l] / q.weight[l] : in[instead * n + c];
                }
            }
        }
    };
    parallel_ranges(0, group_begin_.size() - 1, 64, work);
}

}  // namespace voxtone::optics
#endif
