// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/solid.h"

#include <algorithm>
#include <cmath>

#include "voxtone/base/contracts.h"

namespace voxtone::slicer {

namespace {

__extension__ typedef __int128 Int128;

constexpr int bucket_layers = 16;
constexpr int max_coordinate_bits = 30;  // differences below 2^30, so that edge functions stay below 2^61

// Smallest integer >= n / d, for d > 0.
template <class Int>
constexpr Int ceil_div(Int n, Int d) {
    const Int q = n / d;
    return q * d < n ? q + 1 : q;
}

}  // namespace

struct Solid::Crossing {
    std::uint32_t row;  // (k - k_begin) * rows + j
    std::int32_t i;     // first voxel behind the crossing, clamped to [0, size[0]]
    std::int32_t step;  // change of the winding number
};

Solid::Solid(const SolidMesh& mesh, const VoxelGrid& grid) : grid_(grid), triangles_(mesh.triangles) {
    for (int a = 0; a < 3; ++a) VOXTONE_EXPECT(grid.size[a] > 0 && grid.pitch_mm[a] > 0);

    // In voxels, so that centres are integers.
    std::vector<Eigen::Vector3d> scaled;
    scaled.reserve(mesh.positions_mm.size());
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    Eigen::Vector3d high(grid.size[0], grid.size[1], grid.size[2]);
    for (const Eigen::Vector3d& p : mesh.positions_mm) {
        scaled.emplace_back((p - grid.origin_mm).cwiseQuotient(grid.pitch_mm).array() - 0.5);
        low = low.cwiseMin(scaled.back());
        high = high.cwiseMax(scaled.back());
    }
    const double extent = (high - low).maxCoeff() + 2;
    VOXTONE_EXPECT(extent < 1 << 22);
    while (std::ldexp(extent, fraction_bits_) > std::ldexp(1.0, max_coordinate_bits)) --fraction_bits_;

    vertices_.reserve(scaled.size());
    for (const Eigen::Vector3d& p : scaled) {
        Vertex v;
        for (int a = 0; a < 3; ++a) v[a] = static_cast<std::int32_t>(std::llround(std::ldexp(p[a], fraction_bits_)));
        vertices_.push_back(v);
    }

    const int buckets = (grid.size[2] + bucket_layers - 1) / bucket_layers;
    const auto buckets_of = [&](const std::array<std::uint32_t, 3>& t) {
        const auto [z0, z1] = std::minmax({vertices_[t[0]][2], vertices_[t[1]][2], vertices_[t[2]][2]});
        const std::int64_t k0 = std::max<std::int64_t>(ceil_div<std::int64_t>(z0, std::int64_t{1} << fraction_bits_), 0);
        const std::int64_t k1 = std::min<std::int64_t>(z1 >> fraction_bits_, grid.size[2] - 1);
        return k0 > k1 ? std::pair{0, 0} : std::pair{int(k0 / bucket_layers), int(k1 / bucket_layers) + 1};
    };
    bucket_begin_.assign(std::size_t(buckets) + 1, 0);
    for (const auto& t : triangles_) {
        const auto [first, last] = buckets_of(t);
        for (int b = first; b < last; ++b) ++bucket_begin_[std::size_t(b) + 1];
    }
    for (int b = 0; b < buckets; ++b) bucket_begin_[std::size_t(b) + 1] += bucket_begin_[std::size_t(b)];
    bucket_triangles_.resize(bucket_begin_.back());
    std::vector<std::size_t> next(bucket_begin_.begin(), bucket_begin_.end() - 1);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const auto [first, last] = buckets_of(triangles_[t]);
        for (int b = first; b < last; ++b) bucket_triangles_[next[std::size_t(b)]++] = static_cast<std::uint32_t>(t);
    }
}

double Solid::winding_volume_mm3() const {
    Int128 six_volumes = 0;
    for (const auto& t : triangles_) {
        const Vertex &a = vertices_[t[0]], &b = vertices_[t[1]], &c = vertices_[t[2]];
        six_volumes += Int128(a[0]) * (std::int64_t{b[1]} * c[2] - std::int64_t{b[2]} * c[1]) +
                       Int128(a[1]) * (std::int64_t{b[2]} * c[0] - std::int64_t{b[0]} * c[2]) +
                       Int128(a[2]) * (std::int64_t{b[0]} * c[1] - std::int64_t{b[1]} * c[0]);
    }
    return std::ldexp(static_cast<double>(six_volumes), -3 * fraction_bits_) / 6 * grid_.voxel_volume_mm3();
}

