// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "optics/grid/homogenisation.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/transport/seen_medium.h"
#include "optics/transport/transport.h"
#include "optics/transport/viewing_gradient.h"
#include "optics/transport/viewing_sequence.h"
#include "tests/optics/colour/split_channels.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

TransportOptions on_viewing_cells(int sweeps) {
    TransportOptions options;
    options.refinement = Refinement::none;
    options.sweeps = options.next_sweeps = options.adjoint_sweeps = sweeps;
    options.next_change = options.first_change = 0;
    return options;
}

/// A body of about 2 mm: halftones that vary from place to place in the uppermost 0.4 mm, white below.
struct Body {
    bool sphere = false;
    std::array<int, 3> size{48, 24, 50};
    ResinSet resins = vero_opaque();

    explicit Body(bool round) : sphere(round) {
        if (round) size = {48, 24, 74};
    }
    [[nodiscard]] double depth(int x, int y, int z) const {
        if (!sphere) return (size[2] - z - 0.5) * j750[2];
        return 1 - std::hypot((x + 0.5) * j750[0] - 1.016, (y + 0.5) * j750[1] - 1.016, (z + 0.5) * j750[2] - 1);
    }
    [[nodiscard]] int material(int x, int y, int z) const {
        const double below = depth(x, y, z);
        if (below < 0) return 0;
        if (below > 0.4) return 5;
        const double u = 0.5 + 0.5 * std::sin(x * j750[0] * 5), v = 0.5 + 0.5 * std::cos(y * j750[1] * 4);
        const std::array<double, 5> fractions{0.25 * u, 0.25 * (1 - u), 0.25 * v, 0.15 * (1 - v), 0.35 + 0.1 * v};
        double draw = voxtone::RandomStream(3, address(x, y, z)).uniform();
        for (std::size_t m = 0; m < 4; ++m)
            if ((draw -= fractions[m]) < 0) return static_cast<int>(m) + 1;
        return 5;
    }
    [[nodiscard]] std::uint64_t address(int x, int y, int z) const {
        return static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x);
    }
    template <class Visit>
    void for_each_voxel(Visit&& visit) const {
        for (int z = 0; z < size[2]; ++z)
            for (int y = 0; y < size[1]; ++y)
                for (int x = 0; x < size[0]; ++x) visit(x, y, z);
    }
    template <class Change>
    [[nodiscard]] ResinVolume volume(Change&& change) const {
        return make_resin_volume(size, j750, [&](int x, int y, int z) {
            const int m = material(x, y, z);
            return m == 0 ? 0 : change(x, y, z, m);
        });
    }
    [[nodiscard]] ResinVolume volume() const {
        return volume([](int, int, int, int m) { return m; });
    }
    [[nodiscard]] Scene scene(const ResinVolume& of) const {
        return {&of, &resins, sphere ? Backing::none : Backing::black, Sides::open};
    }
    [[nodiscard]] Surface surface(const ResinVolume& of) const {
        return find_surface(scene(of), {2, 1, 3}, sphere ? SurfacePart::all : SurfacePart::top);
    }
};

/// Half of the squared distance to a grey pattern, and its derivative.
double target(std::size_t i) {
    return 0.3 + 0.2 * std::sin(0.7 * static_cast<double>(i / 3) + static_cast<double>(i % 3));
}
double distance(const Appearance& seen) {
    double sum = 0;
    for (std::size_t i = 0; i < seen.value.size(); ++i)
        sum += 0.5 * std::pow(static_cast<double>(seen.value[i]) - target(i), 2);
    return sum;
}
std::vector<float> adjoint_seed(const Appearance& seen) {
    std::vector<float> out(seen.value.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = seen.value[i] - static_cast<float>(target(i));
    return out;
}

}  // namespace

TEST_CASE("The derivatives of a seen medium agree with finite differences") {
    const ResinSet resins = vero_opaque();
    const EffectiveMedium halftone(resins, j750);
    const SeenMedium seen{halftone, resins, j750};
    // The weights of the layers are fixed: layers alike have the same mixture, so that the mean, which decides on them,
    // may move.
    const Mixture mixed{{{1, 0, 0.3f}, {5, 0, 0.2f}, {2, 1, 0.4f}}, 2}, one{{{3, 0, 0.8f}}, 2};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<std::array<double, 2>> by(15);
        seen.derivatives(one, channel, 0, 3, by);
        // More of the same resin is more of its medium, in whatever layer.
        for (std::size_t layer = 0; layer < 3; ++layer) {
            CHECK(by[layer * 5 + 2][0] == Approx(resins.resins[2].medium(channel).sigma_a).epsilon(1e-6));
            CHECK(by[layer * 5 + 2][1] == Approx(resins.resins[2].medium(channel).sigma_s).epsilon(1e-6));
        }
        // What is nearer to the light counts more; all layers together count as their mean does.
        const auto departure = [&](std::size_t layer) { return by[layer * 5 + 3][0] - by[layer * 5 + 2][0]; };
        CHECK(std::abs(departure(0)) > std::abs(departure(2)));
        Mixture with = one;
        const float step = 0.01f;
        with.holds[0].share -= step;
        with.holds.push_back({4, 0, step});
        const Medium before = seen(one, channel), after = seen(with, channel);
        CHECK((departure(0) + departure(1) + departure(2)) / 3 ==
              Approx((after.sigma_a - before.sigma_a) / static_cast<double>(step)).epsilon(0.03));
        seen.derivatives(mixed, channel, 2, 3, by);
        // Along the mixture itself, all shares grown alike, only the filling changes.
        double along = 0;
        for (const auto& [material, layer, share] : mixed.holds)
            along += static_cast<double>(share) * by[layer * 5u + material - 1u][1];
        CHECK(along == Approx(seen(mixed, channel).sigma_s).epsilon(1e-6));
    }
}

