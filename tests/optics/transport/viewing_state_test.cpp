// SPDX-License-Identifier: GPL-3.0-or-later
//
// A sequence of predictions that is interrupted and goes on elsewhere says the same as one that is not, bit by bit.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "optics/transport/viewing_sequence.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

/// A ball of 3 mm of white with a halftoned shell, which is deeper in one half of some prints.
struct SmallBall {
    std::array<int, 3> size{72, 36, 112};
    ResinSet resins = vero_opaque();
    std::vector<ResinVolume> prints{make(0), make(1), make(1), make(0), make(2)};
    Scene scene{&prints[0], &resins, Backing::none, Sides::open};
    Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);

    [[nodiscard]] ResinVolume make(std::uint64_t kind) const {
        return make_resin_volume(size, j750, [&](int x, int y, int z) {
            const double px = (x + 0.5) * j750[0] - 1.52, py = (y + 0.5) * j750[1] - 1.52,
                         pz = (z + 0.5) * j750[2] - 1.51;
            const double below = 1.5 - std::hypot(px, py, pz);
            if (below < 0) return 0;
            if (below > (kind == 1 && px > 0 ? 0.9 : 0.2)) return 5;
            voxtone::RandomStream draw(kind, static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x));
            return draw.uniform() > 0.4 ? 5 : 1 + static_cast<int>(draw.uniform() * 3);
        });
    }
    bool deep_in_nodes = false;
    [[nodiscard]] TransportOptions options(std::size_t tile_cells) const {
        TransportOptions options;
        options.refinement = Refinement::none;
        options.tile_cells = tile_cells;
        options.tile_halo = 1;
        options.colour_mm = 0.2;
        options.deep_colour_in_nodes = deep_in_nodes;
        return options;
    }
    [[nodiscard]] ViewingSequence sequence(std::size_t tile_cells) const {
        return {scene, surface, options(tile_cells)};
    }
    /// What a sequence says of a print, and of its gradient there.
    [[nodiscard]] std::vector<float> look(ViewingSequence& sequence, std::size_t print) const {
        Appearance seen = sequence.next(prints[print]);
        std::vector<float> out = seen.value;
        for (float& v : seen.value) v -= 0.5f;
        const bool has_gradient =
            sequence.gradient(seen.value, [&](const ResinGradient& gradient, const VoxelBox& box) {
                for (int z = box.begin[2]; z < box.end[2]; z += 3)
                    for (int x = box.begin[0]; x < box.end[0]; x += 5)
                        out.push_back(gradient.at({x, size[1] / 2, z}, 3));
            });
        REQUIRE(has_gradient);
        return out;
    }
};

std::vector<std::byte> state_of(const ViewingSequence& sequence) {
    std::vector<std::byte> state;
    sequence.write_state(
        [&](std::span<const std::byte> bytes) { state.insert(state.end(), bytes.begin(), bytes.end()); });
    return state;
}

