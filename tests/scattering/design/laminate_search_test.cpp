// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "plain_laminate_search.h"
#include "random_layers.h"
#include "scattering/design/laminate_bounds.h"
#include "scattering/design/laminate_lanes.h"

using namespace voxtone;
using namespace voxtone::scattering;

namespace {

constexpr double step_mm = 0.3;

/// A laminate written out step by step, from the top.
struct Written {
    std::vector<std::size_t> steps;  ///< material of each
    std::uint32_t blocks;            ///< least number of blocks: the ones in the binary numbers of its layers' steps
    ChannelProfiles R;
};

std::uint32_t blocks_of(const std::vector<std::size_t>& steps) {
    std::uint32_t blocks = 0;
    for (std::size_t k = 0; k < steps.size();) {
        std::size_t end = k;
        while (end < steps.size() && steps[end] == steps[k]) ++end;
        blocks += static_cast<std::uint32_t>(std::popcount(end - k));
        k = end;
    }
    return blocks;
}

/// Every laminate of up to n steps, each made of thin layers one upon another, over black.
std::vector<Written> write_all(const std::vector<LaminateMaterial>& materials, std::size_t n) {
    std::vector<Written> all;
    std::vector<optics::LayerProfile> steps[8];  // [channel][material]
    const std::size_t channels = materials[0].size();
    for (std::size_t c = 0; c < channels; ++c)
        for (const LaminateMaterial& m : materials) steps[c].push_back(m[c].of_thickness(step_mm));
    Written empty{{}, 0, ChannelProfiles(channels, std::vector<double>(materials[0][0].K().size(), 0.0))};
    all.push_back(empty);
    std::vector<std::vector<optics::LayerProfile>> layers{{}};
    for (std::size_t c = 0; c < channels; ++c) layers[0].push_back(optics::no_layer(materials[0][c].K().size()));
    std::size_t first = 0;
    for (std::size_t length = 1; length <= n; ++length) {
        const std::size_t last = all.size();
        for (std::size_t s = first; s < last; ++s)
            for (std::size_t m = 0; m < materials.size(); ++m) {
                Written next{all[s].steps, 0, ChannelProfiles(channels)};
                next.steps.push_back(m);
                next.blocks = blocks_of(next.steps);
                layers.emplace_back();
                for (std::size_t c = 0; c < channels; ++c) {
                    layers.back().push_back(optics::laminate(layers[s][c], steps[c][m]));
                    next.R[c] = layers.back()[c].R_top;
                }
                all.push_back(std::move(next));
            }
        first = last;
    }
    return all;
}

double nearest(const std::vector<Written>& all, const ChannelProfiles& target, const ProfileWeights& weights,
               auto&& allowed) {
    double best = std::numeric_limits<double>::infinity();
    for (const Written& w : all)
        if (allowed(w)) best = std::min(best, profile_distance(w.R, target, weights));
    return best;
}

std::size_t depth_of(const Written& w, std::size_t material) {
    return static_cast<std::size_t>(std::find(w.steps.begin(), w.steps.end(), material) - w.steps.begin());
}

}  // namespace

TEST_CASE("the laminate found is the best there is: three materials, 200 targets, every n up to 8") {
    double worst = 0;
    int shallow_worse = 0, in_gamut = 0;
    for (std::uint64_t set = 0; set < 10; ++set) {
        RandomStream random(20, set);
        const std::size_t channels = 1 + set % 2;
        const std::vector<LaminateMaterial> materials = random_materials(random, 3, channels, 11);
        const std::vector<Written> all = write_all(materials, 8);
        CHECK(all.size() == 9841);
        std::vector<ChannelProfiles> targets;
        for (int i = 0; i < 20; ++i) {
            if (i % 4 == 0)  // what one of them shows, blurred a little
                targets.push_back(disturbed(
                    random, all[static_cast<std::size_t>(random.uniform() * static_cast<double>(all.size()))].R, 0.01));
            else
                targets.push_back(random_target(random, channels, 11));
        }
        for (std::uint32_t n = 1; n <= 8; ++n) {
            LaminateSearchOptions options;
            options.thickness_mm = step_mm * n;
            options.steps = n;
            options.max_blocks = n;
            options.tolerance = 0;
            options.dc_weight = set % 3 == 0 ? 10 : 1;
            options.edge_weights = set % 4 == 1;
            options.table_laminates = set % 2 == 0 ? 1 : 200;  // most of it from above, or half by tables
            const LaminateSearch search(materials, options);
            double count = 0;
            for (const Written& w : all) count += w.steps.size() <= n;
            CHECK(search.laminates() == count);
            const std::vector<FoundLaminate> found = search.find_all(targets);
            options.max_blocks = 1;
            const LaminateSearch shallow(materials, options);
            for (std::size_t i = 0; i < targets.size(); ++i) {
                const double best =
                    nearest(all, targets[i], options.weights(), [&](const Written& w) { return w.steps.size() <= n; });
                worst = std::max(worst, std::abs(found[i].distance - best));
                const ChannelProfiles R = laminate_reflection(materials, found[i].layers, {});
                worst = std::max(worst, std::abs(profile_distance(R, targets[i], options.weights()) - best));
                CHECK(found[i].outside <= best + 1e-12);
                in_gamut += found[i].outside == 0;
                if (n == 8) shallow_worse += shallow.find(targets[i]).distance > best + 1e-9;
            }
        }
    }
    INFO("largest difference from the best distance " << worst);
    CHECK(worst < 1e-12);
    CHECK(shallow_worse > 100);  // the comparison tells a laminate that is not the best
    CHECK(in_gamut > 100);
}

