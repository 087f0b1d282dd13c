// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_mixture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/patch_surfaces.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

void check_role(std::string_view role, std::string_view whole) {
    if (is_role(role)) return;
    throw InputError(fmt::format(
        "{} is no mixture: a role is a short word such as C or W, a mixture \"C:10+W:90\" in percent.", shown(whole)));
}

PatchMixture parse_mixture(std::string_view text) {
    PatchMixture mixture;
    const auto parts = split(text, '+');
    double sum = 0;
    for (const std::string_view part : parts) {
        const std::size_t colon = part.find(':');
        const std::string_view role = trimmed(part.substr(0, colon));
        check_role(role, text);
        double percent = 100;
        if (colon != std::string_view::npos || parts.size() > 1) {
            const auto value = colon == std::string_view::npos ? std::nullopt : number(trimmed(part.substr(colon + 1)));
            if (!value || !(*value > 0 && *value <= 100))
                throw InputError(fmt::format(
                    "Mixture {}: every part of it needs a percentage above 0, as in \"C:10+W:90\".", shown(text)));
            percent = *value;
        }
        if (std::ranges::any_of(mixture, [&](const ResinShare& share) { return share.role == role; }))
            throw InputError(fmt::format("Mixture {}: {} is there twice.", shown(text), role));
        mixture.push_back({std::string(role), percent / 100});
        sum += percent;
    }
    if (std::abs(sum - 100) > 0.01)
        throw InputError(fmt::format("Mixture {}: the percentages sum to {}, not to 100.", shown(text), sum));
    for (ResinShare& share : mixture) share.fraction *= 100 / sum;
    // One order of resins for one mixture, so that it is recognised.
    std::ranges::sort(mixture, {}, &ResinShare::role);
    return mixture;
}

std::string mixture_text(const PatchMixture& mixture) {
    if (mixture.size() == 1) return mixture.front().role;
    std::string text;
    for (const ResinShare& share : mixture)
        text += fmt::format("{}{}:{:.6g}", text.empty() ? "" : "+", share.role, share.fraction * 100);
    return text;
}

std::string light_name(optics::LightThrough light) { return light == optics::LightThrough::beam ? "beam" : "light"; }

std::string patch_name(const Patch& patch) {
    if (patch.top.empty()) return fmt::format("{} on {}", bare_text(patch.on->kind), patch.backing);
    std::string name = mixture_text(patch.top);
    if (patch.is_laminate()) {
        name += fmt::format(" {:.3g}", patch.thickness_mm);
        for (const PatchLayer& layer : patch.under) name += fmt::format(", {} {:.3g}", layer.role, layer.thickness_mm);
        return name;
    }
    if (patch.is_checker()) name += fmt::format(" in cells of {:.3g} x {:.3g} mm", patch.cell_mm[0], patch.cell_mm[1]);
    if (patch.lit) return fmt::format("{} of {:.3g} mm, {}", name, patch.thickness_mm, light_name(*patch.lit));
    return patch.backing.empty() ? name : fmt::format("{} on {}", name, patch.backing);
}

}  // namespace voxtone::calibration