void Solid::rasterise(std::uint32_t triangle, int k_begin, int k_end, std::vector<Crossing>& out) const {
    const int f = fraction_bits_;
    const std::int64_t one = std::int64_t{1} << f;
    std::array<Vertex, 3> v;
    for (int c = 0; c < 3; ++c) v[c] = vertices_[triangles_[triangle][c]];

    const auto difference = [](std::int32_t a, std::int32_t b) { return std::int64_t{a} - b; };
    // Twice the area on the y-z plane; positive where the surface faces +x, so that a ray along +x leaves there.
    std::int64_t area = difference(v[1][1], v[0][1]) * difference(v[2][2], v[0][2]) -
                        difference(v[1][2], v[0][2]) * difference(v[2][1], v[0][1]);
    if (area == 0) return;
    const std::int32_t step = area > 0 ? -1 : 1;
    if (area < 0) {
        std::swap(v[1], v[2]);
        area = -area;
    }
    const auto [z0, z1] = std::minmax({v[0][2], v[1][2], v[2][2]});
    const int k_first = int(std::max<std::int64_t>(ceil_div<std::int64_t>(z0, one), k_begin));
    const int k_last = int(std::min<std::int64_t>(z1 >> f, k_end - 1));
    const std::int64_t dx1 = difference(v[1][0], v[0][0]), dx2 = difference(v[2][0], v[0][0]);

    for (int k = k_first; k <= k_last; ++k) {
        const std::int64_t z = std::int64_t{k} << f;
        // The inside of edge p -> q is e(y, z) = dy (z - p_z) - dz (y - p_y) > 0, or = 0 where the infinitesimal step
        // makes it positive: dz < 0, or dz = 0 and dy > 0.
        std::int64_t j_first = 0, j_end = grid_.size[1];
        for (int c = 0; c < 3; ++c) {
            const Vertex &p = v[c], &q = v[(c + 1) % 3];
            const std::int64_t dy = difference(q[1], p[1]), dz = difference(q[2], p[2]);
            const std::int64_t along = dy * (z - p[2]);
            if (dz == 0) {
                if (along < 0 || (along == 0 && dy <= 0)) j_end = 0;
            } else if (dz < 0) {
                j_first = std::max(j_first, ceil_div(-(along + dz * p[1]), -dz * one));
            } else {
                j_end = std::min(j_end, ceil_div(along + dz * p[1], dz * one));
            }
        }
        if (j_first >= j_end) continue;

        // Barycentric weights of v1 and v2 times `area` are the edge functions of the edges opposite to them.
        const auto edge = [&](const Vertex& p, const Vertex& q) {
            return difference(q[1], p[1]) * (z - p[2]) - difference(q[2], p[2]) * ((j_first << f) - p[1]);
        };
        std::int64_t w1 = edge(v[2], v[0]), w2 = edge(v[0], v[1]);
        const std::int64_t w1_step = -(difference(v[0][2], v[2][2]) * one), w2_step = -(difference(v[1][2], v[0][2]) * one);
        for (std::int64_t j = j_first; j < j_end; ++j, w1 += w1_step, w2 += w2_step) {
            std::int64_t i;
            const double x = std::ldexp(double(v[0][0]) + (double(w1) * double(dx1) + double(w2) * double(dx2)) / double(area), -f);
            const double up = std::ceil(x);
            // The double is off by less than 1e-9 voxel; nearer than that to a centre the integers decide.
            if (up - x > 1e-8 && x - (up - 1) > 1e-8)
                i = static_cast<std::int64_t>(up);
            else
                i = static_cast<std::int64_t>(ceil_div<Int128>(Int128(v[0][0]) * area + Int128(w1) * dx1 + Int128(w2) * dx2, Int128(area) << f));
            i = std::clamp<std::int64_t>(i, 0, grid_.size[0]);
            out.push_back({std::uint32_t((k - k_begin) * std::int64_t{grid_.size[1]} + j), std::int32_t(i), step});
        }
    }
}

void Solid::slab(int k_begin, int k_end, SpanSlab& out) const {
    VOXTONE_EXPECT(0 <= k_begin && k_begin <= k_end && k_end <= grid_.size[2]);
    const std::size_t rows = std::size_t(k_end - k_begin) * std::size_t(grid_.size[1]);
    VOXTONE_EXPECT(rows < UINT32_MAX);

    std::vector<Crossing> crossings;
    for (int k = k_begin; k < k_end;) {
        const int bucket = k / bucket_layers;
        const int end = std::min(k_end, (bucket + 1) * bucket_layers);
        for (std::size_t n = bucket_begin_[std::size_t(bucket)]; n < bucket_begin_[std::size_t(bucket) + 1]; ++n) {
            const std::size_t first = crossings.size();
            rasterise(bucket_triangles_[n], k, end, crossings);
            const std::uint32_t offset = std::uint32_t(k - k_begin) * std::uint32_t(grid_.size[1]);
            for (std::size_t c = first; c < crossings.size(); ++c) crossings[c].row += offset;
        }
        k = end;
    }

    // By row: counting sort. Within a row only the sums per voxel matter, so the order of equals does not.
    struct Step {
        std::int32_t i, step;
    };
    std::vector<std::uint32_t> begin(rows + 1, 0);
    for (const Crossing& c : crossings) ++begin[c.row + 1];
    for (std::size_t r = 0; r < rows; ++r) begin[r + 1] += begin[r];
    std::vector<Step> steps(crossings.size());
    {
        std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
        for (const Crossing& c : crossings) steps[next[c.row]++] = {c.i, c.step};
    }

    out.reset(k_begin, k_end, grid_.size[1]);
    for (std::size_t r = 0; r < rows; ++r) {
        const auto first = steps.begin() + begin[r], last = steps.begin() + begin[r + 1];
        std::sort(first, last, [](const Step& a, const Step& b) { return a.i < b.i; });
        std::int32_t winding = 0, span_begin = 0;
        for (auto s = first; s != last;) {
            const std::int32_t i = s->i, before = winding;
            for (; s != last && s->i == i; ++s) winding += s->step;
            if (before == 0 && winding != 0) span_begin = i;
            if (before != 0 && winding == 0) out.push(span_begin, i);
        }
        VOXTONE_EXPECT(winding == 0);  // otherwise the surface is not a closed chain
        out.end_row();
    }
}

}  // namespace voxtone::slicer
