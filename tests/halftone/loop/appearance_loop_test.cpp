// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/job_outlook.h"
#include "blurring_model.h"
#include "halftone/loop/residual_feedback.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::halftone;
using namespace voxtone::test;

namespace {

using Roles = std::vector<std::string>;
constexpr int n = 24;

optics::ResinSet black_and_white() { return optics::vero_opaque().subset(Roles{"K", "W"}); }

/// Grey stripes of 4 cells.
std::vector<Eigen::Vector3f> stripes(float dark, float light) {
    std::vector<Eigen::Vector3f> target;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) target.push_back(Eigen::Vector3f::Constant(x / 4 % 2 ? dark : light));
    return target;
}

/// Ends the work after some predictions.
class Impatient final : public Progress {
public:
    explicit Impatient(int after) : after_(after) {}

private:
    void on_advance(std::uint64_t done) override {
        if (static_cast<int>(done) >= after_) cancel();
    }
    int after_;
};

/// How many steps the loop says that it will have, at its begin and after each.
class TellsSteps final : public Progress, public ShowsOutlook {
public:
    std::vector<std::uint64_t> told;
    void expect(std::vector<ExpectedStage>) override {}
    void expect_steps(std::uint64_t steps) override { told.push_back(steps); }

private:
    void on_stage(std::string_view, std::uint64_t steps, std::string_view) override { told.push_back(steps); }
};

LoopResult run(SmallSlab& slab, const BlurringModel& model, std::span<const Eigen::Vector3f> target,
               const LoopOptions& options, Progress& progress, const LoopListener& listener = {},
               std::optional<ResumedLoop> resume = std::nullopt) {
    const optics::ResinVolume open = slab.print(mixtures_of(*slab.recipes, target));
    return run_appearance_loop(slab.task(model, open, target), options, progress, listener, std::move(resume));
}

}  // namespace

TEST_CASE("The last look is at the print that is kept, after all others", "[loop]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel blur(n, 2, 0.5f);
    /// Says half of what is seen at last.
    class Halving final : public optics::AppearanceModel {
    public:
        explicit Halving(const BlurringModel& blur) : blur_(blur) {}
        [[nodiscard]] optics::Appearance predict(const optics::Scene& scene, const optics::Surface& surface,
                                                 const Progress* progress) const override {
            return blur_.predict(scene, surface, progress);
        }
        [[nodiscard]] std::unique_ptr<optics::AppearanceSequence> sequence(const optics::Scene& scene,
                                                                           const optics::Surface& surface,
                                                                           const Progress*) const override {
            class Sequence final : public optics::AppearanceSequence {
            public:
                Sequence(const BlurringModel& blur, const optics::Scene& scene, const optics::Surface& surface)
                    : blur_(blur), scene_(scene), surface_(surface) {}
                [[nodiscard]] optics::Appearance next(const optics::ResinVolume& volume,
                                                      const Progress* progress) override {
                    optics::Scene scene = scene_;
                    scene.volume = &volume;
                    return blur_.predict(scene, surface_, progress);
                }
                [[nodiscard]] optics::Appearance last(const optics::ResinVolume& volume,
                                                      const Progress* progress) override {
                    optics::Appearance seen = next(volume, progress);
                    for (float& value : seen.value) value *= 0.5f;
                    return seen;
                }

            private:
                const BlurringModel& blur_;
                const optics::Scene scene_;
                const optics::Surface& surface_;
            };
            return std::make_unique<Sequence>(blur_, scene, surface);
        }

    private:
        const BlurringModel& blur_;
    } const model(blur);
    const std::vector<Eigen::Vector3f> target = stripes(0.3f, 0.6f);
    const optics::ResinVolume open = slab.print(mixtures_of(*slab.recipes, target));
    LoopOptions options;
    options.iterations = 3;
    Progress progress;
    CHECK(run_appearance_loop(slab.task(model, open, target), options, progress).last_look.empty());
    const int before = blur.predictions;
    options.last_look = true;
    TellsSteps steps;
    const LoopResult result = run_appearance_loop(slab.task(model, open, target), options, steps);
    CHECK(blur.predictions == 2 * before + 1);
    CHECK(result.state.best > 0);
    REQUIRE(result.last_look.size() == result.state.shown.size());
    for (std::size_t i = 0; i < result.last_look.size(); ++i)
        CHECK((result.last_look[i] - 0.5f * result.state.shown[i]).norm() < 1e-6f);
    CHECK(steps.told.front() == 5);
    CHECK(steps.told.back() == steps.told.front());
}

