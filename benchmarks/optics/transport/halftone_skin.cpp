// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone_skin.h"

#include "optics/colour/colour.h"

namespace voxtone::accuracy {

HalftoneSkin::HalftoneSkin(const optics::ResinSet& resins, const std::vector<std::string>& roles, double skin_mm,
                           double core_mm)
    : screen_(j750_mm) {
    const optics::ResinSet loaded = resins.subset(roles);
    for (const std::string& role : roles) material_.push_back(static_cast<optics::Material>(resins.find(role) + 1));
    optics::ShellGeometry geometry;
    geometry.shell_mm = skin_mm;
    geometry.core_resin = loaded.find("W");
    geometry.core_mm = core_mm;
    geometry.backing = optics::Backing::black;
    appearance_ = std::make_unique<const optics::ShellAppearance>(loaded, geometry);
    separation_ = std::make_unique<const halftone::Separation>(*appearance_);
}

halftone::CumulativeMixture HalftoneSkin::of_linear(const Eigen::Vector3f& rgb) const {
    halftone::CumulativeMixture mixture;
    separation_->mixtures(&rgb[0], &rgb[1], &rgb[2], 1, &mixture);
    return mixture;
}

halftone::CumulativeMixture HalftoneSkin::of_code(int r, int g, int b) const {
    const auto linear = [](int code) { return static_cast<float>(optics::srgb_decode(code / 255.0)); };
    return of_linear({linear(r), linear(g), linear(b)});
}

optics::Material HalftoneSkin::at(const halftone::CumulativeMixture& mixture, int x, int y, int z) const {
    return material_[static_cast<std::size_t>(
        halftone::select_resin(mixture, screen_.threshold(x, y, z), static_cast<int>(material_.size())))];
}

}  // namespace voxtone::accuracy
