// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a loop does next, as a function of the steps that it has made and of nothing else.
#pragma once

#include <cstddef>
#include <vector>

#include "halftone/loop/loop_steps.h"

namespace voxtone::halftone {

/// The first of the least score.
[[nodiscard]] std::size_t best_step(const std::vector<LoopStep>& steps);

/// How many steps there may be after the open loop.
struct LoopLimits {
    int asked_for = -1;  ///< -1: until it stops gaining, at most `most_else`
    int most_else = 0;
    int by_feedback = 0;   ///< before a descent
    bool patient = false;  ///< it may take its time: a descent may swing
};

class LoopPolicy {
public:
    explicit LoopPolicy(const LoopLimits& limits) : limits_(limits) {}

    using Steps = std::vector<LoopStep>;
    [[nodiscard]] int most() const { return is_limited() ? limits_.asked_for : limits_.most_else; }
    [[nodiscard]] static int made(const Steps& steps) { return static_cast<int>(steps.size()) - 1; }

    enum class Next {
        correct,  ///< another correction
        target,   ///< the target itself: pages of type are better off without feedback, dark pictures are not
        descend,  ///< from the best print by feedback
    };
    /// After a step of feedback. `may_descend`: a descent may still follow.
    [[nodiscard]] Next after_feedback(const Steps& steps, bool may_descend) const;
    /// No step follows. A resumed loop may be there at its beginning.
    [[nodiscard]] bool ends(const Steps& steps, bool may_descend) const;
    enum class Ending { gains_no_more, all_made, nothing_visible };
    [[nodiscard]] Ending why_it_ended(const Steps& steps, bool may_descend) const;
    /// About: all that may follow while it gains, the fewer the longer it has not.
    [[nodiscard]] std::size_t predictions_left(const Steps& steps, bool may_descend) const;

private:
    [[nodiscard]] bool is_limited() const { return limits_.asked_for >= 0; }
    [[nodiscard]] bool gains_no_more(const Steps& steps, bool may_descend) const;
    [[nodiscard]] bool nothing_visible_left(const Steps& steps) const;

    LoopLimits limits_;
};

}  // namespace voxtone::halftone
