// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "halftone/separation/scalar_lookup.h"
#include "halftone/separation/separation.h"
#include "optics/colour/colour.h"
#include "tests/optics/colour/split_channels.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

using Roles = std::vector<std::string>;

/// The Vero Opaque resins of these roles, and a clear one (T).
optics::ResinSet resin_set(const Roles& roles) {
    optics::ResinSet set = optics::vero_opaque();
    const optics::Resin clear{"Clear", "T", {0, 0, 0}, {1, 1, 1}};
    set.resins.push_back(clear);
    return set.subset(roles);
}

optics::ShellAppearance appearance_of(const optics::ResinSet& set) {
    optics::ShellGeometry geometry;
    geometry.core_resin = set.find("W");
    return optics::ShellAppearance(set, geometry);
}

/// Fractions of a random mixture; every other one mostly white.
std::vector<double> random_mixture(RandomStream& random, std::size_t resins, std::size_t core, bool pale) {
    std::vector<double> f(resins);
    const double power = 1 + 3 * random.uniform();
    double sum = 0;
    for (double& x : f) sum += x = std::pow(-std::log(1 - random.uniform()), power);
    const double white = pale ? 1 - std::pow(random.uniform(), 3) : 0;
    for (double& x : f) x *= (1 - white) / sum;
    f[core] += white;
    return f;
}

/// CIEDE2000 from the colour of a random mixture through the lattice and back, by `colour_of(appearance, fractions)`.
template <class ColourOf>
optics::DifferenceSummary round_trip(const Roles& roles, const SeparationOptions& options, int colours,
                                     ColourOf colour_of) {
    const optics::ResinSet set = resin_set(roles);
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance, options);
    const auto core = static_cast<std::size_t>(set.find("W"));
    std::vector<double> differences(static_cast<std::size_t>(colours));
    parallel_for(0, differences.size(), 4, [&](std::size_t n) {
        RandomStream random(1, n);
        const Eigen::Vector3d target =
            colour_of(appearance, random_mixture(random, set.resins.size(), core, n % 2 == 1));
        const Eigen::Vector3d printed = colour_of(appearance, separation.fractions(target.cast<float>()));
        differences[n] = optics::ciede2000(optics::lab_from_linear_srgb(target), optics::lab_from_linear_srgb(printed));
    });
    return optics::summarize(differences);
}

/// Layered transport without tables: milliseconds a colour.
Eigen::Vector3d exact_colour(const optics::ShellAppearance& appearance, const std::vector<double>& fractions) {
    const std::vector<double> seen = appearance.exact(fractions);
    Eigen::Vector3d colour;
    for (std::size_t c = 0; c < 3; ++c)
        colour[static_cast<Eigen::Index>(c)] = seen[c] / appearance.white_appearance()[c];
    return colour;
}

Eigen::Vector3d table_colour(const optics::ShellAppearance& appearance, const std::vector<double>& fractions) {
    return AppearanceColour(appearance, {}).rgb(fractions);
}

Eigen::Vector3f from_srgb(double r, double g, double b) {
    return Eigen::Vector3d(optics::srgb_decode(r), optics::srgb_decode(g), optics::srgb_decode(b)).cast<float>();
}

}  // namespace

TEST_CASE("Colours of mixtures are met within 0.5 mean and 1.5 max CIEDE2000", "[slow]") {
    for (const Roles& roles :
         {Roles{"C", "M", "Y", "K", "W"}, Roles{"C", "M", "Y", "W"}, Roles{"C", "M", "W"}, Roles{"K", "W"}}) {
        const auto summary = round_trip(roles, {}, 2000, table_colour);
        INFO(roles.size() << " resins: mean " << summary.mean << ", max " << summary.max);
        CHECK(summary.mean < 0.5);
        CHECK(summary.max < 1.5);
    }
    SeparationOptions coarse;
    coarse.nodes = 7;
    CHECK(round_trip({"C", "M", "Y", "K", "W"}, coarse, 500, table_colour).max > 1.5);
}

TEST_CASE("Colours of mixtures are met when seen by layered transport without tables", "[slow]") {
    const auto summary = round_trip({"C", "M", "Y", "K", "W"}, {}, 100, exact_colour);
    INFO("mean " << summary.mean << ", max " << summary.max);
    CHECK(summary.mean < 0.5);
    CHECK(summary.max < 1.5);
}

