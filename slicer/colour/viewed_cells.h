// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cells of a print's surface that are seen as one, and what was asked for in each. They depend on the print's shape
// alone, not on its resins: the appearance loop and the prediction share them.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "optics/media/resin_volume.h"
#include "optics/scene/appearance_model.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"

namespace voxtone::slicer {

struct ViewedCells {
    optics::Surface surface;
    std::vector<Eigen::Vector3f> target;  ///< per cell, linear sRGB
    std::array<double, 3> cell_um{};
};

/// The print as models see it: a picture's slab lies on its sheet. Keeps references.
[[nodiscard]] optics::Scene scene_of(const optics::ResinVolume& volume, const LoadedResins& resins, const JobBody& body,
                                     const BackingChoice& under_picture);

/// The top of a picture's slab, a body's whole surface.
[[nodiscard]] optics::SurfacePart seen_part(const JobBody& body);

/// Cells of about `cell_mm` (look/coarse_cells.h), of the part of the surface that is seen.
[[nodiscard]] ViewedCells find_viewed_cells(const optics::Scene& scene, const JobBody& body, double cell_mm,
                                            const Progress& progress);

}  // namespace voxtone::slicer
