// SPDX-License-Identifier: GPL-3.0-or-later
//
// Time, nodes visited and pruned of the laminate search; materials of tests/scattering/design/resin_layers.h.
// Run: build/release/benchmarks/laminate_search_benchmark [N [TABLE]]: N coefficients per channel (64), TABLE:
// most sub-laminates in a table (12000).
//
// Targets, drawn by address:
//   slabs    three to five layers of the materials of any thickness: in the gamut of continuous thickness
//   solids   half-spaces of sigma_s' 0.5 to 20 mm^-1, sigma_a 0.002 to 0.5 mm^-1 per channel: many outside of the gamut
//   bright   0.5 to 1.2 at every coefficient of a channel: light comes back where it entered; far outside
//   widths   Sec. 8.2 of the paper, neutral: from the profile of a white solid to that of a translucent one, all of one
//   albedo
// Last comes the search of the paper as it is (tests/scattering/design/plain_laminate_search.h), on the first solids.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "base/parallel.h"
#include "tests/scattering/design/plain_laminate_search.h"
#include "tests/scattering/design/resin_layers.h"

using namespace voxtone;
using namespace voxtone::scattering;

namespace {

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

ChannelProfiles slab_target(const std::vector<LaminateMaterial>& materials, double thickness_mm,
                            std::uint64_t address) {
    RandomStream random(6, address);
    std::vector<LaminateLayer> layers;
    const auto count = static_cast<std::size_t>(3 + 3 * random.uniform());
    for (std::size_t k = 0; k < count; ++k)
        layers.push_back({std::min(materials.size() - 1,
                                   static_cast<std::size_t>(static_cast<double>(materials.size()) * random.uniform())),
                          log_uniform(random, 0.02, 1) * thickness_mm / static_cast<double>(count)});
    return laminate_reflection(materials, layers, {});
}

ChannelProfiles solid_target(std::size_t channels, std::size_t coefficients, std::uint64_t address) {
    RandomStream random(7, address);
    ChannelProfiles target;
    for (std::size_t c = 0; c < channels; ++c) {
        const double sigma_a = log_uniform(random, 0.002, 0.5);
        target.push_back(diffusing_target(sigma_a, log_uniform(random, 0.5, 20), coefficients));
    }
    return target;
}

ChannelProfiles bright_target(std::size_t channels, std::size_t coefficients, std::uint64_t address) {
    RandomStream random(8, address);
    ChannelProfiles target;
    for (std::size_t c = 0; c < channels; ++c) target.emplace_back(coefficients, 0.5 + 0.7 * random.uniform());
    return target;
}

ChannelProfiles width_target(std::size_t channels, std::size_t coefficients, double share) {
    const std::vector<double> narrow = diffusing_target(0.002, 20, coefficients),
                              wide = diffusing_target(0.005, 0.4, coefficients);
    std::vector<double> R(coefficients);
    for (std::size_t i = 0; i < coefficients; ++i)
        R[i] = 0.75 * (share * narrow[i] / narrow[0] + (1 - share) * wide[i] / wide[0]);
    return ChannelProfiles(channels, R);
}

ChannelProfiles target_of(char kind, const std::vector<LaminateMaterial>& materials, double thickness_mm,
                          std::size_t coefficients, std::uint64_t address, double share) {
    if (kind == 'l') return slab_target(materials, thickness_mm, address);
    if (kind == 'o') return solid_target(materials[0].size(), coefficients, address);
    if (kind == 'i') return width_target(materials[0].size(), coefficients, share);
    return bright_target(materials[0].size(), coefficients, address);
}

struct Case {
    std::size_t materials, channels;
    std::uint32_t steps;
    std::size_t targets;
};

void run(const Case& the, std::size_t coefficients, std::uint32_t table) {
    const std::vector<LaminateMaterial> materials = resin_layers(the.materials, the.channels, coefficients);
    for (const char* kind : {"slabs", "solids", "bright", "widths"}) {
        std::vector<ChannelProfiles> targets;
        LaminateSearchOptions options;
        options.steps = the.steps;
        if (table > 0) options.table_laminates = table;
        for (std::size_t i = 0; i < the.targets; ++i)
            targets.push_back(target_of(kind[1], materials, options.thickness_mm, coefficients, i,
                                        static_cast<double>(i) / static_cast<double>(the.targets - 1)));
        std::vector<FoundLaminate> found;
        double one_prepared, all;
        std::vector<double> times;
        double laminates;
        {
            const ThreadLimit one_thread(1);
            double start = now_ms();
            const LaminateSearch search(materials, options);
            one_prepared = now_ms() - start;
            laminates = search.laminates();
            for (const ChannelProfiles& target : targets) {
                start = now_ms();
                found.push_back(search.find(target));
                times.push_back(now_ms() - start);
            }
        }
        std::uint32_t table_blocks;
        {
            const ThreadLimit two_threads(2);
            const double start = now_ms();
            const LaminateSearch search(materials, options);
            const std::vector<FoundLaminate> again = search.find_all(targets);
            all = now_ms() - start;
            table_blocks = search.table_blocks();
        }
        double visited = 0, pruned = 0, judged = 0, distance = 0;
        for (const FoundLaminate& f : found) {
            visited += static_cast<double>(f.count.visited);
            pruned += static_cast<double>(f.count.pruned);
            judged += static_cast<double>(f.count.judged);
            distance += f.distance;
        }
        const double n = static_cast<double>(found.size());
        std::sort(times.begin(), times.end());
        std::printf(
            "| %zu | %u | %zu x %zu | %.3g | %s | %.1f | %.1f / %.1f / %.1f | %.0f / %.0f / %.0f | %.4f | %zu targets: "
            "%.0f ms, tables of %u |\n",
            the.materials, the.steps, the.channels, coefficients, laminates, kind, one_prepared,
            times[times.size() / 2], times[times.size() * 95 / 100], times.back(), visited / n, pruned / n, judged / n,
            distance / n, targets.size(), all, table_blocks);
        std::fflush(stdout);
    }
}

void run_plain(std::size_t coefficients) {
    const std::vector<LaminateMaterial> materials = resin_layers(3, 1, coefficients);
    const LaminateSearch search(materials, {});
    PlainLaminateSearch plain(materials, 5, 64);
    std::printf(
        "\n| solid | the paper's search, ms | visited | pruned | distance | this one: visited | judged | distance |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (std::uint64_t i = 0; i < 5; ++i) {
        const ChannelProfiles target = solid_target(1, coefficients, i);
        const double start = now_ms();
        const PlainLaminateSearch::Found expected = plain.find(target, 6);
        const double took = now_ms() - start;
        const FoundLaminate found = search.find(target);
        std::printf("| %d | %.0f | %llu | %llu | %.6f | %llu | %llu | %.6f |\n", static_cast<int>(i), took,
                    static_cast<unsigned long long>(expected.visited), static_cast<unsigned long long>(expected.pruned),
                    expected.distance, static_cast<unsigned long long>(found.count.visited),
                    static_cast<unsigned long long>(found.count.judged), found.distance);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t coefficients = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 64;
    const auto table = static_cast<std::uint32_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 0);
    std::printf(
        "| materials | n | channels x N | laminates | targets | tables, ms | one target on one core: median / 95 %% / "
        "max, ms "
        "| visited / pruned / judged, mean | distance, mean | together on two threads, tables included |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    run({3, 1, 64, 100}, coefficients, table);
    run({3, 3, 64, 100}, coefficients, table);
    run({6, 1, 256, 20}, coefficients, table);
    run({6, 3, 256, 20}, coefficients, table);
    run_plain(coefficients);
}