TEST_CASE("Sets whose gamut the lattice cuts badly are met within 0.5 mean and 3 max CIEDE2000", "[slow]") {
    // Without red and yellow, or with clear as a second way to dilute, many colours lie on the edge of the gamut
    // itself.
    for (const Roles& roles : {Roles{"K", "W", "C"}, Roles{"C", "M", "Y", "K", "W", "T"}}) {
        const auto summary = round_trip(roles, {}, 2000, table_colour);
        INFO(roles.size() << " resins: mean " << summary.mean << ", max " << summary.max);
        CHECK(summary.mean < 0.5);
        CHECK(summary.max < 3);
    }
}

TEST_CASE("White is white resin exactly, for every set", "[slow]") {
    for (const Roles& roles : {Roles{"C", "M", "Y", "K", "W"}, Roles{"C", "M", "W"}, Roles{"K", "W", "C"}, Roles{"W"},
                               Roles{"C", "M", "Y", "K", "W", "T"}}) {
        const optics::ResinSet set = resin_set(roles);
        const optics::ShellAppearance appearance = appearance_of(set);
        const Separation separation(appearance);
        const auto core = static_cast<std::size_t>(set.find("W"));
        CHECK(separation.fractions({1, 1, 1})[core] == 1.0);
        CHECK(separation.gamut_distance({1, 1, 1}) < 0.01);  // the error of the appearance's table
        const float one = 1;
        CumulativeMixture mixture;
        separation.mixtures(&one, &one, &one, 1, &mixture);
        for (int t : {0, 1, 30000, 65534})
            REQUIRE(select_resin(mixture, static_cast<std::uint16_t>(t), static_cast<int>(set.resins.size())) ==
                    set.find("W"));
    }
}

TEST_CASE("A set of one resin gives that resin") {
    const optics::ResinSet set = resin_set({"W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    CHECK(separation.fractions({0.2f, 0.9f, 0.0f}) == std::vector<double>{1.0});
    CHECK(separation.gamut_distance({0, 0, 0}) > 50);
}

TEST_CASE("Clear resin stays out of white and grey", "[slow]") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W", "T"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    for (double v : {0.25, 0.4, 0.6, 0.8, 0.95, 1.0}) CHECK(separation.fractions(from_srgb(v, v, v))[5] < 0.01);
}

TEST_CASE("Colours out of gamut keep their hue", "[slow]") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    double worst = 0, farthest = 0;
    int looked_at = 0;
    for (int hue = 0; hue < 360; hue += 3)
        for (double value : {0.4, 0.7, 1.0})
            for (double saturation : {0.8, 1.0}) {
                // The saturated colours of HSV.
                const auto channel = [&](double n) {
                    const double k = std::fmod(n + hue / 60.0, 6.0);
                    return value - value * saturation * std::max(0.0, std::min({k, 4 - k, 1.0}));
                };
                const Eigen::Vector3f target = from_srgb(channel(5), channel(3), channel(1));
                const double distance = separation.gamut_distance(target);
                farthest = std::max(farthest, distance);
                if (distance < 3) continue;
                const Eigen::Vector3d asked = optics::oklab_from_linear_srgb(target.cast<double>());
                const Eigen::Vector3d got = optics::oklab_from_linear_srgb(separation.predicted(target));
                if (std::hypot(got.y(), got.z()) < 0.04) continue;
                const double turn = std::remainder(std::atan2(got.z(), got.y()) - std::atan2(asked.z(), asked.y()),
                                                   2 * std::numbers::pi);
                worst = std::max(worst, std::abs(turn) * 180 / std::numbers::pi);
                ++looked_at;
            }
    INFO("worst turn of hue " << worst << " degrees of " << looked_at << " colours; farthest mapped by " << farthest);
    REQUIRE(looked_at > 100);
    CHECK(worst < 8);
    // Clipping each channel to what the primaries reach turns saturated green much further than that.
    CHECK(farthest > 5);
}

TEST_CASE("The grey ramp is monotone and neutral", "[slow]") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    double last_lightness = -1, last_white = -1;
    for (int step = 0; step <= 512; ++step) {
        const double v = step / 512.0;
        const Eigen::Vector3d lab = optics::lab_from_linear_srgb(separation.predicted(from_srgb(v, v, v)));
        const double white = separation.fractions(from_srgb(v, v, v))[4];
        REQUIRE(lab.x() >= last_lightness - 1e-3);
        REQUIRE(white >= last_white - 1e-3);
        if (v > 0.2) REQUIRE(std::hypot(lab.y(), lab.z()) < 1.0);
        last_lightness = lab.x();
        last_white = white;
    }
}

