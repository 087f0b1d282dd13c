// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a job of a batch is: OUT/batch/NAME.json (data/schema/batch-job.schema.json), which is always whole, and
// says so to whoever looks, on any host.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/named_values.h"
#include "io/files/file_digest.h"

namespace voxtone::io {
class JsonObject;
}

namespace voxtone::farm {

enum class JobPhase {
    queued,   ///< to be done; perhaps stopped before, then `message` says so
    running,  ///< by `runner`, if that lives
    done,     ///< a whole stack and its report
    failed,   ///< for the reason in `message`
};

/// Who works on a job.
struct JobRunner {
    std::string host;
    pid_t pid = 0;
    std::uint64_t start = 0;  ///< of the process (io/disk/folder_lock.h)
    std::string since;        ///< UTC, "2026-11-23T09:12:31Z"
};

/// What a whole stack is told by.
struct StackFigures {
    std::string content_sha256;  ///< of the stack, as its manifest has it
    std::string printer;
    std::array<double, 3> size_mm{};
    std::uint64_t layers = 0, voxels = 0;
    std::vector<std::pair<std::string, double>> resin_ml;  ///< by role
    std::string verdict;                                   ///< "good", "fair", "bad"; empty: nothing was predicted
    std::optional<double> seen_de2000;                     ///< mean, as seen; nothing: not predicted
    std::vector<std::string> warnings;
    double seconds = 0;  ///< of the job
    std::uint64_t peak_memory_bytes = 0, output_bytes = 0;
};

/// Its warnings of colours that the print does not show, each a sentence.
[[nodiscard]] std::vector<std::string> lost_colours(const StackFigures& figures);

/// What --after made of a result.
struct AfterState {
    bool over = false;
    int exit_code = 0;  ///< once it is over
};

struct JobState {
    std::string name;
    std::size_t number = 0;  ///< in its plan, from 1
    JobPhase phase = JobPhase::queued;
    std::vector<std::string> command;  ///< words behind `voxtone`
    std::string program;               ///< version of the program that did or does it
    bool folder_is_ours = false;       ///< OUT/NAME was not there or empty when the batch took it
    int attempts = 0;                  ///< so far, of the run that ended or runs
    int attempts_that_got_on = 0;      ///< of these: after which the loop had come further than before
    int threads = 0;                   ///< of the last attempt; 0: not known
    double expected_cpu_s = 0;         ///< of processors, by the estimate; 0: none was made
    std::optional<JobRunner> runner;   ///< while it runs
    int exit_code = 0;                 ///< of the last attempt
    std::string message;               ///< why it failed or was stopped
    std::string finished;              ///< UTC
    std::vector<std::pair<std::string, io::KnownDigest>>
        inputs;                           ///< by absolute path, of those that are known for good
    std::optional<StackFigures> figures;  ///< of what is done
    std::optional<AfterState> after;      ///< where a command was to follow
};

/// What a report and the figures of a state have under the same names. Throws InputError.
void read_shared_figures(const io::JsonObject& json, StackFigures& figures);

[[nodiscard]] std::string state_json(const JobState& state);
/// Throws FileError where there is no such file, InputError for what is no state of this version.
[[nodiscard]] JobState read_state(const std::filesystem::path& file);

/// Whether the runner is of this host and lives. Of another host that is not known here: false too.
[[nodiscard]] bool lives_here(const JobRunner& runner);

/// Now, as states have it.
[[nodiscard]] std::string utc_now();
/// Seconds since 1970; nothing for what is no such time.
[[nodiscard]] std::optional<double> seconds_of(const std::string& utc);

}  // namespace voxtone::farm

template <>
struct voxtone::NamesOf<voxtone::farm::JobPhase> {
    using Phase = farm::JobPhase;
    static constexpr auto table = std::to_array<Named<Phase>>(
        {{Phase::queued, "queued"}, {Phase::running, "running"}, {Phase::done, "done"}, {Phase::failed, "failed"}});
};
