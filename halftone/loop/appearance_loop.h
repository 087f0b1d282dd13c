// SPDX-License-Identifier: GPL-3.0-or-later
//
// The appearance loop: resins rearranged until the print looks like its target.
//
//   distribute resins -> predict what will be seen -> compare with the target -> redistribute, again
//   (Iser, Rittig, Wilkie 2025, Fig. 2; Elek et al. 2017; Sumin et al. 2019)
//
// The unknowns are mixtures by surface cell and depth (skin.h). The first steps make them surface first
// (minimal_depth_separation.h) from one colour per cell, its control colour, by residual_feedback.h: most of the way
// for the price of a prediction each, while they gain. Where the model has a gradient, mixture_descent.h goes on from
// the best of these, for the price of a little more than two: it weighs what cells do to each other. Its steps swing a
// little about where they lead to, so the last of all iterations is their running mean. docs/decisions/003 compares the
// two. What is predicted are the voxels themselves, as the screen laid them: its error is fed back like any other. Any
// AppearanceModel serves.
//
// Where the set has a residual, what the model sees is corrected for the mixture around each place
// (optics/layered/mixture_correction.h); the gradient takes the corrections of the last print as fixed.
//
// Before the first step targets are mapped into the gamut of the resins on a thick body (the separation's mapping: hue
// kept; local contrast given back, map_targets.h); what a place cannot show because of its neighbours or of what lies
// behind it is found out on the way, and targets are relaxed.
//
// Errors are CIEDE2000, media-relative, weighed by area, over all cells: as they are, and as seen, after the eye filter
// (eye_filter.h, without its negative surround) and over the level of the print's paper (paper.h). The best iterate is
// that of the least score (loop_measure.h), which sees regions and leaves out cells beyond the gamut that are in none;
// iteration 0 is the open loop, so the result is never worse than that as far as score and model can see.
//
// Stops after `iterations`, or when five steps in a row (three of feedback where there is no gradient) did not improve
// the best mean by 1 %, or when the best one's mean and its 95th percentile as seen are below 0.8, which is just
// noticeable (both only where no number of iterations was asked for), or when it is cancelled: then with the best
// iterate so far. Same bits for any number of threads, and for a loop that was interrupted and resumed any number of
// times.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "halftone/loop/loop_steps.h"
#include "halftone/loop/minimal_depth_separation.h"
#include "halftone/loop/mixture_descent.h"
#include "halftone/loop/seen_target.h"
#include "halftone/loop/skin.h"
#include "optics/colour/colour.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

/// The stage of Progress that a loop is.
inline constexpr std::string_view loop_stage = "appearance loop";

enum class Intent {
    relative,  ///< white of the target is the white resin at that place
    absolute,  ///< white of the target is a body that absorbs nothing
    contrast,  ///< as relative, but where a limit is met the neighbourhood gives way more, and local contrast is kept
};

inline constexpr int most_iterations = 8;      ///< of a loop that has no limit
inline constexpr int patient_iterations = 30;  ///< of one that may take its time

struct LoopOptions {
    int iterations = -1;  ///< most; -1: until it stops gaining, at most `most_without_limit`
    int most_without_limit = most_iterations;
    double viewing_distance_mm = 300;  ///< > 0
    Intent intent = Intent::relative;
    bool descent = true;     ///< after feedback, where the model has a gradient
    bool last_look = false;  ///< at the print that it ends with, as a prediction that stands alone shows it
};

/// LoopResult::why_stopped of a loop that might have gained more.
inline constexpr std::string_view all_iterations_made = "all iterations were made";
inline constexpr int feedback_iterations = 3;  ///< before the descent

struct LoopTask {
    const optics::AppearanceModel* model = nullptr;
    optics::Scene scene;   ///< its volume is the shape, all of the white resin: what media-relative values refer to
    int white_resin = -1;  ///< of the scene's volume; where the set has a residual, relative colours refer to it
    std::function<optics::ResinVolume()> open_loop;  ///< the print that the loop begins with
    const optics::Surface* surface = nullptr;
    const MinimalDepthSeparation* recipes = nullptr;
    std::span<const Eigen::Vector3f> target;  ///< linear sRGB per surface cell
    /// The print of these mixtures: same size and shape as the scene's volume.
    std::function<optics::ResinVolume(const SkinMixtures&)> realise;
    using GradientVisitor = optics::AppearanceSequence::GradientVisitor;
    /// The gradient by voxels that `visit_all` hands over, summed over those of each cell and layer: as
    /// SkinMixtures::all. Empty where that says that there is none.
    std::function<std::vector<float>(const std::function<bool(const GradientVisitor&)>& visit_all)> mixture_gradient;
};

/// With what the model's sequence keeps (AppearanceSequence::write_state) enough to go on later, to the same bits.
struct LoopState {
    std::vector<float> white;  ///< appearance of the white twin; empty for the absolute intent
    std::vector<LoopStep> steps;
    std::size_t best = 0;                        ///< index into steps; 0: the open loop
    std::vector<Eigen::Vector3f> control;        ///< of the next iterate, per cell, while there is feedback
    std::vector<Eigen::Vector3f> start_control;  ///< of the best iterate by feedback: where descent starts
    DescentState descent;                        ///< without cells until it begins
    SkinMixtures recent;         ///< running mean of what it printed, the last step for a half; without cells before
    SkinMixtures best_mixtures;  ///< of a best iterate by descent; by feedback they are those of start_control
    std::vector<Eigen::Vector3f> open, shown;  ///< predicted colours of the open loop and of the best iterate
    std::vector<float> urgency;  ///< of each region: what the descent counts it more by, while it is worse than it was
    double saturated_share = 0;  ///< LoopStep::saturated_share of the next iterate
    bool has_gradient = true;    ///< false once the model said that it has none
};

/// A state to go on from, and what the sequence kept then.
struct ResumedLoop {
    LoopState state;
    std::vector<std::byte> sequence;
};

struct LoopResult {
    LoopState state;
    std::vector<char> in_gamut;  ///< per cell
    bool cancelled = false;
    std::string why_stopped;
    std::optional<SkinMixtures> best;  ///< nothing: the open loop was best
    std::vector<std::string> remarks;  ///< of the model, on the best iterate (Appearance::remarks)
    std::shared_ptr<const SeenTarget> seen_target;
    std::vector<Eigen::Vector3f> last_look;  ///< per cell, linear sRGB; empty where none was asked for
};

/// After each iteration, with all that is needed to go on. What it returns, if anything, is called before any of that
/// changes or is gone: until then it may be read, from another thread too.
using LoopListener = std::function<std::function<void()>(const LoopState&, const optics::AppearanceSequence&)>;

/// `resume`: of the same task; where it has made as many iterations as are asked for, or more, the best of them comes
/// out. Throws what the model throws, InputError for a state that the model cannot use; Cancelled only before the open
/// loop was predicted.
[[nodiscard]] LoopResult run_appearance_loop(const LoopTask& task, const LoopOptions& options, Progress& progress,
                                             const LoopListener& listener = {},
                                             std::optional<ResumedLoop> resume = std::nullopt);

/// Mixtures of every cell for these control colours.
[[nodiscard]] SkinMixtures mixtures_of(const MinimalDepthSeparation& recipes, std::span<const Eigen::Vector3f> control);

}  // namespace voxtone::halftone