TEST_CASE("Surface first: a colour takes the thinnest skin that shows it, pure resins all the way down",
          "[loop][slow]") {
    const SmallSlab slab(2, optics::vero_opaque().subset(Roles{"C", "M", "Y", "K", "W"}));
    const std::size_t resins = 5, white = 4, black = 3;
    std::vector<float> f(slab.skin.size() * resins);
    const auto layer = [&](std::size_t l, std::size_t r) { return f[l * resins + r]; };

    slab.recipes->separate({0.8f, 0.8f, 0.8f}, f);
    CHECK(layer(0, white) < 0.999f);
    CHECK(layer(2, white) == Approx(1).margin(1e-3));
    CHECK(layer(3, white) == Approx(1).margin(1e-3));
    slab.recipes->separate({0, 0, 0}, f);
    CHECK(layer(3, black) + layer(3, 0) + layer(3, 1) + layer(3, 2) > 0.9f);
    slab.recipes->separate({1, 1, 1}, f);
    for (std::size_t l = 0; l < slab.skin.size(); ++l) CHECK(layer(l, white) == 1);
    for (const Eigen::Vector3f& rgb : {Eigen::Vector3f(0.3f, 0.05f, 0.02f), Eigen::Vector3f(0.2f, 0.5f, 0.7f)}) {
        slab.recipes->separate(rgb, f);
        for (std::size_t l = 0; l < slab.skin.size(); ++l) {
            float sum = 0;
            for (std::size_t r = 0; r < resins; ++r) {
                CHECK(layer(l, r) >= 0);
                sum += layer(l, r);
            }
            CHECK(sum == Approx(1).margin(1e-5));
        }
    }
}

TEST_CASE("The loop's skin is as deep as colour is without it", "[loop]") {
    // Through less black than that its core shines.
    for (const double depth : {0.5, 1.0, 2.0}) CHECK(skin_layers(depth).depth_mm() == depth);
    CHECK(std::ranges::is_sorted(skin_layers(1).bottom_mm));
}

TEST_CASE("Skin mixtures become bounds that select each resin by its fraction", "[loop]") {
    SkinMixtures skin(1, 2, 3);
    const std::vector<float> fractions{0.25f, 0, 0.75f, 0, 0, 0};
    std::copy(fractions.begin(), fractions.end(), skin.cell(0).begin());
    const auto mixture = cumulative_mixtures(skin);
    REQUIRE(mixture.size() == 2);
    CHECK(mixture[0].bound[0] == 16384);
    CHECK(mixture[0].bound[1] == 16384);
    CHECK(select_resin(mixture[0], 0, 3) == 0);
    CHECK(select_resin(mixture[0], 16384, 3) == 2);
    // Nothing at all: the bounds stay valid.
    CHECK(select_resin(mixture[1], 5, 3) == 0);
    // A negative fraction counts as none.
    skin.cell(0)[1] = -1;
    CHECK(cumulative_mixtures(skin)[0].bound[1] == 16384);
}

TEST_CASE("Feedback moves a control colour by the residual, and relaxes the target of what cannot follow", "[loop]") {
    const auto whole_cube = [](const Eigen::Vector3f& rgb) { return rgb; };
    const std::vector<Eigen::Vector3f> target{{0.5f, 0.5f, 0.5f}, {0.9f, 0.9f, 0.9f}};
    const std::vector<Eigen::Vector3f> predicted{{0.4f, 0.5f, 0.6f}, {0.5f, 0.7f, 0.8f}};
    std::vector<Eigen::Vector3f> control{{0.5f, 0.5f, 0.5f}, {1, 0.9f, 0.9f}}, relaxed(2);
    const std::size_t saturated = feed_back(target, predicted, whole_cube, {}, control, relaxed);
    CHECK(saturated == 1);
    const float root = std::cbrt(0.5f);
    CHECK(std::cbrt(control[0].x()) == Approx(2 * root - std::cbrt(0.4f)).epsilon(1e-5));
    CHECK(control[0].y() == Approx(0.5f));
    CHECK(control[0].z() < 0.5f);
    CHECK(relaxed[0] == target[0]);
    // Red cannot get lighter than it is: the colour that is asked for is less light and less blue than the target.
    CHECK(control[1].x() == Approx(1));
    CHECK(relaxed[1].x() == Approx(0.5f));
    CHECK(relaxed[1].y() < 0.9f);
    CHECK(relaxed[1].z() < relaxed[1].y() + 0.1f);
}

