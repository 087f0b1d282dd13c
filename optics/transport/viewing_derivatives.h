// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of a function of what leaves with respect to the media of the cells: products of the light of the
// prediction and of the adjoint light, the one that the function's derivative lights (viewing_gradient.h says how).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "optics/grid/viewing_grid.h"
#include "optics/transport/transport_medium.h"
#include "optics/transport/viewing_field.h"

namespace voxtone::optics {

/// A grid, the media of its mixtures and a cell's volume.
struct DerivativeScene {
    const ViewingGrid& grid;
    std::span<const TransportMedium> media;
    float volume;
};

/// From phi and J of each cell: `forward` of light 1. Sets both.
void derivatives_by_moments(const DerivativeScene& scene, std::span<const ViewingField::BlockCode> forward,
                            std::span<const Moments> adjoint, std::span<float> by_sigma_t, std::span<float> by_sigma_s);

/// Light on the open faces, 4 octets for each by tangential signs: what leaves through it and what enters.
struct LightOnFaces {
    std::span<const Octet> out, in;
};
/// Adds what there is beyond phi and J in the cells at the surface: as much as their faces say, each for itself.
void add_derivatives_at_faces(const DerivativeScene& scene, const LightOnFaces& forward, const LightOnFaces& adjoint,
                              std::span<float> by_sigma_t);

}  // namespace voxtone::optics
