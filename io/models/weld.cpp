// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/weld.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace voxtone::io {

namespace {

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hash(const Eigen::Vector3d& p) {
    std::uint64_t h = 0x9E3779B97F4A7C15u;
    for (const double x : p) {
        h ^= std::bit_cast<std::uint64_t>(x);
        h *= 0xBF58476D1CE4E5B9u;
        h ^= h >> 29;
    }
    return h;
}

/// Vertices of edges that are not run through as often in one direction as in the other.
std::vector<std::uint32_t> open_vertices(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                         std::size_t vertices) {
    std::vector<std::uint64_t> edges;  // the lower vertex, the higher, and the direction in the last bit
    edges.reserve(3 * triangles.size());
    for (const auto& triangle : triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint64_t a = triangle[c], b = triangle[(c + 1) % 3];
            if (a != b) edges.push_back(std::min(a, b) << 32 | std::max(a, b) << 1 | std::uint64_t{a < b});
        }
    std::sort(edges.begin(), edges.end());
    std::vector<bool> open(vertices);
    for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
        std::ptrdiff_t balance = 0;
        for (end = first; end < edges.size() && edges[end] >> 1 == edges[first] >> 1; ++end)
            balance += (edges[end] & 1) != 0 ? 1 : -1;
        if (balance == 0) continue;
        open[edges[first] >> 32] = true;
        open[(edges[first] >> 1) & 0x7fffffff] = true;
    }
    std::vector<std::uint32_t> found;
    for (std::uint32_t v = 0; v < vertices; ++v)
        if (open[v]) found.push_back(v);
    return found;
}

/// A vertex of an open edge.
struct CrackVertex {
    Eigen::Vector3d place;
    Rounding rounding;
};

/// Vertices by the cells of a grid.
class CrackGrid {
public:
    CrackGrid(std::span<const CrackVertex> vertices, double side) : vertices_(vertices), side_(side) {
        for (std::uint32_t v = 0; v < vertices.size(); ++v) cells_.emplace(key(cell_of(v)), v);
    }
    /// Calls visit(vertex) of those in the cell of `v` and the 26 around it, of at most `most`.
    template <class Visit>
    void around(std::uint32_t v, std::size_t most, const Visit& visit) const {
        const Eigen::Vector3d here = cell_of(v);
        for (int cell = 0; cell < 27; ++cell) {
            const Eigen::Vector3d offset(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1);
            const auto [first, end] = cells_.equal_range(key(here + offset));
            for (auto i = first; i != end && most > 0; ++i, --most) visit(i->second);
        }
    }

private:
    [[nodiscard]] Eigen::Vector3d cell_of(std::uint32_t v) const {
        return (vertices_[v].place / side_).array().floor();
    }
    static std::uint64_t key(const Eigen::Vector3d& cell) { return hash(cell + Eigen::Vector3d::Zero()); }

    std::span<const CrackVertex> vertices_;
    double side_;
    std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
};

/// Groups of vertices that become one; each has at most one of a piece.
class JoinedVertices {
public:
    explicit JoinedVertices(std::span<const CrackVertex> vertices) : parent_(vertices.size()) {
        std::iota(parent_.begin(), parent_.end(), 0u);
        for (const CrackVertex& vertex : vertices) pieces_.push_back({vertex.rounding.piece});
    }
    std::uint32_t root(std::uint32_t v) {
        while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
        return v;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        if (b < a) std::swap(a, b);
        for (const std::uint32_t piece : pieces_[b])
            if (std::ranges::find(pieces_[a], piece) != pieces_[a].end()) return;
        pieces_[a].insert(pieces_[a].end(), pieces_[b].begin(), pieces_[b].end());
        parent_[b] = a;
    }

private:
    std::vector<std::uint32_t> parent_;
    std::vector<std::vector<std::uint32_t>> pieces_;  ///< of a root
};

