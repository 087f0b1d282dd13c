// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/lab_to_srgb.h"

#include <algorithm>
#include <array>

#include "optics/colour/colour.h"

namespace voxtone::io {

namespace {

constexpr double most_word = 65535;

/// 8 bits: L* of 255 is 100, a* and b* in units. 16 bits: CIELAB has L* of 65535 and a* of 256 a unit; ICCLAB keeps the
/// 8-bit scale, 256 for 1, so that L* of 65280 is 100.
Eigen::Vector3d lab_of(const std::uint16_t* p, const LabCoding& coding) {
    constexpr double unit = 256;
    const auto chroma = [&](std::uint16_t value) {
        if (coding.bits == 8) {
            const int byte = value >> 8;
            return coding.offset ? byte - 128.0 : double(static_cast<std::int8_t>(byte));
        }
        return coding.offset ? (value - 32768.0) / unit : static_cast<std::int16_t>(value) / unit;
    };
    const double white = coding.offset && coding.bits == 16 ? 65280 : most_word;
    return {std::min(100.0, 100 * p[0] / white), chroma(p[1]), chroma(p[2])};
}

}  // namespace

void lab_to_srgb(std::span<std::uint16_t> pixels, const LabCoding& coding) {
    std::array<std::uint16_t, 3> last_in{}, last_out{};
    bool some = false;
    for (std::size_t i = 0; i + 3 < pixels.size(); i += 4) {
        std::uint16_t* const p = pixels.data() + i;
        const std::array<std::uint16_t, 3> in{p[0], p[1], p[2]};
        if (!some || in != last_in) {  // pictures have runs
            const Eigen::Vector3d xyz = optics::adapt_white(optics::xyz_from_lab(lab_of(p, coding), coding.white),
                                                            coding.white, optics::d65_white());
            const Eigen::Vector3d rgb = optics::linear_srgb_from_xyz(xyz);
            for (int c = 0; c < 3; ++c)
                last_out[std::size_t(c)] =
                    static_cast<std::uint16_t>(optics::srgb_encode(std::clamp(rgb[c], 0.0, 1.0)) * most_word + 0.5);
            last_in = in;
            some = true;
        }
        std::copy(last_out.begin(), last_out.end(), p);
    }
}

}  // namespace voxtone::io
