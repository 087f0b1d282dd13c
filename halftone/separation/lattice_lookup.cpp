// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/separation/lattice_lookup.h"

#include <algorithm>
#include <array>
#include <cstdint>

#ifndef VOXTONE_LATTICE_LOOKUP_ONCE
#define VOXTONE_LATTICE_LOOKUP_ONCE
// What is the same for every target: four lanes are in every machine's reach.
namespace voxtone::halftone {
namespace {

constexpr std::size_t block = 16;
static_assert(max_resins == 8);

/// The corners of the colours' tetrahedra (offsets into the lattice, in floats) and their weights.
struct Corners {
    alignas(64) std::array<float, block> weight[4];
    alignas(64) std::array<std::int32_t, block> offset[4];
};

using Four = float __attribute__((vector_size(16)));
using FourInts = std::int32_t __attribute__((vector_size(16)));
using FourShorts = std::uint16_t __attribute__((vector_size(8)));

/// The mean of the interpolated shares and the squares of the interpolated roots: resins 0 .. 3 and 4 .. 7.
inline void blend(const LatticeView& lattice, const Corners& corners, std::size_t i, Four& low, Four& high) {
    Four root_low{}, root_high{}, square_low{}, square_high{};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const float* node = lattice.root + corners.offset[corner][i];
        const float weight = corners.weight[corner][i];
        Four a, b;
        __builtin_memcpy(&a, node, sizeof a);
        __builtin_memcpy(&b, node + 4, sizeof b);
        root_low += weight * a;
        root_high += weight * b;
        square_low += weight * a * a;
        square_high += weight * b * b;
    }
    low = 0.5f * (root_low * root_low + square_low);
    high = 0.5f * (root_high * root_high + square_high);
}

inline Four running_sum(Four v) {
    const Four zero{};
    v += __builtin_shuffle(zero, v, FourInts{0, 4, 5, 6});
    return v + __builtin_shuffle(zero, v, FourInts{0, 0, 4, 5});
}

/// Four sums in units of 1 / 65536, rounded, at most 65535.
inline FourShorts whole(Four sum, float scale) {
    const Four rounded = sum * scale + 0.5f, most = Four{} + 65535.0f;
    return __builtin_convertvector(__builtin_convertvector(rounded < most ? rounded : most, FourInts), FourShorts);
}

/// `all_the_rest`: 65535 from the last resin on, 0 before.
inline void store_mixture(Four low, Four high, const FourShorts* all_the_rest, std::uint16_t* bound) {
    low = running_sum(low);
    high = running_sum(high) + low[3];
    const float scale = 65536.0f / high[3];
    const FourShorts a = whole(low, scale) | all_the_rest[0], b = whole(high, scale) | all_the_rest[1];
    __builtin_memcpy(bound, &a, sizeof a);
    __builtin_memcpy(bound + 4, &b, sizeof b);
}

}  // namespace
}  // namespace voxtone::halftone
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxtone/halftone/separation/lattice_lookup.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::halftone::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, block>;
using IntTag = hn::RebindToSigned<Tag>;
using Vector = hn::Vec<Tag>;

/// Cube root of x in [1e-9, 1], relative error below 1e-6: two of Halley's steps from a bit-level guess.
HWY_INLINE Vector cube_root(Vector x) {
    const Tag d;
    const IntTag di;
    const auto third = hn::Mul(hn::ConvertTo(d, hn::BitCast(di, x)), hn::Set(d, 1.0f / 3.0f));
    auto y = hn::BitCast(d, hn::Add(hn::ConvertTo(di, third), hn::Set(di, 0x2a514067)));
    for (int step = 0; step < 2; ++step) {
        const auto cube = hn::Mul(hn::Mul(y, y), y);
        y = hn::Div(hn::Mul(y, hn::Add(cube, hn::Add(x, x))), hn::Add(hn::Add(cube, cube), x));
    }
    return y;
}

/// The cell along one axis, and the place in it, in [0, 1].
HWY_INLINE void locate(const float* value, float nodes, Vector& cell, Vector& part) {
    const Tag d;
    const IntTag di;
    const auto raw = hn::LoadU(d, value);
    const auto least = hn::Set(d, 1e-9f), one = hn::Set(d, 1.0f);
    const auto position =
        hn::Mul(cube_root(hn::IfThenElse(hn::Gt(raw, least), hn::Min(raw, one), least)), hn::Set(d, nodes - 1));
    cell = hn::Min(hn::ConvertTo(d, hn::ConvertTo(di, position)), hn::Set(d, nodes - 2));
    part = hn::Min(hn::Sub(position, cell), one);
}

