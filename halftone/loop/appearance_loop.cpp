// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/appearance_loop.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/job_outlook.h"
#include "base/parallel.h"
#include "base/step_part.h"
#include "base/stopwatch.h"
#include "halftone/loop/eye_filter.h"
#include "halftone/loop/loop_measure.h"
#include "halftone/loop/loop_policy.h"
#include "halftone/loop/loop_steps.h"
#include "halftone/loop/lost_contrast.h"
#include "halftone/loop/map_targets.h"
#include "halftone/loop/misfit.h"
#include "halftone/loop/relative_colours.h"
#include "halftone/loop/residual_feedback.h"
#include "optics/layered/mixture_correction.h"
#include "optics/scene/surface_smoothing.h"

namespace voxtone::halftone {

namespace {

using Colours = std::vector<Eigen::Vector3f>;

/// In the misfit of a cell whose target lies out of the gamut: its error remains whatever is done. 1 and 0.25 were
/// tried on two of the fitting set (img_marble, img_hubble: a quarter is better in both; benchmarks/sets.json,
/// `appearance_loop_benchmark slabs`).
constexpr float out_of_gamut_weight = 0.25f;

/// k of the misfit. Chosen on the fitting set by the loop's predictor, pieces of 6 x 4 mm: where it grows with the
/// contrast that is lost (lost_contrast.h), up to 0.6, type keeps as much of its contrast (0.57) as with 0.4
/// everywhere, and the four photographs have 3.3 as seen for 3.5. Everywhere and more where contrast is asked for: of
/// 0, 0.3, 0.4, 0.5, 0.7 type comes out at 0.27, 0.41, 0.50, 0.55, 0.64 of its contrast (open loop 0.58); by place, up
/// to 0.9, thin type kept 0.48 for 0.58 (docs/decisions/004).
constexpr float most_contrast_part = 0.6f, part_for_contrast = 0.7f;

/// Steps of the descent are as long near the target as far from it (d is scaled): a print that feedback has brought
/// near is thrown off by the first ones, and swings when rates have grown. So both go by the mean error as seen of what
/// it starts from: the part of them that is taken. Chosen on four photographs by Monte Carlo (docs/decisions/003).
float part_of_rates(double mean) {
    constexpr double far = 5;  // CIEDE2000 as seen
    const auto part = static_cast<float>(std::min(1.0, mean / far));
    return part * part;
}

DescentRates first_rates(float part) {
    const DescentRates whole;
    return {part * whole.own, part * whole.shared};
}

/// What light below the surface spreads over, about: a Gaussian, made when it is first asked for.
class Neighbourhood {
public:
    explicit Neighbourhood(const optics::Surface& surface) : surface_(surface) {}
    void smooth(Colours& values) {
        if (values.empty()) return;
        if (!smoothing_) {
            points_ = optics::surface_points(surface_);
            smoothing_.emplace(points_, spread_mm, 0.0, optics::typical_edge_mm(points_));
        }
        Colours out(values.size());
        smoothing_->apply({values.front().data(), 3 * values.size()}, {out.front().data(), 3 * out.size()}, 3);
        values = std::move(out);
    }

private:
    static constexpr double spread_mm = 1.2;  // exp(-(r / spread)^2); that of the wide Gaussian at 300 mm, not varied
    const optics::Surface& surface_;
    std::vector<optics::SurfacePoint> points_;
    std::optional<optics::SurfaceSmoothing> smoothing_;
};

/// Marks the cells whose target the resins can show; all where none is.
std::vector<char> cells_in_gamut(const MinimalDepthSeparation& recipes, std::span<const Eigen::Vector3f> target) {
    constexpr double visible = 1;  // CIEDE2000
    std::vector<char> in(target.size());
    parallel_for(0, target.size(), 256,
                 [&](std::size_t i) { in[i] = recipes.deepest().gamut_distance(target[i]) < visible; });
    if (std::find(in.begin(), in.end(), 1) == in.end()) std::fill(in.begin(), in.end(), 1);
    return in;
}

void expect_finite(std::span<const Eigen::Vector3f> target) {
    for (const Eigen::Vector3f& rgb : target) VOXTONE_EXPECT(rgb.allFinite());
}

/// recent <- (recent + now) / 2.
void follow(SkinMixtures& recent, const SkinMixtures& now) {
    if (recent.cells() == 0) {
        recent = now;
        return;
    }
    for (std::size_t i = 0; i < now.all().size(); ++i) recent.all()[i] = 0.5f * (recent.all()[i] + now.all()[i]);
}

const char* name_of(LoopMethod method) {
    switch (method) {
        case LoopMethod::open_loop:
            return "open loop";
        case LoopMethod::feedback:
            return "feedback";
        case LoopMethod::descent:
            break;
    }
    return "descent";
}

std::string report_line(const LoopState& state) {
    const LoopStep& step = state.steps.back();
    return fmt::format(
        "iteration {} ({}): error as seen where the resins reach: mean {:.2f}, median {:.2f} "
        "(open loop {:.2f}, {:.2f}), {:.1f} s",
        step.iteration, name_of(step.method), step.seen.mean, step.seen.median, state.steps.front().seen.mean,
        state.steps.front().seen.median, step.seconds);
}

LoopPolicy policy_of(const LoopOptions& options) {
    return LoopPolicy({options.iterations, options.most_without_limit, feedback_iterations,
                       options.most_without_limit >= patient_iterations});
}

std::string_view words_for(LoopPolicy::Ending ending) {
    switch (ending) {
        case LoopPolicy::Ending::gains_no_more:
            return "it stopped gaining";
        case LoopPolicy::Ending::nothing_visible:
            return "what was left to gain cannot be seen";
        case LoopPolicy::Ending::all_made:
            break;
    }
    return all_iterations_made;
}

/// A print, and what was seen of it.
struct SeenPrint {
    optics::ResinVolume volume;  ///< the sequence looks at it again for the gradient
    Colours rgb;
    EyeFilter::Views views;                    ///< what the eye makes of them
    std::vector<Eigen::Matrix3f> corrections;  ///< by cell; empty for a set without a residual
    std::vector<std::string> remarks;          ///< of the model
};

/// A loop while it runs: what one task keeps, the print that was predicted last, and the state that grows.
class LoopRun {
public:
    LoopRun(const LoopTask& task, const LoopOptions& options, Progress& progress, const LoopListener& listener);

