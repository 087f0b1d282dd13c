// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layered-profile appearance model against exact solutions and Monte Carlo (docs/stack-search.md), Vero Opaque, RGB.
//
//   layered_profile_benchmark [paths per cell and channel, default 4096]
//
// Plane-parallel slabs against layered_appearance.h (exact to 2e-6); a free-standing wall and a slab with a picture of patches
// of 1 mm, both open at their sides, against Monte Carlo. Prints Markdown tables.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/optics/slab_scene.h"
#include "voxtone/optics/layered_profile_model.h"
#include "voxtone/optics/monte_carlo.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

const ResinSet& set() {
    static const ResinSet vero = vero_opaque();
    return vero;
}

Material resin(const char* role) { return static_cast<Material>(set().find(role) + 1); }

struct Named {
    const char* name;
    std::vector<SlabLayer> layers;
};

std::vector<Named> slabs() {
    const Material C = resin("C"), M = resin("M"), Y = resin("Y"), K = resin("K"), W = resin("W");
    return {{"W 2", {{W, 74}}},
            {"C 2", {{C, 74}}},
            {"M 2", {{M, 74}}},
            {"Y 2", {{Y, 74}}},
            {"K 2", {{K, 74}}},
            {"W 0.49", {{W, 18}}},
            {"W 0.11 (film)", {{W, 4}}},
            {"M 0.3 / W 4", {{M, 11}, {W, 148}}},
            {"Y 0.3 / W 4", {{Y, 11}, {W, 148}}},
            {"C 0.054 / W 4 (film)", {{C, 2}, {W, 148}}},
            {"M 0.1 / Y 0.2 / W 4", {{M, 4}, {Y, 7}, {W, 148}}},
            {"W 0.24 / K 0.24", {{W, 9}, {K, 9}}},
            {"K 0.24 / W 0.24", {{K, 9}, {W, 9}}}};
}

void plane_parallel() {
    const LayeredProfileModel model;
    std::printf(
        "| slab, mm | backing | R exact | model | G exact | model | B exact | model |\n|---|---|---|---|---|---|---|---|\n");
    double worst = 0, sum = 0;
    int count = 0;
    for (const Named& slab : slabs())
        for (const Backing backing : {Backing::none, Backing::black}) {
            const Appearance seen = slab_appearance(model, set(), slab.layers, backing);
            std::printf("| %s | %s |", slab.name, backing == Backing::none ? "none" : "black");
            for (std::size_t c = 0; c < 3; ++c) {
                const double exact = exact_appearance(set(), slab.layers, backing, c), off = std::abs(seen.value[c] - exact);
                std::printf(" %.4f | %.4f |", exact, static_cast<double>(seen.value[c]));
                worst = std::max(worst, off), sum += off, ++count;
            }
            std::printf("\n");
        }
    std::printf("\nmean error %.4f, worst %.4f\n\n", sum / count, worst);
}

void against_monte_carlo(const char* name, const ResinVolume& volume, Backing backing, SurfacePart part, std::uint32_t paths) {
    const Scene scene{&volume, &set(), backing, Sides::open};
    const Surface surface = find_surface(scene, {4, 2, 6}, part);
    const auto start = std::chrono::steady_clock::now();
    const Appearance model = LayeredProfileModel().predict(scene, surface);
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    MonteCarloOptions options;
    options.paths = paths;
    const Appearance truth = MonteCarlo(options).predict(scene, surface);
    double square = 0, noise = 0, mean_model = 0, mean_truth = 0, worst = 0;
    for (std::size_t i = 0; i < truth.value.size(); ++i) {
        const double off = model.value[i] - truth.value[i];
        square += off * off;
        noise += truth.standard_error[i] * truth.standard_error[i];
        worst = std::max(worst, std::abs(off));
        mean_model += model.value[i], mean_truth += truth.value[i];
    }
    const auto n = static_cast<double>(truth.value.size());
    std::printf("| %s | %zu | %.4f | %.4f | %.4f | %.4f | %.4f | %.2f |\n", name, surface.cells.size(), mean_truth / n,
                mean_model / n, std::sqrt(square / n), worst, std::sqrt(noise / n), s);
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 4096);
    plane_parallel();
    std::printf(
        "| body | cells | mean, Monte Carlo | mean, model | root mean square of the difference | largest | noise of Monte Carlo "
        "in it "
        "| model, s |\n|---|---|---|---|---|---|---|---|\n");
    const Material C = resin("C"), M = resin("M"), Y = resin("Y"), K = resin("K"), W = resin("W");
    // 4 x 3 x 3 mm about a wall of 1 mm, white on the left, magenta on the right.
    const ResinVolume wall = make_resin_volume({28, 36, 112}, slab_pitch_mm, [&](int x, int, int) {
        return x < 2 || x >= 26 ? air : x < 14 ? W : M;
    });
    against_monte_carlo("wall, W 0.5 and M 0.5 mm, 3 x 3 mm, free", wall, Backing::none, SurfacePart::all, paths);
    // 5 x 5 x 2 mm: patches of 1 mm of colour 0.2 mm deep on white.
    const std::array<Material, 5> colours{C, M, Y, K, W};
    const ResinVolume picture = make_resin_volume({118, 59, 74}, slab_pitch_mm, [&](int x, int y, int z) {
        return z < 67 ? W : colours[static_cast<std::size_t>(x / 24 + 2 * (y / 12)) % 5];
    });
    against_monte_carlo("picture slab, patches of 1 mm, 0.19 mm deep, on W 1.8, black", picture, Backing::black, SurfacePart::top,
                        paths);
    return 0;
}
