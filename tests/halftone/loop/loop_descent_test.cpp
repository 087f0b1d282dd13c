// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the loop does where the model has a gradient: from which print it starts downhill, and what it prints last.
#include <catch2/catch.hpp>

#include <cmath>

#include "blurring_model.h"

using namespace voxtone;
using namespace voxtone::halftone;
using namespace voxtone::test;

namespace {

constexpr int n = 16;

/// The blurring model with the derivative of its blur. By mixtures, as if the print were exactly these: the light of a
/// column is w^3, w the white of its upper 0.43 mm.
class DifferentiableBlur final : public optics::AppearanceModel {
public:
    DifferentiableBlur(int white, float spread)
        : blur_(n, static_cast<optics::Material>(white + 1), spread), spread_(spread) {}
    [[nodiscard]] optics::Appearance predict(const optics::Scene& scene, const optics::Surface& surface,
                                             const Progress* progress) const override {
        return blur_.predict(scene, surface, progress);
    }
    [[nodiscard]] std::unique_ptr<optics::AppearanceSequence> sequence(const optics::Scene& scene,
                                                                       const optics::Surface& surface,
                                                                       const Progress*) const override {
        class Sequence final : public optics::AppearanceSequence {
        public:
            Sequence(const DifferentiableBlur& model, const optics::Scene& scene, const optics::Surface& surface)
                : model_(model), scene_(scene), surface_(surface) {}
            [[nodiscard]] optics::Appearance next(const optics::ResinVolume& volume,
                                                  const Progress* progress) override {
                optics::Scene now = scene_;
                now.volume = &volume;
                return model_.predict(now, surface_, progress);
            }
            [[nodiscard]] bool gradient(std::span<const float> adjoint_seed, const GradientVisitor&,
                                        const Progress*) override {
                model_.adjoint_seed.assign(adjoint_seed.begin(), adjoint_seed.end());
                ++model_.gradients;
                return true;
            }

        private:
            const DifferentiableBlur& model_;
            const optics::Scene& scene_;
            const optics::Surface& surface_;
        };
        return std::make_unique<Sequence>(*this, scene, surface);
    }
    /// As LoopTask::mixture_gradient, at the mixtures that were printed last. Cells are in order of y, x.
    [[nodiscard]] std::vector<float> mixture_gradient(const SkinMixtures& printed, std::size_t white) const {
        std::vector<float> out(printed.all().size(), 0.0f);
        const std::array<float, 4> share{4 / 16.0f, 4 / 16.0f, 7 / 16.0f, 1 / 16.0f};  // of the upper 16 voxels, about
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const auto of_cell = [&](int i, int j) {
                    return 3 * static_cast<std::size_t>(std::clamp(j, 0, n - 1) * n + std::clamp(i, 0, n - 1));
                };
                float by_light = 0;
                for (std::size_t c = 0; c < 3; ++c)
                    by_light += (1 - spread_) * adjoint_seed[of_cell(x, y) + c] +
                                spread_ / 4 *
                                    (adjoint_seed[of_cell(x - 1, y) + c] + adjoint_seed[of_cell(x + 1, y) + c] +
                                     adjoint_seed[of_cell(x, y - 1) + c] + adjoint_seed[of_cell(x, y + 1) + c]);
                const std::size_t cell = static_cast<std::size_t>(y * n + x);
                float w = 0;
                for (std::size_t l = 0; l < share.size(); ++l)
                    w += share[l] * printed.cell(cell)[l * printed.resins() + white];
                for (std::size_t l = 0; l < share.size(); ++l)
                    out[(cell * share.size() + l) * printed.resins() + white] = by_light * 3 * w * w * share[l];
            }
        return out;
    }
    mutable std::vector<float> adjoint_seed;
    mutable int gradients = 0;

private:
    BlurringModel blur_;
    float spread_;
};

