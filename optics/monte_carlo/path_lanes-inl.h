// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arithmetic of light paths in vector lanes (Highway): included once per target, between HWY_BEFORE_NAMESPACE files. No
// operation is fused, so that every target gives the same bits.
#if defined(VOXTONE_OPTICS_PATH_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VOXTONE_OPTICS_PATH_LANES_INL_H
#undef VOXTONE_OPTICS_PATH_LANES_INL_H
#else
#define VOXTONE_OPTICS_PATH_LANES_INL_H
#endif

#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace voxtone::optics::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<Tag>;
using BitTag = hn::RebindToUnsigned<Tag>;
using Float = hn::Vec<Tag>;
using Int = hn::Vec<IntTag>;
using Bits = hn::Vec<BitTag>;
using Mask = hn::Mask<Tag>;

HWY_INLINE Float constant(float x) { return hn::Set(Tag(), x); }

struct Random {
    Bits s0, s1, s2, s3;
    HWY_INLINE Bits next() {
        const Bits sum = hn::Add(s0, s3);
        const Bits result = hn::Add(hn::RotateRight<25>(sum), s0);
        const Bits t = hn::ShiftLeft<9>(s1);
        s2 = hn::Xor(s2, s0);
        s3 = hn::Xor(s3, s1);
        s1 = hn::Xor(s1, s2);
        s0 = hn::Xor(s0, s3);
        s2 = hn::Xor(s2, t);
        s3 = hn::RotateRight<21>(s3);
        return result;
    }
};

/// In [0, 1), 24 bits.
HWY_INLINE Float unit(Bits bits) {
    return hn::Mul(hn::ConvertTo(Tag(), hn::BitCast(IntTag(), hn::ShiftRight<8>(bits))), constant(0x1p-24f));
}

/// -ln of a number that is uniform in (0, 1], 31 bits: 2 artanh of (m - 1) / (m + 1) for the mantissa m within a factor
/// sqrt 2 of 1, as a series; what is left out is below 1e-8. Relative error 1e-7.
HWY_INLINE Float exponential(Bits bits) {
    const IntTag di;
    const Tag d;
    const Int whole = hn::Or(hn::BitCast(di, hn::ShiftRight<1>(bits)), hn::Set(di, 1));
    const Int raw = hn::BitCast(di, hn::ConvertTo(d, whole));
    const Int exponent = hn::ShiftRight<23>(hn::Sub(raw, hn::Set(di, 0x3f3504f3)));
    const Float m = hn::BitCast(d, hn::Sub(raw, hn::ShiftLeft<23>(exponent)));
    const Float one = constant(1);
    const Float s = hn::Div(hn::Sub(one, m), hn::Add(one, m)), s2 = hn::Mul(s, s);
    Float sum = hn::Add(hn::Mul(s2, constant(2.0f / 9)), constant(2.0f / 7));
    sum = hn::Add(hn::Mul(s2, sum), constant(2.0f / 5));
    sum = hn::Add(hn::Mul(s2, sum), constant(2.0f / 3));
    sum = hn::Add(hn::Mul(hn::Mul(s2, s), sum), hn::Add(s, s));
    const Float turns = hn::Sub(constant(31), hn::ConvertTo(d, exponent));
    return hn::Add(hn::Mul(turns, constant(0.693147182f)), sum);
}

/// Cosine and sine of one of 2^16 angles of the full turn, from 16 bits; Taylor series within an eighth of a turn.
HWY_INLINE void azimuth(Bits bits, Float& cosine, Float& sine) {
    const Tag d;
    const IntTag di;
    const Int q = hn::BitCast(di, bits);
    const Float part = hn::ConvertTo(d, hn::And(q, hn::Set(di, 0x3fff)));
    const Float a = hn::Mul(hn::Sub(part, constant(8191.5f)), constant(9.58737992e-5f));  // pi / 2 / 2^14
    const Float a2 = hn::Mul(a, a);
    Float s = hn::Add(hn::Mul(a2, constant(1.0f / 362880)), constant(-1.0f / 5040));
    s = hn::Add(hn::Mul(a2, s), constant(1.0f / 120));
    s = hn::Add(hn::Mul(a2, s), constant(-1.0f / 6));
    s = hn::Add(hn::Mul(hn::Mul(a2, a), s), a);
    Float c = hn::Add(hn::Mul(a2, constant(1.0f / 40320)), constant(-1.0f / 720));
    c = hn::Add(hn::Mul(a2, c), constant(1.0f / 24));
    c = hn::Add(hn::Mul(a2, c), constant(-0.5f));
    c = hn::Add(hn::Mul(a2, c), constant(1));
    // Quarter turns: bit 14 swaps, bit 15 turns by half.
    const Mask swap = hn::RebindMask(d, hn::Ne(hn::And(q, hn::Set(di, 0x4000)), hn::Zero(di)));
    const Float half = hn::BitCast(d, hn::ShiftLeft<16>(hn::And(q, hn::Set(di, 0x8000))));
    cosine = hn::Xor(hn::IfThenElse(swap, hn::Neg(s), c), half);
    sine = hn::Xor(hn::IfThenElse(swap, c, s), half);
}