TEST_CASE("A cell's derivatives are the slopes of its transport medium, white's with its little absorption too") {
    const int height = GENERATE(21, 22, 23);  // the layers of one cell
    const ResinSet resins = vero_opaque();
    const EffectiveMedium halftone(resins, j750);
    const SeenMedium seen{halftone, resins, j750};
    // Cells of one resin, and of three whose layers differ.
    for (const Material own : {5, 4, 1, 0}) {
        const ResinVolume volume = make_resin_volume({16, 8, 24}, j750, [&](int x, int y, int z) {
            return own > 0 ? own : std::array<Material, 3>{5, 1, 4}[static_cast<std::size_t>(x * y + z * z) % 3];
        });
        const Scene scene{&volume, &resins, Backing::black, Sides::mirrored};
        ViewingGrid grid =
            make_viewing_grid(scene, {2, 1, 3}, {0.8}, {}, {{}, BlockLattice(volume.size(), {2, 1, 3}).blocks, {}});
        std::vector<std::uint8_t> wanted;
        REQUIRE(homogenise(grid, volume, wanted));
        const TransportMedia media_of(grid.directions, grid.edge_mm());
        const Place voxel{5, 3, height};
        const ViewingGrid::Home home = grid.home_of(voxel);
        REQUIRE(home.cell >= 0);
        const Mixture& mixture = grid.mixtures[grid.medium[static_cast<std::size_t>(home.cell)]];
        const auto layers = static_cast<std::size_t>(grid.view_voxels[home.axis]);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            // Slopes of sigma_t (0) and sigma_s (1) of the transport medium by both of the medium, well within it.
            const Medium at = seen(mixture, channel);
            const auto slope = [&](std::size_t of, bool by_scattering) {
                const double step = 0.05 * (by_scattering ? at.sigma_s : at.sigma_a);
                const auto moved = [&](double s) {
                    return media_of.exact(
                        {at.sigma_a + (by_scattering ? 0 : s), at.sigma_s + (by_scattering ? s : 0)})[of];
                };
                return (moved(step) - moved(-step)) / (2 * step);
            };
            std::vector<std::array<double, 2>> by_share(layers * 5);
            seen.derivatives(mixture, channel, home.axis, layers, by_share);
            for (const std::size_t of : {0u, 1u}) {
                ViewingGradient gradient(grid, seen, 3);
                const std::vector<float> ones(grid.cells(), 1.0f), none(grid.cells(), 0.0f);
                gradient.add(channel, media_of, seen, of == 0 ? ones : none, of == 0 ? none : ones);
                for (std::size_t r = 0; r < 5; ++r) {
                    const auto& [a, s] = by_share[home.layer * 5u + r];
                    const double by_a = a * slope(of, false), by_s = s * slope(of, true);
                    INFO("resin " << r << " in " << int(own) << ", channel " << channel << ", of " << of);
                    CHECK(static_cast<double>(gradient.at(voxel, r)) ==
                          Approx(static_cast<double>(home.share) * (by_a + by_s))
                              .margin(0.01 * static_cast<double>(home.share) * (std::abs(by_a) + std::abs(by_s))));
                }
            }
        }
    }
}

