// SPDX-License-Identifier: GPL-3.0-or-later
#include "flat_colours.h"

#include <algorithm>
#include <cmath>

#include "halftone/separation/appearance_colour.h"
#include "halftone/separation/invert_appearance.h"
#include "halftone/separation/separation.h"
#include "halftone_patch.h"
#include "optics/colour/colour.h"

namespace voxtone {

namespace {

constexpr double core_mm = 3;

/// A made-up set, unlike Vero: stronger, with a cyan that scatters and a white that absorbs more.
optics::ResinSet strong_set() {
    optics::ResinSet set;
    set.name = "strong";
    set.resins = {{"cyan", "C", {22.0, 9.0, 6.0}, {0.30, 0.93, 0.985}},
                  {"magenta", "M", {4.0, 14.0, 6.0}, {0.97, 0.05, 0.80}},
                  {"yellow", "Y", {8.0, 7.0, 28.0}, {0.9985, 0.99, 0.25}},
                  {"black", "K", {16.0, 16.0, 16.0}, {0.10, 0.10, 0.10}},
                  {"white", "W", {14.0, 15.0, 17.0}, {0.9985, 0.9985, 0.9970}}};
    return set;
}

/// Random resins around Vero's white.
optics::ResinSet random_set(std::uint64_t seed, std::size_t resins) {
    RandomStream random(seed, 0);
    optics::ResinSet set;
    set.name = "random";
    for (std::size_t r = 0; r + 1 < resins; ++r) {
        optics::Resin resin;
        resin.name = resin.role = std::string(1, static_cast<char>('a' + r));
        for (int c = 0; c < 3; ++c) {
            resin.sigma_t_per_mm.push_back(2 * std::pow(15.0, random.uniform()));
            const double u = random.uniform();
            resin.albedo.push_back(random.bits() % 2 == 0 ? u : 1 - std::pow(10.0, -1 - 2 * u));
        }
        set.resins.push_back(resin);
    }
    set.resins.push_back(optics::vero_opaque().resins[4]);
    return set;
}

/// A colour is in gamut where a mixture shows it, by the inversion that fills the lattice.
bool in_gamut(const optics::ShellAppearance& appearance, const Eigen::Vector3d& rgb) {
    const halftone::AppearanceColour colour(appearance, {});
    const auto n = static_cast<Eigen::Index>(appearance.resins());
    const halftone::Unknowns penalty = halftone::Unknowns::Constant(n, 1e-8),
                             start = halftone::Unknowns::Constant(n, 0.4);
    return halftone::invert_appearance(colour, rgb, penalty, {}, start).error < 2e-3;
}

Eigen::Vector3d lab_of(const Seen& one, const Seen& two, std::span<const double> white) {
    Eigen::Vector3d rgb;
    for (std::size_t c = 0; c < 3; ++c)
        rgb[static_cast<Eigen::Index>(c)] = 0.5 * (one.value[c] + two.value[c]) / white[c];
    return optics::lab_from_linear_srgb(rgb);
}

Eigen::Vector3d draw(const FlatCase& the, const optics::ShellAppearance& appearance, RandomStream& random) {
    if (!the.from_mixtures) {
        const auto code = [&] { return optics::srgb_decode(0.1 + 0.9 * random.uniform()); };
        const double r = code(), g = code(), b = code();
        return {r, g, b};
    }
    std::vector<double> f(appearance.resins());
    double sum = 0;
    for (double& x : f) sum += x = -std::log(1 - random.uniform());
    for (double& x : f) x /= sum;
    return halftone::AppearanceColour(appearance, {}).rgb(f).cwiseMin(1).cwiseMax(0);
}

}  // namespace

std::vector<FlatCase> flat_cases() {
    const optics::ResinSet vero = optics::vero_opaque();
    optics::ResinSet clear = vero;
    clear.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    const std::array<double, 3> high_mix{25.4 / 600, 25.4 / 300, 0.027}, high_quality{25.4 / 600, 25.4 / 300, 0.014},
        j55{25.4 / 300, 25.4 / 300, 0.01875}, generic{0.05, 0.05, 0.025};
    std::vector<FlatCase> cases{{"Vero C M Y K W, J750 High Mix", vero, high_mix, 1.0, 48},
                                {"the same, coloured 0.4 mm deep", vero, high_mix, 0.4},
                                {"Vero C M Y K W, J750 High Quality", vero, high_quality},
                                {"Vero C M Y K W, J55", vero, j55},
                                {"Vero C M Y K W, generic 50 x 50 x 25 um", vero, generic},
                                {"Vero C M Y K W and clear, J750 High Mix", clear, high_mix, 1.0, 24, true},
                                {"strong C M Y K W, J750 High Mix", strong_set(), high_mix},
                                {"strong C M Y K W, J55", strong_set(), j55}};
    for (std::uint64_t seed : {1, 2, 3, 4})
        cases.push_back({"random resins " + std::to_string(seed) + ", J750 High Mix", random_set(seed, 3 + seed),
                         high_mix, 1.0, 12, true});
    cases.push_back({"Vero C M Y K W, J750 High Mix, error diffusion", vero, high_mix, 1.0, 24, false, false});
    return cases;
}

FlatColours measure_flat_colours(const FlatCase& the, std::uint32_t paths) {
    const int layers = static_cast<int>(std::round(the.shell_mm / the.pitch_mm[2])),
              core_layers = static_cast<int>(std::round(core_mm / the.pitch_mm[2]));
    const int resins = static_cast<int>(the.set.resins.size()), core = the.set.find("W");
    const halftone::BlueNoiseScreen screen(the.pitch_mm);
    const optics::ShellAppearance ideal(the.set, geometry_of(the.pitch_mm, core, layers, core_layers, false)),
        voxels(the.set, geometry_of(the.pitch_mm, core, layers, core_layers, true));
    const halftone::Separation by_eq7(ideal), by_voxels(voxels);
    const std::span<const double> white = ideal.white_appearance();
    const auto print = [&](const halftone::Separation& separation, const Eigen::Vector3d& rgb, std::uint64_t seed) {
        const auto r = static_cast<float>(rgb[0]), g = static_cast<float>(rgb[1]), b = static_cast<float>(rgb[2]);
        halftone::CumulativeMixture mixture;
        separation.mixtures(&r, &g, &b, 1, &mixture);
        const HalftonePatch patch = the.blue_noise
                                        ? make_patch(screen, the.pitch_mm, mixture, resins, core, layers, core_layers)
                                        : make_diffused_patch(the.pitch_mm, mixture, resins, core, layers, core_layers);
        const Seen one = look(patch, the.set, paths / 2, seed), two = look(patch, the.set, paths / 2, seed, paths / 2);
        const Eigen::Vector3d asked = optics::lab_from_linear_srgb(rgb), seen = lab_of(one, two, white);
        FlatColour colour;
        colour.rgb = rgb;
        colour.difference = optics::ciede2000(seen, asked);
        colour.lookup = separation.gamut_distance(rgb.cast<float>());
        // The halves' difference has twice the error of their mean.
        colour.noise = 0.5 * optics::ciede2000(lab_of(one, one, white), lab_of(two, two, white));
        colour.lab_difference = seen - asked;
        return colour;
    };
    FlatColours result;
    RandomStream random(11, 0);
    while (static_cast<int>(result.voxels.size()) < the.targets) {
        const Eigen::Vector3d rgb = draw(the, voxels, random);
        if (!in_gamut(ideal, rgb) || !in_gamut(voxels, rgb)) continue;
        const std::uint64_t seed = result.voxels.size();
        result.eq7.push_back(print(by_eq7, rgb, seed));
        result.voxels.push_back(print(by_voxels, rgb, seed));
    }
    return result;
}

}  // namespace voxtone
