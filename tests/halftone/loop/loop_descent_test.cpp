// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the loop does where the model has a gradient: from which print it starts downhill, and what it prints last.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
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
        : Run(spread, LoopOptions{.iterations = iterations, .viewing_distance_mm = 50}) {}
    Run(float spread, const LoopOptions& options, std::optional<ResumedLoop> resume = {}, Progress&& progress = {})
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
        result = run_appearance_loop(
            task, options, progress,
            [&](const LoopState& state, const auto&) {
                states.push_back(state);
                // What was handed over is as it was until this is called.
                return [this, &state, then = states.size() - 1] {
                    ++looked;
                    is_as_it_was =
                        is_as_it_was && state.steps.size() == states[then].steps.size() &&
                        state.control == states[then].control && state.shown == states[then].shown &&
                        std::ranges::equal(state.descent.mixtures.all(), states[then].descent.mixtures.all());
                };
            },
            std::move(resume));
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
    std::size_t looked = 0;
    bool is_as_it_was = true;
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

namespace {

constexpr LoopOptions six{.iterations = 6, .viewing_distance_mm = 50};

/// Ends the work after some predictions.
class Ends final : public Progress {
public:
    explicit Ends(std::uint64_t after) : after_(after) {}

private:
    void on_advance(std::uint64_t done) override {
        if (done >= after_) cancel();
    }
    std::uint64_t after_;
};

}  // namespace

TEST_CASE("A loop that goes downhill is the same resumed at any of its steps, and tells who looks on before it changes",
          "[loop]") {
    const Run whole(0.9f, six);
    REQUIRE(whole.states.size() == 7);
    REQUIRE(whole.result.best);
    CHECK(whole.looked == whole.states.size());
    CHECK(whole.is_as_it_was);
    CHECK(whole.result.why_stopped == all_iterations_made);
    CHECK_FALSE(whole.result.cancelled);
    for (const std::size_t at : {std::size_t{1}, std::size_t{4}}) {
        CAPTURE(at);
        const Run rest(0.9f, six, ResumedLoop{whole.states[at], {}});
        CHECK(rest.states.size() == 6 - at);
        REQUIRE(rest.result.best);
        CHECK(std::ranges::equal(rest.result.best->all(), whole.result.best->all()));
        CHECK(rest.result.state.best == whole.result.state.best);
        CHECK(rest.result.state.shown == whole.result.state.shown);
        CHECK(rest.result.state.urgency == whole.result.state.urgency);
        REQUIRE(rest.result.state.steps.size() == 7);
        for (std::size_t k = 0; k < 7; ++k)
            CHECK(rest.result.state.steps[k].score == whole.result.state.steps[k].score);
    }
    // What has made them all makes none.
    const Run done(0.9f, six, ResumedLoop{whole.states[6], {}});
    CHECK((done.printed.empty() && done.states.empty()));
    CHECK(std::ranges::equal(done.result.best->all(), whole.result.best->all()));
    // Of another number of values, or of a loop that looks at no white, it is refused.
    LoopState other = whole.states[4];
    other.white.pop_back();
    CHECK_THROWS_AS(Run(0.9f, six, ResumedLoop{other, {}}), InputError);
    LoopOptions absolute = six;
    absolute.intent = Intent::absolute;
    CHECK_THROWS_AS(Run(0.9f, absolute, ResumedLoop{whole.states[4], {}}), InputError);
}

TEST_CASE("A loop that is stopped on its way downhill has the best print so far, and what it knows of each", "[loop]") {
    const Run stopped(0.9f, six, {}, Ends(6));
    const LoopState& state = stopped.result.state;
    CHECK(stopped.result.cancelled);
    CHECK(stopped.result.why_stopped == "it was stopped");
    CHECK(state.steps.size() == 6);
    CHECK(stopped.looked == stopped.states.size());
    CHECK(state.best > 0);
    for (std::size_t k = 0; k < state.steps.size(); ++k) {
        CHECK(state.steps[k].iteration == int(k));
        CHECK(state.steps[state.best].score <= state.steps[k].score);
    }
    REQUIRE(stopped.result.best);
    CHECK(std::ranges::equal(stopped.result.best->all(), stopped.printed[state.best - 1].all()));
    CHECK(stopped.result.seen_target);
    CHECK(stopped.result.in_gamut.size() == stopped.target.size());
}

TEST_CASE("Without a descent feedback alone goes on, and an absolute target is of no white twin", "[loop]") {
    LoopOptions options{.iterations = 5, .viewing_distance_mm = 50};
    options.descent = false;
    options.intent = Intent::absolute;
    const Run run(0.3f, options);
    CHECK(run.methods() == "offfff");
    CHECK(run.model.gradients == 0);
    CHECK(run.result.state.white.empty());
    const auto& steps = run.result.state.steps;
    CHECK(steps[run.result.state.best].score < steps[0].score);
    for (const LoopStep& step : steps) CHECK((step.saturated_share >= 0 && step.saturated_share <= 1));
    REQUIRE(run.result.best);
    CHECK(std::ranges::equal(run.result.best->all(),
                             mixtures_of(*run.slab.recipes, run.result.state.start_control).all()));
    // Where contrast is asked for, the same goes downhill to another print.
    options = six;
    options.intent = Intent::contrast;
    const Run contrast(0.9f, options), relative(0.9f, six);
    CHECK_FALSE(std::ranges::equal(contrast.printed.back().all(), relative.printed.back().all()));
}
