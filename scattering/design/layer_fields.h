// SPDX-License-Identifier: GPL-3.0-or-later
//
// Height fields of layers over a map: how deep each layer of an aligned laminate reaches at every point.
//
// A map of pixels, each with the laminate of a cluster. Between the pixels' centres thicknesses are interpolated
// bilinearly, so layers that the one has and the other has not run out in a wedge, without a step. `smoothing_mm` > 0
// puts a Gaussian of that standard deviation over the thicknesses first. Layers keep their order: with b_l the depth of
// the bottom of layer l, 0 <= b_0 <= b_1 <= ...; where a layer has thickness zero b_l = b_(l-1), to the bit, and no
// depth falls in it.
//
// Beyond the map's edges: repeated, mirrored, or the edge's value for ever. Coordinates in mm from the lower left
// corner, x to the right, y upwards; the map's rows run from the top. Memory: 4 bytes per pixel and layer. Single
// precision: depths are within 1e-6 of themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scattering/design/aligned_laminates.h"

namespace voxtone::scattering {

enum class MapEdge { repeat, mirror, extend };

struct LaminateMap {
    std::uint32_t width_px = 0, height_px = 0;
    double width_mm = 0, height_mm = 0;
    std::span<const std::uint16_t> laminate;  ///< per pixel, rows from the top; below the number of laminates
    MapEdge edge = MapEdge::extend;
    double smoothing_mm = 0;
};

class LayerFields {
public:
    /// More layers than any set of laminates of a printer's resins needs.
    static constexpr std::size_t max_layers = 128;

    /// Contract: sizes above 0, laminates that exist, smoothing >= 0, at most max_layers layers.
    LayerFields(const LaminateMap& map, const AlignedLaminates& laminates);

    [[nodiscard]] std::size_t layers() const { return material_.size(); }
    [[nodiscard]] std::size_t material(std::size_t layer) const { return material_[layer]; }
    /// Depths of the bottoms of all layers at a point.
    void bottoms(double x_mm, double y_mm, std::span<float> out) const;
    /// The layer that a depth >= 0 at a point lies in; layers() below them all. The top of a layer belongs to it.
    [[nodiscard]] std::size_t layer_at(double x_mm, double y_mm, float depth_mm) const;
    /// The laminate of the pixel that a point lies in.
    [[nodiscard]] std::size_t laminate_at(double x_mm, double y_mm) const;
    /// Of all layers together at a point, and at most anywhere.
    [[nodiscard]] float depth_mm(double x_mm, double y_mm) const;
    [[nodiscard]] float most_depth_mm() const { return most_depth_; }

private:
    /// The four pixels about a point and their weights.
    struct Corners {
        const float* at[4];
        float weight[4];
        [[nodiscard]] float mix(std::size_t l) const {
            return weight[0] * at[0][l] + weight[1] * at[1][l] + weight[2] * at[2][l] + weight[3] * at[3][l];
        }
    };
    [[nodiscard]] Corners corners(double x_mm, double y_mm) const;
    void smooth(double sigma_x_px, double sigma_y_px);

    std::vector<std::size_t> material_;
    std::int64_t width_, height_;
    double per_mm_x_, per_mm_y_;  ///< pixels
    MapEdge edge_;
    std::vector<std::uint16_t> laminate_;  ///< pixel by pixel
    std::vector<float> bottom_;            ///< and layer by layer
    float most_depth_ = 0;
};

}  // namespace voxtone::scattering
