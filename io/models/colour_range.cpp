// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/colour_range.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "base/warning.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

constexpr double most_of_unit_range = 1.5, most_of_bright_unit_range = 16;

bool is_colour(const Eigen::Vector4d& colour) { return !colour.head<3>().hasNaN(); }

/// Of red, green and blue, or of alpha alone.
struct Extent {
    double most = 0;
    bool whole = true;
    void take(double value) {
        if (!std::isfinite(value)) return;
        most = std::max(most, value);
        whole = whole && value == std::floor(value);
    }
};

double alpha_range(const FileColours& colours, double most_alpha, double range) {
    if (colours.alpha_numbers == ColourNumbers::bytes) return 255;
    if (colours.alpha_numbers == ColourNumbers::reals && most_alpha <= most_of_unit_range) return 1;
    return std::max(range, colour_range(most_alpha, colours.alpha_numbers));
}

}  // namespace

double colour_range(double most, ColourNumbers numbers, bool whole) {
    constexpr double bytes = 255, words = 65535, all = 4294967295.0;
    if (numbers == ColourNumbers::bytes) return bytes;
    if (numbers == ColourNumbers::reals &&
        (most <= most_of_unit_range || (!whole && most <= most_of_bright_unit_range)))
        return 1;
    if (most <= bytes + 1) return bytes;
    return most <= words + 1 ? words : all;
}

std::vector<Eigen::Vector4f> settled_colours(const FileColours& colours, std::string_view whose, std::string_view file,
                                             std::vector<std::string>& warnings, std::vector<std::string>* lost) {
    Extent rgb, alpha;
    for (const Eigen::Vector4d& colour : colours.value) {
        if (!is_colour(colour)) continue;
        for (int c = 0; c < 3; ++c) rgb.take(colour[c]);
        alpha.take(colour[3]);
    }
    const double range = colour_range(rgb.most, colours.numbers, rgb.whole),
                 of_alpha = alpha_range(colours, alpha.most, range);
    const bool usual =
        colours.numbers == ColourNumbers::bytes || (colours.numbers == ColourNumbers::reals && range == 1);
    if (!usual)
        warnings.push_back(named_warning(
            "colour-range", fmt::format("The {} colours of {} go up to {:g}: they were taken as of 0 to {:.0f}.", whose,
                                        file, rgb.most, range)));
    std::vector<Eigen::Vector4f> out;
    out.reserve(colours.value.size());
    std::size_t clamped = 0;
    bool differ_before = false, differ = false;
    const Eigen::Vector4d* first = nullptr;
    Eigen::Vector3d first_code;
    for (const Eigen::Vector4d& colour : colours.value) {
        Eigen::Vector4f& rgba = out.emplace_back(Eigen::Vector4f::Ones());
        if (!is_colour(colour)) {
            rgba.head<3>().setConstant(std::nanf(""));
            continue;
        }
        const Eigen::Vector3d share = colour.head<3>() / range, code = share.cwiseMax(0).cwiseMin(1);
        clamped += static_cast<std::size_t>(!((code - share).cwiseAbs().maxCoeff() <= 0));
        if (!first) first = &colour, first_code = code;
        differ_before |= colour.head<3>() != first->head<3>();
        differ |= code != first_code;
        rgba.head<3>() = srgb_to_linear(Eigen::Vector3f(code.cast<float>()));
        if (colours.has_alpha) rgba[3] = static_cast<float>(std::clamp(colour[3] / of_alpha, 0.0, 1.0));
    }
    if (clamped)
        warnings.push_back(
            named_warning("colour-range", fmt::format("{} {} colours of {} lie outside 0 to {:.0f}; they were clamped.",
                                                      clamped, whose, file, range)));
    if (clamped && differ_before && !differ && lost) lost->push_back(all_clamped_to_one(whose, file, range));
    return out;
}

std::string all_clamped_to_one(std::string_view whose, std::string_view file, double range) {
    return fmt::format(
        "The {} colours of {} lie outside 0 to {:.0f}, where clamping makes all of them one: they are LOST. Write them "
        "within that range.",
        whose, file, range);
}

std::string white_without_colour(std::size_t count, std::string_view whose, std::string_view file) {
    return fmt::format(
        "{} {} of {} have no colour where others have one: they are printed white, whatever colour they had is LOST. "
        "Colour them, or give them a material, and export it again.",
        count, whose, file);
}

}  // namespace voxtone::io
