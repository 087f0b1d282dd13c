// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colours as resins: separated for a skin over white over black and screened by blue noise, as `slice` does it.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/separation.h"
#include "suite_case.h"

namespace voxtone::accuracy {

class HalftoneSkin {
public:
    /// Only the resins of these roles are used; materials are those of `resins`.
    HalftoneSkin(const optics::ResinSet& resins, const std::vector<std::string>& roles, double skin_mm, double core_mm);

    /// sRGB codes, 0 to 255.
    [[nodiscard]] halftone::CumulativeMixture of_code(int r, int g, int b) const;
    [[nodiscard]] halftone::CumulativeMixture of_linear(const Eigen::Vector3f& rgb) const;
    [[nodiscard]] optics::Material at(const halftone::CumulativeMixture& mixture, int x, int y, int z) const;

private:
    std::vector<optics::Material> material_;
    std::unique_ptr<const optics::ShellAppearance> appearance_;
    std::unique_ptr<const halftone::Separation> separation_;
    halftone::BlueNoiseScreen screen_;
};

}  // namespace voxtone::accuracy