/// Which vertex each becomes.
std::vector<std::uint32_t> joined(std::span<const CrackVertex> vertices) {
    float coarsest = 0;
    for (const CrackVertex& vertex : vertices) coarsest = std::max(coarsest, vertex.rounding.step);
    const double diagonal = std::numbers::sqrt3 * (1 + 1e-3);  // and what floats round besides
    const CrackGrid grid(vertices, diagonal * static_cast<double>(coarsest));
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> pairs;
    constexpr std::size_t most_looked_at = 256;  // a piece has 27 points of its grid in the cells around one
    for (std::uint32_t a = 0; a < vertices.size(); ++a)
        grid.around(a, most_looked_at, [&](std::uint32_t b) {
            const Rounding &one = vertices[a].rounding, &other = vertices[b].rounding;
            const double distance = (vertices[a].place - vertices[b].place).norm();
            if (b > a && one.piece != other.piece &&
                distance <= diagonal / 2 * (static_cast<double>(one.step) + static_cast<double>(other.step)))
                pairs.emplace_back(distance, a, b);
        });
    std::sort(pairs.begin(), pairs.end());
    JoinedVertices groups(vertices);
    for (const auto& [distance, a, b] : pairs) groups.join(a, b);
    std::vector<std::uint32_t> becomes(vertices.size());
    for (std::uint32_t v = 0; v < vertices.size(); ++v) becomes[v] = groups.root(v);
    return becomes;
}

}  // namespace

void weld_positions(std::vector<Eigen::Vector3d>& positions, std::vector<std::array<std::uint32_t, 3>>& triangles) {
    const std::size_t slots = std::bit_ceil(2 * positions.size() + 2);  // open addressing, at most half full
    std::vector<std::uint32_t> table(slots, nobody), renamed(positions.size(), nobody);
    std::vector<Eigen::Vector3d> kept;
    const auto rename = [&](std::uint32_t old) {
        if (renamed[old] != nobody) return renamed[old];
        const Eigen::Vector3d p = positions[old] + Eigen::Vector3d::Zero();  // -0 + 0 = 0
        std::size_t slot = hash(p) & (slots - 1);
        while (table[slot] != nobody && kept[table[slot]] != p) slot = (slot + 1) & (slots - 1);
        if (table[slot] == nobody) {
            table[slot] = static_cast<std::uint32_t>(kept.size());
            kept.push_back(p);
        }
        return renamed[old] = table[slot];
    };
    for (auto& triangle : triangles)
        for (std::uint32_t& corner : triangle) corner = rename(corner);
    positions = std::move(kept);
}

void close_cracks(std::vector<Eigen::Vector3d>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                  std::span<const Rounding> roundings) {
    const auto is_rounded = [](const Rounding& r) { return r.step > 0 && std::isfinite(r.step); };
    const auto is_other = [&](const Rounding& r) { return r.piece != roundings.front().piece; };
    constexpr std::size_t most_vertices = std::size_t{1} << 31;
    if (std::ranges::none_of(roundings, is_rounded) || std::ranges::none_of(roundings, is_other) ||
        positions.size() >= most_vertices)
        return;
    std::vector<Eigen::Vector3d> places = positions;
    std::vector<std::array<std::uint32_t, 3>> corners = triangles;
    weld_positions(places, corners);
    const std::vector<std::uint32_t> open = open_vertices(corners, places.size());
    std::vector<std::uint32_t> number(places.size(), nobody);
    std::vector<CrackVertex> vertices;
    for (const std::uint32_t v : open) {
        number[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back({places[v], {}});
    }
    const auto each_open = [&](const auto& visit) {
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c)
                if (const std::uint32_t n = number[corners[t][c]]; n != nobody) visit(triangles[t][c], n);
    };
    each_open([&](std::uint32_t v, std::uint32_t n) {
        if (is_rounded(roundings[v]) || roundings[v].step == 0) vertices[n].rounding = roundings[v];
    });
    const std::vector<std::uint32_t> becomes = joined(vertices);
    each_open([&](std::uint32_t v, std::uint32_t n) {
        if (becomes[n] != n) positions[v] = vertices[becomes[n]].place;
    });
}

}  // namespace voxtone::io
