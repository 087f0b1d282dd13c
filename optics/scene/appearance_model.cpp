// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/appearance_model.h"

#include <utility>

#include "base/step_part.h"

namespace voxtone::optics {
namespace {

class AnewEachTime final : public AppearanceSequence {
public:
    AnewEachTime(const AppearanceModel& model, const Scene& scene, const Surface& surface)
        : model_(model), scene_(scene), surface_(surface) {}
    [[nodiscard]] Appearance next(const ResinVolume& volume, const Progress* progress) override {
        Scene scene = scene_;
        scene.volume = &volume;
        return model_.predict(scene, surface_, progress);
    }

private:
    const AppearanceModel& model_;
    Scene scene_;
    const Surface& surface_;
};

}  // namespace

bool AppearanceSequence::gradient(std::span<const float> /*adjoint_seed*/, const GradientVisitor& /*visit*/,
                                  const Progress* /*progress*/) {
    return false;
}

TwinAppearances AppearanceModel::predict_with_twin(const Scene& scene, const Surface& surface, const ResinVolume& twin,
                                                   const Progress* progress) const {
    Scene other = scene;
    other.volume = &twin;
    const auto half = [&](const Scene& of, double from) {
        const PartRange range(progress, from, from + 0.5);
        return predict(of, surface, progress);
    };
    Appearance body = half(scene, 0);
    return {std::move(body), half(other, 0.5)};
}

std::unique_ptr<AppearanceSequence> AppearanceModel::sequence(const Scene& scene, const Surface& surface,
                                                              const Progress* /*progress*/) const {
    return std::make_unique<AnewEachTime>(*this, scene, surface);
}

}  // namespace voxtone::optics
