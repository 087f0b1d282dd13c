// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much light a slab reflects and transmits in all, of photographs in even light (Hasan et al. 2010, Sec. 4): beside
// a grey card of known albedo on black cloth, and upon a screen that shows white, under a diffuser, against that screen
// alone at the same place.
//
//   R = albedo of the card  x  (slab - dark) / (card - dark)
//   T = (slab - dark) / time  over  (screen - dark) / time
//
// means over boxes of pixels, channel by channel. The light must be as strong on slab and card; what can be seen of it
// within a box is checked. What it cannot see: glare, a card that is not as matt as the slab, a mirror reflection.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/spot/exposure_merge.h"
#include "calibration/spot/exposure_series.h"

namespace voxtone::calibration {

/// x, y from the upper left corner of the picture; width, height.
using PixelBox = std::array<std::uint32_t, 4>;

struct CardPhotograph {
    ExposureFile lit, dark;
    PixelBox slab{}, card{};
    Eigen::Vector3d albedo = Eigen::Vector3d::Constant(0.18);  ///< of the card, in (0, 1]
};

struct ScreenPhotographs {
    ExposureFile slab, screen, slab_dark, screen_dark;
    PixelBox at{};  ///< in both pictures
};

/// Both throw InputError in one sentence that names the photograph: a box outside of it or of less than 100 pixels,
/// saturated pixels, a dark frame of another size or time, uneven light, no light, more than all of the light;
/// FileError.
[[nodiscard]] Eigen::Vector3d reflectance_by_card(const CardPhotograph& photograph, const CameraNoise& noise,
                                                  const Progress* progress = nullptr);
[[nodiscard]] Eigen::Vector3d transmittance_by_screen(const ScreenPhotographs& photographs, const CameraNoise& noise,
                                                      const Progress* progress = nullptr);

}  // namespace voxtone::calibration
