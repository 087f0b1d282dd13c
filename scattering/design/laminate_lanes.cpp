// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_lanes.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scattering/design/laminate_lanes.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::scattering::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, laminate_lanes>;

void add_distances(const SeenThrough& above, const float* low, const float* high, float limit, LaneSums& sums) {
    const Tag d;
    const auto one = hn::Set(d, 1.0F), least = hn::Set(d, 1e-30F);
    const std::size_t count = above.a.size();
    sums.fill(0.0F);
    for (std::size_t begin = 0; begin < count; begin += lane_stride) {
        const std::size_t end = std::min(count, begin + lane_stride);
        const float tail = above.tail[begin / lane_stride + 1];
        bool open = false;
        for (std::size_t l = 0; l < laminate_lanes; l += hn::Lanes(d)) {
            auto sum = hn::Zero(d);  // of a few first: rounding grows with the longest chain of sums
            for (std::size_t i = begin; i < end; ++i) {
                const auto x = hn::Min(hn::Max(hn::Set(d, above.q[i]), hn::LoadU(d, low + laminate_lanes * i + l)),
                                       hn::LoadU(d, high + laminate_lanes * i + l));
                const auto lost = hn::Max(hn::Sub(one, hn::Mul(hn::Set(d, above.c[i]), x)), least);
                const auto e = hn::Add(hn::Set(d, above.a[i]), hn::Div(hn::Mul(hn::Set(d, above.b[i]), x), lost));
                sum = hn::Add(sum, hn::Mul(e, e));
            }
            sum = hn::Add(sum, hn::LoadU(d, &sums[l]));
            hn::StoreU(sum, d, &sums[l]);
            open = open || !hn::AllFalse(d, hn::Lt(hn::Add(sum, hn::Set(d, tail)), hn::Set(d, limit)));
        }
        if (!open) {
            for (float& sum : sums) sum += tail;
            return;
        }
    }
}

template <class D>
HWY_INLINE void widen_at(D d, const LayerRows& layer, const float* below_low, const float* below_high, float* low,
                         float* high, std::size_t i) {
    const auto one = hn::Set(d, 1.0F), least = hn::Set(d, 1e-30F);
    const auto R = hn::LoadU(d, layer.R + i), T = hn::LoadU(d, layer.T + i), T2 = hn::Mul(T, T);
    const auto p = hn::LoadU(d, below_low + i), q = hn::LoadU(d, below_high + i);
    const auto from = hn::Add(R, hn::Div(hn::Mul(T2, p), hn::Max(hn::Sub(one, hn::Mul(R, p)), least)));
    const auto to = hn::Add(R, hn::Div(hn::Mul(T2, q), hn::Max(hn::Sub(one, hn::Mul(R, q)), least)));
    hn::StoreU(hn::Min(from, hn::LoadU(d, low + i)), d, low + i);
    hn::StoreU(hn::Max(to, hn::LoadU(d, high + i)), d, high + i);
}

void widen(const LayerRows& layer, const float* below_low, const float* below_high, float* low, float* high,
           std::size_t count) {
    const hn::ScalableTag<float> d;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) widen_at(d, layer, below_low, below_high, low, high, i);
    for (; i < count; ++i) widen_at(hn::CappedTag<float, 1>(), layer, below_low, below_high, low, high, i);
}

}  // namespace voxtone::scattering::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::scattering {
HWY_EXPORT(add_distances);
HWY_EXPORT(widen);

void box_distances(const SeenThrough& above, const float* low, const float* high, float limit, LaneSums& sums) {
    HWY_DYNAMIC_DISPATCH(add_distances)(above, low, high, limit, sums);
}

void widen_box(const LayerRows& layer, const std::vector<float>& below_low, const std::vector<float>& below_high,
               std::vector<float>& low, std::vector<float>& high) {
    HWY_DYNAMIC_DISPATCH(widen)(layer, below_low.data(), below_high.data(), low.data(), high.data(), low.size());
}

}  // namespace voxtone::scattering
#endif
