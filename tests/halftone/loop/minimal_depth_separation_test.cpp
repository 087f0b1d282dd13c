// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "base/random.h"
#include "halftone/loop/minimal_depth_separation.h"
#include "optics/colour/colour.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

double difference(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    const auto lab = [](const Eigen::Vector3f& rgb) {
        return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
    };
    return optics::ciede2000(lab(a), lab(b));
}

}  // namespace

TEST_CASE("Colours go into the gamut whether or not the lattice around them lies in it", "[loop][slow]") {
    const optics::ResinSet set = optics::vero_opaque();
    optics::ShellGeometry geometry;
    geometry.core_resin = set.find("W");
    geometry.shell_mm = 0.8;
    const SkinLayers layers = skin_layers(0.8);
    const MinimalDepthSeparation recipes(optics::ShellAppearance(set, geometry), layers, {});
    const Separation& deepest = recipes.deepest();
    constexpr int colours = 4000;
    int stayed = 0, as_computed = 0;
    double most = 0;
    RandomStream random(3, 0);
    for (int i = 0; i < colours; ++i) {
        Eigen::Vector3f rgb;
        for (float& v : rgb) {
            const auto root = static_cast<float>(random.uniform());
            v = root * root * root;
        }
        // A colour that is off by 2 or more goes all the way to what is shown for it, one that is off by 1 stays.
        const auto way = static_cast<float>(std::clamp(deepest.gamut_distance(rgb) - 1, 0.0, 1.0));
        const Eigen::Vector3f wanted = rgb + way * (deepest.predicted(rgb).cast<float>() - rgb);
        const Eigen::Vector3f got = recipes.into_gamut(rgb);
        stayed += got == rgb;
        as_computed += (got - wanted).norm() < 1e-6f;
        most = std::max(most, difference(got, wanted));
    }
    // Each layer of a recipe is a whole.
    std::vector<float> fractions(layers.size() * 5);
    for (int i = 0; i < 50; ++i) {
        recipes.separate({float(random.uniform()), float(random.uniform()), float(random.uniform())}, fractions);
        for (std::size_t l = 0; l < layers.size(); ++l) {
            const auto layer = std::span(fractions).subspan(5 * l, 5);
            CHECK(std::accumulate(layer.begin(), layer.end(), 0.0) == Approx(1).margin(2e-6));
        }
    }
    INFO(stayed << " stayed, " << as_computed << " as computed one by one, off by " << most << " at most");
    CHECK(stayed > colours / 50);
    CHECK(stayed < colours / 2);
    CHECK(as_computed > 0.999 * colours);
    CHECK(most < 0.2);
}
