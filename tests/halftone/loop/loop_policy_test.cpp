// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a loop does next, told by nothing but the steps that it has made.
#include "halftone/loop/loop_policy.h"

#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone::halftone;

namespace {

using Next = LoopPolicy::Next;
using Ending = LoopPolicy::Ending;

/// An open loop, then steps of feedback, of these scores.
std::vector<LoopStep> fed_back(const std::vector<double>& scores) {
    std::vector<LoopStep> steps;
    for (const double score : scores) {
        LoopStep& step = steps.emplace_back();
        step.method = steps.size() == 1 ? LoopMethod::open_loop : LoopMethod::feedback;
        step.score = step.seen.mean = step.seen.percentile_95 = score;
    }
    return steps;
}

LoopPolicy policy(int iterations) { return LoopPolicy({iterations, 8, 3, false}); }

}  // namespace

TEST_CASE("Feedback goes on while it gains, and gives way to a descent that may follow", "[loop]") {
    const LoopPolicy loop = policy(-1);
    CHECK(loop.after_feedback(fed_back({8, 5}), true) == Next::correct);
    CHECK(loop.after_feedback(fed_back({8, 5, 4}), true) == Next::correct);
    CHECK(loop.after_feedback(fed_back({8, 5, 4.95}), true) == Next::descend);
    CHECK(loop.after_feedback(fed_back({8, 5, 4, 3}), true) == Next::descend);  // so many, and no more
    CHECK(loop.after_feedback(fed_back({8, 5, 4, 3}), false) == Next::correct);
    // A first step that is no good: the target itself is tried, and then the descent begins.
    CHECK(loop.after_feedback(fed_back({8, 7.9}), true) == Next::target);
    CHECK(loop.after_feedback(fed_back({8, 7.9, 5}), true) == Next::descend);
    // Nothing is prepared for a step that will not be made.
    CHECK(policy(2).after_feedback(fed_back({8, 5, 4.95}), true) == Next::correct);
}

TEST_CASE("A loop ends with its iterations, or where nothing that is left can be seen if no number was asked for",
          "[loop]") {
    CHECK_FALSE(policy(3).ends(fed_back({8, 5, 4}), true));
    CHECK(policy(3).ends(fed_back({8, 5, 4, 3}), true));
    CHECK(policy(-1).ends(fed_back({8, 0.7}), true));
    CHECK_FALSE(policy(3).ends(fed_back({8, 0.7}), true));
    CHECK(policy(3).why_it_ended(fed_back({8, 5, 4, 3}), true) == Ending::all_made);
    CHECK(policy(-1).why_it_ended(fed_back({8, 0.7}), true) == Ending::nothing_visible);
    CHECK(policy(-1).why_it_ended(fed_back({8, 5, 5, 5, 5, 5}), false) == Ending::gains_no_more);
    CHECK_FALSE(policy(-1).ends(fed_back({8, 5, 5, 5, 5, 5}), true));  // a descent may still follow
    CHECK(policy(5).predictions_left(fed_back({8, 5, 4}), true) == 3);
    CHECK(policy(-1).predictions_left(fed_back({8, 5, 5, 5, 5, 5}), false) == 0);
}

TEST_CASE("The best step is the first of the least score", "[loop]") {
    CHECK(best_step(fed_back({8, 5, 3, 3, 4})) == 2);
    CHECK(best_step(fed_back({8})) == 0);
}