    LoopRun(const LoopRun&) = delete;
    LoopRun& operator=(const LoopRun&) = delete;
    ~LoopRun() {
        try {
            settle();
        } catch (...) {  // the loop is given up for a reason of its own
        }
    }

    void predict_open_loop();
    void resume(ResumedLoop from);
    /// Until all iterations are made, or nothing is gained any more, or the work is cancelled.
    void iterate();
    [[nodiscard]] LoopResult finish();

private:
    [[nodiscard]] Colours look_again(const std::optional<SkinMixtures>& best);
    [[nodiscard]] Colours colours_of(const optics::Appearance& seen, const optics::ResinVolume& volume);
    [[nodiscard]] PartRange this_part(double to);
    [[nodiscard]] bool has_gradient() const { return descent_wanted_ && state_.has_gradient; }
    void notify() {
        if (listener_) settle_ = listener_(state_, *sequence_);
    }
    /// The listener looks no more.
    void settle() {
        if (auto settled = std::exchange(settle_, nullptr)) settled();
    }
    [[nodiscard]] bool descending() const { return state_.descent.mixtures.cells() != 0; }
    [[nodiscard]] double last_score() const { return state_.steps.back().score; }
    [[nodiscard]] Eigen::Vector3f into_gamut(const Eigen::Vector3f& rgb) const { return recipes_.into_gamut(rgb); }
    [[nodiscard]] const EyeFilter& wide_filter();
    [[nodiscard]] Colours mapped_target();
    void know_the_open_loop(const LoopMeasure::Value& open);
    [[nodiscard]] std::vector<float> contrast_part_of_cells();
    void prepare_misfit();

    void feedback_step();
    void descent_step();
    void begin_descent_from_best_control(bool last_was_best);
    void print_and_predict(const SkinMixtures& mixtures, LoopMethod method);
    void predict(optics::ResinVolume volume, LoopMethod method);
    void hurry(const std::vector<RegionLook>& looks);
    void keep_if_best(const SkinMixtures& mixtures);
    void correct_control();
    [[nodiscard]] bool move_downhill();
    [[nodiscard]] bool ends() const { return policy_.ends(state_.steps, has_gradient()); }

    const LoopTask& task_;
    const LoopOptions& options_;
    Progress& progress_;
    const LoopListener& listener_;
    std::function<void()> settle_;
    const MinimalDepthSeparation& recipes_;
    const LoopPolicy policy_;
    std::vector<char> in_gamut_;
    std::optional<EyeFilter> wide_;
    const Colours target_;            ///< as the resins can show it on a thick body
    const RelativeColours relative_;  ///< to the white of the state
    const optics::MixtureCorrection correction_;
    const LoopMeasure measure_;
    Colours wanted_;                      ///< the target at the level of the print's paper; empty before it is known
    std::vector<RegionLook> open_looks_;  ///< of regions in the open loop
    const std::unique_ptr<optics::AppearanceSequence> sequence_;
    Neighbourhood around_;
    std::optional<MisfitFunction> misfit_;
    const bool descent_wanted_;  ///< after feedback, where the model has a gradient
    Stopwatch watch_;
    double step_part_ = 0;  ///< of the step that the progress counts

