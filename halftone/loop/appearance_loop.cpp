// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/loop/appearance_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/halftone/loop/eye_filter.h"
#include "voxtone/halftone/loop/map_targets.h"
#include "voxtone/halftone/loop/misfit.h"
#include "voxtone/halftone/loop/residual_feedback.h"
#include "voxtone/optics/colour/spectral_colour.h"
#include "voxtone/optics/scene/area_summary.h"
#include "voxtone/optics/scene/surface_smoothing.h"

namespace voxtone::halftone {

namespace {

using Colours = std::vector<Eigen::Vector3f>;

/// In the misfit of a cell whose target lies out of the gamut: its error remains whatever is done. 1 and 0.25 were
/// tried (img_marble, img_hubble: a quarter is better in both).
constexpr float out_of_gamut_weight = 0.25f;

/// k of the misfit. Of 0, 0.3, 0.4, 0.5, 0.7 type comes out at 0.27, 0.41, 0.50, 0.55, 0.64 of its contrast (open loop
/// 0.58) with mean errors as seen of 4.3, 4.7, 5.1, 5.4, 7.6 (10.2), img_kodim23 at 2.4, 2.5, 2.5, 2.7, 3.6 (6.6); by
/// the loop's predictor, 10 mm each.
float contrast_part(Intent intent) {
    constexpr float usual = 0.4f, for_contrast = 0.7f;
    return intent == Intent::contrast ? for_contrast : usual;
}

/// Steps of the descent are as long near the target as far from it (d is scaled), until their rates have adapted: a
/// flat grey that feedback has brought within 0.9 CIEDE2000 was thrown to 8. The first ones go by the mean error as
/// seen of what it starts from.
DescentOptions first_rates(double mean) {
    constexpr double far = 5;
    DescentOptions options;
    const auto part = static_cast<float>(std::min(1.0, mean / far));
    options.own_rate = std::max(options.least_rate, part * options.own_rate);
    options.shared_rate = std::max(options.least_rate, part * options.shared_rate);
    return options;
}

/// A model's answers as colours.
class Viewer {
public:
    Viewer(const LoopTask& task, bool relative, const Progress& progress)
        : channels_(task.scene.resins->channels.size()),
          weights_(optics::linear_srgb_weights(task.scene.resins->channels.wavelengths_nm).cast<float>()) {
        if (!relative) return;
        white = task.model->predict(task.scene, *task.surface, &progress).value;
    }
    [[nodiscard]] Colours colours(const optics::Appearance& seen) const {
        Colours rgb(seen.value.size() / channels_);
        parallel_for(0, rgb.size(), 4096, [&](std::size_t i) {
            Eigen::VectorXf value(static_cast<Eigen::Index>(channels_));
            for (std::size_t c = 0; c < channels_; ++c) {
                const std::size_t at = i * channels_ + c;
                // A place without any light, which white can do nothing about, is black.
                value[static_cast<Eigen::Index>(c)] = white.empty()   ? seen.value[at]
                                                      : white[at] > 0 ? seen.value[at] / white[at]
                                                                      : 0;
            }
            rgb[i] = weights_ * value;
        });
        return rgb;
    }
    /// d F / d value from d F / d colour.
    [[nodiscard]] std::vector<float> by_value(std::span<const Eigen::Vector3f> by_colour) const {
        std::vector<float> out(by_colour.size() * channels_);
        parallel_for(0, by_colour.size(), 4096, [&](std::size_t i) {
            const Eigen::VectorXf by = weights_.transpose() * by_colour[i];
            for (std::size_t c = 0; c < channels_; ++c) {
                const std::size_t at = i * channels_ + c;
                out[at] = white.empty()   ? by[static_cast<Eigen::Index>(c)]
                          : white[at] > 0 ? by[static_cast<Eigen::Index>(c)] / white[at]
                                          : 0;
            }
        });
        return out;
    }
    std::vector<float> white;

private:
    std::size_t channels_;
    Eigen::Matrix3Xf weights_;
};

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

/// Errors against the target as it was asked for, over the cells in the gamut.
class Judge {
public:
    Judge(const optics::Surface& surface, std::span<const Eigen::Vector3f> target, const std::vector<char>& counts,
          double distance_mm)
        : surface_(surface),
          eye_(surface, distance_mm, EyeSurround::none),
          target_(target),
          seen_target_(eye_.filter(target)),
          counts_(counts) {}

