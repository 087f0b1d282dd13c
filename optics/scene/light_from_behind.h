// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is seen of a slab by light from behind alone: that of a diffuse source that is as wide as the slab and lies
// behind it with air between, as a lithophane has it.
//
//   through = appearance (backing none: the same light comes from either side) - appearance (backing black: none comes
//   from below, and what leaves there is gone)
//
// which is exact, for light adds up and the lower face is the same in both. Appearance of a cell is then flux that
// leaves there / flux of the source through as large a piece of the lower face, less what that reflects. Light that
// comes in at open sides is in both and falls out. Errors of the model's own: those of two predictions; standard errors
// are told as if they were independent, which is too much for a model that follows the same paths in both.
#pragma once

#include <memory>

#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

class LightFromBehind final : public AppearanceModel {
public:
    /// Asks `model` twice, whatever backing a scene has.
    explicit LightFromBehind(std::unique_ptr<const AppearanceModel> model) : model_(std::move(model)) {}

    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface,
                                     const Progress* progress = nullptr) const override;
    [[nodiscard]] std::unique_ptr<AppearanceSequence> sequence(const Scene& scene, const Surface& surface,
                                                               const Progress* progress = nullptr) const override;

private:
    std::unique_ptr<const AppearanceModel> model_;
};

}  // namespace voxtone::optics
