// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "halftone/screens/error_diffusion.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

constexpr int resins = 5;
constexpr int size = 96;
constexpr std::array<double, 3> j750{25.4 / 600, 25.4 / 300, 0.027};

CumulativeMixture mixture_of(const std::array<double, resins>& share) {
    CumulativeMixture mixture;
    mixture.bound.fill(65535);
    double sum = 0;
    for (std::size_t r = 0; r + 1 < resins; ++r)
        mixture.bound[r] = static_cast<std::uint16_t>(std::min(65535.0, 65536 * (sum += share[r])));
    return mixture;
}

/// A cube of `size`^3 voxels of one colour.
std::vector<std::uint8_t> field(const CumulativeMixture& mixture, const ErrorDiffusionOptions& options) {
    ErrorDiffusion diffusion(size, size, resins, options);
    const std::vector<CumulativeMixture> mixtures(size * size, mixture);
    const std::vector<std::uint8_t> body(size * size, 1);
    std::vector<std::uint8_t> out(size * size * size);
    for (int k = 0; k < size; ++k)
        diffusion.layer(k, mixtures, body,
                        std::span(out).subspan(static_cast<std::size_t>(k) * size * size, size * size));
    return out;
}

std::vector<std::uint8_t> white_noise(const CumulativeMixture& mixture) {
    std::vector<std::uint8_t> out(size * size * size);
    for (std::size_t v = 0; v < out.size(); ++v)
        out[v] = static_cast<std::uint8_t>(
            select_resin(mixture, static_cast<std::uint16_t>(RandomStream(1, v).bits() >> 16), resins));
    return out;
}

/// Worst |count - share * volume| / volume over all resins and cubes of this edge, all positions in steps of `step`.
double worst_share_error(const std::vector<std::uint8_t>& voxels, const std::array<double, resins>& share, int edge,
                         int step) {
    double worst = 0;
    for (int k0 = 0; k0 + edge <= size; k0 += step)
        for (int j0 = 0; j0 + edge <= size; j0 += step)
            for (int i0 = 0; i0 + edge <= size; i0 += step) {
                std::array<int, resins> count{};
                for (int k = k0; k < k0 + edge; ++k)
                    for (int j = j0; j < j0 + edge; ++j)
                        for (int i = i0; i < i0 + edge; ++i)
                            ++count[voxels[static_cast<std::size_t>(i + size * (j + size * k))]];
                for (std::size_t r = 0; r < resins; ++r)
                    worst = std::max(worst, std::abs(count[r] / std::pow(edge, 3) - share[r]));
            }
    return worst;
}

/// What a voxel owes to one of its neighbours, measured from outside. The only voxel before it takes resin 0 at shares
/// of 0.9 and 0.1, so that 0.1 of it is owed away and 0.1 of resin 1 is owed; the neighbour, of shares s and 1 - s,
/// takes resin 0 where its debt of it and a fifth of s are more than those of resin 1: from s = 0.5 + 0.5 times its
/// part of the debt. Layers 2 and up have no debts to start from but these.
double part_owed(const std::array<int, 3>& to, const std::array<double, 3>& pitch_mm, bool leftward) {
    ErrorDiffusionOptions options;
    options.pitch_mm = pitch_mm;
    options.noise = 0;
    constexpr int across = 5, middle = 2, k = 2;  // an even layer: rows upward; every second row is visited leftward
    const int y = leftward ? 1 : middle, dx = leftward ? -1 : 1;
    const auto at = [](int u, int v) { return static_cast<std::size_t>(u + across * v); };
    const std::size_t from = at(middle, y), neighbour = at(middle + dx * to[0], y + to[1]);
    double low = 0, high = 1;
    for (int step = 0; step < 18; ++step) {
        const double s = 0.5 * (low + high);
        std::vector<CumulativeMixture> mixtures(across * across, mixture_of({0.9, 0.1, 0, 0, 0}));
        std::vector<std::uint8_t> none(across * across, 0), body = none, laid(across * across, 99);
        ErrorDiffusion diffusion(across, across, resins, options);
        diffusion.layer(0, mixtures, none, laid);
        diffusion.layer(1, mixtures, none, laid);
        body[from] = 1;
        if (to[2] == 0) {
            mixtures[neighbour] = mixture_of({s, 1 - s, 0, 0, 0});
            body[neighbour] = 1;
        }
        diffusion.layer(k, mixtures, body, laid);
        REQUIRE(laid[from] == 0);
        if (to[2] == 1) {
            body = none;
            body[neighbour] = 1;
            mixtures[neighbour] = mixture_of({s, 1 - s, 0, 0, 0});
            diffusion.layer(k + 1, mixtures, body, laid);
        }
        (laid[neighbour] == 0 ? high : low) = s;
    }
    return 2 * high - 1;
}