TEST_CASE("Feedback goes no further in a step than is allowed, up and down", "[loop]") {
    const auto whole_cube = [](const Eigen::Vector3f& rgb) { return rgb; };
    for (const float most : {0.05f, 0.25f}) {
        // Residuals of +0.6, -0.6 and +0.02 of a cube root, and the other way round.
        const auto grey = [](float r, float g, float b) { return Eigen::Vector3f(r * r * r, g * g * g, b * b * b); };
        const std::vector<Eigen::Vector3f> target{grey(0.8f, 0.2f, 0.5f), grey(0.2f, 0.8f, 0.5f)};
        const std::vector<Eigen::Vector3f> predicted{grey(0.2f, 0.8f, 0.48f), grey(0.8f, 0.2f, 0.52f)};
        std::vector<Eigen::Vector3f> control(2, grey(0.5f, 0.5f, 0.5f)), relaxed(2);
        const FeedbackOptions options{.gain = 0.5f, .most_step = most};
        CHECK(feed_back(target, predicted, whole_cube, options, control, relaxed) == 0);
        const auto roots = [&](std::size_t i) -> Eigen::Vector3f { return control[i].array().pow(1.0f / 3).matrix(); };
        CHECK((roots(0) - Eigen::Vector3f(0.5f + most, 0.5f - most, 0.51f)).norm() < 1e-5f);
        CHECK((roots(1) - Eigen::Vector3f(0.5f - most, 0.5f + most, 0.49f)).norm() < 1e-5f);
    }
}

TEST_CASE("Feedback asks the other channels to follow one whose limit stops them all", "[loop]") {
    const auto darker = [](const Eigen::Vector3f& rgb) -> Eigen::Vector3f { return rgb.cwiseMin(0.8f); };
    const std::vector<Eigen::Vector3f> target{{0.9f, 0.9f, 0.9f}}, predicted{{0.5f, 0.7f, 0.8f}};
    std::vector<Eigen::Vector3f> control{{0.8f, 0.8f, 0.8f}}, relaxed(1);
    CHECK(feed_back(target, predicted, darker, {}, control, relaxed) == 1);
    CHECK(relaxed[0].x() == Approx(0.5f));
    CHECK(control[0].x() == Approx(0.8f));
    // Grey rather than blue, though no channel can get lighter.
    CHECK(control[0].y() < 0.8f);
    CHECK(control[0].z() < control[0].y());
}

TEST_CASE("The nearest colour keeps the channels that are saturated and is a minimum in the others", "[loop]") {
    const Eigen::Vector3f target(0.9f, 0.85f, 0.8f), from(0.5f, 0.1f, 0.1f);
    const Eigen::Vector3f v = nearest_colour(target, from, {true, false, false});
    CHECK(v.x() == 0.5f);
    const Eigen::Vector3d lab = optics::lab_from_linear_srgb(target.cast<double>());
    const auto cost = [&](const Eigen::Vector3f& rgb) {
        const Eigen::Vector3d there = optics::lab_from_linear_srgb(rgb.cast<double>());
        return (optics::ciede2000_metric(0.5 * (lab + there)) * (there - lab)).norm();
    };
    for (int c = 1; c < 3; ++c)
        for (const float step : {-0.02f, 0.02f}) {
            Eigen::Vector3f other = v;
            other[c] += step;
            CHECK(cost(other) > cost(v));
        }
    CHECK((nearest_colour(target, from, {false, false, false}) - target).norm() < 1e-3f);
}

TEST_CASE("A deep colour that cannot be had keeps its hue and does not turn grey", "[loop]") {
    // The cape of a figure, crimson in a sheet of one voxel: green cannot come down.
    const Eigen::Vector3f target(0.521f, 0.009f, 0.125f), from(0.865f, 0.546f, 0.551f), grey(0.554f, 0.561f, 0.510f);
    const auto lab = [](const Eigen::Vector3f& rgb) { return optics::lab_from_linear_srgb(rgb.cast<double>()); };
    const Eigen::Vector3f v = nearest_colour(target, from, {false, true, false});
    CHECK(v.y() == from.y());
    CHECK(optics::ciede2000(lab(target), lab(v)) < optics::ciede2000(lab(target), lab(grey)) - 5);
    CHECK(lab(v)[1] > 10);
}

