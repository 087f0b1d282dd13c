// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/albedo_photographs.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::calibration {
namespace {

constexpr double most_uneven = 0.1, most_saturated = 0.01;
constexpr std::uint64_t least_pixels = 100;

struct LightAndDark {
    Exposure lit, dark;
};

LightAndDark read_pair(const ExposureFile& lit, const ExposureFile& dark, const Progress* progress) {
    io::PhotographReader reader(names_of(std::array{lit, dark}));
    LightAndDark pair{read_exposure(lit, reader, progress), read_exposure(dark, reader, progress)};
    expect_dark_frame(pair.lit, pair.dark);
    return pair;
}

/// Mean light of a part of a box.
Eigen::Vector3d mean_of(const LightAndDark& pair, std::uint32_t x, std::uint32_t y, std::uint32_t width,
                        std::uint32_t height) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::uint32_t row = y; row < y + height; ++row)
        for (std::uint32_t column = x; column < x + width; ++column) {
            const std::size_t i = pair.lit.photograph.index(column, row);
            sum += (pair.lit.photograph.pixels[i] - pair.dark.photograph.pixels[i]).cast<double>();
        }
    return sum / (double(width) * double(height));
}

/// Full scale per second.
Eigen::Vector3d light_in(const LightAndDark& pair, const PixelBox& box, const char* of, const CameraNoise& noise) {
    const io::Photograph& photograph = pair.lit.photograph;
    const auto [x, y, width, height] = box;
    if (std::uint64_t{x} + width > photograph.width_px || std::uint64_t{y} + height > photograph.height_px)
        throw InputError(
            fmt::format("{}: the box {},{},{},{} of the {} reaches beyond its {} x {} pixels; name one "
                        "within the picture",
                        photograph.name, x, y, width, height, of, photograph.width_px, photograph.height_px));
    if (std::uint64_t{width} * height < least_pixels || width < 2 || height < 2)
        throw InputError(
            fmt::format("{}: the box {},{},{},{} of the {} holds {} pixels, too few for a mean; take {} "
                        "or more",
                        photograph.name, x, y, width, height, of, std::uint64_t{width} * height, least_pixels));
    std::uint64_t saturated = 0;
    for (std::uint32_t row = y; row < y + height; ++row)
        for (std::uint32_t column = x; column < x + width; ++column)
            saturated += photograph.pixels[photograph.index(column, row)].maxCoeff() >= noise.saturation;
    if (double(saturated) > most_saturated * double(width) * double(height))
        throw InputError(
            fmt::format("{}: {:.0f} % of the {} is saturated, so that it is darker there than it was; "
                        "expose it for less time",
                        photograph.name, 100 * double(saturated) / (double(width) * double(height)), of));
    const Eigen::Vector3d light = mean_of(pair, x, y, width, height);
    if (!(light.minCoeff() > 0))
        throw InputError(fmt::format("{}: the {} is no brighter than the dark frame {}; were they swapped?",
                                     photograph.name, of, pair.dark.photograph.name));
    const auto apart = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return ((a - b).cwiseAbs().array() / light.array()).maxCoeff();
    };
    const double uneven = std::max(
        apart(mean_of(pair, x, y, width / 2, height), mean_of(pair, x + width - width / 2, y, width / 2, height)),
        apart(mean_of(pair, x, y, width, height / 2), mean_of(pair, x, y + height - height / 2, width, height / 2)));
    if (uneven > most_uneven)
        throw InputError(
            fmt::format("{}: one half of the {} is {:.0f} % brighter than the other, and means of uneven "
                        "light say little; light it evenly, or name a smaller box",
                        photograph.name, of, 100 * uneven));
    return light / pair.lit.seconds;
}

Eigen::Vector3d share_of(const Eigen::Vector3d& share, const char* does, const std::string& name) {
    for (Eigen::Index c = 0; c < 3; ++c)
        if (share[c] > 1)
            throw InputError(
                fmt::format("{}: the slab {} {:.3f} of the light in {}, more than there was; is the box, "
                            "the card's albedo or the exposure time another?",
                            name, does, share[c], std::array{"red", "green", "blue"}[std::size_t(c)]));
    return share;
}

}  // namespace

Eigen::Vector3d reflectance_by_card(const CardPhotograph& photograph, const CameraNoise& noise,
                                    const Progress* progress) {
    if (!(photograph.albedo.minCoeff() > 0 && photograph.albedo.maxCoeff() <= 1))
        throw InputError(
            fmt::format("--card-albedo: {:g}, {:g}, {:g}; a card reflects more than 0 and at most 1 of "
                        "the light",
                        photograph.albedo[0], photograph.albedo[1], photograph.albedo[2]));
    const LightAndDark pair = read_pair(photograph.lit, photograph.dark, progress);
    const Eigen::Vector3d slab = light_in(pair, photograph.slab, "slab", noise),
                          card = light_in(pair, photograph.card, "card", noise);
    return share_of(photograph.albedo.cwiseProduct(slab.cwiseQuotient(card)), "reflects", pair.lit.photograph.name);
}

Eigen::Vector3d transmittance_by_screen(const ScreenPhotographs& photographs, const CameraNoise& noise,
                                        const Progress* progress) {
    const LightAndDark slab = read_pair(photographs.slab, photographs.slab_dark, progress),
                       screen = read_pair(photographs.screen, photographs.screen_dark, progress);
    return share_of(
        light_in(slab, photographs.at, "slab", noise).cwiseQuotient(light_in(screen, photographs.at, "screen", noise)),
        "transmits", slab.lit.photograph.name);
}

}  // namespace voxtone::calibration
