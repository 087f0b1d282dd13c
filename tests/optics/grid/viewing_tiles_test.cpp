// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "optics/transport/viewing_sequence.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> view{2, 1, 3};

/// A ball of 6 mm of white with 0.3 mm of halftoned colour, whose two halves are of different lightness.
struct Ball {
    std::array<int, 3> size{144, 72, 224};
    ResinSet resins = vero_opaque();
    ResinVolume volume = make(0), other = make(1);
    Scene scene{&volume, &resins, Backing::none, Sides::open};
    Surface surface = find_surface(scene, view, SurfacePart::all);

    [[nodiscard]] ResinVolume make(std::uint64_t kind) const {
        return make_resin_volume(size, j750, [&](int x, int y, int z) {
            const double px = (x + 0.5) * j750[0] - 3.05, py = (y + 0.5) * j750[1] - 3.05,
                         pz = (z + 0.5) * j750[2] - 3.02;
            const double below = 3 - std::hypot(px, py, pz);
            if (below < 0) return 0;
            if (below > 0.3) return 5;
            const double ink = (pz > 0.4 ? 0.6 : 0.1) + 0.1 * std::sin(9 * px) + (kind == 1 && py > 0 ? 0.2 : 0.0);
            voxtone::RandomStream draw(7, static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x));
            return draw.uniform() > ink ? 5 : 1 + static_cast<int>(draw.uniform() * 3);
        });
    }
    [[nodiscard]] static TransportOptions options(std::size_t tile_cells) {
        TransportOptions options;
        options.refinement = Refinement::none;
        options.tile_cells = tile_cells;
        options.first_change = 0;  // alike in all tiles
        return options;
    }
};

struct Difference {
    double mean = 0, most = 0;
};
Difference between(const Appearance& a, const Appearance& b) {
    Difference d;
    for (std::size_t i = 0; i < a.value.size(); ++i) {
        const double far = std::abs(static_cast<double>(a.value[i]) - static_cast<double>(b.value[i]));
        d.mean += far / static_cast<double>(a.value.size());
        d.most = std::max(d.most, far);
    }
    return d;
}

}  // namespace

TEST_CASE("Tiles share out the surface cells and the blocks") {
    const Ball ball;
    const auto tiles = viewing_tiles(ball.surface, ball.size, j750, view, 4000, 3);
    REQUIRE(tiles.size() > 2);
    const BlockLattice lattice(ball.size, view);
    std::vector<int> owners(ball.surface.cells.size(), 0);
    std::size_t blocks = 0;
    for (const ViewingTile& tile : tiles) {
        CHECK(tile.cells.size() <= 4000);
        CHECK(std::includes(tile.near.begin(), tile.near.end(), tile.cells.begin(), tile.cells.end()));
        CHECK(tile.near.size() > tile.cells.size());
        for (const std::uint32_t cell : tile.cells) ++owners[cell];
        std::size_t n = 1;
        for (std::size_t a = 0; a < 3; ++a) n *= static_cast<std::size_t>(tile.end[a] - tile.begin[a]);
        blocks += n;
    }
    CHECK(std::all_of(owners.begin(), owners.end(), [](int n) { return n == 1; }));
    CHECK(blocks == static_cast<std::size_t>(lattice.blocks[0]) * static_cast<std::size_t>(lattice.blocks[1]) *
                        static_cast<std::size_t>(lattice.blocks[2]));
    CHECK(viewing_tiles(ball.surface, ball.size, j750, view, ball.surface.cells.size(), 3).size() == 1);
}

TEST_CASE("A body predicted in tiles looks like the whole body, the more the longer") {
    // Tiles of 2 mm, half as long as light travels in white: far worse than those of 4 cm that large bodies are cut
    // into.
    const Ball ball;
    ViewingSequence whole(ball.scene, ball.surface, Ball::options(ball.surface.cells.size()));
    ViewingSequence parts(ball.scene, ball.surface, Ball::options(4000));
    CHECK(whole.summary().pieces == 1);
    CHECK(parts.summary().pieces > 2);
    Difference first, last;
    for (int k = 0; k < 3; ++k) {
        last = between(whole.next(ball.volume), parts.next(ball.volume));
        if (k == 0) first = last;
    }
    CAPTURE(first.mean, first.most, last.mean, last.most);
    CHECK(first.mean < 0.005);
    CHECK(first.most < 0.02);
    CHECK(last.mean < 0.001);
    CHECK(last.most < 0.004);
    // Other resins: the light of the neighbours is of the print before, at first.
    const Appearance seen = whole.next(ball.other);
    const Difference changed = between(seen, parts.next(ball.other));
    CAPTURE(changed.mean, changed.most);
    CHECK(changed.mean < 0.005);
    CHECK(changed.most < 0.04);
    CHECK(between(whole.next(ball.other), parts.next(ball.other)).mean < 0.4 * changed.mean);
}

