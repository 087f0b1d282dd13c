// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the pixels of a proof show: linear sRGB of their channels. Where a print's set has a residual, pixels that see
// it are corrected for the mixture around the place that their middle sees (optics/layered/mixture_correction.h), what
// the surface mirrors there included.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "optics/camera/camera_paths.h"
#include "slicer/proof/proof_scene.h"

namespace voxtone::slicer {

/// Where the ray through the middle of a pixel meets a print.
struct SeenPoint {
    std::size_t print = 0;   ///< in ProofScene::prints
    optics::Point place_mm;  ///< from the corner of its volume
    optics::BoundaryNormals normals;
};

[[nodiscard]] std::optional<SeenPoint> seen_print(const ProofScene& scene, const optics::Camera& camera,
                                                  std::size_t pixel);
/// The same of any ray from the camera.
[[nodiscard]] std::optional<SeenPoint> seen_along(const ProofScene& scene, const optics::Camera& camera,
                                                  const optics::Point& way);

/// One per pixel.
[[nodiscard]] std::vector<Eigen::Vector3f> proof_colours(const optics::CameraPicture& picture, const ProofScene& scene);

}  // namespace voxtone::slicer