TEST_CASE("The loop undoes a blur, keeps its best iterate and is never worse than the open loop", "[loop]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    Progress quiet;
    LoopOptions options;
    options.iterations = 6;
    const auto target = stripes(0.2f, 0.6f);
    const LoopResult result = run(slab, model, target, options, quiet);
    const LoopState& state = result.state;
    REQUIRE(state.steps.size() == 7);
    CHECK(state.steps[state.best].seen.mean < 0.6 * state.steps[0].seen.mean);
    for (const LoopStep& step : state.steps) CHECK(state.steps[state.best].seen.mean <= step.seen.mean);
    REQUIRE(result.best);
    // What is called the best print is what the model says of it.
    const optics::ResinVolume best = slab.print(*result.best);
    optics::Scene scene = slab.scene;
    scene.volume = &best;
    const optics::Appearance seen = model.predict(scene, slab.surface, nullptr);
    for (std::size_t i = 0; i < target.size(); ++i)
        CHECK(state.shown[i].x() == Approx(seen.value[3 * i] / state.white[3 * i]).margin(1e-6));
}

TEST_CASE("What the eye does not see of an error is not fed back", "[loop]") {
    using Eigen::Vector3f;
    const std::vector<Vector3f> target{{0.2f, 0.3f, 0.4f}, {0.001f, 0.5f, 0.9f}};
    const std::vector<Vector3f> seen_target{{0.25f, 0.3f, 0.5f}, {0.2f, 0.4f, 0.8f}};
    // Seen as it should be: the print is as good as its target, whatever its own colours are.
    const auto right = as_wrong_as_seen(target, seen_target, seen_target);
    for (std::size_t i = 0; i < target.size(); ++i) CHECK((right[i] - target[i]).norm() < 1e-6f);
    // Seen too dark in one channel: as much too dark as that, as cube roots go, and never below 0.
    std::vector<Vector3f> dark = seen_target;
    dark[0].x() = 0.1f;
    dark[1].x() = 0;
    const auto wrong = as_wrong_as_seen(target, seen_target, dark);
    CHECK(wrong[0].x() == Approx(std::pow(std::cbrt(0.2) - (std::cbrt(0.25) - std::cbrt(0.1)), 3)).epsilon(1e-4));
    CHECK(wrong[1].x() == 0);
    CHECK(wrong[0].y() == Approx(0.3).epsilon(1e-5));
}

TEST_CASE("A loop that cannot gain ends with the open loop, and stops by itself", "[loop]") {
    SmallSlab slab(n, black_and_white());
    // Everything is seen as one grey: nothing helps.
    class Blind final : public optics::AppearanceModel {
    public:
        optics::Appearance predict(const optics::Scene&, const optics::Surface& surface,
                                   const Progress*) const override {
            return {3, std::vector<float>(3 * surface.cells.size(), 0.3f), {}, {}};
        }
    };
    const Blind model;
    TellsSteps steps;
    const auto target = stripes(0.2f, 0.6f);
    const optics::ResinVolume open = slab.print(mixtures_of(*slab.recipes, target));
    const LoopResult result = run_appearance_loop(slab.task(model, open, target), {}, steps);
    CHECK(result.state.best == 0);
    CHECK_FALSE(result.best);
    CHECK(result.state.steps.size() < most_iterations);
    CHECK(result.why_stopped == "it stopped gaining");
    // What is left becomes less with each prediction that gains nothing, and none is promised that is not made.
    REQUIRE(steps.told.size() == result.state.steps.size() + 1);
    CHECK(steps.told.front() == most_iterations + 1);
    CHECK(std::is_sorted(steps.told.rbegin(), steps.told.rend()));
    CHECK(steps.told[2] < steps.told.front());
    CHECK(steps.told.back() == result.state.steps.size());
}

TEST_CASE("A loop that was told how often to go on says so", "[loop][slow]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    LoopOptions options;
    options.iterations = 4;
    std::vector<LoopState> states;
    const auto target = stripes(0.2f, 0.6f);
    TellsSteps whole, rest;
    (void)run(slab, model, target, options, whole, [&](const LoopState& s, const auto&) {
        states.push_back(s);
        return nullptr;
    });
    CHECK(whole.told == std::vector<std::uint64_t>(6, 5));
    REQUIRE(states.size() >= 3);
    (void)run(slab, model, target, options, rest, {}, ResumedLoop{states[2], {}});
    CHECK(rest.told == std::vector<std::uint64_t>(3, 2));
}

