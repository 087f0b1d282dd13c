// SPDX-License-Identifier: GPL-3.0-or-later
//
// The separation's forward model against Monte Carlo of the voxels that are printed.
#include <catch2/catch.hpp>

#include <algorithm>

#include "flat_colours.h"

using namespace voxtone;

TEST_CASE("Flat halftoned colours are within 1.0 CIEDE2000 of the target, by Eq. 7 they are not") {
    // Noise of a colour with these paths: 0.15 in the mean (the benchmark prints it).
    for (const char* name :
         {"Vero C M Y K W, J750 High Mix", "Vero C M Y K W, J55", "strong C M Y K W, J750 High Mix"}) {
        const std::vector<FlatCase> cases = flat_cases();
        FlatCase the = *std::find_if(cases.begin(), cases.end(), [&](const FlatCase& c) { return c.name == name; });
        the.targets = 10;
        const FlatColours colours = measure_flat_colours(the, 100000);
        double worst = 0, worst_by_eq7 = 0, mean = 0, mean_by_eq7 = 0;
        for (std::size_t i = 0; i < colours.voxels.size(); ++i) {
            worst = std::max(worst, colours.voxels[i].difference);
            worst_by_eq7 = std::max(worst_by_eq7, colours.eq7[i].difference);
            mean += colours.voxels[i].difference / the.targets;
            mean_by_eq7 += colours.eq7[i].difference / the.targets;
        }
        INFO(name << ": voxels " << mean << " / " << worst << ", Eq. 7 " << mean_by_eq7 << " / " << worst_by_eq7);
        CHECK(worst < 1.0);
        CHECK(mean < 0.5);
        CHECK(worst_by_eq7 > 1.5);
        CHECK(mean_by_eq7 > 2 * mean);
    }
}
