// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/srgb_code.h"

#include "optics/colour/colour.h"

namespace voxtone::io {

namespace {

constexpr int bins = 4096;

/// A first guess of the code for each bin of linear light, and the linear values at which the code steps up.
struct EncodeTable {
    std::array<std::uint8_t, bins + 1> guess{};
    std::array<float, 256> step{};  // linear value halfway (in code) between codes i and i + 1
    EncodeTable() {
        for (int i = 0; i < 256; ++i) step[i] = static_cast<float>(optics::srgb_decode((i + 0.5) / 255.0));
        int code = 0;
        for (int i = 0; i <= bins; ++i) {
            while (code < 255 && step[code] <= static_cast<float>(i) / bins) ++code;
            guess[i] = static_cast<std::uint8_t>(code);
        }
    }
};

const EncodeTable encode_table;

const std::array<float, 256> decode_table = [] {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) table[i] = static_cast<float>(optics::srgb_decode(i / 255.0));
    return table;
}();

}  // namespace

float srgb_to_linear(float code) { return static_cast<float>(optics::srgb_decode(code)); }

Eigen::Vector3f srgb_to_linear(const Eigen::Vector3f& code) {
    return {srgb_to_linear(code.x()), srgb_to_linear(code.y()), srgb_to_linear(code.z())};
}

const std::array<float, 256>& srgb8_to_linear() { return decode_table; }

std::uint8_t linear_to_srgb8(float linear) {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    int code = encode_table.guess[static_cast<int>(linear * bins)];
    while (code < 255 && encode_table.step[code] <= linear) ++code;
    return static_cast<std::uint8_t>(code);
}

}  // namespace voxtone::io
