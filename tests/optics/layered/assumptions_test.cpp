// SPDX-License-Identifier: GPL-3.0-or-later
//
// How large the errors are of what appearance_model.h takes for granted, where plane-parallel layers can tell: colours
// of slabs of ideal mixtures of Vero resins, 3.24 mm over a black sheet, each relative to the white resin seen the same
// way.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "optics/colour/colour.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

/// All mixtures of five resins in thirds, by Eq. 7.
std::vector<std::vector<double>> mixtures_in_thirds() {
    std::vector<std::vector<double>> all;
    for (int code = 0; code < 1024; ++code) {
        std::vector<double> f(5);
        int sum = 0;
        for (std::size_t r = 0; r < 5; ++r) {
            const int part = code >> (2 * r) & 3;
            sum += part;
            f[r] = part / 3.0;
        }
        if (sum == 3) all.push_back(f);
    }
    return all;
}

template <class Seen>
std::vector<Eigen::Vector3d> relative_colours(const ResinSet& set, Seen&& seen) {
    constexpr std::size_t pure = 5, white = 4;
    std::vector<Eigen::Vector3d> out;
    for (std::size_t m = pure; m < set.resins.size(); ++m) {
        Eigen::Vector3d rgb;
        for (std::size_t c = 0; c < 3; ++c)
            rgb[static_cast<Eigen::Index>(c)] =
                seen(static_cast<Material>(m + 1), c) / seen(static_cast<Material>(white + 1), c);
        out.push_back(lab_from_linear_srgb(rgb));
    }
    return out;
}

struct Difference {
    double mean = 0, most = 0;
};
Difference between(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
    Difference d;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double e = ciede2000(a[i], b[i]);
        d.mean += e / static_cast<double>(a.size());
        d.most = std::max(d.most, e);
    }
    return d;
}

std::vector<Eigen::Vector3d> diffuse(const ResinSet& set) {
    return relative_colours(set, [&](Material m, std::size_t c) {
        const SlabLayer layer{m, 120};
        return exact_appearance(set, {&layer, 1}, Backing::black, c);
    });
}

}  // namespace

TEST_CASE("What geometry and index make of a colour is as large as appearance_model.h says") {
    const ResinSet set = with_mixtures(vero_opaque(), mixtures_in_thirds());
    const auto usual = diffuse(set);
    const auto directional = relative_colours(set, [&](Material m, std::size_t c) {
        const SlabLayer layer{m, 120};
        return exact_45_0(set, {&layer, 1}, Backing::black, c);
    });
    const Difference geometry = between(usual, directional);
    CAPTURE(usual.size(), geometry.mean, geometry.most);
    CHECK(geometry.mean == Approx(0.78).margin(0.02));
    CHECK(geometry.most == Approx(1.14).margin(0.02));
    for (const double eta : {1.45, 1.55}) {
        ResinSet other = set;
        other.eta = eta;
        const Difference index = between(usual, diffuse(other));
        CAPTURE(eta, index.mean, index.most);
        CHECK(index.mean == Approx(0.75).margin(0.04));
        CHECK(index.most == Approx(1.23).margin(0.04));
    }
}
