// SPDX-License-Identifier: GPL-3.0-or-later
#include "flat_cases.h"

#include <cmath>

#include <fmt/format.h>

namespace voxtone::accuracy {
namespace {

using namespace optics;
using namespace resin;

constexpr int skin_floor = slab_layers - skin_layers;

template <class MaterialOf>
SuiteCase slab(std::string name, std::string shown, int nx, int ny, Symmetry symmetry, double noise,
               MaterialOf&& material_of) {
    SuiteCase c;
    c.name = std::move(name);
    c.shown = std::move(shown);
    c.resins = suite_resins();
    c.symmetry = symmetry;
    c.noise = noise;
    c.volume = make_resin_volume({nx, ny, slab_layers}, j750_mm, material_of);
    return c;
}

/// Bars of black and white, `half` voxels wide each, through the whole skin. The domain begins in the middle of a bar.
SuiteCase grating(const char* name, int half) {
    const double per_mm = 1 / (2 * half * j750_mm[0]);
    return slab(fmt::format("grating-{}", name), fmt::format("black and white bars, {:.2f} line pairs/mm", per_mm), 96,
                24, Symmetry::along_y, 0.12,
                [half](int x, int, int z) { return z >= skin_floor && (2 * x + half) / (2 * half) % 2 == 0 ? K : W; });
}

/// White as dense as some inks are made, 40, 60 and 100 per mm: cells of the eye are 1.7 to 4.3 transport mean free
/// paths thick in it, and light spreads sideways by diffusion alone.
SuiteCase dense(SuiteCase c) {
    c.resins.name += ", white of 40, 60 and 100 per mm";
    c.resins.resins[W - 1].sigma_t_per_mm = {40, 60, 100};
    c.tuning = false;
    return c;
}

}  // namespace

std::vector<SuiteCase> flat_cases() {
    std::vector<SuiteCase> cases;
    cases.push_back(slab("edge", "black beside white, 2 mm each", 96, 24, Symmetry::along_y, 0.12,
                         [](int x, int, int z) { return z >= skin_floor && x < 48 ? K : W; }));
    cases.push_back(grating("0.25", 48));
    cases.push_back(grating("0.5", 24));
    cases.push_back(grating("1", 12));
    cases.push_back(grating("2", 6));
    cases.push_back(grating("4", 3));
    cases.push_back(dense(grating("1-dense", 12)));
    constexpr std::array<const char*, 4> role{"C", "M", "Y", "K"};
    for (std::size_t r = 0; r < role.size(); ++r) {
        const auto ink = static_cast<Material>(r + 1);
        // One viewing cell, 2 x 1 x 3 voxels, in the middle of 21 x 21.
        cases.push_back(
            slab(fmt::format("dot-{}", role[r]), fmt::format("a dot of {} in white, 0.085 x 0.085 x 0.081 mm", role[r]),
                 42, 21, Symmetry::mirror_xy, 0.15,
                 [ink](int x, int y, int z) { return z >= slab_layers - 3 && x / 2 == 10 && y == 10 ? ink : W; }));
        cases.push_back(slab(fmt::format("line-{}", role[r]),
                             fmt::format("a line of {} in white, 0.085 x 0.081 mm", role[r]), 42, 21, Symmetry::along_y,
                             0.08, [ink](int x, int, int z) { return z >= slab_layers - 3 && x / 2 == 10 ? ink : W; }));
    }
    cases.push_back(
        dense(slab("line-K-dense", "a line of K in dense white, 0.085 x 0.081 mm", 42, 21, Symmetry::along_y, 0.08,
                   [](int x, int, int z) { return z >= slab_layers - 3 && x / 2 == 10 ? K : W; })));
    return cases;
}

}  // namespace voxtone::accuracy