TEST_CASE("What the model remarks on the print that is kept is warned of and handed on", "[loop]") {
    SmallSlab slab(n, black_and_white());
    // The white twin, the open loop's print, which is the best one, and prints that are worse.
    class Remarks final : public optics::AppearanceModel {
    public:
        optics::Appearance predict(const optics::Scene&, const optics::Surface& surface,
                                   const Progress*) const override {
            const std::size_t asked = std::min<std::size_t>(asked_++, 2);
            const std::array grey{1.0f, 0.25f, 0.9f};
            const std::array remark{"of the twin", "the light was clipped", "a solve was left open"};
            return {3, std::vector<float>(3 * surface.cells.size(), grey[asked]), {}, {remark[asked]}};
        }

    private:
        mutable std::size_t asked_ = 0;
    };
    const Remarks model;
    class Listens final : public Progress {
    public:
        std::vector<std::string> warnings;

    private:
        void on_warning(const std::string& warning) override { warnings.push_back(warning); }
    } progress;
    const auto target = stripes(0.2f, 0.3f);
    const optics::ResinVolume open = slab.print(mixtures_of(*slab.recipes, target));
    LoopOptions options;
    options.iterations = 2;
    const LoopResult result = run_appearance_loop(slab.task(model, open, target), options, progress);
    REQUIRE(result.state.best == 0);
    CHECK(result.remarks == std::vector<std::string>{"the light was clipped"});
    CHECK(progress.warnings == result.remarks);
}

TEST_CASE("No iterations leave the open loop", "[loop]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    Progress quiet;
    LoopOptions options;
    options.iterations = 0;
    const LoopResult result = run(slab, model, stripes(0.2f, 0.6f), options, quiet);
    CHECK(result.state.steps.size() == 1);
    CHECK_FALSE(result.best);
}

TEST_CASE("A cancelled loop gives the best so far", "[loop][slow]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    Impatient impatient(3);
    const LoopResult result = run(slab, model, stripes(0.2f, 0.6f), {}, impatient);
    CHECK(result.cancelled);
    CHECK(result.state.steps.size() == 3);
    CHECK(result.state.best > 0);
}

TEST_CASE("A resumed loop goes on to the same bits", "[loop][slow]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    Progress quiet;
    LoopOptions options;
    options.iterations = 5;
    const auto target = stripes(0.2f, 0.6f);
    std::vector<LoopState> states;
    const LoopResult whole = run(slab, model, target, options, quiet, [&](const LoopState& state, const auto&) {
        states.push_back(state);
        return nullptr;
    });
    REQUIRE(states.size() >= 3);
    const LoopResult resumed = run(slab, model, target, options, quiet, {}, ResumedLoop{states[2], {}});
    REQUIRE(resumed.state.steps.size() == whole.state.steps.size());
    CHECK(resumed.state.control == whole.state.control);
    REQUIRE(resumed.best.has_value() == whole.best.has_value());
    CHECK(std::ranges::equal(resumed.best->all(), whole.best->all()));
    CHECK(resumed.state.best == whole.state.best);
}

TEST_CASE("The same bits for one thread and five", "[loop][slow]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    Progress quiet;
    LoopOptions options;
    options.iterations = 3;
    const auto target = stripes(0.2f, 0.6f);
    const auto control = test::same_for_threads([&] { return run(slab, model, target, options, quiet).state.control; });
    CHECK(control.size() == target.size());
}

TEST_CASE("Targets without any colour in the gamut, and of one colour", "[loop][slow]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.3f);
    Progress quiet;
    LoopOptions options;
    options.iterations = 3;
    const std::vector<Eigen::Vector3f> red(n * n, Eigen::Vector3f(0.8f, 0.05f, 0.05f)),
        grey(n * n, Eigen::Vector3f::Constant(0.4f));
    const LoopResult all_out = run(slab, model, red, options, quiet);
    CHECK(std::count(all_out.in_gamut.begin(), all_out.in_gamut.end(), 1) == n * n);
    for (const LoopStep& step : all_out.state.steps) CHECK(std::isfinite(step.seen.mean));
    const LoopResult flat = run(slab, model, grey, options, quiet);
    CHECK(flat.state.steps[flat.state.best].seen.mean < 0.7 * flat.state.steps[0].seen.mean);
}

TEST_CASE("A loop that has nothing visible to gain stops, unless it was told how often to go on", "[loop][slow]") {
    SmallSlab slab(n, black_and_white());
    const BlurringModel model(n, static_cast<int>(slab.white) + 1, 0.5f);
    const std::vector<Eigen::Vector3f> white(std::size_t{n} * n, Eigen::Vector3f::Ones());
    Progress progress;
    const LoopResult free = run(slab, model, white, {}, progress);
    CHECK(free.state.steps.size() == 1);
    CHECK(free.why_stopped.find("cannot be seen") != std::string::npos);
    CHECK_FALSE(free.best);
    CHECK(run(slab, model, white, {.iterations = 2}, progress).state.steps.size() == 3);
    // What is far off goes on.
    CHECK(run(slab, model, stripes(0.05f, 0.9f), {}, progress).state.steps.size() > 1);
}