TEST_CASE("with fewer blocks than steps the best of what so few blocks can make is found") {
    double worst = 0;
    for (std::uint64_t set = 0; set < 5; ++set) {
        RandomStream random(21, set);
        const std::vector<LaminateMaterial> materials = random_materials(random, 3, 2, 8);
        const std::vector<Written> all = write_all(materials, 7);
        for (std::uint32_t blocks = 1; blocks <= 5; ++blocks) {
            LaminateSearchOptions options;
            options.thickness_mm = step_mm * 7;
            options.steps = 7;  // no power of 2
            options.max_blocks = blocks;
            options.tolerance = 0;
            options.table_laminates = 60;
            const LaminateSearch search(materials, options);
            double count = 0;
            for (const Written& w : all) count += w.blocks <= blocks;
            CHECK(search.laminates() == count);
            for (int i = 0; i < 10; ++i) {
                const ChannelProfiles target = random_target(random, 2, 8);
                const double best = nearest(all, target, 1, [&](const Written& w) { return w.blocks <= blocks; });
                worst = std::max(worst, std::abs(search.find(target).distance - best));
            }
        }
    }
    CHECK(worst < 1e-12);
}

TEST_CASE("a material stays as far from the top as it must, and the best of the rest is found") {
    double worst = 0;
    int bound = 0;
    for (std::uint64_t set = 0; set < 6; ++set) {
        RandomStream random(22, set);
        const std::vector<LaminateMaterial> materials = random_materials(random, 3, 1, 10);
        const std::vector<Written> all = write_all(materials, 8);
        LaminateSearchOptions options;
        options.thickness_mm = step_mm * 8;
        options.steps = 8;
        options.max_blocks = 8;
        options.tolerance = 0;
        options.table_laminates = set % 2 == 0 ? 1 : 300;
        const LaminateSearch unbound(materials, options);
        options.clear_top_mm = {0, 0.2, 3 * step_mm};  // one step, three steps
        const LaminateSearch search(materials, options);
        const auto allowed = [](const Written& w) {
            return (depth_of(w, 1) >= 1 || w.steps.empty()) &&
                   (depth_of(w, 2) >= std::min<std::size_t>(3, w.steps.size()));
        };
        CHECK(search.laminates() == std::count_if(all.begin(), all.end(), allowed));
        for (int i = 0; i < 20; ++i) {
            const ChannelProfiles target = random_target(random, 1, 10);
            const FoundLaminate found = search.find(target);
            worst = std::max(worst, std::abs(found.distance - nearest(all, target, 1, allowed)));
            bound += unbound.find(target).distance < found.distance - 1e-9;
            double depth = 0;
            for (const LaminateLayer& layer : found.layers) {
                CHECK(depth >= options.clear_top_mm[layer.material] - 1e-9);
                depth += layer.thickness_mm;
            }
        }
    }
    CHECK(worst < 1e-12);
    CHECK(bound > 30);  // the limits did matter
}

