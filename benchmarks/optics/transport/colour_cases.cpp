// SPDX-License-Identifier: GPL-3.0-or-later
#include "colour_cases.h"

#include <cmath>

#include <fmt/format.h>

#include "base/random.h"
#include "halftone_skin.h"
#include "optics/colour/colour.h"

namespace voxtone::accuracy {
namespace {

using namespace optics;
using namespace resin;
using halftone::CumulativeMixture;

const std::vector<std::string> cmykw{"C", "M", "Y", "K", "W"};
constexpr std::array<std::array<int, 3>, 8> hues{{{205, 60, 50},
                                                  {225, 140, 55},
                                                  {235, 210, 75},
                                                  {75, 150, 85},
                                                  {70, 170, 190},
                                                  {55, 80, 160},
                                                  {120, 60, 140},
                                                  {215, 110, 150}}};

/// Patches of 10 x 10 viewing cells, 4 x 2 of them.
constexpr int patch = 10, patches_x = 4, nx = 2 * patch * patches_x, ny = 2 * patch;
int patch_at(int x, int y) { return y / patch * patches_x + x / (2 * patch); }

template <class MaterialOf>
SuiteCase colours(std::string name, std::string shown, int layers, Backing backing, MaterialOf&& material_of) {
    SuiteCase c;
    c.name = std::move(name);
    c.shown = std::move(shown);
    c.resins = suite_resins();
    c.backing = backing;
    c.noise = 0.35;
    c.volume = make_resin_volume({nx, ny, layers}, j750_mm, material_of);
    return c;
}

std::vector<CumulativeMixture> hue_mixtures(const HalftoneSkin& skin) {
    std::vector<CumulativeMixture> mixtures;
    for (const auto& h : hues) mixtures.push_back(skin.of_code(h[0], h[1], h[2]));
    return mixtures;
}

std::vector<CumulativeMixture> grey_mixtures(const HalftoneSkin& skin) {
    std::vector<CumulativeMixture> mixtures;
    for (int i = 0; i < 8; ++i)
        mixtures.push_back(skin.of_linear(linear_srgb_from_lab({20.0 + 10 * i, 0, 0}).cast<float>()));
    return mixtures;
}

/// Hues and light tints in front; behind, black bars as wide as they are apart. Both skins 0.243 mm, or half the wall.
std::vector<SuiteCase> walls(const HalftoneSkin& skin) {
    std::vector<SuiteCase> cases;
    std::vector<CumulativeMixture> front = hue_mixtures(skin);
    for (std::size_t i = 0; i < 4; ++i)  // the second row of patches: tints
        front[4 + i] = skin.of_code((255 + hues[i][0]) / 2, (255 + hues[i][1]) / 2, (255 + hues[i][2]) / 2);
    struct Under {
        Backing backing;
        const char *name, *words;
    };
    for (const auto& [layers, mm] : {std::pair{9, "0.25"}, {18, "0.5"}, {37, "1"}})
        for (const Under& under :
             {Under{Backing::black, "black", "over black"}, Under{Backing::white, "white", "over white"},
              Under{Backing::none, "lit", "lit through"}}) {
            const int depth = std::min(9, layers / 2), whole = layers;
            cases.push_back(colours(fmt::format("wall-{}-{}", mm, under.name),
                                    fmt::format("{} mm wall, {}", mm, under.words), layers, under.backing,
                                    [&, depth, whole](int x, int y, int z) {
                                        if (z >= whole - depth)
                                            return skin.at(front[static_cast<std::size_t>(patch_at(x, y))], x, y, z);
                                        return z < depth && x / patch % 2 == 0 ? K : W;
                                    }));
        }
    return cases;
}

/// Five resins drawn at random, as different from the set of the suite as resins may be: three that absorb in one or
/// two channels, a dark one, a white one.
ResinSet random_resins(std::uint64_t seed) {
    RandomStream random(seed, 0);
    const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
    const auto extinction = [&] { return 2 * std::pow(12.0, random.uniform()); };  // 2 to 24 / mm
    ResinSet set;
    set.name = fmt::format("random {}", seed);
    set.source = "drawn at random";
    set.g = between(0.2, 0.7);
    set.eta = between(1.42, 1.55);
    for (const char role : {'A', 'B', 'D', 'K', 'W'}) {
        Resin r;
        r.role.assign(1, role);
        r.name = r.role;
        const std::size_t hue =
            role - 'A' == 3 ? 2 : static_cast<std::size_t>(role - 'A');  // A, B, D: which channel it absorbs
        for (std::size_t c = 0; c < 3; ++c) {
            r.sigma_t_per_mm.push_back(extinction());
            const bool absorbs = c == hue || random.uniform() < 0.2;
            r.albedo.push_back(role == 'W'   ? between(0.9985, 0.9998)
                               : role == 'K' ? between(0.2, 0.6)
                               : absorbs     ? between(0.05, 0.7)
                                             : between(0.9, 0.998));
        }
        set.resins.push_back(std::move(r));
    }
    return set;
}

}  // namespace

std::vector<SuiteCase> colour_cases() {
    const double skin_mm = skin_layers * j750_mm[2], core_mm = (slab_layers - skin_layers) * j750_mm[2];
    const HalftoneSkin skin(suite_resins(), cmykw, skin_mm, core_mm);
    std::vector<SuiteCase> cases;
    const auto patches = [&](const char* name, const char* shown, const std::vector<CumulativeMixture>& of, int coat) {
        cases.push_back(colours(name, shown, slab_layers + coat, Backing::black, [&, coat](int x, int y, int z) {
            if (z >= slab_layers) return T;
            return z >= slab_layers - skin_layers ? skin.at(of[static_cast<std::size_t>(patch_at(x, y))], x, y, z) : W;
        }));
    };
    patches("hues", "eight hues, patches of 0.85 mm", hue_mixtures(skin), 0);
    patches("greys", "eight greys, L* 20 to 90, patches of 0.85 mm", grey_mixtures(skin), 0);
    for (SuiteCase& c : walls(skin)) cases.push_back(std::move(c));
    for (const std::uint64_t seed : {1, 2}) {
        const ResinSet set = random_resins(seed);
        const HalftoneSkin of_set(set, {"A", "B", "D", "K", "W"}, skin_mm, core_mm);
        const std::vector<CumulativeMixture> mixtures = hue_mixtures(of_set);
        cases.push_back(colours(fmt::format("random-{}", seed), "the eight targets with resins drawn at random",
                                slab_layers, Backing::black, [&](int x, int y, int z) {
                                    return z >= slab_layers - skin_layers
                                               ? of_set.at(mixtures[static_cast<std::size_t>(patch_at(x, y))], x, y, z)
                                               : W;
                                }));
        cases.back().resins = set;
        cases.back().tuning = false;
    }
    patches("coat-hues", "the hues under 0.16 mm of clear", hue_mixtures(skin), 6);
    patches("coat-greys", "the greys under 0.11 mm of clear", grey_mixtures(skin), 4);
    return cases;
}

}  // namespace voxtone::accuracy
