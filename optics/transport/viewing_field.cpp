// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_field.h"

#include <cmath>
#include <cstring>

#include "optics/numerics/lanes.h"

namespace voxtone::optics {

ViewingField::BlockCode block_code(const Moments* moments, std::uint64_t solid) {
    constexpr float steps = 127;
    ViewingField::BlockCode block;
    const auto is_solid = [&](std::size_t cell) { return (solid >> cell & 1) != 0; };
    float largest = 0;
    for (std::size_t cell = 0; cell < 64; ++cell)
        if (is_solid(cell))
            largest =
                std::max({largest, std::abs(moments[cell].x), std::abs(moments[cell].y), std::abs(moments[cell].z)});
    const float per_unit = largest > 0 ? steps / largest : 0;
    block.J_step = largest / steps;
    const auto rounded = [&](float J) {
        return static_cast<std::int8_t>(static_cast<int>(J * per_unit + (steps + 0.5f)) - static_cast<int>(steps));
    };
    for (std::size_t cell = 0; cell < 64; ++cell) {
        if (!is_solid(cell)) continue;
        const Moments& m = moments[cell];
        block.phi[cell] = phi_code(m.phi);
        block.J[0][cell] = rounded(m.x), block.J[1][cell] = rounded(m.y), block.J[2][cell] = rounded(m.z);
    }
    return block;
}

ViewingField::FaceCode face_code(const Octet* out) {
    constexpr std::size_t fours = 8;
    std::array<Four, fours> v;
    std::memcpy(v.data(), out, sizeof v);
    for (Four& f : v) {
        f = f < 0.0f ? Four{} : f;
        f = f > 2.0f ? Four{} + 2.0f : f;
    }
    Four lows = v[0], highs = v[0];
    for (const Four& f : v) {
        lows = f < lows ? f : lows;
        highs = f > highs ? f : highs;
    }
    const float low = std::min({lows[0], lows[1], lows[2], lows[3]}),
                high = std::max({highs[0], highs[1], highs[2], highs[3]}),
                per_unit = high > low ? 255 / (high - low) : 0;
    ViewingField::FaceCode face{phi_code(low), phi_code(high), {}};
    for (std::size_t k = 0; k < fours; ++k) {
        const IntLanes<4> share = __builtin_convertvector((v[k] - low) * per_unit + 0.5f, IntLanes<4>);
        for (std::size_t i = 0; i < 4; ++i) face.share[4 * k + i] = static_cast<std::uint8_t>(share[i]);
    }
    return face;
}

}  // namespace voxtone::optics
