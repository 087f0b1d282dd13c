// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which places of a print support material touched. The printer fills what lies below an overhang, down to the tray, so
// an empty voxel holds support where its column has resin anywhere above; faces beside it come out matt. In the glossy
// mode of printing all other faces stay as they were jetted; in the matt mode support lies on all of them.
//
// What it cannot see: how far a printer's own software widens its supports beyond overhangs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "optics/media/resin_volume.h"
#include "optics/monte_carlo/surface_finish.h"

namespace voxtone::slicer {

class SupportContact : public optics::SurfaceFinish {
public:
    /// Roughness of faces that nothing touched, and of those that support touched.
    SupportContact(const optics::ResinVolume& volume, double glossy, double matt);

    [[nodiscard]] bool touched(const optics::Point& at, const optics::Point& outward) const;
    [[nodiscard]] double roughness(const optics::Point& at, const optics::Point& outward) const override {
        return touched(at, outward) ? matt_ : glossy_;
    }

private:
    std::array<int, 3> size_;
    std::array<double, 3> pitch_mm_;
    std::vector<std::int32_t> top_;  ///< per column: layers up to the highest that holds resin
    double glossy_, matt_;
};

}  // namespace voxtone::slicer
