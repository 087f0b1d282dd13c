// SPDX-License-Identifier: GPL-3.0-or-later
//
// The scene. The body floats in uniform diffuse white light that reaches every point of its surface alike; light that
// leaves is gone (no shadow, no second bounce between parts of a body that is not convex). Its lowest faces, those on
// the plane z = 0 of the volume, may lie on a sheet (`backing`) with a film of air between; then no light reaches
// them from outside but what the sheet sends back. With `sides` mirrored the four vertical faces of the volume's box
// reflect everything: the pattern goes on for ever, for plane-parallel problems.
#pragma once

#include <array>
#include <memory>

#include "optics/media/resin_volume.h"
#include "optics/media/resins.h"
#include "optics/scene/backing.h"
#include "optics/scene/sheet.h"

namespace voxtone::optics {

enum class Sides {
    open,      ///< where the volume ends the body ends, and is lit
    mirrored,  ///< the x and y borders of the volume's box are perfect mirrors
};

/// Everything that decides what is seen. The volume and the resins must outlive the scene.
struct Scene {
    const ResinVolume* volume = nullptr;
    const ResinSet* resins = nullptr;  ///< material m of the volume is resins[m - 1]
    Backing backing = Backing::none;   ///< under the faces on the plane z = 0
    Sides sides = Sides::open;
    std::shared_ptr<const Sheet> sheet = nullptr;  ///< where `backing` is a sheet
    /// How far resin runs sideways before it is cured (lateral_spread.h): standard deviations along x and y, mm.
    std::array<double, 2> spread_mm{};
};

/// Throws InputError that names the first material that has no resin in the set.
void require_resins(const Scene& scene);

}  // namespace voxtone::optics