    void operator()(const Colours& rgb, LoopStep& step) const {
        step.cells = errors(target_, rgb);
        step.seen = errors(seen_target_, eye_.filter(rgb));
    }

    [[nodiscard]] const EyeFilter& eye() const { return eye_; }

private:
    [[nodiscard]] optics::DifferenceSummary errors(std::span<const Eigen::Vector3f> target,
                                                   std::span<const Eigen::Vector3f> rgb) const {
        std::vector<double> difference(target.size());
        parallel_for(0, target.size(), 1024, [&](std::size_t i) {
            const auto lab = [](const Eigen::Vector3f& v) {
                return optics::lab_from_linear_srgb(v.cast<double>().cwiseMax(0));
            };
            difference[i] = counts_[i] ? optics::ciede2000(lab(target[i]), lab(rgb[i])) : 0;
        });
        return optics::summarize_by_area(surface_, difference, counts_);
    }

    const optics::Surface& surface_;
    EyeFilter eye_;
    std::span<const Eigen::Vector3f> target_;
    Colours seen_target_;
    const std::vector<char>& counts_;
};

/// Marks the cells whose target the resins can show; all where none is.
std::vector<char> cells_in_gamut(const SurfaceFirst& recipes, std::span<const Eigen::Vector3f> target) {
    constexpr double visible = 1;  // CIEDE2000
    std::vector<char> in(target.size());
    parallel_for(0, target.size(), 256,
                 [&](std::size_t i) { in[i] = recipes.deepest().mapping_distance(target[i]) < visible; });
    if (std::find(in.begin(), in.end(), 1) == in.end()) std::fill(in.begin(), in.end(), 1);
    return in;
}

void expect_finite(std::span<const Eigen::Vector3f> target) {
    for (const Eigen::Vector3f& rgb : target) VOXTONE_EXPECT(rgb.allFinite());
}

/// Of the steps by `method`; 0: of all. Infinite where there is none.
double least_mean(const std::vector<LoopStep>& steps, char method = 0) {
    double mean = std::numeric_limits<double>::infinity();
    for (const LoopStep& step : steps)
        if (method == 0 || step.method == method) mean = std::min(mean, step.seen.mean);
    return mean;
}

/// recent <- (recent + now) / 2.
void follow(SkinMixtures& recent, const SkinMixtures& now) {
    if (recent.cells() == 0) {
        recent = now;
        return;
    }
    for (std::size_t i = 0; i < now.all().size(); ++i) recent.all()[i] = 0.5f * (recent.all()[i] + now.all()[i]);
}

/// Corrections become smaller where they overshot: on large bodies light spreads farther than a step can know.
float feedback_gain(const std::vector<LoopStep>& steps) {
    float gain = 1;
    for (std::size_t i = 1; i < steps.size(); ++i)
        if (steps[i].seen.mean > steps[i - 1].seen.mean) gain *= 0.6f;
    return gain;
}

/// True where the last `patience` steps did not improve the best mean before them by 1 %.
bool stopped_gaining(const std::vector<LoopStep>& steps, char method, std::size_t patience) {
    constexpr double gain = 0.99;
    const auto made = static_cast<std::size_t>(
        std::count_if(steps.begin(), steps.end(), [&](const LoopStep& s) { return s.method == method; }));
    if (made < patience + 1) return false;
    const auto least = [](auto first, auto last) {
        double mean = first->seen.mean;
        for (; first != last; ++first) mean = std::min(mean, first->seen.mean);
        return mean;
    };
    const auto middle = steps.end() - static_cast<std::ptrdiff_t>(patience);
    return least(middle, steps.end()) > gain * least(steps.begin(), middle);
}

std::string report_line(const LoopState& state, int most) {
    const LoopStep& step = state.steps.back();
    const double left_s = std::max(0, most - step.iteration) * step.seconds;
    const char* const method = step.method == 'o' ? "open loop" : step.method == 'f' ? "feedback" : "descent";
    return fmt::format(
        "iteration {} ({}): mean error as seen {:.2f}, median {:.2f} (open loop {:.2f}, {:.2f}), {:.1f} s; at most "
        "{:.0f} s left",
        step.iteration, method, step.seen.mean, step.seen.median, state.steps.front().seen.mean,
        state.steps.front().seen.median, step.seconds, left_s);
}

}  // namespace

SkinMixtures mixtures_of(const SurfaceFirst& recipes, std::span<const Eigen::Vector3f> drive) {
    SkinMixtures skin(drive.size(), recipes.layers().size(), recipes.resins());
    parallel_for(0, drive.size(), 256, [&](std::size_t i) { recipes.recipe(drive[i], skin.cell(i)); });
    return skin;
}

LoopResult run_appearance_loop(const LoopTask& task, const LoopOptions& options, Progress& progress,
                               const LoopListener& listener, const LoopState* resume) {
    VOXTONE_EXPECT(task.model && task.scene.volume && task.surface && task.recipes && task.open_loop && task.realise);
    VOXTONE_EXPECT(task.target.size() == task.surface->cells.size());
    expect_finite(task.target);
    const SurfaceFirst& recipes = *task.recipes;
    const auto into_gamut = [&](const Eigen::Vector3f& rgb) { return recipes.into_gamut(rgb); };
    const int most = options.iterations < 0 ? most_iterations : options.iterations;

    LoopResult result;
    result.in_gamut = cells_in_gamut(recipes, task.target);
    std::optional<EyeFilter> wide;
    const auto wide_filter = [&]() -> const EyeFilter& {
        if (!wide) wide.emplace(*task.surface, wider * options.viewing_distance_mm, EyeSurround::none);
        return *wide;
    };
    const Colours target =
        map_targets(task.target, into_gamut, wide_filter);  // as the resins can show it on a thick body
    const Viewer viewer(task, options.intent != Intent::absolute, progress);
    result.white = viewer.white;
    const Judge judge(*task.surface, task.target, result.in_gamut, options.viewing_distance_mm);
    const auto sequence = task.model->sequence(task.scene, *task.surface);

    LoopState& state = result.state;
    progress.begin_stage("appearance loop", static_cast<std::uint64_t>(most) + 1, "predictions");
    Stopwatch watch;
    double stuck_share = 0;
    Colours rgb;
    optics::ResinVolume print;  // the sequence looks at it again for the gradient
    const auto predict = [&](optics::ResinVolume volume, char method) {
        print = std::move(volume);
        rgb = viewer.colours(sequence->next(print, &progress));
        LoopStep step;
        step.iteration = static_cast<int>(state.steps.size());
        step.method = method;
        judge(rgb, step);
        step.stuck_share = stuck_share;
        step.seconds = watch.lap();
        state.steps.push_back(step);
        progress.note(report_line(state, most));
        progress.advance();
    };
    const auto keep_if_best = [&](const SkinMixtures& mixtures) {
        if (!(state.steps.back().seen.mean < state.steps[state.best].seen.mean)) return;
        state.best = state.steps.size() - 1;
        state.best_mixtures = mixtures;
        state.shown = rgb;
    };
    const auto correct = [&] {
        Colours eased(rgb.size());
        const std::size_t stuck =
            feed_back(target, rgb, into_gamut, {.gain = feedback_gain(state.steps)}, state.drive, eased);
        stuck_share = rgb.empty() ? 0 : double(stuck) / double(rgb.size());
    };
    bool downhill = options.descent && task.by_mixtures;
    std::vector<float> weight(target.size(), 1.0f);
    for (std::size_t i = 0; i < target.size(); ++i)
        if (!result.in_gamut[i]) weight[i] = out_of_gamut_weight;
    std::optional<MisfitFunction> misfit;
    if (downhill)
        misfit.emplace(*task.surface, judge.eye(), target, weight, &wide_filter(), contrast_part(options.intent));
    else
        wide.reset();
    Neighbourhood around(*task.surface);
    /// False where the model has no gradient.
    const auto turn_downhill = [&] {
        const Misfit now_is = (*misfit)(rgb);
        const std::vector<float> by_value = viewer.by_value(now_is.by_colour);
        std::vector<float> by_mixtures = task.by_mixtures(
            [&](const LoopTask::GradientVisitor& visit) { return sequence->gradient(by_value, visit, &progress); });
        if (by_mixtures.empty()) return false;
        descend(
            std::move(by_mixtures), {}, [&](Colours& values) { around.smooth(values); }, state.descent);
        return true;
    };

    if (resume) {
        state = *resume;
    } else {
        predict(task.open_loop(), 'o');
        state.open = state.shown = rgb;
        state.drive = state.start_drive = target;
        correct();
        if (listener) listener(state);
    }
    try {
        result.why_stopped = "all iterations were made";
        while (static_cast<int>(state.steps.size()) <= most) {
            const bool feedback = state.descent.mixtures.cells() == 0;
            SkinMixtures mixtures = feedback ? mixtures_of(recipes, state.drive) : printed(state.descent.mixtures);
            if (!feedback) {
                follow(state.recent, mixtures);
                if (static_cast<int>(state.steps.size()) == most) mixtures = state.recent;
            }
            const std::vector<LoopStep> before = state.steps;
            predict(task.realise(mixtures), feedback ? 'f' : 'd');
            keep_if_best(mixtures);
            if (feedback) {
                // Worth another step while the mean falls by 3 %.
                const double mean = state.steps.back().seen.mean, least = least_mean(before, 'f');
                const bool gained =
                    mean<0.97 * least_mean(before), last = static_cast<int>(state.steps.size())> feedback_iterations;
                const bool no_good = state.steps[1].seen.mean >= 0.97 * state.steps[0].seen.mean;
                if (mean < least) state.start_drive = state.drive;
                const bool more = static_cast<int>(state.steps.size()) <= most;
                if (downhill && more && no_good && state.steps.size() == 2) {
                    // Pages of type are better off without feedback, dark pictures are not: look at both.
                    state.drive = target;
                    if (listener) listener(state);
                    continue;
                }
                if (downhill && more && (!gained || last || no_good)) {
                    // From the best by feedback; the gradient is at hand if that was the last one.
                    state.descent = begin_descent(mixtures_of(recipes, state.start_drive),
                                                  first_rates(least_mean(state.steps, 'f')));
                    if (mean < least) downhill = turn_downhill();
                    if (!downhill) state.descent = {};
                }
                if (state.descent.mixtures.cells() == 0) correct();
            } else if (!turn_downhill()) {
                downhill = false;
                state.descent = {};
            }
            const char method = state.steps.back().method;
            if (options.iterations < 0 && (method == 'd' || !downhill) &&
                stopped_gaining(state.steps, method, method == 'd' ? 5 : 3)) {
                result.why_stopped = "it stopped gaining";
                break;
            }
            if (listener) listener(state);
        }
    } catch (const Cancelled&) {
        result.cancelled = true;
        result.why_stopped = "it was stopped";
    }
    if (state.best > 0) result.best = state.best_mixtures;
    progress.end_stage();
    return result;
}

}  // namespace voxtone::halftone
