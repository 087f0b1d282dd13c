// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/job_outlook.h"

#include <limits>

#include <catch2/catch.hpp>

#include "base/progress.h"

using namespace voxtone;

TEST_CASE("What is left of a job is what is left of its stage and the stages to come") {
    JobOutlook outlook;
    CHECK_FALSE(outlook.seconds_left(0, 0));
    outlook.expect({{"loop", 40}, {"layers", 2}, {"predict", 20}});
    CHECK(*outlook.seconds_left(0, 0) == Approx(62));
    outlook.begin("loop", 100);
    CHECK(*outlook.seconds_left(0, 110) == Approx(30 + 22));    // not a step yet: as expected
    CHECK(*outlook.seconds_left(0.25, 120) == Approx(52));      // (20 + 20) / 0.75 * 0.75 + 22: waited for
    CHECK(*outlook.seconds_left(0.5, 130) == Approx(20 + 22));  // the second step took 10 s
    CHECK(*outlook.seconds_left(0.5, 131) == Approx(19 + 22));  // and no step since
    outlook.end(181);                                           // 81 s for 40: all is nearly half as fast
    CHECK(*outlook.seconds_left(0, 181) == Approx(22 * 1.82));  // (81 + 10) / (40 + 10)
    outlook.begin("checkpoint", 181);                           // nobody expected it
    CHECK(*outlook.seconds_left(0, 200) == Approx(22 * 1.82));
    outlook.end(201);
    outlook.begin("predict", 201);  // layers were left out
    CHECK(*outlook.seconds_left(0, 211) == Approx(20 * 1.82 - 10));
    CHECK(*outlook.seconds_left(0, 261) == Approx(6));  // longer than expected: near its end, never at it
    CHECK_FALSE(outlook.seconds_left(0, 301));          // 100 s for 36: nobody knows
    outlook.end(310);
    CHECK_FALSE(outlook.seconds_left(0, 310));
}

TEST_CASE("A time that was grossly wrong is corrected") {
    JobOutlook outlook;
    outlook.expect({{"loop", 10}});
    outlook.begin("loop", 0);
    CHECK(*outlook.seconds_left(0, 0) == Approx(10));
    CHECK(*outlook.seconds_left(0.1, 5) == Approx(10));    // (5 + 5) / 0.6 * 0.9: a little more
    CHECK(*outlook.seconds_left(0.2, 20) == Approx(120));  // more than twice as long, and not by seconds only
    CHECK(*outlook.seconds_left(0.5, 50) == Approx(50));   // 30 s for three tenths
}

TEST_CASE("A first step that is unlike the others does not make minutes of seconds") {
    JobOutlook outlook;
    outlook.expect({{"loop", 25}});
    outlook.begin("loop", 0);
    // As on a machine with other work: 158 s for the first of 11 steps, 13 s for each of the others.
    const double first_s = 158, step_s = 13, end_s = first_s + 10 * step_s;
    double before_s = 0;
    for (int step = 1; step < 11; ++step) {
        const double now_s = first_s + (step - 1) * step_s;
        const double left_s = outlook.seconds_left(step / 11.0, now_s).value();
        INFO(step);
        CHECK(left_s >= 0.9 * (end_s - now_s));
        CHECK(left_s <= (step == 1 ? 2.1 : 1.1) * (end_s - now_s));  // all of 158 s a step would be 29 min
        if (step > 1) CHECK(left_s < before_s);
        before_s = left_s;
    }
}

TEST_CASE("The time left is written coarsely") {
    CHECK(left_text(0) == "about 1 s left");
    CHECK(left_text(12.2) == "about 12 s left");
    CHECK(left_text(41) == "about 40 s left");
    CHECK(left_text(100) == "about 2 min left");
    CHECK(left_text(7200) == "about 2.0 h left");
}

TEST_CASE("What is expected reaches a progress that shows it, and any other is left alone") {
    struct Shows final : Progress, ShowsOutlook {
        void expect(std::vector<ExpectedStage> stages) override { expected = std::move(stages); }
        void expect_steps(std::uint64_t steps) override { of_stage = steps; }
        std::vector<ExpectedStage> expected;
        std::uint64_t of_stage = 0;
    };
    Shows shows;
    expect_stages(shows, {{"loop", 4}, {"layers", 2}});
    REQUIRE(shows.expected.size() == 2);
    CHECK(shows.expected[1].name == "layers");
    CHECK(shows.expected[0].seconds == 4);
    expect_steps(shows, 17);
    CHECK(shows.of_stage == 17);
    Progress silent;
    expect_stages(silent, {{"loop", 4}});
    expect_steps(silent, 3);
}

TEST_CASE("Steps are measured over the later half of what is done") {
    JobOutlook outlook;
    outlook.expect({{"loop", 0}, {"layers", 1e-9}});
    outlook.begin("loop", 0);
    // Four seconds for each hundredth to a fifth, one for each from then on.
    double now_s = 0;
    for (int step = 1; step <= 40; ++step) {
        now_s += step <= 20 ? 4 : 1;
        (void)outlook.seconds_left(step / 100.0, now_s);
    }
    // Of the marks the last one that is not beyond a half of 0.4: all since then took a second each.
    CHECK(*outlook.seconds_left(0.4, now_s) == Approx(60).epsilon(0.16));  // or the one before it
}

TEST_CASE("A stage without an expectation counts by its steps alone, and what is expected of others is kept") {
    JobOutlook outlook;
    outlook.expect({{"layers", 30}});
    outlook.begin("repair", 0);
    CHECK(*outlook.seconds_left(0.01, 1) == Approx(30));  // less than one in fifty says nothing
    CHECK(*outlook.seconds_left(0.02, 2) == Approx(98 + 30));
    CHECK(*outlook.seconds_left(0.02, 50) == Approx(98 - 48 + 30));  // and no step since
    outlook.end(60);
    outlook.begin("layers", 60);
    CHECK(*outlook.seconds_left(0, 60) == Approx(30));  // nothing was expected of `repair`: the pace is as it was
    CHECK(*outlook.seconds_left(0, 129) == Approx(6.9));
    CHECK(outlook.seconds_left(0, 130));  // 70 s: twice 30 s and 10 s more
    CHECK_FALSE(outlook.seconds_left(0, 130.1));
    CHECK(outlook.seconds_left(0.5, 131));  // a step says more than the clock
}

TEST_CASE("The time left is rounded to what a person says") {
    CHECK(left_text(0.4) == "about 1 s left");
    CHECK(left_text(19.9) == "about 20 s left");
    CHECK(left_text(22.4) == "about 20 s left");
    CHECK(left_text(22.6) == "about 25 s left");
    CHECK(left_text(89.9) == "about 90 s left");
    CHECK(left_text(90.1) == "about 2 min left");
    CHECK(left_text(5399) == "about 90 min left");
    CHECK(left_text(5400) == "about 1.5 h left");
    CHECK(left_text(3e8) == "about 83333.3 h left");
    CHECK(left_text(1e9) == "long");
    CHECK(left_text(std::numeric_limits<double>::quiet_NaN()) == "long");
}
