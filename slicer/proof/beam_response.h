// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far light goes on beyond the border of a beam on a slab's face: luminance by distance from the border, and the
// distances within which it falls to a half and to a tenth of what it is at the border.
//
//   at the border  between the two rows of pixels beside it
//   errors         a slab's face is cut into eight blocks along the border (sectors of a spot): of the rows the
//                  standard error of their mean, of distances the jackknife's; what differs from place to place counts
//
// Along an edge or a slit the middle half of the face counts, of a spot what is nearer than the face's borders.
// Distances are as sharp as the picture: pixels and their filter blur them.
#pragma once

#include <optional>
#include <vector>

#include "slicer/proof/proof_beam.h"

namespace voxtone::slicer {

struct FallDistance {
    double mm = 0, error_mm = 0;
};

struct BeamResponse {
    std::size_t print = 0;
    int slab = 0;
    std::vector<double> distance_mm;  ///< of rows of pixels, mean, ascending; below 0 where the beam shines
    std::vector<double> luminance, standard_error;
    std::optional<FallDistance> half, tenth;  ///< nothing: not within the face
};

/// Of the slabs on whose face the beam's image lies. `colours`: linear sRGB per pixel.
[[nodiscard]] std::vector<BeamResponse> beam_responses(const ProofScene& scene, const optics::Beam& beam,
                                                       const std::vector<SeenPiece>& pieces,
                                                       const std::vector<Eigen::Vector3f>& colours);

}  // namespace voxtone::slicer
