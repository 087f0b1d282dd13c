// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the beam of a proof falls, and how far light goes on from there within slabs: translucency in numbers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "optics/camera/beam.h"
#include "slicer/proof/proof_scene.h"

namespace voxtone::slicer {

/// A slab that the camera sees, or all of a print that is not made of slabs, and the pixels whose middle sees it.
struct SeenPiece {
    std::size_t print = 0;  ///< in ProofScene::prints
    int slab = -1;          ///< in its `boxes`; -1: none
    std::vector<std::size_t> pixels;
};
/// Those with a pixel, print by print.
[[nodiscard]] std::vector<SeenPiece> seen_pieces(const ProofScene& scene, const Progress& progress);

/// On the surface's tangent plane at `--light-at`. In the middle of what is seen: an edge or a slit lies on the middle
/// of the piece that is nearest to it, and every piece has a spot of its own. An edge lies across slabs, lit above, and
/// upright on bodies, lit on the left. Throws
/// InputError where no print is seen there.
[[nodiscard]] optics::Beam make_beam(const ResolvedProof& job, const ProofLamp& lamp, const ProofScene& scene,
                                     const std::vector<SeenPiece>& pieces);

/// "the edge of a beam across (1.2, 3, 4) mm".
[[nodiscard]] std::string beam_words(const optics::Beam& beam);

}  // namespace voxtone::slicer
