// SPDX-License-Identifier: GPL-3.0-or-later
//
// Profiles as small log plots on one SVG page: traced in black, predicted in red.
#pragma once

#include <string>
#include <vector>

namespace voxtone::optics::profile_laminates {

struct Curve {
    std::vector<double> r_mm, light;  ///< light per mm^2; values <= 0 are left out
};

struct Panel {
    std::string title;
    Curve traced, predicted;
};

/// Panels in rows of `columns`.
[[nodiscard]] std::string draw_panels(const std::vector<Panel>& panels, int columns, double r_max_mm);

}  // namespace voxtone::optics::profile_laminates