    LoopState state_;
    SeenPrint last_;
    Colours near_target_;                    ///< what the eye makes of the wanted colours; empty before feedback
    std::vector<std::string> best_remarks_;  ///< of the model, on the best print
    bool cancelled_ = false;
    std::string why_stopped_;
    std::size_t predictions_ = 0;   ///< of this run, a resumed one's own
    const std::size_t looks_more_;  ///< after all iterations
};

LoopRun::LoopRun(const LoopTask& task, const LoopOptions& options, Progress& progress, const LoopListener& listener)
    : task_(task),
      options_(options),
      progress_(progress),
      listener_(listener),
      recipes_(*task.recipes),
      policy_(policy_of(options)),
      in_gamut_(cells_in_gamut(recipes_, task.target)),
      target_(mapped_target()),
      relative_(task.scene.resins->channels, state_.white),
      correction_(*task.scene.resins, options.intent == Intent::absolute ? -1 : task.white_resin),
      measure_(*task.surface, task.target, target_, in_gamut_, options.viewing_distance_mm,
               options.intent != Intent::absolute),
      sequence_(task.model->sequence(task.scene, *task.surface, &progress)),
      around_(*task.surface),
      descent_wanted_(options.descent && task.mixture_gradient),
      looks_more_(options.last_look ? 1 : 0) {
    if (!descent_wanted_) wide_.reset();
}

const EyeFilter& LoopRun::wide_filter() {
    if (!wide_)
        wide_.emplace(*task_.surface, wider * options_.viewing_distance_mm, EyeSurround::none, OpponentSpace::cielab,
                      EyeParts::narrowest);
    return *wide_;
}

Colours LoopRun::mapped_target() {
    return map_targets(
        task_.target, [this](const Eigen::Vector3f& rgb) { return into_gamut(rgb); },
        [this]() -> const EyeFilter& { return wide_filter(); });
}

/// Needs the open loop's colours.
std::vector<float> LoopRun::contrast_part_of_cells() {
    if (options_.intent == Intent::contrast) return std::vector<float>(target_.size(), part_for_contrast);
    const EyeFilter& eye = measure_.eye();
    return contrast_parts(lost_contrast(eye.smoothed(wanted_), eye.smoothed(state_.open), wide_filter()),
                          most_contrast_part);
}

void LoopRun::prepare_misfit() {
    misfit_.emplace(*task_.surface, measure_.eye(), wanted_, measure_.weights(state_.urgency, out_of_gamut_weight),
                    &wide_filter(), contrast_part_of_cells());
}

/// From where the step that the progress counts is to this share of it: a prediction may have something before it.
PartRange LoopRun::this_part(double to) { return {&progress_, std::exchange(step_part_, to), to}; }

void LoopRun::predict_open_loop() {
    // A print that takes more memory than is allowed says so before anything is predicted.
    optics::ResinVolume print = task_.open_loop();
    if (options_.intent != Intent::absolute) {
        const PartRange part = this_part(0.5);
        state_.white = sequence_->twin(*task_.scene.volume, &progress_).value;
    }
    watch_.lap();
    predict(std::move(print), LoopMethod::open_loop);
    state_.open = state_.shown = last_.rgb;
    state_.urgency.assign(measure_.regions().size(), 1.0f);
    best_remarks_ = last_.remarks;
    state_.control = state_.start_control = target_;
    correct_control();
    notify();
}

void LoopRun::resume(ResumedLoop from) {
    const std::size_t values =
        options_.intent == Intent::absolute ? 0 : target_.size() * task_.scene.resins->channels.size();
    if (from.state.white.size() != values || !sequence_->read_state(from.sequence))
        throw InputError("the saved state of the appearance loop does not fit its model: begin anew with --overwrite");
    state_ = std::move(from.state);
    know_the_open_loop(measure_(state_.open, {}));
}

void LoopRun::know_the_open_loop(const LoopMeasure::Value& open) {
    open_looks_ = open.looks;
    wanted_ = target_;
    for (Eigen::Vector3f& colour : wanted_) colour *= open.paper;
}

void LoopRun::iterate() {
    try {
        // A resumed loop may have been at its end already.
        while (!ends()) {
            if (descending())
                descent_step();
            else
                feedback_step();
            notify();
        }
        why_stopped_ = words_for(policy_.why_it_ended(state_.steps, has_gradient()));
    } catch (const Cancelled&) {
        cancelled_ = true;
        why_stopped_ = "it was stopped";
    }
}

/// Prints the control colours, and makes ready what comes next.
void LoopRun::feedback_step() {
    const double least_by_feedback = least_score(state_.steps, LoopMethod::feedback);
    // Mixtures take as much memory as light: they are made again of the control colours rather than held.
    last_.volume = {};
    optics::ResinVolume print = task_.realise(mixtures_of(recipes_, state_.control));
    predict(std::move(print), LoopMethod::feedback);
    keep_if_best({});
    const bool best_by_feedback = last_score() < least_by_feedback;
    if (best_by_feedback) state_.start_control = state_.control;
    switch (policy_.after_feedback(state_.steps, has_gradient())) {
        case LoopPolicy::Next::target:
            state_.control = target_;
            return;
        case LoopPolicy::Next::descend:
            begin_descent_from_best_control(best_by_feedback);
            if (!descending()) correct_control();
            return;
        case LoopPolicy::Next::correct:
            correct_control();
    }
}

/// The gradient is at hand if the last print was the one to start from.
void LoopRun::begin_descent_from_best_control(bool last_was_best) {
    state_.descent = begin_descent(mixtures_of(recipes_, state_.start_control),
                                   first_rates(part_of_rates(least_score(state_.steps, LoopMethod::feedback))));
    if (last_was_best) state_.has_gradient = move_downhill();
    if (!state_.has_gradient) state_.descent = {};
}

/// Prints where the descent has come to, the last time the running mean, and moves on.
void LoopRun::descent_step() {
    SkinMixtures mixtures = printed(state_.descent.mixtures);
    settle();
    follow(state_.recent, mixtures);
    if (policy_.made(state_.steps) + 1 == policy_.most()) mixtures = state_.recent;
    print_and_predict(mixtures, LoopMethod::descent);
    keep_if_best(mixtures);
    if (ends()) return;  // resumed with more iterations it looks at this print again first
    state_.has_gradient = move_downhill();
    if (!state_.has_gradient) state_.descent = {};
}

/// The print before is looked at no more: one is held at a time.
void LoopRun::print_and_predict(const SkinMixtures& mixtures, LoopMethod method) {
    last_.volume = {};
    predict(task_.realise(mixtures), method);
}

void LoopRun::predict(optics::ResinVolume volume, LoopMethod method) {
    settle();
    last_.volume = std::move(volume);
    const optics::Appearance seen = [&] {
        const PartRange part = this_part(1);
        return sequence_->next(last_.volume, &progress_);
    }();
    last_.rgb = colours_of(seen, last_.volume);
    last_.remarks = seen.remarks;
    LoopStep step;
    step.iteration = static_cast<int>(state_.steps.size());
    step.method = method;
    LoopMeasure::Value value = measure_(last_.rgb, open_looks_);
    step.seen = value.seen, step.cells = value.cells, step.score = value.score, step.paper = value.paper;
    if (!open_looks_.empty()) hurry(value.looks);
    if (method == LoopMethod::open_loop) know_the_open_loop(value);
    last_.views = std::move(value.views);
    step.saturated_share = state_.saturated_share;
    step.seconds = watch_.lap();
    state_.steps.push_back(step);
    progress_.note(report_line(state_));
    progress_.advance();
    step_part_ = 0;
    expect_steps(progress_, ++predictions_ + policy_.predictions_left(state_.steps, has_gradient()) + looks_more_);
}

/// Keeps what they were corrected by.
Colours LoopRun::colours_of(const optics::Appearance& seen, const optics::ResinVolume& volume) {
    Colours rgb = relative_.colours(seen);
    if (correction_.any()) {
        last_.corrections = correction_.of_surface(volume, *task_.surface, &progress_);
        optics::correct_colours(last_.corrections, rgb);
    }
    return rgb;
}

/// Regions that are worse than without a loop count more in the next step, until they are not.
void LoopRun::hurry(const std::vector<RegionLook>& looks) {
    constexpr float more = 1.5f, less = 0.85f, most = 16;  // up to 2 type kept less (decisions/005)
    for (std::size_t r = 0; r < looks.size(); ++r) {
        float& urgency = state_.urgency[r];
        urgency =
            worse_by(looks[r], open_looks_[r]) > 0 ? std::min(most, more * urgency) : std::max(1.0f, less * urgency);
    }
    if (misfit_) misfit_->set_weights(measure_.weights(state_.urgency, out_of_gamut_weight));
}

void LoopRun::keep_if_best(const SkinMixtures& mixtures) {
    if (!(last_score() < state_.steps[state_.best].score)) return;
    state_.best = state_.steps.size() - 1;
    state_.best_mixtures = mixtures;
    state_.shown = last_.rgb;
    best_remarks_ = last_.remarks;
}

void LoopRun::correct_control() {
    Colours relaxed(last_.rgb.size());
    if (near_target_.empty()) near_target_ = measure_.eye().smoothed(wanted_);
    const std::size_t saturated = feed_back(
        wanted_, as_wrong_as_seen(wanted_, near_target_, last_.views.smoothed),
        [this](const Eigen::Vector3f& rgb) { return into_gamut(rgb); }, {.gain = feedback_gain(state_.steps)},
        state_.control, relaxed);
    state_.saturated_share = last_.rgb.empty() ? 0 : double(saturated) / double(last_.rgb.size());
}

/// One step of the descent from the last print. False where the model has no gradient.
bool LoopRun::move_downhill() {
    if (!misfit_) prepare_misfit();
    Colours by_colour = (*misfit_)(last_.rgb, last_.views).by_colour;
    if (correction_.any()) optics::correct_derivatives(last_.corrections, by_colour);
    const std::vector<float> seed = relative_.adjoint(by_colour);
    const PartRange part = this_part(0.5);
    std::vector<float> mixture_gradient = task_.mixture_gradient(
        [&](const LoopTask::GradientVisitor& visit) { return sequence_->gradient(seed, visit, &progress_); });
    if (mixture_gradient.empty()) return false;
    descend(
        std::move(mixture_gradient), [this](Colours& values) { around_.smooth(values); }, state_.descent,
        part_of_rates(least_score(state_.steps, LoopMethod::feedback)));
    return true;
}

/// Without colours where it is stopped meanwhile.
Colours LoopRun::look_again(const std::optional<SkinMixtures>& best) {
    try {
        last_.volume = {};
        const optics::ResinVolume print = best ? task_.realise(*best) : task_.open_loop();
        const optics::Appearance seen = [&] {
            const PartRange part = this_part(1);
            return sequence_->last(print, &progress_);
        }();
        best_remarks_ = seen.remarks;
        Colours rgb = colours_of(seen, print);
        progress_.advance();
        return rgb;
    } catch (const Cancelled&) {
        cancelled_ = true;
        return {};
    }
}

LoopResult LoopRun::finish() {
    settle();
    std::optional<SkinMixtures> best;
    switch (state_.steps[state_.best].method) {
        case LoopMethod::open_loop:
            break;
        case LoopMethod::feedback:  // the best of all is the best by feedback too
            best = mixtures_of(recipes_, state_.start_control);
            break;
        case LoopMethod::descent:
            best = state_.best_mixtures;
    }
    Colours last_look;
    if (options_.last_look && !cancelled_) last_look = look_again(best);
    progress_.end_stage();
    for (const std::string& remark : best_remarks_) progress_.warn(remark);
    return {std::move(state_),       std::move(in_gamut_), cancelled_,
            std::move(why_stopped_), std::move(best),      std::move(best_remarks_),
            measure_.seen_target(),  std::move(last_look)};
}

}  // namespace

SkinMixtures mixtures_of(const MinimalDepthSeparation& recipes, std::span<const Eigen::Vector3f> control) {
    SkinMixtures skin(control.size(), recipes.layers().size(), recipes.resins());
    parallel_for(0, control.size(), 256, [&](std::size_t i) { recipes.separate(control[i], skin.cell(i)); });
    return skin;
}

LoopResult run_appearance_loop(const LoopTask& task, const LoopOptions& options, Progress& progress,
                               const LoopListener& listener, std::optional<ResumedLoop> resume) {
    VOXTONE_EXPECT(task.model && task.scene.volume && task.surface && task.recipes && task.open_loop && task.realise);
    VOXTONE_EXPECT(task.target.size() == task.surface->cells.size());
    expect_finite(task.target);
    // White is predicted first, and belongs to it.
    const int made = resume ? static_cast<int>(resume->state.steps.size()) : 0;
    const int more = options.last_look ? 2 : 1;
    progress.begin_stage(loop_stage, static_cast<std::uint64_t>(std::max(0, policy_of(options).most() + more - made)),
                         "predictions");
    LoopRun run(task, options, progress, listener);
    if (resume)
        run.resume(std::move(*resume));
    else
        run.predict_open_loop();
    run.iterate();
    return run.finish();
}

}  // namespace voxtone::halftone
