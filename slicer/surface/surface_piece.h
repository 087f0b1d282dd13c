// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangles halved where a part of them is seen and a part is not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace voxtone::slicer {

/// A triangle or a part of one.
struct Piece {
    std::array<Eigen::Vector3d, 3> corner;
    std::array<Eigen::Vector2f, 3> uv;
    std::uint32_t source;

    [[nodiscard]] Eigen::Vector3d centre() const { return (corner[0] + corner[1] + corner[2]) / 3; }
    [[nodiscard]] double longest() const {
        return std::sqrt(std::max({(corner[1] - corner[0]).squaredNorm(), (corner[2] - corner[1]).squaredNorm(),
                                   (corner[0] - corner[2]).squaredNorm()}));
    }
    /// In two, across the longest edge.
    [[nodiscard]] std::array<Piece, 2> halves() const {
        int c = 0;
        double longest2 = -1;
        for (int e = 0; e < 3; ++e) {
            const double l = (corner[(e + 1) % 3] - corner[e]).squaredNorm();
            if (l > longest2) longest2 = l, c = e;
        }
        std::array<Piece, 2> half{*this, *this};
        const int d = (c + 1) % 3;
        half[0].corner[d] = half[1].corner[c] = (corner[c] + corner[d]) / 2;
        half[0].uv[d] = half[1].uv[c] = (uv[c] + uv[d]) / 2;
        return half;
    }
};

enum class Sight { visible, hidden, mixed };

/// Adds the visible parts of a piece, in as few pieces as it takes. Returns what it is as a whole.
template <class Look>
Sight add_visible(const Piece& piece, const Look& look, std::vector<Piece>& out) {
    Sight sight = look(piece);
    if (sight == Sight::mixed) {
        const std::size_t before = out.size();
        const auto [a, b] = piece.halves();
        const Sight first = add_visible(a, look, out), second = add_visible(b, look, out);
        if (first != second || first == Sight::mixed) return Sight::mixed;
        out.resize(before);
        sight = first;
    }
    if (sight == Sight::visible) out.push_back(piece);
    return sight;
}

}  // namespace voxtone::slicer
