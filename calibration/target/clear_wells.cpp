// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/clear_wells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/contracts.h"
#include "calibration/patches/patch_model.h"
#include "optics/media/resin_volume.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/scene/surface.h"

namespace voxtone::calibration {

namespace {

constexpr double voxel_mm = 0.5, margin_mm = 8;

/// Voxels of a length, and how large they are.
std::pair<int, double> voxels_of(double mm) {
    const int count = std::max(1, static_cast<int>(std::lround(mm / voxel_mm)));
    return {count, mm / count};
}

}  // namespace

std::vector<double> light_of_well(const TargetSquare& well, double under_mm, const optics::ResinSet& all,
                                  double sampled, double paths) {
    VOXTONE_EXPECT(well.top.size() == 1 && well.depth_mm > 0);
    const optics::ResinSet set = all.subset(std::array{well.backing, well.top.front().role});
    const auto [across, pitch] = voxels_of(well.area.size().x());
    const auto [deep, layer] = voxels_of(well.depth_mm);
    const int margin = static_cast<int>(std::lround(margin_mm / pitch)), size = across + 2 * margin;
    const int under = std::max(1, static_cast<int>(std::lround(under_mm / layer)));
    const auto in_well = [&](int x) { return x >= margin && x < margin + across; };
    const optics::ResinVolume volume = optics::make_resin_volume(
        {size, size, under + deep}, {pitch, pitch, layer},
        [&](int x, int y, int z) { return optics::Material(z >= under && in_well(x) && in_well(y) ? 2 : 1); });
    const optics::Scene scene{&volume, &set, optics::Backing::black, optics::Sides::mirrored};
    const optics::Surface top = optics::find_surface(scene, {1, 1, 1}, optics::SurfacePart::top);
    std::vector<std::uint32_t> middle;
    const double reach = sampled / 2 * well.area.size().x(), centre = size * pitch / 2;
    for (std::uint32_t c = 0; c < top.cells.size(); ++c)
        if (std::abs(double(top.cells[c].centre_mm[0]) - centre) < reach &&
            std::abs(double(top.cells[c].centre_mm[1]) - centre) < reach)
            middle.push_back(c);
    VOXTONE_EXPECT(!middle.empty());
    const auto each = static_cast<std::uint32_t>(std::max(2.0, std::ceil(paths / double(middle.size()))));
    optics::MonteCarloSummary summary;
    const optics::Appearance seen =
        optics::MonteCarlo({.paths = each}).reflectance_45_0(scene, optics::part_of(top, middle), summary);
    const std::size_t channels = set.channels.size();
    std::vector<double> rho(channels, 0.0);
    for (std::size_t c = 0; c < middle.size(); ++c)
        for (std::size_t channel = 0; channel < channels; ++channel)
            rho[channel] += double(seen.value[c * channels + channel]) / double(middle.size());
    return rho;
}

std::vector<double> well_without_end(const TargetSquare& well, double under_mm, const optics::ResinSet& set) {
    const Patch patch{well.top, well.backing, well.depth_mm, under_mm, {}, {}, {}};
    const std::vector<std::string> roles{well.backing, well.top.front().role};
    const PatchModel model(std::span(&patch, 1), roles, {.g = set.g, .eta = set.eta, .under = UnderBase::air});
    std::vector<double> rho;
    for (std::size_t channel = 0; channel < set.channels.size(); ++channel) {
        std::vector<optics::Medium> media;
        for (const std::string& role : roles) media.push_back(set.resins[std::size_t(set.find(role))].medium(channel));
        rho.push_back(model.rho(media).front());
    }
    return rho;
}

}  // namespace voxtone::calibration
