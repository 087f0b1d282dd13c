// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "base/random.h"
#include "optics/grid/sheet_way.h"
#include "optics/transport/transport.h"
#include "optics/transport/transport_medium.h"
#include "optics/transport/viewing_sequence.h"
#include "tests/optics/transport/slab_scene.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> viewing_cell{2, 1, 3};

/// A sphere of white under a halftone of `depth_mm`, the more of it coloured the larger `strength`.
ResinVolume halftoned_sphere(double radius_mm, double strength, double depth_mm = 0.3) {
    std::array<int, 3> n{};
    for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<int>(2 * radius_mm / j750[a]) + 3;
    return make_resin_volume(n, j750, [&](int x, int y, int z) -> int {
        const double r = std::hypot((x - 0.5 * n[0]) * j750[0], (y - 0.5 * n[1]) * j750[1], (z - 0.5 * n[2]) * j750[2]);
        if (r > radius_mm) return air;
        if (radius_mm - r > depth_mm) return 5;
        RandomStream random(1, static_cast<std::uint64_t>((z * n[1] + y) * n[0] + x));
        const double u = random.uniform();
        const double coverage = strength * (0.5 + 0.4 * std::sin(3 * x * j750[0]) * std::cos(2 * z * j750[2]));
        return u < coverage ? 1 + static_cast<int>(random.bits() % 4) : 5;
    });
}

struct Distance {
    double rms = 0, largest = 0;
};
Distance between(const std::vector<float>& a, const std::vector<float>& b) {
    Distance d;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double e = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
        d.rms += e * e / static_cast<double>(a.size());
        d.largest = std::max(d.largest, e);
    }
    d.rms = std::sqrt(d.rms);
    return d;
}

TransportOptions on_viewing_cells(int sweeps = 3) {
    TransportOptions options;
    options.refinement = Refinement::none;
    options.sweeps = sweeps;
    return options;
}

}  // namespace

