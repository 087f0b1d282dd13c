// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/refinement.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "optics/grid/homogenisation.h"
#include "optics/grid/lattice.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/transport/transport.h"
#include "optics/transport/transport_sweep.h"
#include "optics/transport/viewing_sequence.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> viewing_cell{2, 1, 3};

Material halftone(int x, int y, int z, double coverage) {
    RandomStream random(3, static_cast<std::uint64_t>((z * 997 + y) * 991 + x));
    return static_cast<Material>(random.uniform() < coverage ? 1 + random.bits() % 4 : 5);
}

/// White under a halftone of 0.3 mm, cut by a slanting plane and by the sphere around it.
ResinVolume cut_sphere(double radius_mm, double coverage) {
    std::array<int, 3> n{};
    for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<int>(2 * radius_mm / j750[a]) + 3;
    return make_resin_volume(n, j750, [&](int x, int y, int z) -> int {
        const double px = (x - 0.5 * n[0]) * j750[0], py = (y - 0.5 * n[1]) * j750[1], pz = (z - 0.5 * n[2]) * j750[2];
        const double r = std::hypot(px, py, pz);
        if (r > radius_mm || px + 0.5 * py + 0.8 * pz > 0.6 * radius_mm) return air;
        return radius_mm - r > 0.3 ? 5 : halftone(x, y, z, coverage);
    });
}

/// White with a halftone on top that is black on the left.
ResinVolume slab(int across, double coverage) {
    return make_resin_volume({across, across / 2, 48}, j750, [&](int x, int y, int z) -> int {
        if (z < 36) return 5;
        return x < across / 2 - 3 ? 4 : halftone(x, y, z, coverage);
    });
}

TransportOptions refined(Refinement where, int sweeps = 3) {
    TransportOptions options;
    options.refinement = where;
    options.sweeps = sweeps;
    return options;
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
    REQUIRE(a.size() == b.size());
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - double(b[i]), 2) / double(a.size());
    return std::sqrt(sum);
}

/// Volume of each resin in the cells and in the parts of the fine blocks, mm^3.
std::array<std::vector<double>, 2> held(const ViewingGrid& viewing) {
    const auto edge = viewing.edge_mm();
    const double cell = edge[0] * edge[1] * edge[2], part = cell / double(viewing.fine.parts());
    std::array<std::vector<double>, 2> sums{std::vector<double>(6), std::vector<double>(6)};
    for (std::size_t t = 0; t < viewing.fine.first.size(); ++t) {
        if (viewing.fine.first[t] == not_fine) continue;
        const auto add = [&](const Mixture& mixture, double volume, std::vector<double>& to) {
            for (const auto& one : mixture.holds) to[one.material] += volume * double(one.share);
        };
        for (std::size_t k = 0; k < 64; ++k) add(viewing.mixtures[viewing.medium[64 * t + k]], cell, sums[0]);
        for (std::size_t i = 0; i < 64 * viewing.fine.parts(); ++i)
            add(viewing.fine.contents[viewing.fine.medium[viewing.fine.first[t] + i]], part, sums[1]);
    }
    return sums;
}

}  // namespace

TEST_CASE("Parts of cells are voxels, and pieces of those that are longer than light can be followed in") {
    CHECK(parts_of_cell({2, 1, 3}, {0.0423, 0.0847, 0.027}) == std::array{2, 2, 3});
    CHECK(parts_of_cell({1, 1, 1}, {0.1, 0.2, 0.04}) == std::array{3, 4, 1});
}