/// A loop over a chequered slab, and all that it printed.
struct Run {
    explicit Run(float spread, int iterations)
        : slab(n, optics::vero_opaque().subset(std::vector<std::string>{"K", "W"})), model(slab.white, spread) {
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) target.push_back(Eigen::Vector3f::Constant((x + y) % 2 ? 0.25f : 0.55f));
        const optics::ResinVolume open = slab.print(mixtures_of(*slab.recipes, target));
        LoopTask task = slab.task(model, open, target);
        task.realise = [this](const SkinMixtures& mixtures) {
            printed.push_back(mixtures);
            return slab.print(mixtures);
        };
        task.mixture_gradient = [this](const std::function<bool(const LoopTask::GradientVisitor&)>& visit_all) {
            if (!visit_all([](const optics::ResinGradient&, const optics::VoxelBox&) {})) return std::vector<float>{};
            return model.mixture_gradient(printed.back(), static_cast<std::size_t>(slab.white));
        };
        Progress quiet;
        result = run_appearance_loop(task, {.iterations = iterations, .viewing_distance_mm = 50}, quiet,
                                     [&](const LoopState& state, const auto&) {
                                         states.push_back(state);
                                         return nullptr;
                                     });
    }
    [[nodiscard]] std::string methods() const {
        std::string all;
        for (const LoopStep& step : result.state.steps) all += static_cast<char>(step.method);
        return all;
    }

    SmallSlab slab;
    DifferentiableBlur model;
    std::vector<Eigen::Vector3f> target;
    std::vector<SkinMixtures> printed;
    std::vector<LoopState> states;
    LoopResult result;
};

}  // namespace

TEST_CASE("Where feedback makes things worse, the loop starts downhill from the print without it", "[loop]") {
    // A cell shows its neighbours, which want the opposite: what it does for itself is wrong.
    const Run run(0.9f, 10);
    const auto& steps = run.result.state.steps;
    // Then downhill to the end, however many steps that takes.
    CHECK(run.methods().substr(0, 4) == "offd");
    CHECK(run.methods().find_first_not_of('d', 3) == std::string::npos);
    CHECK(steps[1].seen.mean > steps[0].seen.mean);
    CHECK(steps[2].seen.mean < 0.97 * steps[1].seen.mean);
    // The second print was that of the target itself, mapped into the gamut of black and white resin.
    CHECK(run.states[1].control != run.states[0].control);
    CHECK(run.result.state.start_control == run.states[1].control);
    CHECK(run.result.state.start_control[0].x() == Approx(run.target[0].x()).margin(0.05));
    CHECK(steps[run.result.state.best].method == LoopMethod::descent);
    CHECK(steps[run.result.state.best].seen.mean < 0.5 * steps[0].seen.mean);
}

TEST_CASE("Where feedback helps, the loop starts downhill from it", "[loop]") {
    const Run run(0.3f, 8);
    const auto& steps = run.result.state.steps;
    CHECK(run.methods().substr(0, 3) == "off");
    CHECK(run.methods().back() == 'd');
    CHECK(steps[1].seen.mean < 0.97 * steps[0].seen.mean);
    CHECK(run.result.state.start_control != run.target);
}

TEST_CASE("A gradient is asked for where a step follows, and not of the last print", "[loop]") {
    for (const int iterations : {8, -1}) {
        const Run run(0.9f, iterations);
        const std::string methods = run.methods();
        CHECK(run.model.gradients == std::ranges::count(methods, 'd'));
    }
}

TEST_CASE("The last iteration prints the running mean of the descent, those before it their own", "[loop][slow]") {
    const Run run(0.9f, 8);
    REQUIRE(run.states.size() == 9);
    const auto mean_of = [](const LoopState& before) {
        SkinMixtures mean = before.recent;
        const SkinMixtures now = printed(before.descent.mixtures);
        for (std::size_t i = 0; i < mean.all().size(); ++i) mean.all()[i] = (mean.all()[i] + now.all()[i]) / 2;
        return mean;
    };
    CHECK(std::ranges::equal(run.printed[6].all(), printed(run.states[6].descent.mixtures).all()));
    CHECK(std::ranges::equal(run.printed[7].all(), mean_of(run.states[7]).all()));
    CHECK_FALSE(std::ranges::equal(run.printed[7].all(), printed(run.states[7].descent.mixtures).all()));
}
