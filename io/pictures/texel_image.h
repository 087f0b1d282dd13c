// SPDX-License-Identifier: GPL-3.0-or-later
//
// Decoded pixels with alpha, as a picture reader leaves them: RGBA, rows from the top, alpha straight (not
// premultiplied). Pictures of 8 bits stay in their sRGB codes, 4 bytes a pixel; deeper ones are linear in 16 bits
// (65535 is 1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "io/pictures/srgb_code.h"

namespace voxtone::io {

struct TexelImage {
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<std::uint8_t> srgb8;      ///< RGBA; alpha is not coded. One of the two is empty.
    std::vector<std::uint16_t> linear16;  ///< RGBA

    [[nodiscard]] std::size_t pixels() const { return std::size_t{width_px} * height_px; }
    [[nodiscard]] bool is_8_bit() const { return !srgb8.empty(); }

    /// Linear RGB of pixel i, alpha left aside.
    [[nodiscard]] Eigen::Vector3f rgb(std::size_t i) const {
        if (is_8_bit()) {
            const auto& table = srgb8_to_linear();
            return {table[srgb8[4 * i]], table[srgb8[4 * i + 1]], table[srgb8[4 * i + 2]]};
        }
        return Eigen::Vector3f(linear16[4 * i], linear16[4 * i + 1], linear16[4 * i + 2]) / 65535.0f;
    }
    [[nodiscard]] float alpha(std::size_t i) const {
        return is_8_bit() ? srgb8[4 * i + 3] / 255.0f : linear16[4 * i + 3] / 65535.0f;
    }

    void set_opaque(std::size_t i) {
        if (is_8_bit())
            srgb8[4 * i + 3] = 255;
        else
            linear16[4 * i + 3] = 65535;
    }

    /// Sets an opaque pixel from linear RGB in [0, 1].
    void set(std::size_t i, const Eigen::Vector3f& rgb) {
        for (int c = 0; c < 3; ++c) {
            if (is_8_bit())
                srgb8[4 * i + c] = linear_to_srgb8(rgb[c]);
            else
                linear16[4 * i + c] = static_cast<std::uint16_t>(rgb[c] * 65535.0f + 0.5f);
        }
        set_opaque(i);
    }
};

/// Whether colours look as if they were times alpha: where alpha is between none is brighter than it, and the brightest
/// rise with it.
[[nodiscard]] bool looks_premultiplied(const TexelImage& image);

/// Alpha as a grey, linear in 16 bits; the picture becomes opaque.
[[nodiscard]] TexelImage take_alpha(TexelImage& image);

/// Composes the picture over a colour in linear light: rgb <- tint * rgb * a + under * (1 - a) with a = alpha *
/// tint_alpha.
void compose_over(TexelImage& image, const Eigen::Vector3f& under,
                  const Eigen::Vector3f& tint = Eigen::Vector3f::Ones(), float tint_alpha = 1);

}  // namespace voxtone::io
