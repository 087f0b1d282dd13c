// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the end of a process means for its job: the table that a farm's nights depend on.
#include "farm/batch/job_life.h"

#include <csignal>

#include <catch2/catch.hpp>

using namespace voxtone::farm;
using Catch::Matchers::Contains;
using End = JobEnding::Kind;
using Step = NextStep::Kind;

TEST_CASE("An exit code says whether the same again may go") {
    CHECK(ending_of({0, 0}, "", false).kind == End::done);
    CHECK(ending_of({0, 0}, "", true).kind == End::done);
    for (const int code : {75, 85}) {
        CHECK(ending_of({code, 0}, "", false).kind == End::again);
        CHECK(ending_of({code, 0}, "disk full", false).message == "disk full");
        CHECK(ending_of({code, 0}, "", false).exit_code == code);
    }
    for (const int code : {1, 2, 3, 4, 5, 127}) {
        CHECK(ending_of({code, 0}, "no model", false).kind == End::failed);
        CHECK(ending_of({code, 0}, "no model", true).message == "no model");
        CHECK(ending_of({code, 0}, "", false).exit_code == code);
        CHECK_FALSE(ending_of({code, 0}, "", false).message.empty());
    }
    CHECK(ending_of({6, 0}, "", false).kind == End::checked);
}

TEST_CASE("A signal from outside is no fault of the job, a crash is one of ours") {
    for (const int signal : {SIGKILL, SIGTERM, SIGINT}) {
        const JobEnding killed = ending_of({-1, signal}, "", false), asked = ending_of({-1, signal}, "", true);
        CHECK(killed.kind == End::again);
        CHECK(killed.exit_code == 75);
        CHECK(asked.kind == End::again);
        CHECK(asked.exit_code == 85);
    }
    for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE}) {
        CHECK(ending_of({-1, signal}, "", true).kind == End::failed);
        CHECK(ending_of({-1, signal}, "", false).exit_code == 1);
    }
}

TEST_CASE("What the kernel killed for memory is not a stranger's signal") {
    const JobEnding killed = ending_of({-1, SIGKILL}, "", false, 1);
    CHECK(killed.kind == End::starved);
    CHECK(killed.exit_code == 5);
    CHECK_THAT(killed.message, Contains("memory"));
    CHECK(ending_of({75, 0}, "the reader was killed", false, 1).kind == End::starved);  // its reader was
    // Something else in the group was killed while this went its own way.
    CHECK(ending_of({0, 0}, "", false, 1).kind == End::done);
    CHECK(ending_of({3, 0}, "no model", false, 1).kind == End::failed);
    CHECK(ending_of({85, 0}, "", false, 1).kind == End::again);
}

TEST_CASE("What the kernel killed of others while a job held little is not the job's doing") {
    constexpr std::uint64_t given = 1'000'000'000;
    const auto killed = [&](std::uint64_t peak, std::uint64_t kills) {
        return ending_of({-1, SIGKILL, peak}, "", false, kills, given);
    };
    CHECK(killed(given / 2, 1).kind == End::starved);
    CHECK(killed(given / 2 - 1, 1).kind == End::again);
    CHECK(killed(given / 2 - 1, 1).exit_code == 75);
    CHECK_THAT(killed(given / 2 - 1, 1).message, Contains("signal 9"));
    CHECK(killed(2 * given, 0).kind == End::again);
    CHECK(killed(0, 1).kind == End::starved);                               // what it held is not known
    CHECK(ending_of({-1, SIGKILL, 1}, "", false, 1).kind == End::starved);  // alone in its group
    CHECK(ending_of({75, 0, given}, "", false, 1, given).kind == End::starved);
    CHECK(ending_of({75, 0, 1}, "", false, 1, given).kind == End::again);
}

TEST_CASE("A job is tried so many times again as is allowed, and no more") {
    const JobEnding again{End::again, 75, "disk full"};
    CHECK(next_step(again, {1, 2, false, true}).kind == Step::again);
    CHECK(next_step(again, {2, 2, false, true}).kind == Step::again);
    const NextStep given_up = next_step(again, {3, 2, false, true});
    CHECK(given_up.kind == Step::fail);
    CHECK(given_up.exit_code == 75);
    CHECK(given_up.message == "disk full (after 3 attempts)");
    CHECK(next_step(again, {1, 0, false, true}).kind == Step::fail);
    // What was stopped on request is gone on with, however often it was tried.
    CHECK(next_step(again, {9, 2, true, true}).kind == Step::put_aside);
}

TEST_CASE("A try that came further costs none of those that are allowed") {
    const JobEnding stopped{End::again, 85, "its time was over"};
    for (int made = 1; made < 40; ++made) CHECK(next_step(stopped, {made, 2, false, false, made}).kind == Step::again);
    CHECK(next_step(stopped, {9, 2, false, false, 7}).kind == Step::again);
    const NextStep given_up = next_step(stopped, {9, 2, false, false, 6});
    CHECK(given_up.kind == Step::fail);
    CHECK(given_up.message == "its time was over (after 9 attempts, of which 6 came further)");
    JobState state;
    note_start(state, {}, 1, 4);
    state.attempts_that_got_on = 1;
    note_start(state, {}, 2, 4);
    CHECK(state.attempts_that_got_on == 1);
    note_start(state, {}, 1, 4);  // handed over anew
    CHECK(state.attempts_that_got_on == 0);
}

TEST_CASE("A job that was killed for memory gets more once, where there is more to get") {
    const JobEnding starved{End::starved, 5, "killed for memory"};
    CHECK(next_step(starved, {1, 5, false, true}).kind == Step::with_more);
    CHECK(next_step(starved, {2, 5, false, false}).kind == Step::fail);
    CHECK(next_step(starved, {1, 5, false, false}).exit_code == 5);
    CHECK(next_step(starved, {1, 0, false, true}).kind == Step::fail);
    CHECK(next_step(starved, {1, 5, true, true}).kind == Step::put_aside);
}

TEST_CASE("The other ends are for good") {
    CHECK(next_step({End::done, 0, ""}, {}).kind == Step::finish);
    CHECK(next_step({End::failed, 3, "no model"}, {1, 5, true, true}).kind == Step::fail);
    CHECK(next_step({End::checked, 6, "strict"}, {}).kind == Step::fail_with_stack);
}

TEST_CASE("A state tells of the attempt that runs, or of the end of the last one") {
    JobState state;
    note_start(state, {"host", 12, 345, "2026-11-23T09:12:31Z"}, 2, 4);
    CHECK(state.phase == JobPhase::running);
    REQUIRE(state.runner);
    CHECK(state.runner->pid == 12);
    CHECK(state.attempts == 2);
    CHECK(state.threads == 4);
    CHECK_FALSE(state.program.empty());

    note_waiting(state, 75, "disk full");
    CHECK(state.phase == JobPhase::queued);
    CHECK_FALSE(state.runner);
    CHECK(state.exit_code == 75);
    CHECK(state.message == "disk full");
    CHECK(state.finished.empty());

    note_failed(state, 3, "no model");
    CHECK(state.phase == JobPhase::failed);
    CHECK_FALSE(state.finished.empty());

    state.figures = StackFigures();
    note_start(state, {"host", 13, 346, "2026-11-23T09:13:31Z"}, 1, 0);
    CHECK(state.message.empty());
    CHECK(state.finished.empty());
    CHECK_FALSE(state.figures);
    note_done(state);
    CHECK(state.phase == JobPhase::done);
    CHECK(state.exit_code == 0);
    CHECK_FALSE(state.runner);
    CHECK_FALSE(state.finished.empty());
}
