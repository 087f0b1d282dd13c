// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/contracts.h"
#include "slicer/solid/line_crossings.h"

// Own code, not OpenVDB's meshToVolume: that gives narrow-band distances in floats, cracks and doubled sheets decided
// by its flood fill, where a print needs each voxel's winding number, exactly and alike on every machine, one slab at a
// time, of bodies of 1e9 voxels.
namespace voxtone::slicer {

Solid::Solid(const SolidMesh& mesh, const VoxelGrid& grid, Relief relief)
    : grid_(grid), mesh_(mesh, grid), relief_(std::move(relief)) {}

double Solid::winding_volume_mm3() const {
    __extension__ typedef __int128 Int128;
    Int128 six_volumes = 0;
    for (const auto& t : mesh_.triangles) {
        const FixedMesh::Vertex &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
        six_volumes += Int128(a[0]) * (std::int64_t{b[1]} * c[2] - std::int64_t{b[2]} * c[1]) +
                       Int128(a[1]) * (std::int64_t{b[2]} * c[0] - std::int64_t{b[0]} * c[2]) +
                       Int128(a[2]) * (std::int64_t{b[0]} * c[1] - std::int64_t{b[1]} * c[0]);
    }
    return std::ldexp(static_cast<double>(six_volumes), -3 * mesh_.fraction_bits) / 6 * grid_.voxel_volume_mm3();
}

void Solid::slab(int k_begin, int k_end, SpanSlab& out) const {
    VOXTONE_EXPECT(0 <= k_begin && k_begin <= k_end && k_end <= grid_.size[2]);
    const std::size_t rows = std::size_t(k_end - k_begin) * std::size_t(grid_.size[1]);
    VOXTONE_EXPECT(rows < UINT32_MAX);

    struct Step {
        std::int32_t i;     // first voxel behind the crossing, clamped to [0, size[0]]
        std::int32_t step;  // change of the winding number
    };
    std::vector<std::pair<std::uint32_t, Step>> crossings;  // by row (k - k_begin) * size[1] + j
    mesh_.for_each_triangle(k_begin, k_end, [&](std::uint32_t t, int first, int last) {
        const auto& [a, b, c] = mesh_.triangles[t];
        for_each_line_crossing(
            {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]}, mesh_.fraction_bits,
            {0, grid_.size[1], first, last},
            [&](std::int64_t j, std::int64_t k, std::int64_t i, double, std::int32_t step) {
                i = std::clamp<std::int64_t>(i, 0, grid_.size[0]);
                crossings.push_back({std::uint32_t((k - k_begin) * grid_.size[1] + j), {std::int32_t(i), step}});
            });
    });

    // By row: counting sort. Within a row only the sums per voxel matter, so the order of equals does not.
    std::vector<std::uint32_t> begin(rows + 1, 0);
    for (const auto& [row, step] : crossings) ++begin[row + 1];
    for (std::size_t r = 0; r < rows; ++r) begin[r + 1] += begin[r];
    std::vector<Step> steps(crossings.size());
    {
        std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
        for (const auto& [row, step] : crossings) steps[next[row]++] = step;
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
    relief_.apply(out);
}

}  // namespace voxtone::slicer
