// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/column_sampling.h"

#include <algorithm>
#include <cmath>

#include "optics/media/mirrored_box.h"

namespace voxtone::optics {
namespace {

constexpr double deepest_mm = 15;
constexpr double depth_steps = 16;
constexpr std::size_t most_walks = 16;

}  // namespace

ColumnSampler::ColumnSampler(const Scene& scene)
    : scene_(scene), volume_(*scene.volume), materials_(scene.resins->resins.size() + 1) {
    step_mm_ = *std::min_element(volume_.pitch_mm().begin(), volume_.pitch_mm().end());
}

void ColumnSampler::under(const Surface& surface, const SurfaceCell& cell, MaterialColumn& layers) const {
    layers.steps.clear();
    layers.shares.clear();
    layers.mm = 0;
    const std::size_t walks = std::min<std::size_t>(cell.faces, most_walks);
    std::vector<std::array<double, 3>> from;
    for (std::size_t w = 0; w < walks; ++w)
        from.push_back(centre(surface.faces[cell.first_face + w * cell.faces / walks]));
    std::vector<char> inside(walks, 1);
    std::size_t left = walks, on_sheet = 0;
    layers.end = LayersEnd::endless;
    while (layers.mm < deepest_mm) {
        const double mm = std::max(step_mm_, layers.mm / depth_steps), depth = layers.mm + 0.5 * mm;
        std::vector<float> shares(materials_);
        for (std::size_t w = 0; w < walks; ++w) {
            if (!inside[w]) continue;
            bool below = false;
            const Material material = at(from[w], cell.normal, depth, below);
            if (material != air) {
                shares[material] += 1;
                continue;
            }
            inside[w] = 0;
            --left;
            on_sheet += below ? 1 : 0;
        }
        if (2 * left < walks || left == 0) {
            layers.end = end(2 * on_sheet > walks);
            return;
        }
        for (float& share : shares) share /= static_cast<float>(left);
        layers.steps.push_back({mm, layers.shares.size()});
        layers.shares.insert(layers.shares.end(), shares.begin(), shares.end());
        layers.mm += mm;
    }
}

std::array<double, 3> ColumnSampler::centre(const SurfaceFace& face) const {
    std::array<double, 3> place{};
    for (std::size_t a = 0; a < 3; ++a) place[a] = (face.voxel[a] + 0.5) * volume_.pitch_mm()[a];
    const auto axis = static_cast<std::size_t>(face.facing) / 2;
    place[axis] += (static_cast<int>(face.facing) % 2 == 1 ? 0.5 : -0.5) * volume_.pitch_mm()[axis];
    return place;
}

Material ColumnSampler::at(const std::array<double, 3>& from, const std::array<float, 3>& normal, double depth,
                           bool& below) const {
    std::array<int, 3> voxel{};
    for (std::size_t a = 0; a < 3; ++a)
        voxel[a] = static_cast<int>(std::floor((from[a] - depth * normal[a]) / volume_.pitch_mm()[a]));
    below = voxel[2] < 0;
    if (scene_.sides == Sides::mirrored)
        for (std::size_t a = 0; a < 2; ++a) voxel[a] = reflected(voxel[a], volume_.size()[a]);
    return volume_.at(voxel[0], voxel[1], voxel[2]);
}

LayersEnd ColumnSampler::end(bool on_plane) const {
    if (!on_plane || scene_.backing == Backing::none) return LayersEnd::open;
    return scene_.backing == Backing::white ? LayersEnd::white_sheet : LayersEnd::black_sheet;  // others: refused
}

}  // namespace voxtone::optics
