// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layered-profile appearance model against exact solutions and Monte Carlo (docs/laminate-search.md), Vero Opaque,
// RGB.
//
//   layered_profile_benchmark [paths per cell and channel, default 4096]
//
// Plane-parallel slabs against layered_appearance.h (exact to 2e-6); a free-standing wall and a slab with a picture of
// patches of 1 mm, both open at their sides, against Monte Carlo. Prints Markdown tables.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>

#include "base/random.h"
#include "benchmarks/optics/transport/reference_file.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/profiles/layered_profile_model.h"
#include "tests/optics/transport/slab_scene.h"
#include "tests/places.h"

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
        "| slab, mm | backing | R exact | model | G exact | model | B exact | model "
        "|\n|---|---|---|---|---|---|---|---|\n");
    double worst = 0, sum = 0;
    int count = 0;
    for (const Named& slab : slabs())
        for (const Backing backing : {Backing::none, Backing::black}) {
            const Appearance seen = slab_appearance(model, set(), slab.layers, backing);
            std::printf("| %s | %s |", slab.name, backing == Backing::none ? "none" : "black");
            for (std::size_t c = 0; c < 3; ++c) {
                const double exact = exact_appearance(set(), slab.layers, backing, c),
                             off = std::abs(seen.value[c] - exact);
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
                difference(truth, truth).mean, without.mean, with.mean, without.rms, with.rms, without.worst,
                with.worst, noise);
}

// The suite of the transport predictor's accuracy: halftoned photographs, gratings, bodies, each with two independent
// halves of Monte Carlo, so that the product of the differences from both has no noise in it.
void against_suite() {
    namespace fs = std::filesystem;
    std::printf(
        "\n| case of the accuracy suite | groups of cells | mean, Monte Carlo | own layers alone | with sideways light "
        "| root mean square without noise, "
        "own layers | with sideways light |\n|---|---|---|---|---|---|---|\n");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(voxtone::test::source_dir()) / "tests/data/appearance"))
        if (entry.path().extension() == ".ref") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        const voxtone::accuracy::Reference reference = voxtone::accuracy::read_reference(file);
        const Scene scene = reference.of.scene();
        const Surface surface = find_surface(scene, voxtone::accuracy::viewing_cell, reference.of.part);
        const voxtone::accuracy::Groups groups = voxtone::accuracy::group_cells(reference.of, surface);
        std::array<double, 2> mean{}, product{};
        double truth = 0;
        for (const bool sideways : {false, true}) {
            const Appearance model = LayeredProfileModel({.sideways = sideways}).predict(scene, surface);
            for (std::size_t g = 0; g < groups.first_cell.size(); ++g)
                for (std::size_t c = 0; c < model.channels; ++c) {
                    const double P = model.value[groups.first_cell[g] * model.channels + c],
                                 M1 = reference.half[0][g * model.channels + c],
                                 M2 = reference.half[1][g * model.channels + c];
                    mean[sideways] += P;
                    product[sideways] += (P - M1) * (P - M2);
                    if (sideways) truth += 0.5 * (M1 + M2);
                }
        }
        const auto n = static_cast<double>(reference.half[0].size());
        std::printf("| %s | %zu | %.4f | %.4f | %.4f | %.4f | %.4f |\n", reference.of.name.c_str(),
                    groups.first_cell.size(), truth / n, mean[0] / n, mean[1] / n,
                    std::sqrt(std::max(0.0, product[0] / n)), std::sqrt(std::max(0.0, product[1] / n)));
        std::fflush(stdout);
    }
}

