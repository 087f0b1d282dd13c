// SPDX-License-Identifier: GPL-3.0-or-later
//
// The coloured skin in the unknowns of the appearance loop: a mixture of resins for every surface cell and every layer
// of depth below it. A voxel belongs to the surface cell that is nearest to it and to the layer that its depth falls
// in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "halftone/separation/mixture.h"

namespace voxtone::halftone {

/// Layers below the surface: layer l reaches from bottom_mm[l - 1] (0 for the first) to bottom_mm[l]. Rising.
struct SkinLayers {
    std::vector<double> bottom_mm;

    [[nodiscard]] std::size_t size() const { return bottom_mm.size(); }
    [[nodiscard]] double depth_mm() const { return bottom_mm.empty() ? 0 : bottom_mm.back(); }
    [[nodiscard]] double top_mm(std::size_t layer) const { return layer == 0 ? 0 : bottom_mm[layer - 1]; }
    /// size() for depths below the skin.
    [[nodiscard]] std::size_t layer_of(double depth_mm) const {
        return static_cast<std::size_t>(std::upper_bound(bottom_mm.begin(), bottom_mm.end(), depth_mm) -
                                        bottom_mm.begin());
    }
};

/// The layers that the loop uses when colour may reach `depth_mm` deep, as deep as without a loop: through four fifths
/// of the black of a common set white shines, 14 CIEDE2000 off where it is 11. What lies deep is seen blurred and needs
/// no finer choice; halves (1/8 to 1) came out the same on photographs, and a little worse on solids
/// (docs/decisions/005).
[[nodiscard]] inline SkinLayers skin_layers(double depth_mm) {
    return {{0.1 * depth_mm, 0.2 * depth_mm, 0.4 * depth_mm, depth_mm}};
}

/// Fractions per cell, layer and resin; those of a cell's layer sum to 1.
class SkinMixtures {
public:
    SkinMixtures() = default;
    SkinMixtures(std::size_t cells, std::size_t layers, std::size_t resins)
        : layers_(layers), resins_(resins), fraction_(cells * layers * resins, 0.0f) {
        VOXTONE_EXPECT(resins >= 1 && resins <= max_resins);
    }
    /// Fractions as `all` gives them; their number is a multiple of layers * resins.
    SkinMixtures(std::size_t layers, std::size_t resins, std::vector<float> fractions)
        : layers_(layers), resins_(resins), fraction_(std::move(fractions)) {
        VOXTONE_EXPECT(fraction_.empty() || (resins >= 1 && resins <= max_resins && layers >= 1 &&
                                             fraction_.size() % (layers * resins) == 0));
    }
    [[nodiscard]] std::size_t cells() const { return fraction_.empty() ? 0 : fraction_.size() / (layers_ * resins_); }
    [[nodiscard]] std::size_t layers() const { return layers_; }
    [[nodiscard]] std::size_t resins() const { return resins_; }
    /// All layers of a cell: layers x resins.
    [[nodiscard]] std::span<float> cell(std::size_t c) {
        return {fraction_.data() + c * layers_ * resins_, layers_ * resins_};
    }
    [[nodiscard]] std::span<const float> cell(std::size_t c) const {
        return {fraction_.data() + c * layers_ * resins_, layers_ * resins_};
    }
    [[nodiscard]] std::span<float> all() { return fraction_; }
    [[nodiscard]] std::span<const float> all() const { return fraction_; }

private:
    std::size_t layers_ = 0, resins_ = 0;
    std::vector<float> fraction_;
};

/// As the screens read them: [cell * layers + layer]. Fractions need not sum to 1 exactly; negative ones count as 0.
[[nodiscard]] std::vector<CumulativeMixture> cumulative_mixtures(const SkinMixtures& skin);

}  // namespace voxtone::halftone
