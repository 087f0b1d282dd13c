// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_ending.h"

#include <csignal>
#include <cstring>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::farm {

JobEnding ending_of(const ProcessEnd& end, const std::string& said, bool was_asked, std::uint64_t oom_kills,
                    std::uint64_t given_bytes) {
    using Kind = JobEnding::Kind;
    constexpr auto number = [](ExitCode code) { return static_cast<int>(code); };
    const auto why = [&](const char* otherwise) { return said.empty() ? std::string(otherwise) : said; };
    const int code = end.exit_code;
    const bool was_killed = end.signal == SIGKILL || end.signal == SIGTERM || end.signal == SIGINT;
    if (code == number(ExitCode::done)) return {};
    if (code == number(ExitCode::stopped) || (was_killed && was_asked))
        return {Kind::again, number(ExitCode::stopped), why("stopped on request")};
    // A job whose reader was killed ends with 75, as if another time might do.
    const bool held_much = end.peak_bytes == 0 || end.peak_bytes >= given_bytes / 2;
    const bool starved = oom_kills > 0 && held_much && (end.signal == SIGKILL || code == number(ExitCode::try_again));
    if (starved)
        return {Kind::starved, number(ExitCode::unfinished),
                "the kernel killed it for memory: it took more than it was given"};
    if (code == number(ExitCode::try_again))
        return {Kind::again, code, why("it could not go on for no fault of its own")};
    if (was_killed)
        return {Kind::again, number(ExitCode::try_again),
                fmt::format("was killed from outside (signal {}), perhaps because the machine's memory was used up",
                            end.signal)};
    if (end.signal != 0)
        return {
            Kind::failed, number(ExitCode::bug),
            fmt::format("crashed (signal {}, {}); a bug of ours, please report it", end.signal, strsignal(end.signal))};
    if (code == number(ExitCode::check_failed))
        return {Kind::checked, code,
                why("the print will not look as asked (strict); its stack and its report are there")};
    return {Kind::failed, code, why("ended without a word")};
}

}  // namespace voxtone::farm