// A picture of 250,000 cells, 3 mm deep.
void seconds_of_many_cells() {
    const std::array<Material, 5> colours{resin("C"), resin("M"), resin("Y"), resin("K"), resin("W")};
    const ResinVolume picture = make_resin_volume({2000, 1000, 111}, slab_pitch_mm, [&](int x, int y, int z) {
        return z < 104 ? colours[4] : colours[static_cast<std::size_t>(x / 24 + 2 * (y / 12)) % 5];
    });
    const Scene scene{&picture, &set(), Backing::black, Sides::open};
    const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::top);
    for (const bool sideways : {false, true}) {
        const std::clock_t start = std::clock();
        (void)LayeredProfileModel({.sideways = sideways}).predict(scene, surface);
        const double s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        std::printf("%s%zu cells, %s: %.2f core seconds\n", sideways ? "" : "\n", surface.cells.size(),
                    sideways ? "with sideways light" : "own layers alone", s);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 4096);
    plane_parallel();
    std::printf(
        "| body | cells | mean, Monte Carlo | own layers alone | with sideways light | root mean square, own layers | "
        "with sideways light "
        "| largest, own layers | with sideways light | noise of Monte Carlo "
        "|\n|---|---|---|---|---|---|---|---|---|---|\n");
    const Material C = resin("C"), M = resin("M"), Y = resin("Y"), K = resin("K"), W = resin("W");
    // 4 x 3 x 3 mm about a wall of 1 mm, white on the left, magenta on the right.
    const ResinVolume wall = make_resin_volume({28, 36, 112}, slab_pitch_mm, [&](int x, int, int) {
        return x < 2 || x >= 26 ? air : x < 14 ? W : M;
    });
    against_monte_carlo("wall, W 0.5 and M 0.5 mm, 3 x 3 mm, free", wall, Backing::none, Sides::open, SurfacePart::all,
                        paths);
    // 5 x 5 x 2 mm: patches of colour 0.19 mm deep on white.
    const std::array<Material, 5> colours{C, M, Y, K, W};
    const auto picture = [&](int x_voxels) {
        return make_resin_volume({120, 60, 74}, slab_pitch_mm, [&, x_voxels](int x, int y, int z) {
            return z < 67 ? W : colours[static_cast<std::size_t>(x / x_voxels + 2 * (y / (x_voxels / 2))) % 5];
        });
    };
    for (const auto& [name, x_voxels] : {std::pair{"0.25", 6}, {"0.5", 12}, {"1", 24}, {"2", 48}}) {
        const std::string patches = std::string("patches of ") + name + " mm on white, black below, ";
        against_monte_carlo((patches + "mirrored sides").c_str(), picture(x_voxels), Backing::black, Sides::mirrored,
                            SurfacePart::top, paths);
        if (x_voxels >= 24)
            against_monte_carlo((patches + "open sides").c_str(), picture(x_voxels), Backing::black, Sides::open,
                                SurfacePart::top, paths);
    }
    // A picture of fine and coarse detail: rings that get finer outwards, each voxel of the upper 0.19 mm C, M, Y, K or
    // W by chance.
    const ResinVolume rings = make_resin_volume({160, 80, 74}, slab_pitch_mm, [&](int x, int y, int z) {
        if (z < 67) return W;
        const double at_x = x * slab_pitch_mm[0], at_y = y * slab_pitch_mm[1], r2 = at_x * at_x + at_y * at_y;
        voxtone::RandomStream random(1, static_cast<std::uint64_t>((z * 80 + y) * 160 + x));
        if (random.uniform() > 0.5 + 0.5 * std::cos(0.45 * r2)) return W;
        return colours[static_cast<std::size_t>(std::atan2(at_y, at_x) / 1.5708 * 3.999)];
    });
    against_monte_carlo("halftoned rings, ever finer outwards, mirrored sides", rings, Backing::black, Sides::mirrored,
                        SurfacePart::top, paths);
    // An edge across: one material all the way down on each side, 4 x 0.3 mm with mirrored sides.
    const std::array<std::pair<const char*, std::array<Material, 2>>, 4> edges{
        {{"edge, W and K", {W, K}}, {"edge, W and M", {W, M}}, {"edge, W and C", {W, C}}, {"edge, Y and M", {Y, M}}}};
    for (const auto& [name, of] : edges) {
        const ResinVolume edge =
            make_resin_volume({96, 4, 74}, slab_pitch_mm, [&](int x, int, int) { return of[x < 48 ? 0 : 1]; });
        against_monte_carlo((std::string(name) + ", 2 mm deep, black").c_str(), edge, Backing::black, Sides::mirrored,
                            SurfacePart::top, 4 * paths);
    }
    against_suite();
    seconds_of_many_cells();
    return 0;
}
