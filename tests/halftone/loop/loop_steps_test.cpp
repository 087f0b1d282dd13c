// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a loop makes of the errors of its steps.
#include "halftone/loop/loop_steps.h"

#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone::halftone;

namespace {

/// An open loop, then steps by a method, of these scores.
std::vector<LoopStep> steps(LoopMethod method, const std::vector<double>& scores) {
    std::vector<LoopStep> all;
    for (const double score : scores) {
        LoopStep& step = all.emplace_back();
        step.method = all.size() == 1 ? LoopMethod::open_loop : method;
        step.score = score;
    }
    return all;
}

}  // namespace

TEST_CASE("Corrections become smaller after steps that made it worse, and after no others", "[loop]") {
    CHECK(feedback_gain(steps(LoopMethod::feedback, {5, 4, 3, 2})) == 1);
    const float once = feedback_gain(steps(LoopMethod::feedback, {5, 4, 4.5, 3}));
    CHECK(once < 1);
    CHECK(once > 0);
    CHECK(feedback_gain(steps(LoopMethod::feedback, {5, 5.5, 4, 4.5})) == Approx(once * once));
}

TEST_CASE("A loop goes on while it gains, and through a time that is worse before it is better", "[loop]") {
    for (const LoopMethod method : {LoopMethod::feedback, LoopMethod::descent}) {
        std::vector<double> gains{5}, idle{5, 3}, swings{5};
        for (int k = 1; k <= 12; ++k) gains.push_back(5 * std::pow(0.9, k)), idle.push_back(3);
        for (int k = 1; k <= 12; ++k) swings.push_back(5 * std::pow(0.95, k) * (k % 2 ? 1.2 : 1));
        CHECK_FALSE(stopped_gaining(steps(method, gains)));
        CHECK_FALSE(stopped_gaining(steps(method, swings)));
        CHECK(stopped_gaining(steps(method, idle)));
        // Of the steps that are allowed all are left while it gains, fewer where it has not for a while.
        CHECK(steps_left(steps(method, gains), 40) == 40);
        idle.resize(4);
        CHECK(steps_left(steps(method, idle), 40) < 40);
    }
}

TEST_CASE("A descent that throws the print off at once is given up, one that gains or hardly loses is not", "[loop]") {
    const auto lost = [](const std::vector<double>& descent) {
        std::vector<LoopStep> all = steps(LoopMethod::feedback, {8, 5, 3.5, 3.4});
        for (const double score : descent) {
            all.push_back(all.back());
            all.back().method = LoopMethod::descent, all.back().score = score;
        }
        return descent_lost_its_way(all);
    };
    CHECK(lost({4, 3.7}));
    CHECK(lost({3.52, 3.52}));
    CHECK_FALSE(lost({4}));
    CHECK_FALSE(lost({4, 3.49}));
    CHECK_FALSE(lost({3.3, 4}));
    CHECK_FALSE(lost({4, 3.7, 3.6}));                                     // was let go on once
    std::vector<LoopStep> bad = steps(LoopMethod::descent, {5.5, 8, 8});  // still bad before it
    bad.front().seen.mean = 5.1;
    CHECK_FALSE(descent_lost_its_way(bad));
    bad.front().seen.mean = 4.9;
    CHECK(descent_lost_its_way(bad));
    CHECK_FALSE(descent_lost_its_way(steps(LoopMethod::feedback, {3, 4, 5})));
    CHECK_FALSE(descent_lost_its_way(steps(LoopMethod::descent, {3})));
}
