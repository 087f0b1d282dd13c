// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body as it is predicted, for photographs to be compared with: its surface as a mesh with a vertex a cell, and what
// of the sky each place sees.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/models/coloured_mesh.h"
#include "slicer/mesh/mesh_boundary.h"
#include "slicer/predict/predicted_stack.h"

namespace voxtone::slicer {

struct BodyPrint {
    io::ColouredMesh mesh;                      ///< model's frame; linear sRGB, 1 is thick white resin in even light
    std::vector<Eigen::Vector3f> normals;       ///< outward
    std::array<double, 3> low_mm{}, high_mm{};  ///< of the volume, in the same frame
    double cell_mm = 0;                         ///< square root of a cell's area, the median
    optics::ResinSet set;                       ///< by which it was predicted
    std::string illuminant;                     ///< under which lamp
    std::shared_ptr<const MeshBoundary> surface;

    /// [vertex * directions + direction]: 1 where nothing of the body lies in that direction, 0 also below the surface.
    [[nodiscard]] std::vector<std::uint8_t> sees_sky(std::span<const std::uint32_t> vertices,
                                                     std::span<const Eigen::Vector3d> directions) const;
};

/// Of a prediction in absolute values. Throws InputError where there is no surface.
[[nodiscard]] BodyPrint body_print(PredictedStack predicted, const PredictFigures& figures);

/// What a photograph is exposed for: thick white resin in even light; of a picture that is lit from behind, and of sets
/// without white, the lightest hundredth of it. Absolute, linear sRGB.
[[nodiscard]] Eigen::Vector3f photographed_white(const PredictedStack& predicted, const PredictFigures& figures);

}  // namespace voxtone::slicer
