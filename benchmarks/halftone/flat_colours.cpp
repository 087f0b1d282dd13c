// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a flat halftoned colour, printed as `slice` would, is from what was asked for: targets in gamut are separated
// by Eq. 7 and by the medium of voxels, screened with the printer's screen, and the voxels judged by Monte Carlo.
// Run: build/release/benchmarks/halftone/flat_colours [PATHS] [CASE]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "halftone_patch.h"
#include "voxtone/base/parallel.h"
#include "voxtone/halftone/appearance_colour.h"
#include "voxtone/halftone/invert_appearance.h"
#include "voxtone/halftone/separation.h"
#include "voxtone/optics/colour.h"

namespace {

using namespace voxtone;

struct Case {
    const char* name;
    optics::ResinSet set;
    std::array<double, 3> pitch_mm;
    double shell_mm;
    int targets;
};

/// A made-up set, unlike Vero: stronger, with a cyan that scatters and a white that absorbs more.
optics::ResinSet other_set() {
    optics::ResinSet set;
    set.name = "made-up";
    set.resins = {{"cyan", "C", {22.0, 9.0, 6.0}, {0.30, 0.93, 0.985}},
                  {"magenta", "M", {4.0, 14.0, 6.0}, {0.97, 0.05, 0.80}},
                  {"yellow", "Y", {8.0, 7.0, 28.0}, {0.9985, 0.99, 0.25}},
                  {"black", "K", {16.0, 16.0, 16.0}, {0.10, 0.10, 0.10}},
                  {"white", "W", {14.0, 15.0, 17.0}, {0.9985, 0.9985, 0.9970}}};
    return set;
}

std::vector<Case> cases() {
    const optics::ResinSet vero = optics::vero_opaque();
    const std::vector<std::string> three{"C", "M", "W"};
    return {{"Vero C M Y K W, J750 High Mix, 1 mm", vero, {25.4 / 600, 25.4 / 300, 0.027}, 1.0, 48},
            {"the same, coloured 0.4 mm deep", vero, {25.4 / 600, 25.4 / 300, 0.027}, 0.4, 24},
            {"Vero C M Y K W, J750 High Quality, 1 mm", vero, {25.4 / 600, 25.4 / 300, 0.014}, 1.0, 24},
            {"Vero C M Y K W, J55, 1 mm", vero, {25.4 / 300, 25.4 / 300, 0.01875}, 1.0, 24},
            {"made-up C M Y K W, J750 High Mix, 1 mm", other_set(), {25.4 / 600, 25.4 / 300, 0.027}, 1.0, 24}};
}

/// A colour is in gamut where a mixture shows it, by the inversion that fills the lattice.
bool in_gamut(const optics::ShellAppearance& appearance, const Eigen::Vector3d& rgb) {
    const halftone::AppearanceColour colour(appearance, {});
    const auto n = static_cast<Eigen::Index>(appearance.resins());
    const halftone::Unknowns penalty = halftone::Unknowns::Constant(n, 1e-8), start = halftone::Unknowns::Constant(n, 0.4);
    return halftone::invert_appearance(colour, rgb, penalty, {}, start).error < 2e-3;
}

Eigen::Vector3d lab_of(const Seen& seen, std::span<const double> white) {
    Eigen::Vector3d rgb;
    for (std::size_t c = 0; c < 3; ++c) rgb[static_cast<Eigen::Index>(c)] = seen.value[c] / white[c];
    return optics::lab_from_linear_srgb(rgb);
}

void run(const Case& the, std::uint32_t paths) {
    const int layers = static_cast<int>(std::round(the.shell_mm / the.pitch_mm[2])),
              core_layers = static_cast<int>(std::round(3.0 / the.pitch_mm[2]));
    const int resins = static_cast<int>(the.set.resins.size()), core = the.set.find("W");
    const halftone::BlueNoiseScreen screen(the.pitch_mm);
    const optics::ShellAppearance ideal(the.set, geometry_of(the.pitch_mm, core, layers, core_layers, false)),
        voxels(the.set, geometry_of(the.pitch_mm, core, layers, core_layers, true));
    const std::array<halftone::Separation, 2> separation{halftone::Separation(ideal), halftone::Separation(voxels)};
    std::array<std::vector<double>, 2> difference, lookup;
    double noise = 0;
    RandomStream random(11, 0);
    for (int k = 0; k < the.targets;) {
        // Even in Lab's sense: sRGB codes.
        Eigen::Vector3d rgb;
        for (double& x : rgb) x = optics::srgb_decode(0.1 + 0.9 * random.uniform());
        if (!in_gamut(ideal, rgb) || !in_gamut(voxels, rgb)) continue;
        const Eigen::Vector3d target = optics::lab_from_linear_srgb(rgb);
        std::printf("  %3d  %.3f %.3f %.3f ", k, rgb[0], rgb[1], rgb[2]);
        for (std::size_t m = 0; m < 2; ++m) {
            const auto r = static_cast<float>(rgb[0]), g = static_cast<float>(rgb[1]), b = static_cast<float>(rgb[2]);
            halftone::CumulativeMixture mixture;
            separation[m].mixtures(&r, &g, &b, 1, &mixture);
            const HalftonePatch patch = make_patch(screen, the.pitch_mm, mixture, resins, core, layers, core_layers);
            const auto seed = static_cast<std::uint64_t>(k);
            const Seen one = look(patch, the.set, paths / 2, seed), two = look(patch, the.set, paths / 2, seed, paths / 2);
            const Eigen::Vector3d a = lab_of(one, ideal.white_appearance()), c = lab_of(two, ideal.white_appearance());
            // The halves' difference has twice the error of their mean.
            noise += 0.5 * optics::ciede2000(a, c) / (2 * the.targets);
            Seen both = one;
            for (std::size_t i = 0; i < 3; ++i) both.value[i] = 0.5 * (one.value[i] + two.value[i]);
            const Eigen::Vector3d lab = lab_of(both, ideal.white_appearance());
            difference[m].push_back(optics::ciede2000(lab, target));
            lookup[m].push_back(separation[m].mapping_distance(rgb.cast<float>()));
            std::printf("  %5.2f (%.2f; %+.2f %+.2f %+.2f)", difference[m].back(), lookup[m].back(), lab[0] - target[0],
                        lab[1] - target[1], lab[2] - target[2]);
        }
        std::printf("\n");
        std::fflush(stdout);
        ++k;
    }
    const auto eq7 = optics::summarize(difference[0]), medium = optics::summarize(difference[1]),
               table = optics::summarize(lookup[1]);
    std::printf("| %s | %d | %.2f / %.2f | %.2f / %.2f | %.2f / %.2f | %.2f |\n", the.name, the.targets, eq7.mean, eq7.max,
                medium.mean, medium.max, table.mean, table.max, noise);
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 400000);
    const int only = argc > 2 ? std::atoi(argv[2]) : -1;
    std::printf("| case | colours | Eq. 7, mean / max CIEDE2000 | voxels, mean / max | of that the lattice's lookup | noise |\n");
    int i = 0;
    for (const Case& the : cases())
        if (int(i++) == only || only < 0) run(the, paths);
}
