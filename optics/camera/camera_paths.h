// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture of printed bodies as a camera would take it: light paths from the camera to the light.
//
// A path begins at a random place of a pixel and goes where light could have come from (reciprocity):
//   resin     reflected or refracted by Fresnel's equations at a surface that is smooth or rough (rough_boundary.h);
//             within, scattered and absorbed voxel by voxel (path_packets.h), deep inside by steps through spheres
//             (first_passage.h); out again, to whatever is there: another part of the body, another body, the ground,
//             the sky. Nothing is cut off: Russian roulette only
//   diffuser  (the ground, a target beside its print): the sky drawn by its luminance and a direction drawn by the
//             cosine law, weighed by the balance heuristic (E. Veach, L. Guibas, "Optimally combining sampling
//             techniques for Monte Carlo rendering", SIGGRAPH 1995)
//   sky       its radiance counts, and the path ends
// At the first surface of a path the mirrored part and the part that enters are both followed.
//
// In the air one path carries all channels; in a print each channel has its own, and channels that make little of the
// luminance have fewer: of linear sRGB red half as many as green, blue a quarter (tile_paths.h). A pixel gathers its
// samples by a filter (pixel_filter.h). Unbiased but for the filter's blur and the tables of the spheres; the noise is
// estimated from the spread of the samples (exposure.h). The same bits for any number of threads.
//
// Memory of linear sRGB: 200 bytes a pixel besides the bodies.
#pragma once

#include "base/progress.h"
#include "optics/camera/camera_picture.h"
#include "optics/camera/camera_scene.h"

namespace voxtone::optics {

/// Where `progress` is asked to stop it leaves what there is, if every tile has something; else throws Cancelled.
/// Throws InputError where a material has no resin.
[[nodiscard]] CameraPicture take_picture(const CameraScene& scene, const CameraOptions& options, Progress& progress);

}  // namespace voxtone::optics
