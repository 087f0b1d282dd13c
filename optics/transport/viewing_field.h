// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light of a viewing grid of whole cells as it is kept between two predictions: phi and J of each in 16 bits each, and
// what leaves through each face to the light in its 32 directions, in 255 steps from the least of them to the most: a
// few thousandths at an edge between black and white, of which the first sweep leaves a third. In 16 bits it was the
// half of all light that is kept.
//
// Of light 1 everywhere phi has steps of 2 / 65535 from 0 to 2 and J of 1 / 32767 from -1 to 1; what lies outside is
// clipped. Of an adjoint, which has both signs, phi has twice these steps, from -2 to 2, and all is in units of the
// field's scale.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "optics/transport/transport_sweep.h"

namespace voxtone::optics {

/// One channel's light between two predictions; of an adjoint, which has both signs, in coarser steps of its `scale`.
struct ViewingField {
    struct Code {
        std::uint16_t phi = 0;
        std::int16_t x = 0, y = 0, z = 0;
    };
    /// Radiance that leaves through a face, as Code::phi; [tangential signs * 8 + direction] of 255 from low to high.
    struct FaceCode {
        std::uint16_t low = 0, high = 0;
        std::array<std::uint8_t, 32> share{};
    };
    std::vector<Code> cells;
    std::vector<float> core;
    std::vector<FaceCode> out;  ///< of each open face
    float scale = 0;            ///< of an adjoint: radiance that stands for 1; 0: of light 1 everywhere
    bool stored = false;        ///< the lists are elsewhere (TileGrids::put_away)
    [[nodiscard]] bool empty() const { return cells.empty() && !stored; }
    [[nodiscard]] std::size_t memory_bytes() const {
        return cells.capacity() * sizeof(Code) + 4 * core.capacity() + sizeof(FaceCode) * out.capacity();
    }
};

inline constexpr float J_step = 1.0f / 32767;

/// How codes stand for phi: step * (code - zero), from `least` to 2.
struct PhiCode {
    float step, zero, least;
    [[nodiscard]] std::uint16_t operator()(float phi) const {
        return static_cast<std::uint16_t>(std::clamp(phi * (1 / step) + (zero + 0.5f), 0.0f, 65535.0f));
    }
    /// Whether a code holds this, or all of it but what nobody sees: corrections by diffusion leave dark places with
    /// light a little below none.
    [[nodiscard]] bool fits(float phi) const { return phi > least - unseen && phi < 2 + unseen; }
    static constexpr float unseen = 1.0f / 256;
};
inline constexpr PhiCode phi_code{2.0f / 65535, 0, 0},
    signed_code{4.0f / 65535, 32768, -2};  ///< of light 1, of an adjoint
[[nodiscard]] inline bool J_fits(float J) { return std::abs(J) < 1 + PhiCode::unseen; }

[[nodiscard]] inline std::int16_t J_code(float J) {
    return static_cast<std::int16_t>(static_cast<int>(std::clamp(J * (1 / J_step), -32767.0f, 32767.0f) + 32768.5f) -
                                     32768);
}
/// Codes of phi that stand for its radiances, not rounded.
[[nodiscard]] inline float code_of(const ViewingField::FaceCode& face, std::size_t k) {
    const float low = face.low;
    return low + (static_cast<float>(face.high) - low) * (static_cast<float>(face.share[k]) * (1.0f / 255));
}
[[nodiscard]] inline float phi_of(const ViewingField::Code& code) {
    return phi_code.step * static_cast<float>(code.phi);
}
[[nodiscard]] inline Moments moments_of(const ViewingField::Code& code) {
    return {phi_of(code), J_step * static_cast<float>(code.x), J_step * static_cast<float>(code.y),
            J_step * static_cast<float>(code.z)};
}

/// Of the 32 radiances that leave through a face, each clipped to what codes of phi hold.
[[nodiscard]] ViewingField::FaceCode face_code(const Octet* out, const PhiCode& code);

}  // namespace voxtone::optics
