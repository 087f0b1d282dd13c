// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layered-profile appearance model against exact solutions and Monte Carlo (docs/stack-search.md), Vero Opaque, RGB.
//
//   layered_profile_benchmark [paths per cell and channel, default 4096]
//
// Plane-parallel slabs against layered_appearance.h (exact to 2e-6); a free-standing wall and a slab with a picture of patches
// of 1 mm, both open at their sides, against Monte Carlo. Prints Markdown tables.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

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

struct Difference {
    double mean = 0, rms = 0, worst = 0;
};

Difference difference(const Appearance& model, const Appearance& truth) {
    Difference d;
    for (std::size_t i = 0; i < truth.value.size(); ++i) {
        const double off = model.value[i] - truth.value[i];
        d.mean += model.value[i];
        d.rms += off * off;
        d.worst = std::max(d.worst, std::abs(off));
    }
    const auto n = static_cast<double>(truth.value.size());
    return {d.mean / n, std::sqrt(d.rms / n), d.worst};
}

void against_monte_carlo(const char* name, const ResinVolume& volume, Backing backing, Sides sides, SurfacePart part,
                         std::uint32_t paths) {
    const Scene scene{&volume, &set(), backing, sides};
    const Surface surface = find_surface(scene, {4, 2, 6}, part);
    MonteCarloOptions options;
    options.paths = paths;
    const Appearance truth = MonteCarlo(options).predict(scene, surface);
    double noise = 0;
    for (const float error : truth.standard_error) noise += error * error;
    noise = std::sqrt(noise / static_cast<double>(truth.value.size()));
    const Difference without = difference(LayeredProfileModel({.sideways = false}).predict(scene, surface), truth),
                     with = difference(LayeredProfileModel().predict(scene, surface), truth);
    std::printf("| %s | %zu | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f |\n", name, surface.cells.size(),
                difference(truth, truth).mean, without.mean, with.mean, without.rms, with.rms, without.worst, with.worst, noise);
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 4096);
    plane_parallel();
    std::printf(
        "| body | cells | mean, Monte Carlo | own layers alone | with sideways light | root mean square, own layers | with sideways light "
        "| largest, own layers | with sideways light | noise of Monte Carlo |\n|---|---|---|---|---|---|---|---|---|---|\n");
    const Material C = resin("C"), M = resin("M"), Y = resin("Y"), K = resin("K"), W = resin("W");
    // 4 x 3 x 3 mm about a wall of 1 mm, white on the left, magenta on the right.
    const ResinVolume wall = make_resin_volume({28, 36, 112}, slab_pitch_mm, [&](int x, int, int) {
        return x < 2 || x >= 26 ? air : x < 14 ? W : M;
    });
    against_monte_carlo("wall, W 0.5 and M 0.5 mm, 3 x 3 mm, free", wall, Backing::none, Sides::open, SurfacePart::all, paths);
    // 5 x 5 x 2 mm: patches of colour 0.2 mm deep on white.
    const std::array<Material, 5> colours{C, M, Y, K, W};
    for (const int voxels : {6, 12, 24, 48}) {
        const ResinVolume picture = make_resin_volume({118, 59, 74}, slab_pitch_mm, [&](int x, int y, int z) {
            return z < 67 ? W : colours[static_cast<std::size_t>(x / voxels + 2 * (y / (voxels / 2))) % 5];
        });
        const std::string name = "picture slab, patches of " + std::to_string(voxels) + " voxels, 0.19 mm deep, on W 1.8, black";
        against_monte_carlo(name.c_str(), picture, Backing::black, Sides::open, SurfacePart::top, paths);
    }
    // An edge across: one material all the way down on each side, 4 x 0.3 mm with mirrored sides.
    const std::array<std::pair<const char*, std::array<Material, 2>>, 4> edges{
        {{"edge, W and K", {W, K}}, {"edge, W and M", {W, M}}, {"edge, W and C", {W, C}}, {"edge, Y and M", {Y, M}}}};
    for (const auto& [name, of] : edges) {
        const ResinVolume edge = make_resin_volume({96, 4, 74}, slab_pitch_mm, [&](int x, int, int) { return of[x < 48 ? 0 : 1]; });
        against_monte_carlo((std::string(name) + ", 2 mm deep, black").c_str(), edge, Backing::black, Sides::mirrored,
                            SurfacePart::top, 4 * paths);
    }
    return 0;
}
