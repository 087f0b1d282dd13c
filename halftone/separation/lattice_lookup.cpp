// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/lattice_lookup.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "halftone/separation/scalar_lookup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "halftone/separation/lattice_lookup.cpp"
// The order of these two matters.
// clang-format off
#include "hwy/foreach_target.h"
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace voxtone::halftone::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void look_up_shares(const LatticeView& lattice, float red, float green, float blue, float* shares) {
    std::ranges::copy(scalar_shares(lattice, red, green, blue), shares);
}

void look_up_mixtures(const LatticeView& lattice, const float* red, const float* green, const float* blue,
                      std::size_t n, CumulativeMixture* out) {
    for (std::size_t i = 0; i < n; ++i) out[i] = scalar_mixture(lattice, red[i], green[i], blue[i]);
}

#else

/// Colours at once. Their corners are found by vectors as wide as there are; each is then blended by vectors of four
/// resins, which every vector unit has.
constexpr std::size_t block = 16;
static_assert(max_resins == 8);

using Tag = hn::CappedTag<float, block>;
using IntTag = hn::RebindToSigned<Tag>;
using Vector = hn::Vec<Tag>;

using FourTag = hn::FixedTag<float, 4>;
using Four = hn::Vec<FourTag>;
using FourShortsTag = hn::FixedTag<std::uint16_t, 4>;
using FourShorts = hn::Vec<FourShortsTag>;

/// The corners of the colours' tetrahedra (offsets into the lattice, in floats) and their weights.
struct Corners {
    alignas(64) std::array<float, block> weight[4];
    alignas(64) std::array<std::int32_t, block> offset[4];
};

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
HWY_INLINE void find_corners(const LatticeView& lattice, const float* red, const float* green, const float* blue,
                             Corners& out) {
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

/// Before the corners of one of the block's colours are read.
HWY_INLINE void require_corners(const LatticeView& lattice, const Corners& corners, std::size_t i) {
    if (!lattice.solved) return;
    const auto node = [&](std::size_t corner) {
        return static_cast<std::size_t>(corners.offset[corner][i]) / max_resins;
    };
    bool all = true;
    for (std::size_t corner = 0; corner < 4; ++corner) all &= lattice.solved->made(node(corner));
    if (all) return;
    for (std::size_t corner = 0; corner < 4; ++corner) require_node(lattice, node(corner));
}

/// Resins 0 .. 3 and 4 .. 7.
struct Eight {
    Four low, high;
};

/// The mean of the interpolated shares and the squares of the interpolated roots, of one of the block's colours.
HWY_INLINE Eight blend(const LatticeView& lattice, const Corners& corners, std::size_t i) {
    require_corners(lattice, corners, i);
    const FourTag d;
    Eight root{hn::Zero(d), hn::Zero(d)}, square = root;
    const auto add = [&](Four weight, Four a, Four& roots, Four& squares) {
        const auto weighed = hn::Mul(weight, a);
        roots = hn::Add(roots, weighed);
        squares = hn::Add(squares, hn::Mul(weighed, a));
    };
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const float* node = lattice.root + corners.offset[corner][i];
        const auto weight = hn::Set(d, corners.weight[corner][i]);
        add(weight, hn::LoadU(d, node), root.low, square.low);
        add(weight, hn::LoadU(d, node + 4), root.high, square.high);
    }
    const auto mean = [&](Four r, Four s) { return hn::Mul(hn::Set(d, 0.5f), hn::Add(hn::Mul(r, r), s)); };
    return {mean(root.low, square.low), mean(root.high, square.high)};
}

HWY_INLINE Four running_sum(Four v) {
    const FourTag d;
    v = hn::Add(v, hn::ShiftLeftLanes<1>(d, v));
    return hn::Add(v, hn::ShiftLeftLanes<2>(d, v));
}

/// Four sums in units of 1 / 65536, rounded, at most 65535.
HWY_INLINE FourShorts whole(Four sum, Four scale) {
    const FourTag d;
    const auto rounded = hn::Add(hn::Mul(sum, scale), hn::Set(d, 0.5f)), most = hn::Set(d, 65535.0f);
    const auto bounded = hn::IfThenElse(hn::Lt(rounded, most), rounded, most);
    return hn::DemoteTo(FourShortsTag(), hn::ConvertTo(hn::RebindToSigned<FourTag>(), bounded));
}

/// `all_the_rest`: 65535 from the last resin on, 0 before.
HWY_INLINE void store_mixture(const Eight& shares, const std::uint16_t* all_the_rest, std::uint16_t* bound) {
    const FourTag d;
    const FourShortsTag ds;
    const auto low = running_sum(shares.low), high = hn::Add(running_sum(shares.high), hn::Broadcast<3>(low));
    const auto scale = hn::Div(hn::Set(d, 65536.0f), hn::Broadcast<3>(high));
    hn::StoreU(hn::Or(whole(low, scale), hn::LoadU(ds, all_the_rest)), ds, bound);
    hn::StoreU(hn::Or(whole(high, scale), hn::LoadU(ds, all_the_rest + 4)), ds, bound + 4);
}

void look_up_shares(const LatticeView& lattice, float red, float green, float blue, float* shares) {
    std::array<std::array<float, block>, 3> colour;
    colour[0].fill(red);
    colour[1].fill(green);
    colour[2].fill(blue);
    Corners corners;
    find_corners(lattice, colour[0].data(), colour[1].data(), colour[2].data(), corners);
    const FourTag d;
    const Eight blended = blend(lattice, corners, 0);
    hn::StoreU(blended.low, d, shares);
    hn::StoreU(blended.high, d, shares + 4);
}

void look_up_mixtures(const LatticeView& lattice, const float* red, const float* green, const float* blue,
                      std::size_t n, CumulativeMixture* out) {
    std::array<std::uint16_t, max_resins> all_the_rest{};
    std::fill(all_the_rest.begin() + lattice.resins - 1, all_the_rest.end(), std::uint16_t{65535});
    Corners corners;
    for (std::size_t first = 0; first < n; first += block) {
        const std::size_t count = std::min(block, n - first);
        if (count == block) {
            find_corners(lattice, red + first, green + first, blue + first, corners);
        } else {
            std::array<std::array<float, block>, 3> rest{};
            std::copy_n(red + first, count, rest[0].begin());
            std::copy_n(green + first, count, rest[1].begin());
            std::copy_n(blue + first, count, rest[2].begin());
            find_corners(lattice, rest[0].data(), rest[1].data(), rest[2].data(), corners);
        }
        for (std::size_t i = 0; i < count; ++i)
            store_mixture(blend(lattice, corners, i), all_the_rest.data(), out[first + i].bound.data());
    }
}

#endif

}  // namespace voxtone::halftone::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace voxtone::halftone {

HWY_EXPORT(look_up_shares);
HWY_EXPORT(look_up_mixtures);

void lattice_shares(const LatticeView& lattice, float red, float green, float blue, float* shares) {
    HWY_DYNAMIC_DISPATCH(look_up_shares)(lattice, red, green, blue, shares);
}

void lattice_mixtures(const LatticeView& lattice, const float* red, const float* green, const float* blue,
                      std::size_t n, CumulativeMixture* out) {
    HWY_DYNAMIC_DISPATCH(look_up_mixtures)(lattice, red, green, blue, n, out);
}

}  // namespace voxtone::halftone
#endif
