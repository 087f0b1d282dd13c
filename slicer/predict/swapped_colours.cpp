// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/swapped_colours.h"

#include <fmt/core.h>

#include "optics/colour/colour.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

namespace {

constexpr double much_nearer = 0.5, least_gain = 20;

Eigen::Vector3d lab_of(const io::Rgb& codes) {
    const auto linear = [&](std::size_t i) { return optics::srgb_decode(codes[i] / 255.0); };
    return optics::lab_from_linear_srgb({linear(0), linear(1), linear(2)});
}

}  // namespace

std::string hex_code(const io::Rgb& rgb) { return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]); }

std::vector<std::string> swapped_colours(std::span<const ToldColour> told) {
    std::vector<std::string> doubts;
    for (const ToldColour& colour : told) {
        const auto usual = usual_colour(colour.role);
        if (!usual) continue;
        const Eigen::Vector3d lab = lab_of(colour.rgb);
        const double own = optics::ciede2000(lab, lab_of(*usual));
        const ToldColour* nearest = nullptr;
        double least = own;
        for (const ToldColour& other : told)
            if (const auto its = usual_colour(other.role); its && other.role != colour.role)
                if (const double d = optics::ciede2000(lab, lab_of(*its)); d < least) nearest = &other, least = d;
        if (nearest && least < much_nearer * own && own - least > least_gain)
            doubts.push_back(
                fmt::format("\"{}={}\": this colour looks far more like the resin '{}', which was given {}; were they "
                            "swapped? Compare with the sheet that came with the stack",
                            hex_code(colour.rgb), colour.told, nearest->told, hex_code(nearest->rgb)));
    }
    return doubts;
}

}  // namespace voxtone::slicer