/// Larger part first, with its step.
HWY_INLINE void order(Vector& part_a, Vector& step_a, Vector& part_b, Vector& step_b) {
    const auto wrong = hn::Lt(part_a, part_b);
    const auto part = hn::IfThenElse(wrong, part_b, part_a), step = hn::IfThenElse(wrong, step_b, step_a);
    part_b = hn::IfThenElse(wrong, part_a, part_b);
    step_b = hn::IfThenElse(wrong, step_a, step_b);
    part_a = part;
    step_a = step;
}

/// Tetrahedra that share the diagonal from black to white, so that greys are interpolated between greys: from the
/// cell's first corner to its last along the axis of the largest part first. Whole numbers below 2^24 are kept as
/// floats.
void find_corners(const LatticeView& lattice, const float* red, const float* green, const float* blue, Corners& out) {
    const Tag d;
    const IntTag di;
    const auto nodes = static_cast<float>(lattice.nodes);
    for (std::size_t i = 0; i < block; i += hn::Lanes(d)) {
        Vector cell_r, cell_g, cell_b, a, b, c;
        locate(red + i, nodes, cell_r, a);
        locate(green + i, nodes, cell_g, b);
        locate(blue + i, nodes, cell_b, c);
        auto step_a = hn::Set(d, 1.0f), step_b = hn::Set(d, nodes), step_c = hn::Set(d, nodes * nodes);
        auto at = hn::Add(cell_r, hn::Add(hn::Mul(cell_g, step_b), hn::Mul(cell_b, step_c)));
        order(a, step_a, b, step_b);
        order(b, step_b, c, step_c);
        order(a, step_a, b, step_b);
        hn::Store(hn::Sub(hn::Set(d, 1.0f), a), d, &out.weight[0][i]);
        hn::Store(hn::Sub(a, b), d, &out.weight[1][i]);
        hn::Store(hn::Sub(b, c), d, &out.weight[2][i]);
        hn::Store(c, d, &out.weight[3][i]);
        const auto store = [&](std::size_t corner) {
            hn::Store(hn::ShiftLeft<3>(hn::ConvertTo(di, at)), di, &out.offset[corner][i]);
        };
        store(0);
        at = hn::Add(at, step_a);
        store(1);
        at = hn::Add(at, step_b);
        store(2);
        at = hn::Add(at, step_c);
        store(3);
    }
}

}  // namespace voxtone::halftone::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::halftone {

HWY_EXPORT(find_corners);

void lattice_shares(const LatticeView& lattice, float red, float green, float blue, float* shares) {
    std::array<std::array<float, block>, 3> colour;
    colour[0].fill(red);
    colour[1].fill(green);
    colour[2].fill(blue);
    Corners corners;
    HWY_DYNAMIC_DISPATCH(find_corners)(lattice, colour[0].data(), colour[1].data(), colour[2].data(), corners);
    Four low, high;
    blend(lattice, corners, 0, low, high);
    __builtin_memcpy(shares, &low, sizeof low);
    __builtin_memcpy(shares + 4, &high, sizeof high);
}

void lattice_mixtures(const LatticeView& lattice, const float* red, const float* green, const float* blue,
                      std::size_t n, CumulativeMixture* out) {
    std::array<FourShorts, 2> all_the_rest{};
    for (std::size_t r = static_cast<std::size_t>(lattice.resins) - 1; r < max_resins; ++r)
        all_the_rest[r / 4][r % 4] = 65535;
    const auto find = HWY_DYNAMIC_DISPATCH(find_corners);
    Corners corners;
    for (std::size_t first = 0; first < n; first += block) {
        const std::size_t count = std::min(block, n - first);
        if (count == block) {
            find(lattice, red + first, green + first, blue + first, corners);
        } else {
            std::array<std::array<float, block>, 3> rest{};
            std::copy_n(red + first, count, rest[0].begin());
            std::copy_n(green + first, count, rest[1].begin());
            std::copy_n(blue + first, count, rest[2].begin());
            find(lattice, rest[0].data(), rest[1].data(), rest[2].data(), corners);
        }
        for (std::size_t i = 0; i < count; ++i) {
            Four low, high;
            blend(lattice, corners, i, low, high);
            store_mixture(low, high, all_the_rest.data(), out[first + i].bound.data());
        }
    }
}

}  // namespace voxtone::halftone
#endif