TEST_CASE("Mixtures change smoothly along ramps of colour", "[slow]") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    double worst = 0;
    for (int ramp = 0; ramp < 200; ++ramp) {
        RandomStream random(9, static_cast<std::uint64_t>(ramp));
        const auto draw = [&] { return Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()); };
        const Eigen::Vector3d from = draw(), to = draw();
        // Steps of one unit of 8-bit sRGB.
        const int steps = static_cast<int>(std::ceil(255 * (to - from).cwiseAbs().maxCoeff()));
        std::vector<double> last;
        for (int n = 0; n <= steps; ++n) {
            const Eigen::Vector3d coded = from + (to - from) * n / steps;
            const std::vector<double> f = separation.fractions(from_srgb(coded[0], coded[1], coded[2]));
            for (std::size_t r = 0; r < last.size(); ++r) worst = std::max(worst, std::abs(f[r] - last[r]));
            last = f;
        }
    }
    INFO("largest change of a fraction for one 8-bit step " << worst);
    CHECK(worst < 0.08);
}

TEST_CASE("Batches of any length give what single colours give, and bounds are in order", "[slow]") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    RandomStream random(4, 0);
    for (std::size_t n : {1u, 7u, 16u, 17u, 100u}) {
        std::vector<float> r(n), g(n), b(n);
        for (std::size_t i = 0; i < n; ++i) {
            r[i] = static_cast<float>(1.2 * random.uniform() - 0.1);  // some outside [0, 1]
            g[i] = static_cast<float>(random.uniform());
            b[i] = i % 5 == 0 ? g[i] : static_cast<float>(random.uniform());
        }
        if (n > 10) r[3] = std::numeric_limits<float>::quiet_NaN();
        std::vector<CumulativeMixture> mixtures(n);
        separation.mixtures(r.data(), g.data(), b.data(), n, mixtures.data());
        for (std::size_t i = 0; i < n; ++i) {
            const std::vector<double> f = separation.fractions({r[i], g[i], b[i]});
            double sum = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                sum += f[k];
                REQUIRE(std::abs(mixtures[i].bound[k] - 65536 * sum) < 1.1);
                REQUIRE((k == 0 || mixtures[i].bound[k] >= mixtures[i].bound[k - 1]));
            }
            for (std::size_t k = 4; k < max_resins; ++k) REQUIRE(mixtures[i].bound[k] == 65535);
        }
    }
}

TEST_CASE("A spectral set is separated by the colour of its spectrum under D65", "[slow]") {
    // Five wavelengths with the resins' blue, green and red values: not a real set, but white, cyan, magenta, yellow,
    // black.
    optics::ResinSet set = optics::vero_opaque();
    set.channels.wavelengths_nm = {430, 480, 540, 600, 650};
    for (optics::Resin& resin : set.resins) {
        const auto spread = [](const std::vector<double>& rgb) {
            return std::vector<double>{rgb[2], rgb[2], rgb[1], rgb[0], rgb[0]};
        };
        resin.sigma_t_per_mm = spread(resin.sigma_t_per_mm);
        resin.albedo = spread(resin.albedo);
    }
    const optics::ShellAppearance appearance = appearance_of(set);
    REQUIRE_THROWS_AS(Separation(appearance), InputError);
    SeparationOptions options;
    options.channels = set.channels;
    const Separation separation(appearance, options);
    CHECK(separation.fractions({1, 1, 1})[4] == 1.0);
    CHECK((separation.predicted({1, 1, 1}) - Eigen::Vector3d::Ones()).norm() < 1e-4);
    const AppearanceColour colour(appearance, options.channels);
    std::vector<double> differences;
    for (int n = 0; n < 1000; ++n) {
        RandomStream random(2, static_cast<std::uint64_t>(n));
        const Eigen::Vector3d target = colour.rgb(random_mixture(random, 5, 4, n % 2 == 1));
        // sRGB does not hold all colours of spectra.
        if (target.minCoeff() < 0 || target.maxCoeff() > 1) continue;
        differences.push_back(separation.gamut_distance(target.cast<float>()));
    }
    REQUIRE(differences.size() > 300);
    const auto summary = optics::summarize(differences);
    INFO("mean " << summary.mean << ", max " << summary.max);
    CHECK(summary.mean < 0.5);
    CHECK(summary.max < 3);  // at the edge of the gamut
}