namespace {

struct Agreement {
    double cosine = 0, scale = 0;  ///< of the gradient's promises with the differences that other resins make
};

/// In eight places a sixth of the voxels around get another resin: the mean of the derivatives before and after is
/// right to second order. Differences are those of predictions of eight sweeps.
Agreement against_differences(const Body& body, const TransportOptions& options) {
    const ResinVolume volume = body.volume();
    const Surface surface = body.surface(volume);
    ViewingSequence sequence(body.scene(volume), surface, options),
        patient(body.scene(volume), surface, on_viewing_cells(8));
    (void)sequence.next(volume);
    const std::vector<float> weight = adjoint_seed(patient.next(volume));
    const auto F = [&](const ResinVolume& of) {
        const Appearance seen = patient.next(of);
        double sum = 0;
        for (std::size_t i = 0; i < weight.size(); ++i)
            sum += static_cast<double>(weight[i]) * static_cast<double>(seen.value[i]);
        return sum;
    };
    double dd = 0, dg = 0, gg = 0;
    voxtone::RandomStream draw(11, 0);
    for (int trial = 0; trial < 8; ++trial) {
        std::array<int, 3> at{};
        const double wanted = 0.01 + 0.027 * (trial % 4) * 4;
        do
            for (std::size_t a = 0; a < 3; ++a)
                at[a] = static_cast<int>(draw.bits() % static_cast<std::uint64_t>(body.size[a]));
        while (std::abs(body.depth(at[0], at[1], at[2]) - wanted) > 0.014);
        const int resin = 1 + trial % 5;
        const auto chosen = [&](int x, int y, int z) {
            return std::abs(x - at[0]) < 8 && std::abs(y - at[1]) < 4 && std::abs(z - at[2]) < 2 &&
                   voxtone::RandomStream(20 + static_cast<std::uint64_t>(trial), body.address(x, y, z)).uniform() <
                       0.17;
        };
        const ResinVolume other = body.volume([&](int x, int y, int z, int m) { return chosen(x, y, z) ? resin : m; });
        double predicted = 0;
        for (const ResinVolume* const of : {&volume, &other}) {
            (void)sequence.next(*of);
            REQUIRE(sequence.gradient(weight, [&](const ResinGradient& gradient, const VoxelBox& box) {
                body.for_each_voxel([&](int x, int y, int z) {
                    const int m = volume.at(x, y, z);
                    if (m == 0 || !box.holds({x, y, z}) || !chosen(x, y, z)) return;
                    predicted += 0.5 * static_cast<double>(gradient.at({x, y, z}, static_cast<std::size_t>(resin - 1)) -
                                                           gradient.at({x, y, z}, static_cast<std::size_t>(m - 1)));
                });
            }));
        }
        const double before = F(volume), after = F(other);
        UNSCOPED_INFO("trial " << trial << ": difference " << after - before << ", gradient " << predicted);
        dd += (after - before) * (after - before);
        dg += (after - before) * predicted;
        gg += predicted * predicted;
    }
    return {dg / std::sqrt(dd * gg), dg / dd};
}

}  // namespace

TEST_CASE("The gradient on viewing cells agrees with the difference that other resins make", "[slow]") {
    // A slab and a ball in R, G, B, and the slab in four channels of its own.
    const auto [round, own] = GENERATE(table<bool, bool>({{false, false}, {true, false}, {false, true}}));
    Body body(round);
    if (own) body.resins = testing::split_set(body.resins, testing::green_twice);
    const auto [cosine, scale] = against_differences(body, on_viewing_cells(8));
    CAPTURE(body.sphere, own, cosine, scale);
    CHECK(cosine > 0.99);
    CHECK(scale == Approx(1).epsilon(0.05));
}

TEST_CASE("The gradient at a loop's effort, which stops early, agrees with the difference that other resins make",
          "[slow]") {
    const Body body(GENERATE(false, true));
    TransportOptions loop;  // as slicer/options/model_choice.cpp has it
    loop.refinement = Refinement::none;
    loop.deep_colour_in_nodes = true;
    const auto [cosine, scale] = against_differences(body, loop);
    CAPTURE(body.sphere, cosine, scale);
    CHECK(cosine > 0.99);
    CHECK(scale == Approx(1).epsilon(0.05));
}