const std::vector<std::array<double, resins>> colours{{0.05, 0.3, 0.25, 0.1, 0.3},   {0.2, 0.2, 0.2, 0.2, 0.2},
                                                      {0.02, 0.01, 0.03, 0.0, 0.94}, {0.5, 0.0, 0.0, 0.0, 0.5},
                                                      {0.33, 0.33, 0.34, 0, 0},      {0.003, 0.002, 0.001, 0.004, 0.99},
                                                      {0, 0.05, 0, 0, 0.95}};

}  // namespace

TEST_CASE("Error diffusion keeps the shares of resins in cubes, slab borders and edges included", "[slow]") {
    ErrorDiffusionOptions options;
    options.pitch_mm = j750;
    double worst_16 = 0, worst_64 = 0;
    for (const auto& share : colours) {
        const CumulativeMixture mixture = mixture_of(share);
        const auto voxels = field(mixture, options);
        worst_16 = std::max(worst_16, worst_share_error(voxels, share, 16, 8));
        worst_64 = std::max(worst_64, worst_share_error(voxels, share, 64, 16));
    }
    INFO("worst error of a share: " << worst_16 << " in 16^3, " << worst_64 << " in 64^3");
    CHECK(worst_16 <= 0.01);
    CHECK(worst_64 <= 0.001);
    const auto noise = white_noise(mixture_of(colours[1]));
    CHECK(worst_share_error(noise, colours[1], 16, 8) > 0.01);
}

TEST_CASE("Error diffusion by slabs gives the same voxels in any order of slabs") {
    ErrorDiffusionOptions options;
    options.pitch_mm = j750;
    const CumulativeMixture mixture = mixture_of(colours[0]);
    const auto whole = field(mixture, options);
    // The last slab alone, in an object of its own.
    ErrorDiffusion diffusion(size, size, resins, options);
    const std::vector<CumulativeMixture> mixtures(size * size, mixture);
    const std::vector<std::uint8_t> body(size * size, 1);
    std::vector<std::uint8_t> layer(size * size);
    for (int k = 2 * ErrorDiffusion::slab_layers; k < size; ++k) {
        diffusion.layer(k, mixtures, body, layer);
        REQUIRE(std::equal(layer.begin(), layer.end(), whole.begin() + static_cast<std::ptrdiff_t>(k) * size * size));
    }
}

TEST_CASE("Error diffusion never lays a resin where it has no share") {
    // Stripes of two colours without a resin in common.
    ErrorDiffusionOptions options;
    options.pitch_mm = j750;
    const CumulativeMixture left = mixture_of({0.4, 0.6, 0, 0, 0}), right = mixture_of({0, 0, 0.3, 0, 0.7});
    std::vector<CumulativeMixture> mixtures(size * size);
    std::vector<std::uint8_t> body(size * size, 1);
    for (std::size_t v = 0; v < mixtures.size(); ++v) {
        mixtures[v] = v % 8 < 4 ? left : right;
        body[v] = v % 5 != 0;
    }
    ErrorDiffusion diffusion(size, size, resins, options);
    std::vector<std::uint8_t> layer(size * size, 99);
    int strays = 0;
    for (int k = 0; k < 40; ++k) {
        diffusion.layer(k, mixtures, body, layer);
        for (std::size_t v = 0; v < layer.size(); ++v) {
            const bool right_one = !body[v]    ? layer[v] == 99
                                   : v % 8 < 4 ? layer[v] < 2
                                               : layer[v] == 2 || layer[v] == 4;
            strays += !right_one;
        }
    }
    CHECK(strays == 0);
}

