// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/light_from_behind.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "base/contracts.h"
#include "base/step_part.h"

namespace voxtone::optics {
namespace {

Scene over(Scene scene, Backing backing) {
    scene.backing = backing;
    return scene;
}

Appearance difference(Appearance lit_from_both, const Appearance& lit_from_front) {
    VOXTONE_ENSURE(lit_from_both.value.size() == lit_from_front.value.size());
    for (std::size_t i = 0; i < lit_from_front.value.size(); ++i) lit_from_both.value[i] -= lit_from_front.value[i];
    for (std::size_t i = 0; i < lit_from_front.standard_error.size(); ++i)
        lit_from_both.standard_error[i] = std::hypot(lit_from_both.standard_error[i], lit_from_front.standard_error[i]);
    for (const std::string& remark : lit_from_front.remarks)
        if (std::ranges::find(lit_from_both.remarks, remark) == lit_from_both.remarks.end())
            lit_from_both.remarks.push_back(remark);
    return lit_from_both;
}

/// `of(scene, progress)` for both; each is a half of the work.
template <class Ask>
Appearance both(const Scene& with, const Scene& without, const Progress* progress, const Ask& ask) {
    Appearance lit_from_both = [&] {
        const PartRange half(progress, 0, 0.5);
        return ask(with);
    }();
    const PartRange half(progress, 0.5, 1);
    return difference(std::move(lit_from_both), ask(without));
}

class SequenceFromBehind final : public AppearanceSequence {
public:
    SequenceFromBehind(const AppearanceModel& model, const Scene& scene, const Surface& surface,
                       const Progress* progress)
        : with_(over(scene, Backing::none)),
          without_(over(scene, Backing::black)),
          lit_from_both_(model.sequence(with_, surface, progress)),
          lit_from_front_(model.sequence(without_, surface, progress)) {}

    void write_state(const StateSink& sink) const override {
        std::uint64_t bytes = 0;
        lit_from_both_->write_state([&](std::span<const std::byte> piece) { bytes += piece.size(); });
        sink(std::as_bytes(std::span(&bytes, 1)));
        lit_from_both_->write_state(sink);
        lit_from_front_->write_state(sink);
    }
    [[nodiscard]] bool read_state(std::span<const std::byte> state) override {
        std::uint64_t bytes = 0;
        if (state.size() < sizeof bytes) return false;
        std::memcpy(&bytes, state.data(), sizeof bytes);
        state = state.subspan(sizeof bytes);
        return bytes <= state.size() && lit_from_both_->read_state(state.first(bytes)) &&
               lit_from_front_->read_state(state.subspan(bytes));
    }
    [[nodiscard]] Appearance next(const ResinVolume& volume, const Progress* progress) override {
        return both(with_, without_, progress, [&](const Scene& scene) { return of(scene).next(volume, progress); });
    }
    [[nodiscard]] Appearance twin(const ResinVolume& volume, const Progress* progress) override {
        return both(with_, without_, progress, [&](const Scene& scene) { return of(scene).twin(volume, progress); });
    }
    /// Every voxel is visited twice: what is summed up comes out right.
    [[nodiscard]] bool gradient(std::span<const float> adjoint_seed, const GradientVisitor& visit,
                                const Progress* progress) override {
        if (!lit_from_both_->gradient(adjoint_seed, visit, progress)) return false;
        std::vector<float> negative(adjoint_seed.begin(), adjoint_seed.end());
        for (float& seed : negative) seed = -seed;
        return lit_from_front_->gradient(negative, visit, progress);
    }

private:
    [[nodiscard]] AppearanceSequence& of(const Scene& scene) {
        return &scene == &with_ ? *lit_from_both_ : *lit_from_front_;
    }

    Scene with_, without_;
    std::unique_ptr<AppearanceSequence> lit_from_both_, lit_from_front_;
};

}  // namespace

Appearance LightFromBehind::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    return both(over(scene, Backing::none), over(scene, Backing::black), progress,
                [&](const Scene& of) { return model_->predict(of, surface, progress); });
}

std::unique_ptr<AppearanceSequence> LightFromBehind::sequence(const Scene& scene, const Surface& surface,
                                                              const Progress* progress) const {
    return std::make_unique<SequenceFromBehind>(*model_, scene, surface, progress);
}

}  // namespace voxtone::optics