TEST_CASE("Options of the separation that mean nothing are refused by name") {
    const optics::ShellAppearance appearance = appearance_of(optics::vero_opaque());
    const auto refuses = [&](double SeparationOptions::*option, const char* name) {
        SeparationOptions options;
        options.nodes = 2;
        options.*option = 0;
        CHECK_THROWS_WITH(Separation(appearance, options), Catch::Contains(name) && Catch::Contains("must be above 0"));
        options.*option = 0.01;
        CHECK_NOTHROW(Separation(appearance, options));
    };
    refuses(&SeparationOptions::ink_penalty, "ink_penalty");
    refuses(&SeparationOptions::clear_penalty, "clear_penalty");
    refuses(&SeparationOptions::lightness_weight, "weights");
    refuses(&SeparationOptions::chroma_weight, "weights");
    refuses(&SeparationOptions::hue_weight, "weights");
    for (const int nodes : {1, 66}) {
        SeparationOptions options;
        options.nodes = nodes;
        CHECK_THROWS_WITH(Separation(appearance, options), Catch::Contains("2 to 65"));
    }
}

TEST_CASE("A set with a residual is separated by its corrected colours", "[slow]") {
    optics::ResinSet set = optics::vero_opaque();
    // Cyan and yellow together darker and greener than physics says, pale magenta redder.
    Eigen::MatrixXd centres(3, 5);
    centres << 0.3, 0, 0.3, 0, 0.4, 0, 0.1, 0, 0, 0.9, 0, 0, 0, 0, 1;
    Eigen::MatrixX3d weights(3, 3);
    weights << -0.04, -0.02, -0.03, 0.03, 0.01, 0.01, 0.01, 0.01, 0.01;
    const optics::ShellAppearance plain_appearance = appearance_of(set);
    set.residual = {{1, 1, 1, 1, 1}, centres, weights};
    const optics::ShellAppearance appearance = appearance_of(set);
    const Separation separation(appearance);
    const AppearanceColour colour(appearance, {}), plain(plain_appearance, {});
    const std::vector<double> white{0, 0, 0, 0, 1}, green{0.3, 0, 0.3, 0, 0.4};
    CHECK((colour.rgb(white) - plain.rgb(white)).norm() < 1e-8);
    const auto lab = [](const Eigen::Vector3d& rgb) { return optics::lab_from_linear_srgb(rgb); };
    CHECK(optics::ciede2000(lab(colour.rgb(green)), lab(plain.rgb(green))) > 2);

    std::vector<double> differences, uncorrected;
    for (int n = 0; n < 600; ++n) {
        RandomStream random(4, static_cast<std::uint64_t>(n));
        const Eigen::Vector3d target = colour.rgb(random_mixture(random, 5, 4, n % 2 == 1));
        if (target.minCoeff() < 0 || target.maxCoeff() > 1) continue;
        const std::vector<double> found = separation.fractions(target.cast<float>());
        differences.push_back(optics::ciede2000(lab(target), lab(colour.rgb(found))));
        uncorrected.push_back(optics::ciede2000(lab(target), lab(plain.rgb(found))));
    }
    REQUIRE(differences.size() > 300);
    CHECK(optics::summarize(differences).mean < 0.5);
    CHECK(optics::summarize(uncorrected).mean > 2 * optics::summarize(differences).mean);
}

TEST_CASE("A set in channels of its own is separated as the R, G, B set that shows the same colours") {
    const optics::ResinSet rgb = optics::vero_opaque(),
                           own = optics::testing::split_set(rgb, optics::testing::green_twice);
    const optics::ShellAppearance of_rgb = appearance_of(rgb), of_own = appearance_of(own);
    REQUIRE_THROWS_WITH(Separation(of_own), Catch::Contains("told of 3 channels") && Catch::Contains("has 4"));
    SeparationOptions options;
    options.nodes = 9;
    const Separation as_rgb(of_rgb, options);
    options.channels = own.channels;
    const Separation as_own(of_own, options);
    const AppearanceColour rgb_colour(of_rgb, {}), own_colour(of_own, own.channels);
    for (int n = 0; n < 500; ++n) {
        RandomStream random(9, static_cast<std::uint64_t>(n));
        const std::vector<double> f = random_mixture(random, 5, 4, n % 2 == 1);
        AppearanceColour::Gradient by_rgb, by_own;
        REQUIRE((rgb_colour.rgb(f) - own_colour.rgb(f)).norm() < 1e-12);
        REQUIRE((rgb_colour.rgb(f, by_rgb) - own_colour.rgb(f, by_own)).norm() < 1e-12);
        REQUIRE((by_rgb - by_own).norm() < 1e-10 * by_rgb.norm());
        const Eigen::Vector3f target = rgb_colour.rgb(f).cwiseMax(0).cwiseMin(1).cast<float>();
        const std::vector<double> a = as_rgb.fractions(target), b = as_own.fractions(target);
        for (std::size_t r = 0; r < 5; ++r) REQUIRE(std::abs(a[r] - b[r]) < 1e-4);
        REQUIRE((as_rgb.predicted(target) - as_own.predicted(target)).norm() < 1e-4);
    }
}

