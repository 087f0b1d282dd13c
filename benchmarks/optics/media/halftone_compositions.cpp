// SPDX-License-Identifier: GPL-3.0-or-later
//
// The departure of halftones of Vero resins from Eq. 7 as a function of composition and voxel shape: mixtures of two
// resins, 1 mm over 1.5 mm of white on a black sheet, appearance by Monte Carlo and by the medium of voxels, both
// against Eq. 7. Comma-separated values; halftone_departure.cpp is of random resins.
// Run: build/release/benchmarks/halftone_compositions [PATHS]
#include <cstdio>
#include <cstdlib>

#include "tests/halftone/screens/halftone_patch.h"

int main(int argc, char** argv) {
    using namespace voxtone;
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 400000);
    struct Shape {
        const char* name;
        std::array<double, 3> pitch_mm;
    };
    constexpr double dpi600 = 25.4 / 600, dpi300 = 25.4 / 300;
    const std::array<Shape, 4> shapes{{{"J750 High Mix", {dpi600, dpi300, 0.027}},
                                       {"J750 High Quality", {dpi600, dpi300, 0.014}},
                                       {"J55", {dpi300, dpi300, 0.01875}},
                                       {"cubes of 42 um", {dpi600, dpi600, dpi600}}}};
    struct Pair {
        const char *first, *second, *channel_name;
        std::size_t channel;
    };
    const std::array<Pair, 6> pairs{{{"Y", "W", "blue", 2},
                                     {"C", "W", "red", 0},
                                     {"K", "W", "green", 1},
                                     {"Y", "C", "blue", 2},
                                     {"M", "Y", "green", 1},
                                     {"Y", "M", "blue", 2}}};
    const optics::ResinSet set = optics::vero_opaque();
    const int core = set.find("W");
    std::printf("voxels,first,second,channel,share,eq7,medium,seen,error\n");
    for (const Shape& shape : shapes) {
        const halftone::BlueNoiseScreen screen(shape.pitch_mm);
        const int layers = static_cast<int>(std::round(1 / shape.pitch_mm[2])),
                  core_layers = static_cast<int>(std::round(1.5 / shape.pitch_mm[2]));
        const optics::ShellAppearance ideal(set, geometry_of(shape.pitch_mm, core, layers, core_layers, false)),
            voxels(set, geometry_of(shape.pitch_mm, core, layers, core_layers, true));
        for (const Pair& pair : pairs)
            for (const double share : {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95}) {
                std::vector<double> f(set.resins.size(), 0.0);
                f[static_cast<std::size_t>(set.find(pair.first))] = share;
                f[static_cast<std::size_t>(set.find(pair.second))] = 1 - share;
                const HalftonePatch patch =
                    make_patch(screen, shape.pitch_mm, cumulative(f), 5, core, layers, core_layers);
                const Seen seen = look(patch, set, paths, 1);
                std::printf("%s,%s,%s,%s,%.2f,%.5f,%.5f,%.5f,%.5f\n", shape.name, pair.first, pair.second,
                            pair.channel_name, share, ideal.appearance(patch.fractions)[pair.channel],
                            voxels.appearance(patch.fractions)[pair.channel], seen.value[pair.channel],
                            seen.standard_error[pair.channel]);
                std::fflush(stdout);
            }
    }
}
