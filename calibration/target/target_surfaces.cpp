// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_surfaces.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

std::shared_ptr<const PatchSurface> parse_target_surface(std::string_view text) {
    const std::size_t equals = text.find('='), colon = text.rfind(':');
    if (equals == std::string_view::npos || colon == std::string_view::npos || colon < equals)
        throw InputError(
            fmt::format("--surface {}: expected its name, what it is and what it reflects bare, as white=smooth:0.85 "
                        "or paper=matt:0.85,0.84,0.80 (linear R, G, B).",
                        shown(text)));
    PatchSurface surface{
        std::string(text.substr(0, equals)), parse_surface_kind(text.substr(equals + 1, colon - equals - 1)), {}, {}};
    check_role(surface.name, text);
    for (const std::string_view part : split(text.substr(colon + 1), ',')) {
        const auto value = number(trimmed(part));
        if (!value || !(*value >= 0 && *value <= 1))
            throw InputError(fmt::format("--surface {}: reflects {}; expected a share of light, from 0 to 1.",
                                         shown(text), shown(part)));
        surface.rho.push_back(*value);
    }
    if (surface.rho.size() == 1) surface.rho.assign(3, surface.rho.front());
    if (surface.rho.size() != 3)
        throw InputError(fmt::format("--surface {}: {} values; give one, or those of red, green and blue.", shown(text),
                                     surface.rho.size()));
    return std::make_shared<const PatchSurface>(std::move(surface));
}

Patch patch_of(const Target& target, const TargetSquare& square) {
    Patch patch{square.top, square.backing, target.depth_mm(square), target.under_mm(square), {}, {}, {}};
    patch.cell_mm = target.cell_mm(square);
    patch.on = target.surface(square.backing);
    return patch;
}

Eigen::Vector3d rgb_of(const Target& target, std::string_view name) {
    const auto surface = target.surface(name);
    VOXTONE_EXPECT(surface && surface->rho.size() == 3);
    return {surface->rho[0], surface->rho[1], surface->rho[2]};
}

}  // namespace voxtone::calibration