TEST_CASE("Blocks are cut where resins meet, and hold in their parts what they held") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = cut_sphere(1.2, 0.6);
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const BlockLattice lattice(volume.size(), viewing_cell);
    ViewingGrid grid = make_viewing_grid(scene, viewing_cell, {0.8}, {}, {{}, lattice.blocks, {}});
    refine(grid, volume, blocks_to_refine(grid, volume, Refinement::none), viewing_cell);
    CHECK_FALSE(grid.fine.any());
    const auto fine_blocks = [&](Refinement which) {
        refine(grid, volume, blocks_to_refine(grid, volume, which), parts_of_cell(viewing_cell, j750));
        return std::count_if(grid.fine.first.begin(), grid.fine.first.end(),
                             [](std::uint32_t first) { return first != not_fine; });
    };
    const auto all = fine_blocks(Refinement::all), contrast = fine_blocks(Refinement::contrast);
    CHECK(all == std::ptrdiff_t(grid.transport_blocks.size()));
    CHECK(contrast < all);
    CHECK(contrast > all / 2);
    const auto [cells, parts] = held(grid);
    for (std::size_t m = 1; m < cells.size(); ++m) {
        INFO("resin " << m);
        // Five voxels of a column over three parts: amounts are kept in twelfths.
        CHECK(parts[m] == Approx(cells[m]).epsilon(0.005));
    }
    CHECK(cells[5] > 0.1);
    // More contents than numbers: whole resins have one, and stand for what has none.
    CHECK(grid.fine.contents.size() > 30);
    refine(grid, volume, blocks_to_refine(grid, volume, Refinement::contrast), parts_of_cell(viewing_cell, j750),
           nullptr, 10);
    CHECK(grid.fine.contents.size() == 10);
    CHECK(*std::max_element(grid.fine.medium.begin(), grid.fine.medium.end()) < 10);
}

TEST_CASE("Each part of a full cell holds the resin of the voxel that is there") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume =
        make_resin_volume({24, 12, 36}, j750, [](int x, int y, int z) { return halftone(x, y, z, 0.7); });
    for (const Backing backing : {Backing::black, Backing::none}) {
        // A slab that is lit from above, and a box that is lit from all sides: columns run along every axis.
        const Scene scene{&volume, &set, backing, backing == Backing::black ? Sides::mirrored : Sides::open};
        ViewingGrid grid = make_viewing_grid(scene, viewing_cell, {0.8}, {},
                                             {{}, BlockLattice(volume.size(), viewing_cell).blocks, {}});
        std::vector<std::uint8_t> wanted;
        REQUIRE(homogenise(grid, volume, wanted));
        for (const std::array<int, 3>& split : {viewing_cell, std::array{2, 2, 3}}) {
            refine(grid, volume, blocks_to_refine(grid, volume, Refinement::all), split);
            std::size_t other = 0, parts = 0;
            std::array<std::size_t, 6> towards{};
            for (std::size_t t = 0; t < grid.fine.first.size(); ++t) {
                if (grid.fine.first[t] == not_fine) continue;
                ++towards[grid.towards[t]];
                const auto corner = grid.corner_of(grid.transport_block(t).at);
                for_each({4, 4, 4}, [&](const Place& cell) {
                    for_each(split, [&](const Place& part) {
                        Place voxel{};
                        for (std::size_t a = 0; a < 3; ++a)
                            voxel[a] = corner[a] + cell[a] * viewing_cell[a] + part[a] * viewing_cell[a] / split[a];
                        const auto& holds =
                            grid.fine.contents[grid.fine.medium[grid.fine.first[t] + grid.fine.part(cell, part)]].holds;
                        other += holds.size() != 1 || holds[0].material != volume.at(voxel[0], voxel[1], voxel[2]) ||
                                 holds[0].share != 1;
                        ++parts;
                    });
                });
            }
            CAPTURE(parts, towards);
            CHECK(parts > 10000);
            CHECK(other == 0);
            if (backing == Backing::none)
                for (const std::size_t blocks : towards) CHECK(blocks > 0);
        }
    }
}

