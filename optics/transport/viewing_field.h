// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light of a viewing grid of whole cells as it is kept between two predictions: phi of each in 16 bits, J in 8 bits an
// axis of the largest in its block, and what leaves through each face to the light in its 32 directions, in 255 steps
// from the least of them to the most: a few thousandths at an edge between black and white, of which the first sweep
// leaves a third.
//
// phi has steps of 2 / 65535 from 0 to 2; what lies outside is clipped.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "optics/transport/transport_sweep.h"

namespace voxtone::optics {

inline constexpr float phi_step = 2.0f / 65535;

/// One channel's light between two predictions.
struct ViewingField {
    /// Of the cells of a transport block.
    struct BlockCode {
        std::array<std::uint16_t, 64> phi{};
        std::array<std::array<std::int8_t, 64>, 3> J{};  ///< by axis, in J_step
        float J_step = 0;
        [[nodiscard]] Moments moments(std::size_t cell) const {
            return {phi_step * static_cast<float>(phi[cell]), J_step * static_cast<float>(J[0][cell]),
                    J_step * static_cast<float>(J[1][cell]), J_step * static_cast<float>(J[2][cell])};
        }
    };
    /// Radiance that leaves through a face, as BlockCode::phi; [tangential signs * 8 + direction] of 255 from low to
    /// high.
    struct FaceCode {
        std::uint16_t low = 0, high = 0;
        std::array<std::uint8_t, 32> share{};
    };
    std::vector<BlockCode> blocks;  ///< of each transport block
    std::vector<float> core;
    std::vector<FaceCode> out;  ///< of each open face
    bool stored = false;        ///< the lists are elsewhere (TileGrids::put_away)
    [[nodiscard]] bool empty() const { return blocks.empty() && !stored; }
    [[nodiscard]] std::size_t memory_bytes() const {
        return blocks.capacity() * sizeof(BlockCode) + 4 * core.capacity() + sizeof(FaceCode) * out.capacity();
    }
};

/// How codes stand for phi.
struct PhiCode {
    [[nodiscard]] std::uint16_t operator()(float phi) const {
        return static_cast<std::uint16_t>(std::clamp(phi * (1 / phi_step) + 0.5f, 0.0f, 65535.0f));
    }
    /// Whether a code holds this, or all of it but what nobody sees: corrections by diffusion leave dark places with
    /// light a little below none.
    [[nodiscard]] bool fits(float phi) const { return phi > -unseen && phi < 2 + unseen; }
    static constexpr float unseen = 1.0f / 256;
};
inline constexpr PhiCode phi_code;
/// Codes of phi that stand for its radiances, not rounded.
[[nodiscard]] inline float code_of(const ViewingField::FaceCode& face, std::size_t k) {
    const float low = face.low;
    return low + (static_cast<float>(face.high) - low) * (static_cast<float>(face.share[k]) * (1.0f / 255));
}

/// Of the 64 cells of a block of which these are solid; air is kept as nothing.
[[nodiscard]] ViewingField::BlockCode block_code(const Moments* moments, std::uint64_t solid);
/// Of the 32 radiances that leave through a face, each clipped to what codes of phi hold.
[[nodiscard]] ViewingField::FaceCode face_code(const Octet* out);

}  // namespace voxtone::optics
