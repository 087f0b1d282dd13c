// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/separation/translucency.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

using namespace voxtone;
using namespace voxtone::halftone;
using Eigen::Vector3f;

namespace {

optics::ResinSet with_clear() {
    optics::ResinSet set = optics::vero_opaque();
    set.resins.push_back({"Clear", "T", {0, 0, 0}, {1, 1, 1}});
    return set.subset(std::vector<std::string>{"C", "M", "Y", "K", "W", "T"});
}

struct Print {
    optics::ResinSet set = with_clear();
    optics::ShellAppearance appearance;
    Separation separation;
    Translucency translucency;
    Print() : appearance(set, geometry()), separation(appearance), translucency(appearance, separation, 5) {}
    [[nodiscard]] optics::ShellGeometry geometry() const {
        optics::ShellGeometry geometry;
        geometry.core_resin = set.find("W");
        geometry.seen = optics::SeenFrom::all_sides;
        geometry.pitch_mm = {25.4 / 600, 25.4 / 300, 0.027};
        return geometry;
    }
};

const Print& print() {
    static const Print made;
    return made;
}

const std::array nine_colours{Vector3f(1, 1, 1),          Vector3f(0.5f, 0.5f, 0.5f),  Vector3f(0.2f, 0.2f, 0.2f),
                              Vector3f(0.7f, 0.1f, 0.1f), Vector3f(0.1f, 0.4f, 0.15f), Vector3f(0.1f, 0.2f, 0.6f),
                              Vector3f(0.8f, 0.7f, 0.1f), Vector3f(0.1f, 0.5f, 0.6f),  Vector3f(0.6f, 0.35f, 0.25f)};

}  // namespace

TEST_CASE("A print of any colour is thinned to where it reads as the alpha that is asked for", "[slow]") {
    const optics::TranslucencyScale scale(print().set.eta);
    double worst = 0;
    for (const Vector3f& rgb : nine_colours) {
        CAPTURE(rgb.transpose());
        const auto shown = [&](double k) {
            return optics::translucency_alpha(scale.eta_per_cm(print().translucency.reading(rgb, k)));
        };
        const double most = shown(1);
        float before = 0;
        for (float alpha = 0.2f; alpha < 0.951f; alpha += 0.05f) {
            const float k = print().translucency.kept(rgb, alpha);
            CAPTURE(alpha, k, most);
            CHECK(k >= before);
            before = k;
            const double off = std::abs(shown(k) - std::min<double>(alpha, most));
            CHECK(print().translucency.shown_alpha(rgb, k) == Approx(shown(k)).margin(0.03));
            worst = std::max(worst, off);
            CHECK(off < 0.05);
        }
    }
    CAPTURE(worst);
    CHECK(worst > 1e-6);
}

TEST_CASE("A ramp of all eight-bit alphas has no band: what is read of it leaves its own mean by little", "[slow]") {
    const optics::TranslucencyScale scale(print().set.eta);
    constexpr int first = 51, last = 242, around = 12;  // 0.2 to 0.95; 0.05 to either side
    double worst = 0, largest_step = 0;
    for (const Vector3f& rgb : nine_colours) {
        std::vector<double> off;  // of what is asked for
        double before = 0;
        for (int code = first - around; code <= last + around; ++code) {
            const float asked = float(code) / 255, k = print().translucency.kept(rgb, asked);
            if (k == 1) break;  // as opaque as the resins are
            const double shown = optics::translucency_alpha(scale.eta_per_cm(print().translucency.reading(rgb, k)));
            if (!off.empty()) largest_step = std::max(largest_step, std::abs(shown - before - 1.0 / 255));
            before = shown;
            off.push_back(shown - double(asked));
        }
        REQUIRE(off.size() > 2 * around + 1);
        for (std::size_t i = around; i + around < off.size(); ++i) {
            double sum = 0;
            for (std::size_t j = i - around; j <= i + around; ++j) sum += off[j];
            worst = std::max(worst, std::abs(off[i] - sum / (2 * around + 1)));
        }
    }
    std::printf("bands in ramps of A: %.4f of it off the mean of 0.1 around, steps of 1/255 off by %.4f\n", worst,
                largest_step);
    CHECK(worst < 0.02);
    CHECK(largest_step < 0.01);
}

TEST_CASE("Clear at 0, and at 1 what is printed without alpha, to the bit", "[slow]") {
    const Translucency& translucency = print().translucency;
    const Vector3f rgb(0.7f, 0.1f, 0.1f);
    CHECK(translucency.kept(rgb, 0) == 0);
    CHECK(translucency.kept(rgb, 1) == 1);
    CHECK(translucency.shown_alpha(rgb, 1) < 1);
    CHECK(translucency.shown_alpha(rgb, 0) == 0);
    CHECK(translucency.kept(rgb, 0.9999f) == 1);
    CumulativeMixture mixture;
    print().separation.mixtures(&rgb.x(), &rgb.y(), &rgb.z(), 1, &mixture);
    CHECK(translucency.diluted(mixture, 1).bound == mixture.bound);
    const CumulativeMixture clear = translucency.diluted(mixture, 0), half = translucency.diluted(mixture, 0.5f);
    for (const std::uint16_t threshold : {0, 1, 30000, 65534}) CHECK(select_resin(clear, threshold, 6) == 5);
    int kept = 0, asked = 0;
    for (int t = 0; t < 65536; ++t) {
        kept += select_resin(half, std::uint16_t(t), 6) != 5;
        asked += select_resin(mixture, std::uint16_t(t), 6) != 5;
    }
    CHECK(std::abs(2 * kept - asked) <= 12);
}