TEST_CASE("A sequence arrives where fresh predictions of many sweeps do", "[slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume first = halftoned_sphere(1.5, 0.5);
    const Scene scene{&first, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    const TransportPredictor predictor(on_viewing_cells()), patient(on_viewing_cells(16));
    const auto sequence = predictor.sequence(scene, surface);
    Appearance before = sequence->next(first);
    for (const double strength : {0.55, 0.62, 0.58}) {
        const ResinVolume volume = halftoned_sphere(1.5, strength);
        const Appearance seen = sequence->next(volume);
        const Scene now{&volume, &set, Backing::none, Sides::open};
        const Appearance exact = patient.predict(now, surface);
        const Distance error = between(seen.value, exact.value), change = between(before.value, exact.value);
        INFO(strength << ": rms " << error.rms << ", largest " << error.largest << "; the change: " << change.rms);
        CHECK(error.rms < 0.0015);
        CHECK(error.rms < 0.2 * change.rms);
        CHECK(error.largest < 0.03);
        before = seen;
    }
    // Asked again about the same volume it gets nearer.
    const ResinVolume volume = halftoned_sphere(1.5, 0.58);
    Appearance seen;
    for (int k = 0; k < 4; ++k) seen = sequence->next(volume);
    const Appearance exact = patient.predict({&volume, &set, Backing::none, Sides::open}, surface);
    CHECK(between(seen.value, exact.value).rms < 2e-4);  // the steps of the codes are 3e-5
}

TEST_CASE("A sequence sweeps once where little has changed, and more where much has") {
    const ResinSet set = vero_opaque();
    const ResinVolume first = halftoned_sphere(1.5, 0.5), other = halftoned_sphere(1.5, 0.8);
    const Scene scene{&first, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options;
    options.refinement = Refinement::none;
    options.next_sweeps = 2;
    const auto steps = [&](double next_change, const ResinVolume& next) {  // one a sweep and channel
        options.next_change = next_change;
        ViewingSequence sequence(scene, surface, options);
        (void)sequence.next(first);
        (void)sequence.next(first);
        const int before = sequence.summary().diffusion_steps;
        (void)sequence.next(next);
        return sequence.summary().diffusion_steps - before;
    };
    CHECK(steps(0.01, first) == 3);
    CHECK(steps(0.01, other) == 6);
    CHECK(steps(0, first) == 6);
}

TEST_CASE("A twin leaves shape and the light between tiles, and no light to start from", "[slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume print = halftoned_sphere(3, 0.5), white = all_of(halftoned_sphere(3, 0), 5);
    const Scene scene{&white, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    const auto predictions = [&](const TransportOptions& options) {
        ViewingSequence fresh(scene, surface, options), after(scene, surface, options);
        const Appearance twin = after.twin(white);
        const Appearance seen = after.next(print);
        return std::array{twin, seen, fresh.next(print)};
    };
    const auto [twin, seen, fresh] = predictions(on_viewing_cells());
    TransportOptions patient = on_viewing_cells();
    patient.sweeps = 12;
    const Appearance exact_twin = ViewingSequence(scene, surface, patient).only(white),
                     exact = ViewingSequence(scene, surface, patient).only(print);
    CHECK(seen.value == fresh.value);
    CHECK(between(twin.value, exact_twin.value).rms < 0.002);
    // In tiles it starts from what shines across the cuts of the twin, which is nearer than nothing.
    TransportOptions in_tiles = on_viewing_cells();
    in_tiles.tile_cells = 8000;
    const auto [tiled_twin, tiled, tiled_fresh] = predictions(in_tiles);
    const double own = between(tiled.value, exact.value).rms, without = between(tiled_fresh.value, exact.value).rms;
    const double of_twin = between(tiled_twin.value, exact_twin.value).rms;
    CAPTURE(own, without);
    CHECK(of_twin < 0.003);
    CHECK(own < 0.005);
    CHECK(tiled.value != tiled_fresh.value);
    CHECK(own < 0.95 * without);
}

TEST_CASE("The last look of a sequence sees droplets run, as a prediction that stands alone does", "[slow]") {
    ResinSet set = vero_opaque();
    set.dot_spread = 0.8;
    const ResinVolume first = halftoned_sphere(1.5, 0.5), print = halftoned_sphere(1.5, 0.7);
    const Scene scene{&first, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions patient;
    patient.sweeps = 8;
    const Appearance exact = ViewingSequence(scene, surface, patient).only(print);
    ViewingSequence sequence(scene, surface, on_viewing_cells());
    (void)sequence.next(first);
    const Appearance next = sequence.next(print), last = sequence.last(print);
    const double chosen_by = between(next.value, exact.value).rms, kept = between(last.value, exact.value).rms;
    CAPTURE(chosen_by, kept);
    CHECK(kept < 0.002);
    CHECK(kept < 0.3 * chosen_by);
    // Of a sequence that has looked at nothing else it is as near.
    CHECK(between(ViewingSequence(scene, surface, on_viewing_cells()).last(print).value, exact.value).rms < 0.002);
}

TEST_CASE("A body and its twin on one grid are seen as alone, in parts and in tiles", "[slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume print = halftoned_sphere(3, 0.5, 1.2), white = all_of(print, 5);
    Scene scene{&print, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options;
    options.tile_cells = GENERATE(std::size_t{250'000}, std::size_t{8000});
    const TransportPredictor model(options);
    const auto [body, twin] = model.predict_with_twin(scene, surface, white);
    TransportSummary summary;
    const Appearance body_alone = model.predict(scene, surface, summary);
    CHECK((summary.pieces > 1) == (options.tile_cells == 8000));
    scene.volume = &white;
    const Appearance twin_alone = model.predict(scene, surface);
    CHECK(body.value == body_alone.value);
    CHECK(body.remarks == body_alone.remarks);
    CHECK(twin.remarks == twin_alone.remarks);
    const Distance apart = between(twin.value, twin_alone.value);
    CAPTURE(apart.rms, apart.largest);
    // The print's grid has cells deeper down than a white body needs; three sweeps leave 0.002.
    CHECK(apart.rms > 0);
    CHECK(apart.rms < 0.001);
    CHECK(apart.largest < 0.01);
}

TEST_CASE("Colour that gets deeper than expected makes a new grid and keeps the light", "[slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume first = halftoned_sphere(2.0, 0.5), deep = halftoned_sphere(2.0, 0.5, 1.8);
    const Scene scene{&first, &set, Backing::none, Sides::open}, deep_scene{&deep, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.3;
    ViewingSequence sequence(scene, surface, options);
    (void)sequence.next(first);
    const std::size_t cells = sequence.summary().cells;
    Appearance seen = sequence.next(deep);
    CHECK(sequence.summary().cells > cells);
    for (int k = 0; k < 5; ++k) seen = sequence.next(deep);
    options.sweeps = 16;
    const Appearance exact = TransportPredictor(options).predict(deep_scene, surface);
    CHECK(between(seen.value, exact.value).rms < 0.001);  // margins differ a little
}

TEST_CASE("Colour that gets deeper than expected beside a mirror makes a new grid with more faces, and keeps the light",
          "[slow]") {
    const ResinSet set = vero_opaque();
    const auto slab = [](double depth_mm) {
        return make_resin_volume({96, 48, 90}, j750, [&](int x, int y, int z) -> int {
            if ((89.5 - z) * j750[2] > (x > 48 ? depth_mm : 0.2)) return 5;
            return RandomStream(6, static_cast<std::uint64_t>((z * 48 + y) * 96 + x)).uniform() < 0.4 ? 1 + x % 4 : 5;
        });
    };
    const ResinVolume shallow = slab(0.2), deep = slab(1.6);
    const Scene scene{&shallow, &set, Backing::black, Sides::mirrored},
        deep_scene{&deep, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.3;
    ViewingSequence sequence(scene, surface, options);
    (void)sequence.next(shallow);
    const std::size_t cells = sequence.summary().cells;
    Appearance seen = sequence.next(deep);
    CHECK(sequence.summary().cells > cells);
    for (int k = 0; k < 5; ++k) seen = sequence.next(deep);
    options.sweeps = 16;
    CHECK(between(seen.value, TransportPredictor(options).predict(deep_scene, surface).value).rms < 0.001);
}

TEST_CASE("Where colour came no more the cells go, once, and what is seen stays right", "[slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume shape = halftoned_sphere(2.2, 0), deep = halftoned_sphere(2.2, 0.5, 1.8),
                      shallow = halftoned_sphere(2.2, 0.5);
    const Scene scene{&shape, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.4;
    ViewingSequence sequence(scene, surface, options);
    const std::size_t at_first = sequence.summary().cells;
    (void)sequence.next(deep);
    CHECK(sequence.summary().cells > at_first);
    (void)sequence.next(shallow);
    CHECK(sequence.summary().cells == at_first);
    const Appearance seen = sequence.next(shallow);
    const Appearance exact =
        TransportPredictor(on_viewing_cells(16)).predict({&shallow, &set, Backing::none, Sides::open}, surface);
    const Distance error = between(seen.value, exact.value);
    INFO("rms " << error.rms << ", largest " << error.largest);
    CHECK(error.rms < 0.003);
    (void)sequence.next(deep);
    (void)sequence.next(shallow);
    CHECK(sequence.summary().cells > at_first);
}

TEST_CASE("Deep colour in nodes of diffusion is seen as in cells, in a grid that keeps its shape", "[slow]") {
    const ResinSet set = vero_opaque();
    for (const double strength : {0.05, 0.5}) {
        const ResinVolume white = halftoned_sphere(2.2, 0), deep = halftoned_sphere(2.2, strength, 1.2),
                          shallow = halftoned_sphere(2.2, strength, 0.6);
        const Scene scene{&white, &set, Backing::none, Sides::open},
            deep_scene{&deep, &set, Backing::none, Sides::open};
        const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
        TransportOptions options = on_viewing_cells(12);
        options.colour_mm = 0.4;
        options.first_change = 0;
        options.deep_colour_in_nodes = true;
        ViewingSequence sequence(scene, surface, options);
        const std::size_t cells = sequence.summary().cells;
        const Appearance seen = sequence.next(deep);
        CHECK(sequence.summary().cells == cells);
        const Appearance exact = TransportPredictor(on_viewing_cells(12)).predict(deep_scene, surface);
        const Distance error = between(seen.value, exact.value);
        // What the nodes hold is looked at: colour that ends above them is another print.
        const Distance without = between(ViewingSequence(scene, surface, options).next(shallow).value, exact.value);
        CAPTURE(strength, error.rms, error.largest, without.rms);
        CHECK(error.rms < 0.002);
        CHECK(error.largest < 0.01);
        CHECK(without.rms > 5 * error.rms);
    }
}

TEST_CASE("Deep colour in nodes: a resin that the print does not hold costs no cells") {
    const ResinSet cyan_and_white = vero_opaque();
    ResinSet with_clear = cyan_and_white;
    Resin clear;
    clear.name = clear.role = "clear";
    clear.sigma_t_per_mm.assign(3, 0.0);
    clear.albedo.assign(3, 1.0);
    with_clear.resins.push_back(clear);
    const ResinVolume print = make_resin_volume({32, 16, 120}, j750, [](int x, int y, int z) {
        return RandomStream(4, static_cast<std::uint64_t>((z * 16 + y) * 32 + x)).uniform() < 0.3 ? 1 : 5;
    });
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.3;
    options.deep_colour_in_nodes = true;
    const auto cells = [&](const ResinSet& set) {
        const Scene scene{&print, &set, Backing::white, Sides::mirrored};
        const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
        return ViewingSequence(scene, surface, options).summary().cells;
    };
    const BlockLattice lattice(print.size(), viewing_cell);
    const auto all = static_cast<std::size_t>(64 * lattice.blocks[0] * lattice.blocks[1] * lattice.blocks[2]);
    CHECK(cells(cyan_and_white) < all);
    CHECK(cells(with_clear) == cells(cyan_and_white));
}

TEST_CASE("A slab that is asked for from above has cells below its top, and looks as it does with cells all around") {
    const ResinSet set = vero_opaque();
    const std::array<int, 3> n{142, 71, 130};  // 6 x 6 x 3.5 mm
    const ResinVolume slab = make_resin_volume(n, j750, [&](int x, int y, int z) -> int {
        if (z < n[2] - 20) return 5;
        RandomStream random(2, static_cast<std::uint64_t>((z * n[1] + y) * n[0] + x));
        return random.uniform() < 0.4 ? 1 + static_cast<int>(random.bits() % 4) : 5;
    });
    const Scene scene{&slab, &set, Backing::black, Sides::open};
    const Surface all = find_surface(scene, viewing_cell, SurfacePart::all),
                  top = find_surface(scene, viewing_cell, SurfacePart::top);
    ViewingSequence around(scene, all, on_viewing_cells()), above(scene, top, on_viewing_cells());
    CHECK(10 * above.summary().cells < 9 * around.summary().cells);
    const Appearance from_all = around.next(slab), from_above = above.next(slab);
    std::map<std::array<std::int32_t, 3>, std::size_t> place;
    for (std::size_t i = 0; i < all.cells.size(); ++i)
        if (all.cells[i].normal[2] > 0.99f) place[all.cells[i].cell] = i;
    std::vector<float> a, b;
    for (std::size_t i = 0; i < top.cells.size(); ++i) {
        const auto found = place.find(top.cells[i].cell);
        if (found == place.end()) continue;  // at the edges normals differ
        for (std::size_t c = 0; c < from_all.channels; ++c) {
            a.push_back(from_above.value[i * from_all.channels + c]);
            b.push_back(from_all.value[found->second * from_all.channels + c]);
        }
    }
    REQUIRE(2 * a.size() > top.cells.size() * from_all.channels);
    const Distance error = between(a, b);
    INFO("rms " << error.rms << ", largest " << error.largest);
    CHECK(error.rms < 0.0015);  // the sides' white is diffusion's at 0.7 mm for 1 mm
}

TEST_CASE("A sequence gives the same bits for any number of threads", "[slow]") {
    const ResinSet set = vero_opaque();
    const bool deep_in_nodes = GENERATE(false, true);
    const ResinVolume first = halftoned_sphere(1.6, 0.5, 0.8), second = halftoned_sphere(1.6, 0.7, 1.0);
    const Scene scene{&first, &set, Backing::none, Sides::open};
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.2;
    options.deep_colour_in_nodes = deep_in_nodes;
    const auto run = [&] {
        const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
        ViewingSequence sequence(scene, surface, options);
        (void)sequence.next(first);
        return sequence.next(second).value;
    };
    const std::vector<float> seen = test::same_for_threads(run, {5});
    CHECK(std::all_of(seen.begin(), seen.end(), [](float v) { return std::isfinite(v); }));
}

TEST_CASE("Cells of the eye: a body that absorbs nothing is white wherever the surface cuts the cells") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo.assign(3, 1.0);
    const ResinVolume volume = halftoned_sphere(0.7, 0.8);
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    const Appearance seen = TransportPredictor(on_viewing_cells()).predict(scene, surface);
    for (const float v : seen.value) REQUIRE(std::abs(v - 1) < 1e-3f);
}

TEST_CASE("Deep colour in nodes: a body that absorbs nothing is white") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo.assign(3, 1.0);
    const ResinVolume volume = halftoned_sphere(1.6, 0.8, 1.2);
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.2;
    options.deep_colour_in_nodes = true;
    const Appearance seen = TransportPredictor(options).predict(scene, surface);
    for (const float v : seen.value) REQUIRE(std::abs(v - 1) < 1e-3f);
}

TEST_CASE("Cells of the eye: a flat surface looks alike wherever it cuts the cells") {
    const ResinSet set = vero_opaque();
    for (const int resin : {1, 4, 5}) {
        std::vector<double> lightness;
        for (int empty = 0; empty < 3; ++empty) {
            const ResinVolume volume =
                make_resin_volume({8, 4, 48 + empty}, j750, [&](int, int, int z) { return z < 48 ? resin : 0; });
            const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
            const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
            const Appearance cells = TransportPredictor(on_viewing_cells(10)).predict(scene, surface);
            const SlabLayer layer{static_cast<Material>(resin), 48};
            INFO("resin " << resin << ", layers of air " << empty);
            for (std::size_t i = 0; i < cells.value.size(); ++i) {
                const double exact = exact_appearance(set, {&layer, 1}, Backing::black, i % 3);
                CHECK(std::abs(double(cells.value[i]) - exact) <
                      0.005);  // white over black is 0.004 brighter: differences with theta blur
            }
        }
    }
}

TEST_CASE("Deep colour in nodes: margins suffice wherever a flat surface cuts the cells", "[slow]") {
    ResinSet set = vero_opaque();
    Resin white = set.resins[4];  // as measured on a J750 in its third and fourth channel, and a darker one
    white.name = white.role = "measured white";
    white.sigma_t_per_mm = {11.35, 23.99, 11.35};
    white.albedo = {0.9895, 0.99629, 0.97};
    set.resins.push_back(white);
    for (const int resin : {1, 2, 3, 4, 5, 6})
        for (int empty = 0; empty < 12; ++empty) {  // of the layers of a block
            const int n = 120;
            const ResinVolume volume =
                make_resin_volume({8, 4, n + empty}, j750, [&](int, int, int z) { return z < n ? resin : 0; });
            const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
            const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
            TransportOptions options = on_viewing_cells(10);
            options.colour_mm = 0.15;
            options.deep_colour_in_nodes = true;
            const Appearance cells = TransportPredictor(options).predict(scene, surface);
            const SlabLayer layer{static_cast<Material>(resin), n};
            for (std::size_t i = 0; i < cells.value.size(); ++i) {
                const double exact = exact_appearance(set, {&layer, 1}, Backing::black, i % 3),
                             error = double(cells.value[i]) - exact;
                INFO("resin " << resin << ", layers of air " << empty << ", channel " << i % 3 << ": error " << error);
                CHECK(std::abs(error) < 0.0015);
            }
        }
}

TEST_CASE("A sheet deep under resin is seen through nodes as through cells", "[slow]") {
    const ResinSet set = vero_opaque();
    const DirectionSet directions = make_directions(set.g, set.eta);
    for (const Backing backing : {Backing::black, Backing::white})
        for (const int resin : {2, 3, 5})         // magenta, yellow and white, the clearer ones
            for (const int empty : {0, 5, 11}) {  // of the layers of a block
                const double deep = sheet_depth_mm(set, set.resins[std::size_t(resin) - 1], directions);
                REQUIRE(deep < 10);
                const int n = static_cast<int>((deep + 1.2) / j750[2]);
                const ResinVolume volume =
                    make_resin_volume({8, 4, n + empty}, j750, [&](int, int, int z) { return z < n ? resin : 0; });
                const Scene scene{&volume, &set, backing, Sides::mirrored};
                const Surface surface = find_surface(scene, viewing_cell, SurfacePart::top);
                const auto predict = [&](double cells_mm, TransportSummary& summary) {
                    TransportOptions options = on_viewing_cells(10);
                    options.colour_mm = cells_mm;
                    options.deep_colour_in_nodes = true;
                    return TransportPredictor(options).predict(scene, surface, summary).value;
                };
                TransportSummary few, all;
                const std::vector<float> seen = predict(0.15, few), by_cells = predict(n * j750[2], all);
                CHECK(few.cells < 0.6 * all.cells);
                const SlabLayer layer{static_cast<Material>(resin), n};
                for (std::size_t i = 0; i < seen.size(); ++i) {
                    INFO("resin " << resin << ", layers " << n << ", of air " << empty << ", channel " << i % 3);
                    CHECK(std::abs(seen[i] - by_cells[i]) < 0.001f);
                    CHECK(double(seen[i]) == Approx(exact_appearance(set, {&layer, 1}, backing, i % 3)).margin(0.002));
                }
            }
}

TEST_CASE("Cells of the eye: a sphere of one colour looks as it does to cells of half their size") {
    ResinSet set = vero_opaque();
    Resin mixture;
    mixture.name = mixture.role = "dark blue";
    for (std::size_t c = 0; c < 3; ++c) {
        const Medium m = set.mix(std::vector<double>{0.4, 0.3, 0, 0.2, 0.1}, c);
        mixture.sigma_t_per_mm.push_back(m.sigma_t());
        mixture.albedo.push_back(m.albedo());
    }
    set.resins.push_back(mixture);
    constexpr double radius_mm = 1.2;
    std::array<int, 3> n{};
    for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<int>(std::ceil(2 * radius_mm / j750[a])) + 2;
    const ResinVolume volume = make_resin_volume(n, j750, [&](int x, int y, int z) {
        return std::hypot((x + 0.4 - 0.5 * n[0]) * j750[0], (y + 0.45 - 0.5 * n[1]) * j750[1],
                          (z + 0.55 - 0.5 * n[2]) * j750[2]) < radius_mm
                   ? 6
                   : 0;
    });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    const Appearance cells = TransportPredictor(on_viewing_cells()).predict(scene, surface);
    TransportOptions half = on_viewing_cells();
    half.cell_mm /= 2;
    const Appearance smaller = TransportPredictor(half).predict(scene, surface);
    for (std::size_t c = 0; c < 3; ++c) {
        double mean = 0, mean_of_smaller = 0, scatter = 0;
        const double share = 1.0 / static_cast<double>(surface.cells.size());
        for (std::size_t i = 0; i < surface.cells.size(); ++i) {
            mean += share * static_cast<double>(cells.value[3 * i + c]);
            mean_of_smaller += share * static_cast<double>(smaller.value[3 * i + c]);
        }
        for (std::size_t i = 0; i < surface.cells.size(); ++i)
            scatter += share * std::pow(static_cast<double>(cells.value[3 * i + c]) - mean, 2);
        INFO("channel " << c << ": " << mean << ", of smaller ones " << mean_of_smaller << ", scatter "
                        << std::sqrt(scatter));
        // In L*: less than such a sphere differs from side to side, 0.3 at least (docs/predict.md).
        const auto lightness = [](double y) { return 116 * std::cbrt(y) - 16; };
        CHECK(std::abs(lightness(mean) - lightness(mean_of_smaller)) < 0.3);
        CHECK(std::sqrt(scatter) < 0.005);
    }
}

TEST_CASE("Cells of the eye: parts thinner than a cell, bubbles and specks have a defined appearance") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = make_resin_volume({30, 20, 60}, j750, [](int x, int y, int z) -> int {
        if (x == 9 && y > 3 && y < 12) return 4;   // a sheet of one voxel
        if (x == 3 && y == 3 && z == 7) return 1;  // a speck
        if (x > 12 && x < 28 && y > 2 && y < 18 && z > 5 && z < 50)
            return x == 20 && y == 9 && z == 25 ? 0 : 5;  // a bubble
        return 0;
    });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    const Appearance seen = TransportPredictor(on_viewing_cells()).predict(scene, surface);
    // All of its resins absorb.
    for (const float v : seen.value) {
        REQUIRE(v > 0.0f);
        REQUIRE(v < 1.0f);
    }
    // What absorbs nothing is white on all of its parts, however thin.
    ResinSet clear = set;
    for (Resin& resin : clear.resins) resin.albedo.assign(3, 1.0);
    for (const float v : TransportPredictor(on_viewing_cells(12)).predict({&volume, &clear}, surface).value)
        REQUIRE(std::abs(v - 1) < 1e-3f);
}

TEST_CASE("Cells of the eye: too little memory is an error") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = halftoned_sphere(1.5, 0.5);
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options = on_viewing_cells();
    options.memory_bytes = 1'000'000;
    CHECK_THROWS_AS(ViewingSequence(scene, surface, options), ResourceError);
    CHECK_THROWS_AS((void)TransportPredictor(options).predict(scene, surface), ResourceError);
}

TEST_CASE("A print whose light does not come nearer from that of the one before begins anew") {
    const ResinSet set = vero_opaque();
    const std::array<int, 3> n{48, 24, 60};
    const auto of = [&](double black) {
        return make_resin_volume(n, j750, [&](int x, int y, int z) {
            return RandomStream(6, static_cast<std::uint64_t>((z * n[1] + y) * n[0] + x)).uniform() < black ? 4 : 5;
        });
    };
    const ResinVolume dark = of(0.5), light = of(0.02), lighter = of(0.019);
    const Scene scene{&dark, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, viewing_cell, SurfacePart::all);
    TransportOptions options = on_viewing_cells();
    options.colour_mm = 0.4;
    options.deep_colour_in_nodes = true;  // grids of one shape
    options.next_sweeps = 1;
    const auto fresh = [&](const ResinVolume& print) {
        return ViewingSequence(scene, surface, options).next(print).value;
    };
    ViewingSequence sequence(scene, surface, options);
    (void)sequence.next(dark);
    CHECK(sequence.next(light).value == fresh(light));
    // From nearly the same print one sweep is enough, and what was found is kept.
    const std::vector<float> on = sequence.next(lighter).value, anew = fresh(lighter);
    CHECK(on != anew);
    CHECK(between(on, anew).rms < 0.01);
}