TEST_CASE("at 64 steps the best of all sequences of three blocks is found") {
    RandomStream random(23, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 1, 12);
    LaminateSearchOptions options;
    options.max_blocks = 3;
    options.tolerance = 0;
    options.backing = {std::vector<double>(12, 0.4)};
    const double unit_mm = options.thickness_mm / options.steps;
    for (const std::uint32_t table : {1U, 500U, 100000U}) {
        options.table_laminates = table;
        const LaminateSearch search(materials, options);
        for (int i = 0; i < 4; ++i) {
            const ChannelProfiles target = random_target(random, 1, 12);
            // Blocks in any order, repeats and all.
            double best = profile_distance(options.backing, target, 1);
            const std::size_t blocks = 3 * 7;
            const auto layer = [&](std::size_t b) {
                return LaminateLayer{b / 7, unit_mm * static_cast<double>(1U << (b % 7))};
            };
            for (std::size_t b1 = 0; b1 < blocks; ++b1)
                for (std::size_t b2 = 0; b2 <= blocks; ++b2)
                    for (std::size_t b3 = 0; b3 <= blocks; ++b3) {
                        std::vector<LaminateLayer> layers{layer(b1)};
                        if (b2 < blocks) layers.push_back(layer(b2));
                        if (b3 < blocks) layers.push_back(layer(b3));
                        double mm = 0;
                        for (const LaminateLayer& l : layers) mm += l.thickness_mm;
                        if (mm > options.thickness_mm + 1e-9) continue;
                        best = std::min(
                            best, profile_distance(laminate_reflection(materials, layers, options.backing), target, 1));
                    }
            CHECK(std::abs(search.find(target).distance - best) < 1e-12);
        }
    }
}

TEST_CASE("five blocks at 64 steps: the paper's own search finds the same and visits far more") {
    const std::vector<LaminateMaterial> materials = resin_layers(3, 1, 24);
    LaminateSearchOptions options;
    options.max_blocks = 5;
    options.tolerance = 0;
    const LaminateSearch search(materials, options);
    PlainLaminateSearch plain(materials, options.thickness_mm, options.steps);
    std::uint64_t visited = 0, visited_plain = 0;
    for (std::uint64_t i = 0; i < 6; ++i) {
        RandomStream random(31, i);
        const double sigma_a = log_uniform(random, 0.005, 0.3);
        const ChannelProfiles target{diffusing_target(sigma_a, log_uniform(random, 0.5, 8), 24)};
        const FoundLaminate found = search.find(target);
        const PlainLaminateSearch::Found expected = plain.find(target, 5);
        CHECK(std::abs(found.distance - expected.distance) < 1e-12);
        visited += found.count.visited + found.count.judged;
        visited_plain += expected.visited;
    }
    INFO("visited " << visited << ", by the paper's search " << visited_plain);
    CHECK(visited_plain > 20 * visited);
}

TEST_CASE("a laminate that can be printed is found again, and its figures are what its layers show") {
    RandomStream random(24, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 3, 24);
    LaminateSearchOptions options;
    options.thickness_mm = 3.2;  // steps of 0.05 mm
    const LaminateSearch search(materials, options);
    options.tolerance = 0;
    const LaminateSearch exact(materials, options);
    for (int i = 0; i < 10; ++i) {
        const std::vector<LaminateLayer> layers{{0, 0.05 * (1 << (i % 3))}, {2, 0.1}, {1, 0.2}, {0, 0.4}};
        const ChannelProfiles target = disturbed(random, laminate_reflection(materials, layers, {}), i < 5 ? 0 : 0.02);
        const FoundLaminate found = search.find(target), best = exact.find(target);
        CHECK(best.distance <= profile_distance(laminate_reflection(materials, layers, {}), target, 1) + 1e-12);
        CHECK(found.distance <= best.distance + options.tolerance + 1e-5);
        CHECK(std::abs(profile_distance(laminate_reflection(materials, found.layers, {}), target, 1) - found.distance) <
              1e-12);
        std::uint32_t blocks = 0;
        double steps = 0;
        for (std::size_t k = 0; k < found.layers.size(); ++k) {
            const double units = found.layers[k].thickness_mm / 0.05;
            CHECK(std::abs(units - std::round(units)) < 1e-9);
            blocks += static_cast<std::uint32_t>(std::popcount(static_cast<unsigned>(std::lround(units))));
            steps += units;
            if (k > 0) CHECK(found.layers[k].material != found.layers[k - 1].material);
        }
        CHECK(blocks <= options.max_blocks);
        CHECK(steps <= 64 + 1e-9);
        CHECK(found.count.visited > 0);
        CHECK(found.count.judged > 0);
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(found.channels[c].target_total == target[c][0]);
            CHECK(found.channels[c].least_total <= found.channels[c].found_total + 1e-5);
            CHECK(found.channels[c].most_total >= found.channels[c].found_total - 1e-5);
        }
    }
}

