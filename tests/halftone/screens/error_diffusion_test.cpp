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
