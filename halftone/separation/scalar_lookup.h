// SPDX-License-Identifier: GPL-3.0-or-later
//
// The look-up of lattice_lookup.h for one colour, operation for operation: the definition that its vector code has to
// meet to the last bit (lattice_lookup_test.cpp), and what runs where there are no vectors.
//
// A cell of the lattice is cut into six tetrahedra that share the diagonal from black to white; a colour's corners are
// met by going from the cell's first corner to its last, along the axis of the largest part first (J. M. Kasson,
// W. Plouffe, S. I. Nin, "Tetrahedral interpolation technique for color space conversion", Proc. SPIE, 1993).
// With weights w and square roots r of shares at the corners the shares are ((sum w r)^2 + sum w r^2) / 2.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "halftone/separation/lattice_view.h"
#include "halftone/separation/mixture.h"

namespace voxtone::halftone {

/// Two of Halley's steps from a guess by the bits.
inline float scalar_cube_root(float x) {
    const float third = static_cast<float>(std::bit_cast<std::int32_t>(x)) * (1.0f / 3.0f);
    auto y = std::bit_cast<float>(static_cast<std::int32_t>(third) + 0x2a514067);
    for (int step = 0; step < 2; ++step) {
        const float cube = y * y * y;
        y = y * (cube + (x + x)) / (cube + cube + x);
    }
    return y;
}

using Shares = std::array<float, max_resins>;

inline Shares scalar_shares(const LatticeView& lattice, float red, float green, float blue) {
    struct Axis {
        float part, step;
    };
    const auto nodes = static_cast<float>(lattice.nodes);
    std::array<Axis, 3> axis;
    float at = 0, step = 1;
    for (std::size_t c = 0; c < 3; ++c, step *= nodes) {
        const float value = std::array{red, green, blue}[c];
        const float position = scalar_cube_root(value > 1e-9f ? std::min(value, 1.0f) : 1e-9f) * (nodes - 1);
        const float cell = std::min(static_cast<float>(static_cast<std::int32_t>(position)), nodes - 2);
        axis[c] = {std::min(position - cell, 1.0f), step};
        at += cell * step;
    }
    for (const std::size_t first : {0u, 1u, 0u})
        if (axis[first].part < axis[first + 1].part) std::swap(axis[first], axis[first + 1]);

    const std::array<float, 4> weight{1.0f - axis[0].part, axis[0].part - axis[1].part, axis[1].part - axis[2].part,
                                      axis[2].part};
    Shares root{}, square{}, shares;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        require_node(lattice, static_cast<std::size_t>(at));
        const float* const node = lattice.root + static_cast<std::size_t>(at) * max_resins;
        for (std::size_t r = 0; r < max_resins; ++r) {
            const float weighed = weight[corner] * node[r];
            root[r] += weighed;
            square[r] += weighed * node[r];
        }
        if (corner < 3) at += axis[corner].step;
    }
    for (std::size_t r = 0; r < max_resins; ++r) shares[r] = 0.5f * (root[r] * root[r] + square[r]);
    return shares;
}

/// Sums of four: pairs of neighbours first, then pairs of pairs.
inline std::array<float, 4> scalar_running_sum(const float* v) {
    const std::array<float, 4> pair{v[0], v[1] + v[0], v[2] + v[1], v[3] + v[2]};
    return {pair[0], pair[1], pair[2] + pair[0], pair[3] + pair[1]};
}

inline CumulativeMixture scalar_mixture(const LatticeView& lattice, float red, float green, float blue) {
    const Shares shares = scalar_shares(lattice, red, green, blue);
    const std::array<float, 4> low = scalar_running_sum(shares.data());
    std::array<float, 4> high = scalar_running_sum(shares.data() + 4);
    for (float& sum : high) sum += low[3];
    const float scale = 65536.0f / high[3];
    CumulativeMixture mixture;
    for (std::size_t r = 0; r < max_resins; ++r) {
        const float rounded = (r < 4 ? low[r] : high[r - 4]) * scale + 0.5f;
        const bool last = r + 1 >= static_cast<std::size_t>(lattice.resins);
        mixture.bound[r] = static_cast<std::uint16_t>(!last && rounded < 65535.0f ? rounded : 65535.0f);
    }
    return mixture;
}

}  // namespace voxtone::halftone
