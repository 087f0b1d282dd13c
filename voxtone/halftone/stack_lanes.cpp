// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/stack_lanes.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxtone/halftone/stack_lanes.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::halftone::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, stack_lanes>;

/// Coefficients between two looks at the limit.
constexpr std::size_t stride = 8;

void add_distances(const SeenThrough& above, const float* low, const float* high, float limit, LaneSums& sums) {
    const Tag d;
    const auto one = hn::Set(d, 1.0F), least = hn::Set(d, 1e-30F);
    const std::size_t count = above.a.size();
    sums.fill(0.0F);
    for (std::size_t begin = 0; begin < count; begin += stride) {
        const std::size_t end = std::min(count, begin + stride);
        bool open = false;
        for (std::size_t l = 0; l < stack_lanes; l += hn::Lanes(d)) {
            auto sum = hn::LoadU(d, &sums[l]);
            for (std::size_t i = begin; i < end; ++i) {
                const auto x = hn::Min(hn::Max(hn::Set(d, above.q[i]), hn::LoadU(d, low + stack_lanes * i + l)),
                                       hn::LoadU(d, high + stack_lanes * i + l));
                const auto lost = hn::Max(hn::Sub(one, hn::Mul(hn::Set(d, above.c[i]), x)), least);
                const auto e = hn::Add(hn::Set(d, above.a[i]), hn::Div(hn::Mul(hn::Set(d, above.b[i]), x), lost));
                sum = hn::Add(sum, hn::Mul(e, e));
            }
            hn::StoreU(sum, d, &sums[l]);
            open = open || !hn::AllFalse(d, hn::Lt(sum, hn::Set(d, limit)));
        }
        if (!open) return;
    }
}

}  // namespace voxtone::halftone::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::halftone {
HWY_EXPORT(add_distances);

void box_distances(const SeenThrough& above, const float* low, const float* high, float limit, LaneSums& sums) {
    HWY_DYNAMIC_DISPATCH(add_distances)(above, low, high, limit, sums);
}

}  // namespace voxtone::halftone
#endif