TEST_CASE("The gradient comes tile by tile, and is that of the whole body but near the cuts") {
    const Ball ball;
    const auto ask = [&](std::size_t tile_cells, int halo, std::size_t threads, std::size_t& boxes) {
        const voxtone::ThreadLimit limit(threads);
        TransportOptions options = Ball::options(tile_cells);
        options.tile_halo = halo;
        ViewingSequence sequence(ball.scene, ball.surface, options);
        std::vector<float> out(static_cast<std::size_t>(ball.size[0] * ball.size[1] * ball.size[2]), 0.0f);
        for (int k = 0; k < 2; ++k) {
            Appearance seen = sequence.next(ball.volume);
            for (float& v : seen.value) v -= 0.5f;
            boxes = 0;
            REQUIRE(sequence.gradient(seen.value, [&](const ResinGradient& gradient, const VoxelBox& box) {
                ++boxes;
                std::size_t i = 0;
                for (int z = 0; z < ball.size[2]; ++z)
                    for (int y = 0; y < ball.size[1]; ++y)
                        for (int x = 0; x < ball.size[0]; ++x, ++i)
                            if (box.holds({x, y, z})) out[i] = gradient.at({x, y, z}, 3) - gradient.at({x, y, z}, 4);
            }));
        }
        return out;
    };
    std::size_t one = 0, several = 0;
    const std::vector<float> whole = ask(ball.surface.cells.size(), 3, 2, one);
    CHECK(one == 1);
    const auto near_whole = [&](const std::vector<float>& parts) {
        double ab = 0, aa = 0, bb = 0;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            ab += static_cast<double>(whole[i]) * static_cast<double>(parts[i]);
            aa += static_cast<double>(whole[i]) * static_cast<double>(whole[i]);
            bb += static_cast<double>(parts[i]) * static_cast<double>(parts[i]);
        }
        return std::pair(ab / std::sqrt(aa * bb), ab / aa);
    };
    // Cuts are mirrors to an adjoint, and here they lie 2 mm apart instead of 4 cm: the farther they are from a tile's
    // own cells, the nearer it comes (0.981 and 1.11 at a halo of 0.35 mm, 0.996 and 1.04 at that of 1 mm).
    const std::vector<float> parts = ask(4000, 3, 2, several);
    CHECK(several > 2);
    const auto [cosine, scale] = near_whole(parts);
    const auto [thin_cosine, thin_scale] = near_whole(ask(4000, 1, 2, several));
    CAPTURE(cosine, scale, thin_cosine, thin_scale);
    CHECK(cosine > 0.995);
    CHECK(scale == Approx(1).epsilon(0.05));
    CHECK(1 - cosine < 0.3 * (1 - thin_cosine));
    CHECK(std::abs(1 - scale) < 0.5 * std::abs(1 - thin_scale));
    CHECK(ask(4000, 3, 1, several) == parts);
}

TEST_CASE("Grids of tiles that are kept change no bit, and memory decides how many there are") {
    const Ball ball;
    const auto look = [&](std::size_t memory_bytes, TransportSummary& summary) {
        TransportOptions options = Ball::options(4000);
        options.memory_bytes = memory_bytes;
        ViewingSequence sequence(ball.scene, ball.surface, options);
        std::vector<float> out;
        for (const ResinVolume* const volume : {&ball.volume, &ball.other}) {
            Appearance seen = sequence.next(*volume);
            out.insert(out.end(), seen.value.begin(), seen.value.end());
            for (float& v : seen.value) v -= 0.5f;
            REQUIRE(sequence.gradient(seen.value, [&](const ResinGradient& gradient, const VoxelBox& box) {
                for (int z = box.begin[2]; z < box.end[2]; z += 3)
                    out.push_back(gradient.at({ball.size[0] / 2, ball.size[1] / 2, z}, 3));
            }));
        }
        summary = sequence.summary();
        return out;
    };
    TransportSummary all, some;
    const std::vector<float> kept = look(0, all);
    REQUIRE(all.pieces > 2);
    // Fields and the equations of one tile are needed in any case.
    const std::vector<float> anew = look(all.memory_bytes * 8 / 10, some);
    CHECK(kept == anew);
    CAPTURE(all.memory_bytes, some.memory_bytes);
    CHECK(some.memory_bytes < all.memory_bytes);
}

TEST_CASE("What is predicted does not depend on the memory that there is: it fits, or it is refused") {
    const Ball ball;
    const auto sequence_in = [&](std::size_t memory_bytes) {
        TransportOptions options = Ball::options(ball.surface.cells.size() / 3);
        options.memory_bytes = memory_bytes;
        options.tile_halo = 1;
        return ViewingSequence::within_memory(ball.scene, ball.surface, options);
    };
    const auto free = sequence_in(0);
    const Appearance seen = free->next(ball.volume);
    CHECK(free->summary().pieces > 1);
    const std::size_t taken = free->summary().memory_bytes;
    const auto tight = sequence_in(taken * 2);
    CHECK(tight->next(ball.volume).value == seen.value);
    CHECK(tight->summary().pieces == free->summary().pieces);
    CHECK_THROWS_AS(sequence_in(taken / 4), voxtone::ResourceError);
}