TEST_CASE("The colour of a shell in channels that overlap is that of print and white, with derivatives") {
    optics::ResinSet set = optics::testing::split_set(optics::vero_opaque(), optics::testing::green_twice);
    set.channels = optics::testing::overlapping_channels();
    const optics::ShellAppearance appearance = appearance_of(set);
    const AppearanceColour colour(appearance, set.channels);
    const Eigen::Matrix3Xd M = optics::linear_srgb_weights(set.channels);
    const auto of = [&](std::span<const double> light) {
        return Eigen::Vector3d(M * Eigen::Map<const Eigen::Vector4d>(light.data()));
    };
    for (int n = 0; n < 50; ++n) {
        RandomStream random(10, static_cast<std::uint64_t>(n));
        const std::vector<double> f = random_mixture(random, 5, 4, n % 2 == 1);
        AppearanceColour::Gradient gradient;
        const Eigen::Vector3d rgb = colour.rgb(f, gradient);
        REQUIRE((rgb - of(appearance.appearance(f)).cwiseQuotient(of(appearance.white_appearance()))).norm() < 1e-12);
        for (std::size_t r = 0; r < 5; ++r) {
            constexpr double step = 1e-5;
            std::vector<double> above = f, below = f;
            above[r] += step, below[r] -= step;
            const Eigen::Vector3d difference = (colour.rgb(above) - colour.rgb(below)) / (2 * step);
            REQUIRE((difference - gradient.col(static_cast<Eigen::Index>(r))).norm() < 1e-3 * gradient.norm() + 1e-6);
        }
    }
}

TEST_CASE("At the nodes no exchange of one resin for another comes nearer to what is asked for") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    SeparationOptions options;
    options.nodes = 17;
    const AppearanceColour colour(appearance, {});
    MixtureLattice lattice(colour, options);
    const auto white = static_cast<std::size_t>(set.find("W"));
    // The objective of separation.h, of a mixture; chroma and hue fade into one weight at the neutral axis.
    const auto objective = [&](const std::vector<double>& f, const Eigen::Vector3d& target) {
        const Eigen::Vector3d wanted = optics::oklab_from_linear_srgb(target),
                              off = optics::oklab_from_linear_srgb(colour.rgb(f)) - wanted;
        const double chroma = std::hypot(wanted.y(), wanted.z()), coloured = chroma / (chroma + 0.1);
        const Eigen::Vector2d along =
            chroma > 0 ? Eigen::Vector2d(wanted.tail<2>() / chroma) : Eigen::Vector2d(Eigen::Vector2d::UnitX());
        const double by_chroma = (1 + coloured * (options.chroma_weight - 1)) * along.dot(off.tail<2>()),
                     by_hue = (1 + coloured * (options.hue_weight - 1)) * (along.x() * off.z() - along.y() * off.y());
        double cost = std::pow(options.lightness_weight * off.x(), 2) + by_chroma * by_chroma + by_hue * by_hue;
        for (std::size_t r = 0; r < f.size(); ++r)
            if (r != white) cost += options.ink_penalty * f[r] * f[r];
        return cost;
    };
    const auto size = static_cast<std::size_t>(options.nodes);
    std::size_t better = 0, tried = 0;
    double most = 0;
    for (std::size_t node = 0; node + 1 < size * size * size; ++node) {
        const auto axis = [&](std::size_t i) { return std::pow(double(i) / double(size - 1), 3); };
        const Eigen::Vector3d target(axis(node % size), axis(node / size % size), axis(node / size / size));
        std::vector<double> f(5);
        for (std::size_t r = 0; r < 5; ++r) f[r] = std::pow(double(lattice.at(node)[r]), 2);
        const double here = objective(f, target);
        for (const double part : {0.01, 0.003})
            for (std::size_t from = 0; from < 5; ++from)
                for (std::size_t to = 0; to < 5; ++to) {
                    if (to == from || f[from] < part) continue;
                    std::vector<double> other = f;
                    other[from] -= part, other[to] += part;
                    const double gain = here - objective(other, target);
                    most = std::max(most, gain / here);
                    better += gain > 1e-9 + 1e-5 * here;
                    ++tried;
                }
    }
    INFO(better << " of " << tried << " exchanges gain, at most " << most);
    CHECK(tried > 100000);
    CHECK(better == 0);  // beyond ten times the gain for which a search goes on
}

