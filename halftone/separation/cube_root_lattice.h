// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values of colours between the nodes of a lattice that is even in the cube root of linear channels, about as the eye
// is: trilinear in these roots. Node (r, g, b) of `edge` a side is number (r edge + g) edge + b.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "optics/numerics/portable_math.h"

namespace voxtone::halftone {

/// In [0, edge - 1]; `linear` is taken as within [0, 1].
inline float cube_root_place(float linear, std::size_t edge) {
    return portable::cbrt(std::clamp(linear, 0.0f, 1.0f)) * static_cast<float>(edge - 1);
}

/// Calls take(node, weight) for the eight nodes around a colour; weights sum to 1.
template <class Take>
void for_nodes_around(const Eigen::Vector3f& linear_rgb, std::size_t edge, Take&& take) {
    std::array<std::size_t, 3> first{};
    std::array<float, 3> past{};
    for (std::size_t c = 0; c < 3; ++c) {
        const float x = cube_root_place(linear_rgb[static_cast<Eigen::Index>(c)], edge);
        first[c] = std::min(static_cast<std::size_t>(x), edge - 2);
        past[c] = x - static_cast<float>(first[c]);
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
        float weight = 1;
        std::size_t node = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const bool upper = corner >> c & 1;
            weight *= upper ? past[c] : 1 - past[c];
            node = node * edge + first[c] + (upper ? 1 : 0);
        }
        take(node, weight);
    }
}

}  // namespace voxtone::halftone
