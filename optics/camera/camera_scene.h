// SPDX-License-Identifier: GPL-3.0-or-later
//
// What stands before a camera: prints, diffusers, the ground, the light. All lengths in mm, in one frame.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "optics/camera/beam.h"
#include "optics/camera/camera.h"
#include "optics/camera/sky.h"
#include "optics/monte_carlo/surface_finish.h"
#include "optics/scene/scene.h"

namespace voxtone::optics {

/// A print. All that it names must outlive the picture.
struct ResinBody {
    const Scene* scene = nullptr;            ///< open sides, no backing
    const BodyBoundary* boundary = nullptr;  ///< mm from the volume's corner; needs `meets`
    const SurfaceFinish* finish = nullptr;   ///< nullptr: smooth
    Point corner_mm{};                       ///< of the volume, where the camera is told
};

/// A clear surface over a diffuser, which mirrors as a resin's does: of what falls on it the share F(mu) of Fresnel is
/// mirrored, and what is seen of the diffuser goes by 1 - F, on average as if it were bare.
struct Coat {
    double eta = 1;        ///< 1: none
    double roughness = 0;  ///< alpha of GGX
    double mean = 0;       ///< F of light from all sides: `mean_reflectance(eta)`
};

/// A body that is a diffuser of known colour throughout its surface.
class DiffuseBody {
public:
    virtual ~DiffuseBody() = default;
    /// Where a ray first meets it; a start on its surface does not count. `reflectance`: linear sRGB, in [0, 1].
    [[nodiscard]] virtual bool meets(const Point& from, const Point& way, double& distance, BoundaryNormals& normals,
                                     Light& reflectance) const = 0;
    /// Over it at a place of its surface; `outward`: the geometric normal there.
    [[nodiscard]] virtual Coat coat(const Point& /*at*/, const Point& /*outward*/) const { return {}; }
};

/// A plane without end, a diffuser.
struct Ground {
    Point up{0, 0, 1};     ///< its normal
    double height_mm = 0;  ///< along it
    Light reflectance{0.5, 0.5, 0.5};
};

struct CameraScene {
    CameraView view;
    const Sky* sky = nullptr;
    const Beam* beam = nullptr;                                        ///< in the sky's place
    std::array<Point, 3> sky_axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< the sky's x, y and z
    std::vector<ResinBody> prints;                                     ///< all of the same channels
    std::vector<const DiffuseBody*> diffusers;
    std::optional<Ground> ground;
};

}  // namespace voxtone::optics