TEST_CASE("Parts are told apart by how much of other resins lies beside them") {
    const ResinSet set = vero_opaque();
    // A wall of one resin on the left; on the right single voxels amid white.
    const auto single = [](int x, int y, int z) { return x > 16 && x % 4 == 2 && y % 3 == 1 && z % 4 == 2; };
    const ResinVolume volume = make_resin_volume({32, 12, 36}, j750, [&](int x, int y, int z) -> int {
        return x < 10 ? 2 : single(x, y, z) ? 3 : 5;
    });
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    ViewingGrid grid =
        make_viewing_grid(scene, viewing_cell, {0.8}, {}, {{}, BlockLattice(volume.size(), viewing_cell).blocks, {}});
    std::vector<std::uint8_t> wanted;
    REQUIRE(homogenise(grid, volume, wanted));
    refine(grid, volume, blocks_to_refine(grid, volume, Refinement::all), viewing_cell);
    std::size_t singles = 0, walls = 0, beside_walls = 0;
    for (std::size_t t = 0; t < grid.fine.first.size(); ++t) {
        if (grid.fine.first[t] == not_fine) continue;
        const auto corner = grid.corner_of(grid.transport_block(t).at);
        for_each({4, 4, 4}, [&](const Place& cell) {
            for_each(viewing_cell, [&](const Place& part) {
                Place voxel{};
                for (std::size_t a = 0; a < 3; ++a) voxel[a] = corner[a] + cell[a] * viewing_cell[a] + part[a];
                const auto& content =
                    grid.fine.contents[grid.fine.medium[grid.fine.first[t] + grid.fine.part(cell, part)]];
                const auto apart = double(content.apart);
                if (single(voxel[0], voxel[1], voxel[2])) {
                    CHECK(apart == 1);
                    ++singles;
                } else if (voxel[0] < 8) {
                    CHECK(apart == 0);
                    ++walls;
                } else if (voxel[0] == 9 || voxel[0] == 10) {  // on either side of the wall's end
                    if (voxel[0] % 8 != 0 && voxel[0] % 8 != 7) CHECK(apart > 0);
                    CHECK(apart < 0.3);
                    beside_walls += apart > 0;
                }
            });
        });
    }
    CAPTURE(singles, walls, beside_walls);
    CHECK(singles > 20);
    CHECK(walls > 100);
    CHECK(beside_walls > 100);
}

TEST_CASE("Cells of voxels: a body that absorbs nothing is white wherever the surface cuts the cells") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo.assign(3, 1.0);
    const ResinVolume volume = cut_sphere(0.7, 0.8);
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    for (const Refinement where : {Refinement::contrast, Refinement::all}) {
        const Appearance seen = TransportPredictor(refined(where)).predict(scene, surface);
        for (const float v : seen.value) REQUIRE(std::abs(v - 1) < 1e-3f);
    }
}

TEST_CASE("Cut where resins meet alone, a slab looks as it does cut everywhere") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = slab(48, 0.5);
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
    const std::vector<float> voxels = TransportPredictor(refined(Refinement::all)).predict(scene, surface).value;
    const auto distance = [&](Refinement where) {
        return rms(TransportPredictor(refined(where)).predict(scene, surface).value, voxels);
    };
    const double coarse = distance(Refinement::none), fine = distance(Refinement::contrast);
    CAPTURE(coarse, fine);
    CHECK(fine < 0.4 * coarse);
}

TEST_CASE("A sweep of whole cells before one of parts brings them nearer to where many end") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = slab(48, 0.5);
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
    const auto after = [&](int sweeps) {
        TransportOptions options = refined(Refinement::all, sweeps);
        options.first_change = 0;  // so many and no more
        return TransportPredictor(options).predict(scene, surface).value;
    };
    const std::vector<float> many = after(12);
    const double parts_alone = rms(after(1), many), whole_first = rms(after(2), many),
                 parts_twice = rms(after(3), many);
    CAPTURE(parts_alone, whole_first, parts_twice);
    CHECK(whole_first < parts_alone / 2);
    CHECK(parts_twice < whole_first / 2);
}

TEST_CASE("Refined predictions are the same bits for any threads, and a sequence refines nothing") {
    const ResinSet set = vero_opaque();
    const ResinVolume first = slab(48, 0.0), second = slab(48, 0.6);
    const Scene scene{&first, &set, Backing::black, Sides::mirrored},
        other{&second, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
    const auto predicted = [&](std::size_t threads) {
        const ThreadLimit limit(threads);
        return TransportPredictor(refined(Refinement::contrast)).predict(other, surface).value;
    };
    const std::vector<float> one = predicted(1);
    CHECK(rms(one, predicted(3)) == 0);
    const auto last_of_sequence = [&](Refinement where) {
        const auto sequence = TransportPredictor(refined(where)).sequence(scene, surface);
        (void)sequence->next(first);
        return sequence->next(second).value;
    };
    const std::vector<float> whole = last_of_sequence(Refinement::none);
    CHECK(rms(last_of_sequence(Refinement::contrast), whole) == 0);
    CHECK(rms(one, whole) > 0.001);
}
