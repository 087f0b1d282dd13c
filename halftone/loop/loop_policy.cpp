// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/loop_policy.h"

#include <algorithm>
#include <span>

namespace voxtone::halftone {

namespace {

/// CIEDE2000 between two surfaces side by side that half of all people see: Paravina et al. 2015, J. Esthet. Restor.
/// Dent. 27:S1.
constexpr double just_noticeable = 0.8;

/// No other method may follow.
bool by_last_method(const std::vector<LoopStep>& steps, bool may_descend) {
    return steps.back().method == LoopMethod::descent || !may_descend;
}

}  // namespace

std::size_t best_step(const std::vector<LoopStep>& steps) {
    return static_cast<std::size_t>(std::ranges::min_element(steps, {}, &LoopStep::score) - steps.begin());
}

LoopPolicy::Next LoopPolicy::after_feedback(const Steps& steps, bool may_descend) const {
    if (!may_descend || made(steps) >= most()) return Next::correct;
    const bool no_good = steps[1].score >= worthwhile * steps[0].score;
    if (no_good && made(steps) == 1) return Next::target;
    const auto before = std::span(steps).first(steps.size() - 1);
    const bool gained = steps.back().score < worthwhile * std::ranges::min_element(before, {}, &LoopStep::score)->score;
    return !gained || no_good || made(steps) >= limits_.by_feedback ? Next::descend : Next::correct;
}

/// Only a loop without a limit stops by itself; one that may take long lets a descent swing.
bool LoopPolicy::gains_no_more(const Steps& steps, bool may_descend) const {
    return !is_limited() && by_last_method(steps, may_descend) &&
           (stopped_gaining(steps) || (!limits_.patient && descent_lost_its_way(steps)));
}

/// The best print's mean, and all but a twentieth of its surface, are within what can be seen.
bool LoopPolicy::nothing_visible_left(const Steps& steps) const {
    const LoopStep& best = steps[best_step(steps)];
    return !is_limited() && best.score < just_noticeable && best.seen.percentile_95 < just_noticeable;
}

bool LoopPolicy::ends(const Steps& steps, bool may_descend) const {
    return gains_no_more(steps, may_descend) || made(steps) >= most() || nothing_visible_left(steps);
}

LoopPolicy::Ending LoopPolicy::why_it_ended(const Steps& steps, bool may_descend) const {
    if (gains_no_more(steps, may_descend)) return Ending::gains_no_more;
    return made(steps) < most() ? Ending::nothing_visible : Ending::all_made;
}

std::size_t LoopPolicy::predictions_left(const Steps& steps, bool may_descend) const {
    const auto allowed = static_cast<std::size_t>(std::max(0, most() - made(steps)));
    if (is_limited() || !by_last_method(steps, may_descend)) return allowed;
    return gains_no_more(steps, may_descend) ? 0 : steps_left(steps, allowed);
}

}  // namespace voxtone::halftone
