// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/relief.h"

#include <array>

#include <catch2/catch.hpp>

using namespace voxtone::slicer;

namespace {

constexpr int layers_begin = 2, layers_end = 5, rows = 3, width = 12;

/// Row 1 of layer 3 has these spans, all others [4, 6).
SpanSlab body(const std::vector<Span>& spans) {
    SpanSlab slab;
    slab.reset(layers_begin, layers_end, rows);
    for (int k = layers_begin; k < layers_end; ++k)
        for (int j = 0; j < rows; ++j) {
            if (k == 3 && j == 1)
                for (const Span& span : spans) slab.push(span.begin, span.end);
            else
                slab.push(4, 6);
            slab.end_row();
        }
    return slab;
}

std::vector<Span> spans_of(const SpanSlab& slab, int j, int k) {
    const auto row = slab.row(j, k);
    return {row.begin(), row.end()};
}

}  // namespace

TEST_CASE("A relief adds voxels to a row and takes them away, the later of two that overlap") {
    const std::vector<Span> two{{2, 5}, {7, 10}};
    const std::vector<std::pair<std::vector<ReliefRun>, std::vector<Span>>> cases{
        {{{3, 1, 5, 7, true}}, {{2, 10}}},                               // fills the gap
        {{{3, 1, 0, 1, true}}, {{0, 1}, {2, 5}, {7, 10}}},               // apart
        {{{3, 1, 0, 2, true}}, {{0, 5}, {7, 10}}},                       // touches
        {{{3, 1, 3, 8, false}}, {{2, 3}, {8, 10}}},                      // of both
        {{{3, 1, 3, 4, false}}, {{2, 3}, {4, 5}, {7, 10}}},              // within one
        {{{3, 1, 2, 5, false}}, {{7, 10}}},                              // one as a whole
        {{{3, 1, 0, 12, false}}, {}},                                    // all
        {{{3, 1, 5, 7, false}}, {{2, 5}, {7, 10}}},                      // of nothing
        {{{3, 1, 4, 8, true}, {3, 1, 5, 6, false}}, {{2, 5}, {6, 10}}},  // in turn
        {{{3, 1, 5, 6, false}, {3, 1, 4, 8, true}}, {{2, 10}}},
    };
    for (const auto& [runs, wanted] : cases) {
        SpanSlab slab = body(two);
        Relief(runs).apply(slab);
        CHECK(spans_of(slab, 1, 3) == wanted);
        // And no other row.
        SpanSlab others = body(wanted);
        CHECK(slab == others);
    }
}

TEST_CASE("A relief's runs find their rows in whatever order they were given, and those of other slabs stay out") {
    SpanSlab slab = body({{4, 6}});
    Relief({{9, 0, 0, 12, true}, {4, 2, 0, 1, true}, {1, 0, 0, 12, false}, {2, 0, 6, 8, true}, {4, 2, 8, 9, true}})
        .apply(slab);
    CHECK(spans_of(slab, 2, 4) == std::vector<Span>{{0, 1}, {4, 6}, {8, 9}});
    CHECK(spans_of(slab, 0, 2) == std::vector<Span>{{4, 8}});
    CHECK(slab.voxels_of_layer(3) == 6);
    for (const Relief& none : {Relief(), Relief({{1, 0, 0, 12, false}}), Relief({{5, 0, 0, 12, false}})}) {
        SpanSlab same = body({{4, 6}});
        none.apply(same);
        CHECK(same == body({{4, 6}}));
    }
    CHECK(Relief().empty());
    CHECK_FALSE(Relief({{1, 0, 0, 12, false}}).empty());
}

TEST_CASE("Depths below a relief are those of the body, moved or turned, and never below nothing") {
    const Relief relief({},
                        {{3, 1, 2, 5, 1, 0.5f}, {3, 1, 7, 9, -1, 1.0f}, {3, 1, 4, 5, 1, 0.25f}, {3, 2, 0, 12, 1, 9}});
    std::array<float, width> depth;
    depth.fill(0.75f);
    relief.apply(0, 1, 3, depth);
    CHECK(depth ==
          std::array<float, width>{0.75f, 0.75f, 1.25f, 1.25f, 1.5f, 0.75f, 0.75f, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f});
    // A part of the row, from voxel 3 on.
    std::array<float, 5> part;
    part.fill(2);
    relief.apply(3, 1, 3, part);
    CHECK(part == std::array<float, 5>{2.5f, 2.75f, 2, 2, 0});
    std::array<float, 2> other{1, 1};
    relief.apply(2, 1, 4, other);
    CHECK(other == std::array<float, 2>{1, 1});
}
