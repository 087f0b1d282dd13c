// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table of flat halftoned colours (tests/halftone/screens/flat_colours.h).
// Run: build/release/benchmarks/flat_colours [PATHS [CASE [all]]]; CASE counts from 0, -1: all of them.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "optics/colour/colour.h"
#include "tests/halftone/screens/flat_colours.h"

using namespace voxtone;

namespace {

optics::DifferenceSummary summary(const std::vector<FlatColour>& colours, double FlatColour::*figure) {
    std::vector<double> values;
    for (const FlatColour& colour : colours) values.push_back(colour.*figure);
    return optics::summarize(values);
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 200000);
    const int only = argc > 2 ? std::atoi(argv[2]) : -1;
    std::printf(
        "| case | colours | Eq. 7: mean / max | voxels: mean / max | lookup's share: mean / max | noise |\n"
        "|---|---|---|---|---|---|\n");
    int number = 0;
    for (const FlatCase& the : flat_cases()) {
        if (only >= 0 && number++ != only) continue;
        const FlatColours colours = measure_flat_colours(the, paths);
        if (argc > 3)
            for (std::size_t i = 0; i < colours.voxels.size(); ++i) {
                const FlatColour &a = colours.eq7[i], &b = colours.voxels[i];
                std::printf(
                    "  %.3f %.3f %.3f  Eq. 7 %.2f (L* %+.2f, a* %+.2f, b* %+.2f)  voxels %.2f (%+.2f, %+.2f, %+.2f), "
                    "lookup %.2f\n",
                    a.rgb[0], a.rgb[1], a.rgb[2], a.difference, a.lab_difference[0], a.lab_difference[1],
                    a.lab_difference[2], b.difference, b.lab_difference[0], b.lab_difference[1], b.lab_difference[2],
                    b.lookup);
            }
        const auto eq7 = summary(colours.eq7, &FlatColour::difference),
                   voxels = summary(colours.voxels, &FlatColour::difference),
                   lookup = summary(colours.voxels, &FlatColour::lookup),
                   noise = summary(colours.voxels, &FlatColour::noise);
        std::printf("| %s | %zu | %.2f / %.2f | %.2f / %.2f | %.2f / %.2f | %.2f |\n", the.name.c_str(),
                    colours.voxels.size(), eq7.mean, eq7.max, voxels.mean, voxels.max, lookup.mean, lookup.max,
                    noise.mean);
        std::fflush(stdout);
    }
}
