// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/path_entries.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/monte_carlo/path_entries.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include "optics/monte_carlo/path_lanes-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::optics::HWY_NAMESPACE {

void draw(std::uint64_t seed, float eta, Entries& entries) {
    const Tag d;
    const BitTag db;
    const Float one = constant(1);
    for (std::size_t i = 0; i < Entries::most; i += hn::Lanes(d)) {
        Bits counter[4];
        for (std::size_t k = 0; k < 4; ++k) counter[k] = hn::Load(db, entries.random[k].data() + i);
        philox(counter, static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
        const Bits any = hn::Or(hn::Or(counter[0], counter[1]), hn::Or(counter[2], counter[3]));
        counter[0] = hn::IfThenElse(hn::Eq(any, hn::Zero(db)), hn::Set(db, 1), counter[0]);
        Random random{counter[0], counter[1], counter[2], counter[3]};
        hn::Store(unit(random.next()), d, entries.face.data() + i);
        hn::Store(unit(random.next()), d, entries.u.data() + i);
        hn::Store(unit(random.next()), d, entries.v.data() + i);
        hn::Store(exponential(random.next()), d, entries.depth.data() + i);
        const Bits turn = random.next();

        // mu^2 is uniform in diffuse light; what the surface reflects is drawn again.
        Float mu2 = hn::Zero(d);
        Mask rejected = hn::Le(mu2, mu2);
        do {
            Random more = random;
            const Float candidate = unit(more.next()), chance = unit(more.next());
            const Float nu = hn::Sqrt(hn::Sub(one, hn::Mul(hn::Sub(one, candidate), constant(1 / (eta * eta)))));
            mu2 = hn::IfThenElse(rejected, candidate, mu2);
            const auto bits = hn::RebindMask(db, rejected);
            random.s0 = hn::IfThenElse(bits, more.s0, random.s0);
            random.s1 = hn::IfThenElse(bits, more.s1, random.s1);
            random.s2 = hn::IfThenElse(bits, more.s2, random.s2);
            random.s3 = hn::IfThenElse(bits, more.s3, random.s3);
            rejected = hn::And(rejected, hn::Lt(chance, fresnel(hn::Sqrt(candidate), nu, constant(eta))));
        } while (!hn::AllFalse(d, rejected));
        const Float sine2 = hn::Mul(hn::Sub(one, mu2), constant(1 / (eta * eta))), sine = hn::Sqrt(sine2);
        Float x, y;
        azimuth(hn::ShiftRight<16>(turn), x, y);
        hn::Store(hn::Sqrt(hn::Sub(one, sine2)), d, entries.inward.data() + i);
        hn::Store(not_parallel(hn::Mul(sine, x)), d, entries.along_u.data() + i);
        hn::Store(not_parallel(hn::Mul(sine, y)), d, entries.along_v.data() + i);
        hn::Store(random.s0, db, entries.random[0].data() + i);
        hn::Store(random.s1, db, entries.random[1].data() + i);
        hn::Store(random.s2, db, entries.random[2].data() + i);
        hn::Store(random.s3, db, entries.random[3].data() + i);
    }
}

}  // namespace voxtone::optics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::optics {

HWY_EXPORT(draw);

void draw_entries(std::uint64_t seed, double eta, Entries& entries) {
    HWY_DYNAMIC_DISPATCH(draw)(seed, static_cast<float>(eta), entries);
}

}  // namespace voxtone::optics
#endif