/// A disk of so many bytes, in memory.
class SmallDisk final : public ScratchSpace {
public:
    SmallDisk(std::vector<std::byte>& bytes, std::size_t room) : bytes_(bytes), room_(room) {}
    void write(std::uint64_t at, std::span<const std::byte> from) override {
        if (at + from.size() > room_) throw voxtone::TryAgain("the disk is full");
        bytes_.resize(std::max<std::size_t>(bytes_.size(), at + from.size()));
        std::ranges::copy(from, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    void read(std::uint64_t at, std::span<std::byte> to) const override {
        REQUIRE(at + to.size() <= bytes_.size());
        std::ranges::copy(std::span(bytes_).subspan(at, to.size()), to.begin());
    }

private:
    std::vector<std::byte>& bytes_;
    std::size_t room_;
};

}  // namespace

TEST_CASE("Tiles that do not fit into memory wait elsewhere, and say the same", "[slow]") {
    const SmallBall ball;
    TransportOptions options = ball.options(1500);
    ViewingSequence free{ball.scene, ball.surface, options};
    std::vector<std::vector<float>> said;
    constexpr std::size_t prints = 3;  // with colour deeper than before, and less
    for (std::size_t print = 0; print < prints; ++print) said.push_back(ball.look(free, print));
    REQUIRE(free.summary().pieces > 2);

    // As little as suffices, to a tenth.
    std::vector<std::byte> disk;
    const auto sequence = [&](std::size_t room) {
        options.scratch = [&disk, room] { return std::make_unique<SmallDisk>(disk, room); };
        return ViewingSequence::within_memory(ball.scene, ball.surface, options);
    };
    constexpr std::size_t large = 1'000'000'000;
    for (options.memory_bytes = free.summary().memory_bytes / 10;; options.memory_bytes += options.memory_bytes / 10)
        try {
            const auto narrow = sequence(large);
            for (const std::size_t print : {0u, 1u}) (void)ball.look(*narrow, print);
            break;
        } catch (const voxtone::ResourceError&) {
        }
    CAPTURE(options.memory_bytes, free.summary().memory_bytes);
    CHECK(options.memory_bytes < free.summary().memory_bytes * 2 / 3);
    disk.clear();
    const auto tight = sequence(large);
    for (std::size_t print = 0; print < prints; ++print) CHECK(ball.look(*tight, print) == said[print]);
    CHECK(disk.size() > free.summary().memory_bytes / 4);
    CHECK(state_of(*tight) == state_of(free));

    // Saved here, it goes on there.
    const auto resumed = sequence(large);
    ViewingSequence begun{ball.scene, ball.surface, ball.options(1500)};
    (void)ball.look(begun, 0);
    REQUIRE(resumed->read_state(state_of(begun)));
    CHECK(ball.look(*resumed, 1) == said[1]);

    CHECK_THROWS_AS(ball.look(*sequence(disk.size() / 2), 0), voxtone::TryAgain);
    options.scratch = {};
    CHECK_THROWS_AS((void)ViewingSequence::within_memory(ball.scene, ball.surface, options), voxtone::ResourceError);
}

TEST_CASE("A sequence that goes on from a saved state says the same, whole and in tiles", "[slow]") {
    const bool deep_in_nodes = GENERATE(false, true);
    SmallBall ball;
    ball.deep_in_nodes = deep_in_nodes;
    for (const std::size_t tile_cells : {ball.surface.cells.size(), std::size_t{1500}}) {
        ViewingSequence whole = ball.sequence(tile_cells);
        CAPTURE(deep_in_nodes, tile_cells, whole.summary().pieces);
        CHECK((whole.summary().pieces > 1) == (tile_cells == 1500));
        std::vector<std::vector<float>> said;
        std::vector<std::vector<std::byte>> states;
        for (std::size_t print = 0; print < ball.prints.size(); ++print) {
            said.push_back(ball.look(whole, print));
            states.push_back(state_of(whole));
        }
        for (std::size_t stop = 0; stop + 1 < ball.prints.size(); ++stop) {
            ViewingSequence resumed = ball.sequence(tile_cells);
            REQUIRE(resumed.read_state(states[stop]));
            CHECK(state_of(resumed) == states[stop]);
            for (std::size_t print = stop + 1; print < ball.prints.size(); ++print) {
                CAPTURE(stop, print);
                CHECK(ball.look(resumed, print) == said[print]);
            }
        }
        // The light of the print before matters: without it the same print is said to look otherwise.
        ViewingSequence anew = ball.sequence(tile_cells);
        CHECK(ball.look(anew, 2) != said[2]);
    }
}

TEST_CASE("What is no state of a sequence is refused") {
    const SmallBall ball;
    ViewingSequence one = ball.sequence(ball.surface.cells.size());
    (void)one.next(ball.prints[0]);
    const std::vector<std::byte> state = state_of(one);
    for (const std::size_t size : {std::size_t{0}, std::size_t{7}, state.size() / 2, state.size() - 1})
        CHECK_FALSE(ball.sequence(ball.surface.cells.size()).read_state(std::span(state).first(size)));
    std::vector<std::byte> longer = state;
    longer.push_back({});
    CHECK_FALSE(ball.sequence(ball.surface.cells.size()).read_state(longer));
}

TEST_CASE("A sequence goes on with the tiles of the state, whatever its own were", "[slow]") {
    const SmallBall ball;
    ViewingSequence in_tiles = ball.sequence(1500), resumed = ball.sequence(ball.surface.cells.size());
    (void)ball.look(in_tiles, 0);
    REQUIRE(resumed.read_state(state_of(in_tiles)));
    CHECK(resumed.summary().pieces == in_tiles.summary().pieces);
    CHECK(ball.look(resumed, 1) == ball.look(in_tiles, 1));
}
