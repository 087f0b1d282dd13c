// SPDX-License-Identifier: GPL-3.0-or-later
//
// Profiles drawn as a page of SVG: one plot per channel, light per mm^2 on a log scale over the distance in mm.
#pragma once

#include <string>
#include <vector>

#include "optics/numerics/hankel.h"

namespace voxtone::scattering {

struct ProfileCurve {
    std::string name, colour;                       ///< colour: any of CSS
    std::vector<std::vector<double>> coefficients;  ///< by channel
    bool dashed = false;
};

/// All curves are seen through a blur of 1.5 reach / n, which takes the ripples of a series that ends, up to `most_mm`.
/// One row for each title with its curves; `channels` names the columns.
struct ProfileRow {
    std::string title;
    std::vector<ProfileCurve> curves;
};
[[nodiscard]] std::string profile_plots(const optics::HankelGrid& grid, const std::vector<std::string>& channels,
                                        const std::vector<ProfileRow>& rows, double most_mm);

}  // namespace voxtone::scattering