HWY_INLINE Float gather(const float* table, Int index) { return hn::GatherIndex(Tag(), table, index); }

/// Unpolarised, for cosines to the normal in air and in the resin.
HWY_INLINE Float fresnel(Float mu, Float nu, Float eta) {
    const Float s_wave = hn::Div(hn::Sub(mu, hn::Mul(eta, nu)), hn::Add(mu, hn::Mul(eta, nu)));
    const Float p_wave = hn::Div(hn::Sub(hn::Mul(eta, mu), nu), hn::Add(hn::Mul(eta, mu), nu));
    return hn::Mul(constant(0.5f), hn::Add(hn::Mul(s_wave, s_wave), hn::Mul(p_wave, p_wave)));
}

/// 1 beyond the critical angle.
HWY_INLINE Float internal_reflectance(Float nu, Float eta) {
    const Float one = constant(1), zero = hn::Zero(Tag());
    const Float mu2 = hn::Sub(one, hn::Mul(hn::Mul(eta, eta), hn::Mul(hn::Sub(one, nu), hn::Add(one, nu))));
    return hn::IfThenElse(hn::Gt(mu2, zero), fresnel(hn::Sqrt(hn::Max(mu2, zero)), nu, eta), one);
}

/// -0 and 0 and all that is nearly so: a direction is never parallel to a side, divisions stay finite.
HWY_INLINE Float not_parallel(Float x) {
    const Float least = constant(1e-18f);
    return hn::IfThenElse(hn::Lt(hn::Abs(x), least), hn::CopySign(least, x), x);
}

/// The upper half of a 64-bit product, from the four products of halves (not every target has wider lanes).
HWY_INLINE Bits high_product(Bits a, Bits b) {
    const Bits low = hn::Set(BitTag(), 0xffff);
    const Bits a0 = hn::And(a, low), a1 = hn::ShiftRight<16>(a), b0 = hn::And(b, low), b1 = hn::ShiftRight<16>(b);
    const Bits p01 = hn::Mul(a0, b1), p10 = hn::Mul(a1, b0);
    const Bits middle = hn::Add(hn::ShiftRight<16>(hn::Mul(a0, b0)), hn::Add(hn::And(p01, low), hn::And(p10, low)));
    return hn::Add(hn::Add(hn::Mul(a1, b1), hn::ShiftRight<16>(middle)),
                   hn::Add(hn::ShiftRight<16>(p01), hn::ShiftRight<16>(p10)));
}

/// Philox4x32-10 as in base/random.h.
HWY_INLINE void philox(Bits* counter, std::uint32_t key0, std::uint32_t key1) {
    const BitTag d;
    const Bits m0 = hn::Set(d, 0xD2511F53u), m1 = hn::Set(d, 0xCD9E8D57u);
    for (int round = 0; round < 10; ++round) {
        const Bits high0 = high_product(counter[0], m0), low0 = hn::Mul(counter[0], m0);
        const Bits high1 = high_product(counter[2], m1), low1 = hn::Mul(counter[2], m1);
        counter[0] = hn::Xor(hn::Xor(high1, counter[1]), hn::Set(d, key0));
        counter[1] = low1;
        counter[2] = hn::Xor(hn::Xor(high0, counter[3]), hn::Set(d, key1));
        counter[3] = low0;
        key0 += 0x9E3779B9u;
        key1 += 0xBB67AE85u;
    }
}

}  // namespace voxtone::optics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
