// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_surfaces.h"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/error.h"
#include "calibration/patches/table_observer.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

namespace {

using optics::BareFinish;

constexpr std::string_view bare_word = "bare:", gap_word = "+gap";
constexpr std::array<std::pair<std::string_view, BareFinish>, 3> finishes{
    {{"matt", BareFinish::matt}, {"smooth", BareFinish::smooth}, {"mirror", BareFinish::mirror}}};

using Surface = std::shared_ptr<const PatchSurface>;

std::vector<double> between(const std::vector<double>& nm, const std::vector<double>& rho,
                            const std::vector<double>& wanted) {
    std::vector<double> values;
    for (const double at : wanted) {
        const auto above = std::size_t(std::ranges::upper_bound(nm, at) - nm.begin());
        if (above == 0 || above == nm.size()) {
            values.push_back(above == 0 ? rho.front() : rho.back());
            continue;
        }
        const double share = (at - nm[above - 1]) / (nm[above] - nm[above - 1]);
        values.push_back((1 - share) * rho[above - 1] + share * rho[above]);
    }
    return values;
}

std::vector<double> as_in(const optics::ResinSet& set, const PatchTable& table, const PatchSurface& surface) {
    const optics::Channels &from = table.channels, &to = set.channels;
    if (from.is_spectral() && to.is_spectral()) return between(from.wavelengths_nm, surface.rho, to.wavelengths_nm);
    if (!(to.is_rgb() || (to.is_own() && to.size() == 3)))
        throw InputError(fmt::format(
            "{}: of {} it is known what it reflects in {} channels that are no wavelengths, and the set \"{}\" has {} "
            "of its own; measure spectra of the bare surface and of what lies on it.",
            table.source, surface.name, from.size(), set.name, to.size()));
    const TableObserver observer = table_observer(from, optics::Illuminant::d65);
    const Eigen::Vector3d rgb =
        optics::linear_srgb_of(observer.white) * observer.weights *
        Eigen::Map<const Eigen::VectorXd>(surface.rho.data(), static_cast<Eigen::Index>(surface.rho.size()));
    const Eigen::Vector3d rho = Eigen::Matrix3d(optics::linear_srgb_weights(to)).inverse() * rgb;
    return {rho[0], rho[1], rho[2]};
}

}  // namespace

optics::KnownSurface parse_surface_kind(std::string_view text) {
    const bool gap = text.ends_with(gap_word);
    const std::string_view word = gap ? text.substr(0, text.size() - gap_word.size()) : text;
    const auto found = std::ranges::find(finishes, word, &std::pair<std::string_view, BareFinish>::first);
    if (found != finishes.end()) return {found->second, gap};
    throw InputError(fmt::format(
        "{} is no surface: it is matt, smooth or a mirror, \"+gap\" behind the word where air lies under the squares.",
        shown(text)));
}

std::string surface_kind_text(const optics::KnownSurface& kind) {
    const auto* const found =
        std::ranges::find(finishes, kind.finish, &std::pair<std::string_view, BareFinish>::second);
    return std::string(found->first) + std::string(kind.gap ? gap_word : "");
}

std::optional<optics::KnownSurface> bare_kind(std::string_view text) {
    if (!text.starts_with(bare_word)) return std::nullopt;
    return parse_surface_kind(text.substr(bare_word.size()));
}

std::string bare_text(const optics::KnownSurface& kind) { return std::string(bare_word) + surface_kind_text(kind); }

void lay_on_surfaces(PatchTable& table) {
    std::map<std::string, Surface> surfaces;
    for (const Patch& patch : table.patches) {
        if (!patch.top.empty()) continue;
        const auto [at, is_new] = surfaces.try_emplace(
            patch.backing,
            std::make_shared<PatchSurface>(PatchSurface{patch.backing, patch.on->kind, patch.rho, patch.error}));
        if (!is_new)
            throw InputError(fmt::format("{}: the bare surface {} is there twice, as {} and as {}; keep one row.",
                                         patch.where, patch.backing, surface_kind_text(at->second->kind),
                                         surface_kind_text(patch.on->kind)));
    }
    if (surfaces.empty()) return;
    std::erase_if(table.patches, [](const Patch& patch) { return patch.top.empty(); });
    if (table.patches.empty())
        throw InputError(fmt::format("{}: holds bare surfaces alone; add the squares on them.", table.source));
    for (Patch& patch : table.patches) {
        for (const ResinShare& share : patch.top)
            if (surfaces.contains(share.role))
                throw InputError(fmt::format(
                    "{}: {} is a resin here and a bare surface elsewhere in the table; give the surface another name.",
                    patch.where, share.role));
        const auto found = surfaces.find(patch.backing);
        if (found == surfaces.end()) continue;
        if (patch.base_mm > 0)
            throw InputError(fmt::format("{}: base_mm is {}, but {} is a surface without a thickness; give 0.",
                                         patch.where, patch.base_mm, patch.backing));
        patch.on = found->second;
    }
}

std::vector<Patch> bare_patches(const PatchTable& table) {
    std::vector<Patch> bare;
    for (const Patch& patch : table.patches) {
        if (!patch.on || std::ranges::find(bare, patch.backing, &Patch::backing) != bare.end()) continue;
        bare.push_back({{}, patch.backing, 0, 0, patch.on->rho, patch.on->error, {}});
        bare.back().on = patch.on;
    }
    return bare;
}

void change_surfaces(PatchTable& table, const std::function<void(PatchSurface&)>& change) {
    std::map<Surface, Surface> changed;
    for (Patch& patch : table.patches) {
        if (!patch.on) continue;
        const auto [at, is_new] = changed.try_emplace(patch.on);
        if (is_new) {
            auto copy = std::make_shared<PatchSurface>(*patch.on);
            change(*copy);
            at->second = std::move(copy);
        }
        patch.on = at->second;
    }
}

PatchTable in_channels_of(const optics::ResinSet& set, PatchTable table) {
    if (set.channels == table.channels) return table;
    change_surfaces(table, [&](PatchSurface& surface) { surface.rho = as_in(set, table, surface); });
    return table;
}

}  // namespace voxtone::calibration
