// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_scene.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "calibration/patches/patch_model.h"
#include "calibration/target/ideal_patch.h"
#include "calibration/target/marker_pattern.h"
#include "calibration/target/square_ends.h"
#include "calibration/target/target_surfaces.h"
#include "optics/colour/observed_colour.h"

namespace voxtone::calibration {

namespace {

constexpr double bin_mm = 2;

/// Of all squares, and at last of the dark cells of markers, by channel.
std::vector<std::vector<double>> modelled_squares(const Target& target, const optics::ResinSet& set,
                                                  MixtureKind mixtures) {
    PatchTable table;
    for (const TargetSquare& square : target.squares) table.patches.push_back(patch_of(target, square));
    TargetSquare marker;
    marker.top = target.of_markers(), marker.backing = target.light;
    table.patches.push_back(patch_of(target, marker));
    const std::vector<Patch> patches = in_channels_of(set, std::move(table)).patches;
    PatchModelOptions options;
    options.g = set.g;
    options.eta = set.eta;
    for (std::size_t axis = 0; mixtures == MixtureKind::dithered && axis < 3; ++axis)
        options.pitch_mm[axis] = target.pitch_um[axis] / 1000;
    const PatchModel model(patches, target.roles, options);
    std::vector<std::vector<double>> rho(patches.size());
    for (std::size_t channel = 0; channel < set.channels.size(); ++channel) {
        std::vector<optics::Medium> media;
        for (const std::string& role : target.roles)
            media.push_back(set.resins[std::size_t(set.find(role))].medium(channel));
        const std::vector<double> values = model.rho(media, channel);
        for (std::size_t s = 0; s < values.size(); ++s) rho[s].push_back(values[s]);
    }
    return rho;
}

TargetColours colours_on_surfaces(const Target& target, const optics::ResinSet& set, MixtureKind mixtures) {
    const optics::ObservedColour<double> observed(set.channels);
    TargetColours colours{rgb_of(target, target.light), rgb_of(target, target.dark), {}};
    for (const std::vector<double>& rho : modelled_squares(target, set, mixtures))
        colours.squares.push_back(observed.absolute(rho.data()));
    colours.markers = colours.squares.back();
    colours.squares.pop_back();
    return colours;
}

}  // namespace

TargetColours reflected_colours(const Target& target, const optics::ResinSet& all, MixtureKind mixtures,
                                SquareKind squares) {
    const optics::ResinSet set = all.subset(target.roles);
    if (!target.surfaces.empty()) return colours_on_surfaces(target, set, mixtures);
    const IdealPatches patches(set);
    const optics::ObservedColour<double> observed(set.channels);
    const auto colour = [&](const std::vector<double>& rho) { return observed.absolute(rho.data()); };
    TargetColours colours;
    colours.light = colour(patches.reflectance({{target.light, 1.0}}, target.top_mm, target.light, target.base_mm));
    colours.dark = colour(patches.reflectance({{target.dark, 1.0}}, target.top_mm, target.dark, target.base_mm));
    const bool ideal = mixtures == MixtureKind::ideal;
    std::vector<std::vector<double>> all_rho =
        ideal ? patches.squares(target) : modelled_squares(target, set, mixtures);
    all_rho.resize(target.squares.size());
    if (squares == SquareKind::ended) {
        const auto light = light_of_squares(target, set, false, light_of_deep_squares(target, set));
        for (std::size_t s = 0; s < all_rho.size(); ++s)
            for (std::size_t c = 0; c < all_rho[s].size(); ++c) all_rho[s][c] += light[s][c].more(all_rho[s][c]);
    }
    for (const std::vector<double>& rho : all_rho) colours.squares.push_back(colour(rho));
    return colours;
}

TargetColours drawn_colours(const Target& target, const std::vector<Eigen::Vector3d>& of_roles) {
    VOXTONE_EXPECT(of_roles.size() == target.roles.size());
    const auto mix = [&](const PatchMixture& mixture) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const ResinShare& share : mixture)
            sum +=
                share.fraction * of_roles[std::size_t(std::find(target.roles.begin(), target.roles.end(), share.role) -
                                                      target.roles.begin())];
        return sum;
    };
    const bool surfaces = !target.surfaces.empty();
    TargetColours colours{surfaces ? rgb_of(target, target.light) : mix({{target.light, 1.0}}),
                          surfaces ? rgb_of(target, target.dark) : mix({{target.dark, 1.0}}),
                          {}};
    colours.markers = mix(target.of_markers());
    for (const TargetSquare& square : target.squares) colours.squares.push_back(mix(square.top));
    return colours;
}

TargetScene::TargetScene(const Target& target, TargetColours colours)
    : target_(target), colours_(std::move(colours)), marker_(colours_.markers.value_or(colours_.dark)) {
    VOXTONE_EXPECT(colours_.squares.size() == target.squares.size());
    for (const TargetMarker& marker : target.markers) patterns_.push_back(marker_pattern(marker.id));
    bins_ = (target.size_mm.array() / bin_mm).ceil().cast<int>().max(1);
    squares_.resize(std::size_t(bins_.prod()));
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        const Area& area = target.squares[s].area;
        const Eigen::Array2i low = bin(area.min_mm), high = bin(area.max_mm);
        for (int y = low.y(); y <= high.y(); ++y)
            for (int x = low.x(); x <= high.x(); ++x) squares_[index({x, y})].push_back(s);
    }
}

/// Points beyond the edge are in the nearest bin.
Eigen::Array2i TargetScene::bin(const Eigen::Vector2d& p) const {
    return (p.array() / bin_mm).cast<int>().max(0).min(bins_ - 1);
}

const Eigen::Vector3d& TargetScene::at(const Eigen::Vector2d& p) const {
    for (const std::size_t s : squares_[index(bin(p))])
        if (target_.squares[s].area.contains(p)) return colours_.squares[s];
    for (std::size_t m = 0; m < target_.markers.size(); ++m) {
        const Area& area = target_.markers[m].area;
        if (!area.contains(p)) continue;
        const double cell = area.size().x() / marker_cells;
        const int column = std::min(marker_cells - 1, int((p.x() - area.min_mm.x()) / cell)),
                  row = std::min(marker_cells - 1, int((area.max_mm.y() - p.y()) / cell));
        return patterns_[m][std::size_t(row * marker_cells + column)] ? marker_ : colours_.light;
    }
    return target_.dark_half.contains(p) ? colours_.dark : colours_.light;
}

io::LinearPicture target_preview(const Target& target, const TargetColours& colours, double px_per_mm) {
    const TargetScene scene(target, colours);
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>(std::lround(target.size_mm.x() * px_per_mm));
    picture.height_px = static_cast<std::uint32_t>(std::lround(target.size_mm.y() * px_per_mm));
    for (std::uint32_t y = 0; y < picture.height_px; ++y)
        for (std::uint32_t x = 0; x < picture.width_px; ++x) {
            const Eigen::Vector3f rgb =
                scene.at({(x + 0.5) / px_per_mm, target.size_mm.y() - (y + 0.5) / px_per_mm}).cast<float>();
            picture.pixels.emplace_back(rgb.x(), rgb.y(), rgb.z(), 1.0f);
        }
    return picture;
}

}  // namespace voxtone::calibration