TEST_CASE("The separation has the same bits for any number of threads, whatever is asked for first") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const AppearanceColour colour(appearance, {});
    SeparationOptions options;
    options.nodes = 9;
    using Roots = std::vector<MixtureLattice::Roots>;
    // Of every node, asked for in steps of `stride` nodes.
    const auto solved = [&](std::size_t stride) {
        MixtureLattice lattice(colour, options);
        Roots roots(lattice.nodes());
        parallel_for(0, roots.size(), 1, [&](std::size_t i) {
            const std::size_t node = i * stride % roots.size();
            roots[node] = lattice.at(node);
        });
        return roots;
    };
    const Roots in_order = test::same_for_threads([&] { return solved(1); });
    REQUIRE(in_order.size() == std::size_t{9 * 9 * 9});
    CHECK(in_order.back()[4] == 1.0f);
    for (const std::size_t stride : {2, 100, 728}) {  // all without a factor of 729 = 3^6
        CAPTURE(stride);
        CHECK(test::same_for_threads([&] { return solved(stride); }) == in_order);
    }
}

TEST_CASE("Colours are looked up in a lattice that is solved on the way as in one that is solved before") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const AppearanceColour colour(appearance, {});
    SeparationOptions options;
    options.nodes = 9;
    MixtureLattice whole(colour, options);
    for (std::size_t node = 0; node < whole.nodes(); ++node) REQUIRE(whole.at(node)[5] == 0.0f);
    constexpr std::size_t n = 200;
    std::vector<float> red(n), green(n), blue(n);
    RandomStream random(14, 0);
    for (std::size_t i = 0; i < n; ++i)
        for (auto* channel : {&red, &green, &blue}) (*channel)[i] = static_cast<float>(random.uniform());
    std::vector<CumulativeMixture> wanted(n);
    lattice_mixtures(whole.view(), red.data(), green.data(), blue.data(), n, wanted.data());
    using Bounds = std::vector<decltype(CumulativeMixture::bound)>;
    const Bounds bounds = test::same_for_threads([&] {
        const Separation fresh(appearance, options);
        Bounds found(n);
        parallel_for(0, n, 1, [&](std::size_t i) {
            CumulativeMixture mixture;
            fresh.mixtures(&red[i], &green[i], &blue[i], 1, &mixture);
            found[i] = mixture.bound;
        });
        return found;
    });
    for (std::size_t i = 0; i < n; ++i) {
        REQUIRE(bounds[i] == wanted[i].bound);
        // By the scalar definition, of a lattice that nobody has asked yet.
        MixtureLattice fresh(colour, options);
        REQUIRE(scalar_mixture(fresh.view(), red[i], green[i], blue[i]).bound == wanted[i].bound);
    }
}

TEST_CASE("A colour costs the nodes next to it, not the whole lattice") {
    const optics::ResinSet set = resin_set({"C", "M", "Y", "K", "W"});
    const optics::ShellAppearance appearance = appearance_of(set);
    const AppearanceColour colour(appearance, {});
    MixtureLattice lattice(colour, {});
    const auto solved = [&] {
        std::size_t count = 0;
        for (std::size_t node = 0; node < lattice.nodes(); ++node) count += lattice.view().solved->made(node);
        return count;
    };
    const auto ask = [&](float red, float green, float blue) {
        std::vector<float> shares(max_resins);
        lattice_shares(lattice.view(), red, green, blue, shares.data());
    };
    CHECK(solved() == 0);
    ask(1, 1, 1);
    CHECK(solved() <= 8);
    ask(0, 0, 0.5f);
    CHECK(solved() <= 8 + 4 * 41);
}
