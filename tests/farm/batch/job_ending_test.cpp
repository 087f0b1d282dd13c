// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which ends of a job's process send it back into the queue, and which are for a person to mend.
#include "farm/batch/job_ending.h"

#include <csignal>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::farm;
using Catch::Contains;
using Kind = JobEnding::Kind;

namespace {

constexpr int code_of(ExitCode code) { return static_cast<int>(code); }

JobEnding with_code(ExitCode code, const std::string& said = "", bool was_asked = false) {
    return ending_of({code_of(code), 0}, said, was_asked);
}

JobEnding by_signal(int signal, bool was_asked, const std::string& said = "") {
    return ending_of({-1, signal}, said, was_asked);
}

}  // namespace

TEST_CASE("Every exit code says what becomes of its job, and keeps what was said") {
    CHECK(with_code(ExitCode::done).kind == Kind::done);
    CHECK(with_code(ExitCode::done, "a warning").message.empty());
    for (const auto& [code, kind] :
         {std::pair{ExitCode::bug, Kind::failed}, std::pair{ExitCode::usage, Kind::failed},
          std::pair{ExitCode::invalid_input, Kind::failed}, std::pair{ExitCode::file, Kind::failed},
          std::pair{ExitCode::unfinished, Kind::failed}, std::pair{ExitCode::check_failed, Kind::checked},
          std::pair{ExitCode::try_again, Kind::again}, std::pair{ExitCode::stopped, Kind::again}})
        for (const bool was_asked : {false, true}) {
            CAPTURE(code_of(code), was_asked);
            const JobEnding silent = with_code(code, "", was_asked);
            CHECK(silent.kind == kind);
            CHECK(silent.exit_code == code_of(code));
            CHECK(silent.message.size() > 10);
            CHECK(with_code(code, "the disk is full", was_asked).message == "the disk is full");
        }
}

TEST_CASE("A job that was killed goes again, one that crashed is a bug") {
    for (const int signal : {SIGKILL, SIGTERM, SIGINT}) {
        CAPTURE(signal);
        const JobEnding asked = by_signal(signal, true), unasked = by_signal(signal, false);
        CHECK(asked.kind == Kind::again);
        CHECK(asked.exit_code == code_of(ExitCode::stopped));
        CHECK(unasked.kind == Kind::again);
        CHECK(unasked.exit_code == code_of(ExitCode::try_again));
        CHECK_THAT(unasked.message, Contains("signal " + std::to_string(signal)) && Contains("memory"));
    }
    for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS})
        for (const bool was_asked : {false, true}) {
            CAPTURE(signal, was_asked);
            // What it said last was before the crash, and is not why.
            const JobEnding crashed = by_signal(signal, was_asked, "reading model");
            CHECK(crashed.kind == Kind::failed);
            CHECK(crashed.exit_code == code_of(ExitCode::bug));
            CHECK_THAT(crashed.message, Contains("crashed") && Contains("signal " + std::to_string(signal)));
        }
}