TEST_CASE("A step against the gradient brings what is seen nearer to its target", "[slow]") {
    const Body body(GENERATE(false, true));
    const ResinVolume volume = body.volume();
    const Surface surface = body.surface(volume);
    ViewingSequence sequence(body.scene(volume), surface, on_viewing_cells(8));
    const Appearance seen = sequence.next(volume);
    const double start = distance(seen);
    // What each voxel of the coloured skin promises, with the resin that lowers F most.
    struct Gain {
        double by;
        std::array<int, 3> voxel;
        int resin;
    };
    std::vector<Gain> gains;
    REQUIRE(sequence.gradient(adjoint_seed(seen), [&](const ResinGradient& gradient, const VoxelBox& box) {
        body.for_each_voxel([&](int x, int y, int z) {
            const int m = volume.at(x, y, z);
            if (m == 0 || !box.holds({x, y, z}) || body.depth(x, y, z) > 0.4) return;
            Gain best{0, {x, y, z}, m};
            for (int r = 1; r <= 5; ++r) {
                const auto change = static_cast<double>(gradient.at({x, y, z}, static_cast<std::size_t>(r - 1)) -
                                                        gradient.at({x, y, z}, static_cast<std::size_t>(m - 1)));
                if (change < best.by) best = {change, {x, y, z}, r};
            }
            if (best.by < 0) gains.push_back(best);
        });
    }));
    std::sort(gains.begin(), gains.end(), [](const Gain& a, const Gain& b) { return a.by < b.by; });
    const auto step = [&](std::size_t first, std::size_t last, std::size_t every, double& expected) {
        std::vector<std::uint8_t> to(static_cast<std::size_t>(body.size[0] * body.size[1] * body.size[2]), 0);
        for (std::size_t i = first; i < last; i += every) {
            const auto& [by, voxel, resin] = gains[i];
            to[body.address(voxel[0], voxel[1], voxel[2])] = static_cast<std::uint8_t>(resin);
            expected += by;
        }
        return distance(sequence.next(body.volume([&](int x, int y, int z, int m) {
            const int resin = to[body.address(x, y, z)];
            return resin > 0 ? resin : m;
        })));
    };
    // A few voxels far from each other do what is expected of them.
    double expected = 0;
    const double after = step(gains.size() / 50, gains.size(), 400, expected);
    CAPTURE(body.sphere, start, after, expected);
    CHECK((after - start) / expected == Approx(1).epsilon(0.1));
    // More of them, those that promise most, together do less: one of these steps is good.
    double least = start;
    for (const std::size_t share : {30u, 10u}) least = std::min(least, step(0, gains.size() / share, 1, expected));
    CHECK(least < 0.75 * start);
}

TEST_CASE("Any number of threads gives the same gradient, and predictions do not depend on it") {
    const Body body(true);
    const ResinVolume volume = body.volume();
    const Surface surface = body.surface(volume);
    const auto ask = [&](std::size_t threads, bool with_gradient, std::vector<float>& last) {
        const voxtone::ThreadLimit limit(threads);
        ViewingSequence sequence(body.scene(volume), surface, on_viewing_cells(2));
        std::vector<float> out;
        for (int k = 0; k < 2; ++k) {
            const Appearance seen = sequence.next(volume);
            last = seen.value;
            if (!with_gradient) continue;
            REQUIRE(sequence.gradient(adjoint_seed(seen), [&](const ResinGradient& gradient, const VoxelBox& box) {
                body.for_each_voxel([&](int x, int y, int z) {
                    if (z % 3 != 0 || !box.holds({x, y, z})) return;
                    std::array<float, 5> all{};
                    gradient.all_at({x, y, z}, all);
                    for (std::size_t r = 0; r < 5; ++r) {
                        const float single = gradient.at({x, y, z}, r);
                        if (single != all[r])
                            FAIL("resin " << r << ": alone " << single << ", with the others " << all[r]);
                        out.push_back(single);
                    }
                });
            }));
        }
        return out;
    };
    std::vector<float> seen, seen_by_many, seen_alone;
    const std::vector<float> one = ask(1, true, seen), many = ask(5, true, seen_by_many);
    CHECK(one == many);
    CHECK(std::any_of(one.begin(), one.end(), [](float v) { return v != 0; }));
    CHECK(std::all_of(one.begin(), one.end(), [](float v) { return std::isfinite(v); }));
    (void)ask(1, false, seen_alone);
    CHECK(seen == seen_by_many);
    CHECK(seen == seen_alone);
}

TEST_CASE("Where there is nothing to gain the gradient says so, and what memory cannot hold is refused") {
    const Body body(true);
    const ResinVolume volume = body.volume();
    const Surface surface = body.surface(volume);
    ViewingSequence sequence(body.scene(volume), surface, on_viewing_cells(2));
    const std::vector<float> none(sequence.next(volume).value.size(), 0.0f);
    REQUIRE(sequence.gradient(none, [&](const ResinGradient& gradient, const VoxelBox& box) {
        CHECK(box.holds({24, 12, 70}));
        CHECK(gradient.at({24, 12, 70}, 0) == 0);
        CHECK(gradient.at({-1, 0, 0}, 0) == 0);
        CHECK(gradient.at({0, 0, 0}, 0) == 0);  // air
    }));
    // Enough memory for predictions, not for the adjoint light besides.
    TransportOptions tight = on_viewing_cells(2);
    tight.memory_bytes = sequence.summary().memory_bytes * 17 / 20;
    ViewingSequence small(body.scene(volume), surface, tight);
    (void)small.next(volume);
    const auto never = [](const ResinGradient&, const VoxelBox&) { FAIL("visited"); };
    CHECK_THROWS_AS(small.gradient(none, never), voxtone::ResourceError);
    tight.memory_bytes = 1'000'000;
    CHECK_THROWS_AS(TransportPredictor(tight).sequence(body.scene(volume), surface), voxtone::ResourceError);
}