TEST_CASE("the result has the same bits for any number of threads and any company") {
    RandomStream random(25, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 2, 16);
    const LaminateSearch search(materials, {});
    std::vector<ChannelProfiles> targets;
    for (int i = 0; i < 24; ++i) targets.push_back(random_target(random, 2, 16));
    const auto find_with = [&](std::size_t threads) {
        const ThreadLimit limit(threads);
        return LaminateSearch(materials, {}).find_all(targets);
    };
    const std::vector<FoundLaminate> one = find_with(1), four = find_with(4);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const FoundLaminate alone = search.find(targets[i]);
        for (const FoundLaminate* other : {&four[i], &alone}) {
            CHECK(one[i].distance == other->distance);
            CHECK(one[i].count.visited == other->count.visited);
            CHECK(one[i].count.pruned == other->count.pruned);
            CHECK(one[i].count.judged == other->count.judged);
            REQUIRE(one[i].layers.size() == other->layers.size());
            for (std::size_t k = 0; k < one[i].layers.size(); ++k) {
                CHECK(one[i].layers[k].material == other->layers[k].material);
                CHECK(one[i].layers[k].thickness_mm == other->layers[k].thickness_mm);
            }
        }
    }
}

TEST_CASE("targets brighter, darker and wider than any laminate: the best is found and the distance said") {
    RandomStream random(26, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 1, 12);
    const LaminateSearch search(materials, {});
    const FoundLaminate bright = search.find({std::vector<double>(12, 1.2)});
    CHECK(bright.outside > 0.1);
    CHECK(bright.distance >= bright.outside);
    CHECK(bright.channels[0].target_total > bright.channels[0].most_total);
    const FoundLaminate dark = search.find({std::vector<double>(12, -0.05)});  // a noisy tail, all of it
    CHECK(dark.layers.empty());
    CHECK(dark.distance == Approx(0.05));
    CHECK(dark.outside == Approx(0.05).margin(1e-5));
    std::vector<double> wide(12, 0.0);
    wide[0] = 0.9 * bright.channels[0].most_total;  // light that comes back far away only
    const FoundLaminate widest = search.find({wide});
    CHECK(widest.distance > 0.01);
    CHECK(widest.channels[0].target_spread < widest.channels[0].found_spread);
}

TEST_CASE("one material only is searched for its thickness") {
    RandomStream random(27, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 1, 1, 12);
    LaminateSearchOptions options;
    options.tolerance = 0;
    const LaminateSearch search(materials, options);
    CHECK(search.laminates() == 65);
    const double unit_mm = options.thickness_mm / 64;
    for (int units = 1; units < 64; units += 7) {
        const std::vector<LaminateLayer> layers{{0, units * unit_mm}};
        const FoundLaminate found = search.find(laminate_reflection(materials, layers, {}));
        REQUIRE(found.layers.size() == 1);
        CHECK(found.distance < 1e-6);
    }
}

TEST_CASE("what cannot be searched is refused with its reason") {
    RandomStream random(28, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 2, 1, 6);
    const auto refused = [&](const std::vector<LaminateMaterial>& m, auto&& change, const char* word) {
        LaminateSearchOptions options;
        change(options);
        try {
            const LaminateSearch search(m, options);
            FAIL("accepted: " << word);
        } catch (const InputError& e) {
            CHECK_THAT(e.what(), Catch::Matchers::Contains(word));
        }
    };
    const auto as_it_is = [](LaminateSearchOptions&) {};
    refused({}, as_it_is, "no material");
    refused({materials[0], random_materials(random, 1, 1, 7)[0]}, as_it_is, "coefficients");
    refused({materials[0], random_materials(random, 1, 2, 6)[0]}, as_it_is, "channels");
    refused(
        materials, [](LaminateSearchOptions& o) { o.thickness_mm = 0; }, "thickness");
    refused(
        materials, [](LaminateSearchOptions& o) { o.thickness_mm = std::nan(""); }, "thickness");
    refused(
        materials, [](LaminateSearchOptions& o) { o.steps = 0; }, "steps");
    refused(
        materials, [](LaminateSearchOptions& o) { o.max_blocks = 0; }, "blocks");
    refused(
        materials, [](LaminateSearchOptions& o) { o.dc_weight = 0; }, "weight");
    refused(
        materials, [](LaminateSearchOptions& o) { o.tolerance = -1; }, "tolerance");
    refused(
        materials, [](LaminateSearchOptions& o) { o.clear_top_mm = {1}; }, "from the top");
    refused(
        materials, [](LaminateSearchOptions& o) { o.backing = {{0.1}}; }, "backing");
    refused(
        materials, [](LaminateSearchOptions& o) { o.backing = {std::vector<double>(6, 1.5)}; }, "backing");
    const LaminateSearch search(materials, {});
    CHECK_THROWS_AS(search.find({std::vector<double>(5, 0.1)}), InputError);
    CHECK_THROWS_AS(search.find({std::vector<double>(6, 0.1), std::vector<double>(6, 0.1)}), InputError);
    CHECK_THROWS_AS(search.find({std::vector<double>(6, std::nan(""))}), InputError);
}