TEST_CASE("What is owed goes to voxels not yet visited, by the square of how near they are in mm") {
    for (const std::array<double, 3>& pitch_mm : {j750, std::array{0.03, 0.03, 0.03}, std::array{0.02, 0.09, 0.05}}) {
        const auto nearness = [&](const std::array<int, 3>& to) {
            double square = 0;
            for (std::size_t a = 0; a < 3; ++a) square += std::pow(to[a] * pitch_mm[a], 2);
            return 1 / square;
        };
        const std::vector<std::array<int, 3>> above{{0, 0, 1}, {-1, 0, 1}, {1, 0, 1}, {0, -1, 1}, {0, 1, 1}};
        double next_layer = 0;
        for (const auto& to : above) next_layer += nearness(to);
        for (const bool leftward : {false, true}) {
            for (const auto& to : above) {
                INFO(leftward << ": " << to[0] << " " << to[1] << " " << to[2]);
                CHECK(part_owed(to, pitch_mm, leftward) == Approx(nearness(to) / next_layer).margin(2e-4));
            }
            // Of a layer's voxels only those of the body count.
            for (const auto& to :
                 {std::array{1, 0, 0}, std::array{-1, 1, 0}, std::array{0, 1, 0}, std::array{1, 1, 0}}) {
                INFO(leftward << ": " << to[0] << " " << to[1] << " " << to[2]);
                CHECK(part_owed(to, pitch_mm, leftward) ==
                      Approx(nearness(to) / (nearness(to) + next_layer)).margin(2e-4));
            }
        }
    }
}

TEST_CASE("Error diffusion lays the bits that it laid before: a print that goes on fits what is there") {
    // Regression values, of this test at the commit that added it: FNV-1a over 34 layers of 13 x 9 voxels, of a body
    // with holes and of mixtures of one to five resins that differ from voxel to voxel.
    const auto digest = [](const ErrorDiffusionOptions& options) {
        constexpr int width = 13, height = 9, layers = ErrorDiffusion::slab_layers + 2;
        ErrorDiffusion diffusion(width, height, resins, options);
        std::uint64_t hash = 0xcbf29ce484222325u;
        for (int k = 0; k < layers; ++k) {
            std::vector<CumulativeMixture> mixtures;
            std::vector<std::uint8_t> body, laid(width * height, 99);
            for (int v = 0; v < width * height; ++v) {
                RandomStream random(9, std::uint64_t(v + 1000 * k));
                body.push_back(random.uniform() < 0.85);
                const double red = random.uniform() * 0.5, rare = 0.02 * random.uniform();
                mixtures.push_back(mixture_of(v % 7 == 0   ? std::array{0.0, 0.0, 1.0, 0.0, 0.0}
                                              : v % 7 == 1 ? std::array{red, 0.0, 0.0, 1 - red, 0.0}
                                                           : std::array{red, rare, 0.2, 0.1, 0.7 - red - rare}));
            }
            diffusion.layer(k, mixtures, body, laid);
            for (const std::uint8_t resin : laid) hash = (hash ^ resin) * 0x100000001b3u;
        }
        return hash;
    };
    ErrorDiffusionOptions options;
    options.pitch_mm = j750;
    const std::uint64_t usual = digest(options);
    CHECK(usual == 0xccdf3ca8c14bc2f2u);
    options.seed = 7;
    CHECK(digest(options) == 0x1251fbc8d2135412u);
    options.seed = 1, options.noise = 0.5f;
    CHECK(digest(options) == 0x2512d6ed1209fe38u);
    options.noise = 0.1f, options.pitch_mm = {0.03, 0.06, 0.05};
    CHECK(digest(options) == 0xe5840b9450ce47c6u);
}
