// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print small enough to reason about, for tests of the appearance loop: a slab whose columns are one voxel per
// surface cell and layer, and a model that sees the column's mixture blurred over its neighbours. Not light: a linear
// blur whose inverse the loop has to find.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "halftone/loop/appearance_loop.h"
#include "halftone/screens/blue_noise_screen.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::test {

/// A slab of n x n cells of 2 x 1 voxels, J750 voxels.
struct SmallSlab {
    static constexpr std::array<double, 3> pitch{25.4 / 600, 25.4 / 300, 0.027};
    static constexpr int layers = 48;

    explicit SmallSlab(int n, const optics::ResinSet& set)
        : cells(n), resins(set), screen(pitch), skin(halftone::skin_layers(1)), white(set.find("W")) {
        const auto voxels =
            optics::make_resin_volume({2 * n, n, layers}, pitch, [&](int, int, int) { return white + 1; });
        plain = voxels;
        scene = {&plain, &resins, optics::Backing::black, optics::Sides::mirrored};
        surface = optics::find_surface(scene, {2, 1, 3}, optics::SurfacePart::top);
        optics::ShellGeometry geometry;
        geometry.core_resin = white;
        geometry.shell_mm = skin.depth_mm();
        geometry.pitch_mm = pitch;
        geometry.core_mm = layers * pitch[2] - skin.depth_mm();
        geometry.backing = optics::Backing::black;
        halftone::SeparationOptions options;
        options.nodes = 17;
        recipes = std::make_unique<const halftone::MinimalDepthSeparation>(optics::ShellAppearance(resins, geometry),
                                                                           skin, options);
    }
    /// Surface cells are in order of y, x.
    [[nodiscard]] optics::ResinVolume print(const halftone::SkinMixtures& mixtures) const {
        const auto screened = halftone::cumulative_mixtures(mixtures);
        const int n = static_cast<int>(resins.resins.size());
        return optics::make_resin_volume({2 * cells, cells, layers}, pitch, [&](int x, int y, int z) {
            const std::size_t layer = skin.layer_of((layers - z - 0.5) * pitch[2]);
            if (layer == skin.size()) return white + 1;
            const std::size_t cell = static_cast<std::size_t>(y * cells + x / 2);
            return 1 + halftone::select_resin(screened[cell * skin.size() + layer], screen.threshold(x, y, z), n);
        });
    }
    [[nodiscard]] halftone::LoopTask task(const optics::AppearanceModel& model, const optics::ResinVolume& open,
                                          std::span<const Eigen::Vector3f> target) {
        scene.volume = &plain;
        halftone::LoopTask task;
        task.model = &model;
        task.scene = scene;
        task.surface = &surface;
        task.recipes = recipes.get();
        task.target = target;
        task.open_loop = [&open] { return open; };
        task.realise = [this](const halftone::SkinMixtures& mixtures) { return print(mixtures); };
        return task;
    }

    int cells;
    optics::ResinSet resins;
    halftone::BlueNoiseScreen screen;
    halftone::SkinLayers skin;
    int white;
    optics::ResinVolume plain;
    optics::Scene scene;
    optics::Surface surface;
    std::unique_ptr<const halftone::MinimalDepthSeparation> recipes;
};

/// Each cell shows 1 - the share of voxels of other resins than white in its column's upper voxels, blurred: weight
/// `spread` for the four neighbours together. The same in all channels.
class BlurringModel final : public optics::AppearanceModel {
public:
    explicit BlurringModel(int cells, int white_material, float spread)
        : cells_(cells), white_(white_material), spread_(spread) {}
    [[nodiscard]] optics::Appearance predict(const optics::Scene& scene, const optics::Surface& surface,
                                             const Progress* progress) const override {
        if (progress) progress->check_cancelled();
        ++predictions;
        const auto& size = scene.volume->size();
        std::vector<float> light(static_cast<std::size_t>(cells_ * cells_));
        for (int y = 0; y < cells_; ++y)
            for (int x = 0; x < cells_; ++x) {
                int ink = 0;
                constexpr int deep = 16;
                for (int k = 1; k <= deep; ++k)
                    for (int i = 0; i < 2; ++i) ink += scene.volume->at(2 * x + i, y, size[2] - k) != white_;
                light[static_cast<std::size_t>(y * cells_ + x)] =
                    std::pow(1 - static_cast<float>(ink) / (2 * deep), 3.0f);
            }
        optics::Appearance seen;
        seen.channels = 3;
        for (const optics::SurfaceCell& cell : surface.cells) {
            const auto at = [&](int x, int y) {
                return light[static_cast<std::size_t>(std::clamp(y, 0, cells_ - 1) * cells_ +
                                                      std::clamp(x, 0, cells_ - 1))];
            };
            const int x = cell.cell[0], y = cell.cell[1];
            const float value =
                (1 - spread_) * at(x, y) + spread_ / 4 * (at(x - 1, y) + at(x + 1, y) + at(x, y - 1) + at(x, y + 1));
            seen.value.insert(seen.value.end(), 3, value);
        }
        return seen;
    }
    mutable int predictions = 0;

private:
    int cells_;
    optics::Material white_;
    float spread_;
};

}  // namespace voxtone::test