TEST_CASE("the boxes of what can follow hold whatever follows") {
    RandomStream random(29, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 1, 9);
    LaminateSearchOptions options;
    options.steps = 40;
    const LaminateBlocks blocks(materials, options);
    const LaminateBounds bounds(blocks, 3);
    LaneBoxes lanes;
    const std::vector<float> none(9, 0.0F);
    int reached = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        BlockIndex at[3];
        std::uint32_t units = 0;
        for (BlockIndex& b : at) {
            b = static_cast<BlockIndex>(random.uniform() * static_cast<double>(blocks.size()));
            units += blocks[b].units;
        }
        if (units > 40) continue;
        std::vector<float> x = none, y(9);
        for (std::size_t k = 3; k-- > 0;) {
            blocks.cover(at[k], x, y);
            x = y;
        }
        bounds.next_block(3, units, at[0] / laminate_lanes, lanes);
        for (std::size_t i = 0; i < 9; ++i) {
            const float low = lanes.low[laminate_lanes * i + at[0] % laminate_lanes],
                        high = lanes.high[laminate_lanes * i + at[0] % laminate_lanes];
            REQUIRE(x[i] >= low - 1e-6F);
            REQUIRE(x[i] <= high + 1e-6F);
            REQUIRE(x[i] >= bounds.least()[i] - 1e-6F);
            REQUIRE(x[i] <= bounds.most()[i] + 1e-6F);
            reached += high - low < 0.05F;
        }
    }
    CHECK(reached > 1000);  // and are not just everything
}

TEST_CASE("sixteen boxes at once are what one box is by itself") {
    RandomStream random(30, 0);
    constexpr std::size_t n = 37;
    SeenThrough above;
    std::vector<float> low(n * laminate_lanes), high(n * laminate_lanes);
    for (std::size_t i = 0; i < n; ++i) {
        const auto u = [&] { return static_cast<float>(random.uniform()); };
        const float R_below = 0.8F * u(), T2 = (1 - R_below) * (1 - R_below) * u(), missing = u() - 0.5F;
        above.a.push_back(-missing);
        above.b.push_back(T2);
        above.c.push_back(R_below);
        above.q.push_back(missing > 0 ? std::min(1.0F, missing / (T2 + R_below * missing)) : 0.0F);
        for (std::size_t l = 0; l < laminate_lanes; ++l) {
            const float p = u(), q = u();
            low[i * laminate_lanes + l] = std::min(p, q);
            high[i * laminate_lanes + l] = std::max(p, q);
        }
    }
    above.tail.assign(n / lane_stride + 2, 0.0F);
    LaneSums sums;
    box_distances(above, low.data(), high.data(), 1e9F, sums);
    for (std::size_t l = 0; l < laminate_lanes; ++l) {
        double expected = 0;
        for (std::size_t i = 0; i < n; ++i) {
            double least = 1e9;  // over the box, by sampling it
            for (int k = 0; k <= 4000; ++k) {
                const double x = low[i * laminate_lanes + l] +
                                 (high[i * laminate_lanes + l] - low[i * laminate_lanes + l]) * k / 4000.0;
                least = std::min(least, std::abs(above.a[i] + above.b[i] * x / (1 - above.c[i] * x)));
            }
            expected += least * least;
        }
        CHECK(sums[l] == Approx(expected).margin(1e-4));
    }
    LaneSums cut;
    box_distances(above, low.data(), high.data(), 0.01F, cut);
    for (std::size_t l = 0; l < laminate_lanes; ++l) {
        CHECK(cut[l] <= sums[l]);
        CHECK(cut[l] >= 0.01F);
    }
}
