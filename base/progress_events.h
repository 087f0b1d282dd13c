// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress for programs: one JSON object per line (NDJSON), each with an "event":
//   {"event":"stage","stage":"layers","state":"begin","steps":3920,"unit":"layers"}   ("steps" 0: unknown)
//   {"event":"progress","stage":"layers","done":1842,"steps":3920,"seconds":30.21,"job_seconds_left":95}
//     with "part":0.37 before "seconds" where it is known how far the running step is;
//     at most ten a second, at least one; "steps" become fewer where the work turns out to be shorter;
//     "job_seconds_left" where the job's stages are known
//   {"event":"stage","stage":"layers","state":"end","done":3920,"seconds":64.80}
//   {"event":"warning","message":"..."}   {"event":"note","message":"..."}
//   {"event":"result","result":{...}}     once, the last line
//   {"event":"error","exit_code":3,"message":"..."}   instead of a result, whatever failed
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>

#include "base/progress_bar.h"

namespace voxtone {

class ProgressEvents final : public Progress, public ShowsOutlook, public ShowsParts, public ShowsPartNames {
public:
    ProgressEvents(TextSink sink, SecondsClock clock, bool ticks = false);

    /// Tells how far the stage is, unless that was told within the last second.
    void tick();

    /// `json` is one valid JSON value; line breaks in it are taken out.
    void result(std::string_view json);

    void expect(std::vector<ExpectedStage> stages) override;
    void expect_steps(std::uint64_t steps) override;

private:
    void on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) override;
    void on_advance(std::uint64_t done) override;
    void on_stage_end() override;
    void on_warning(const std::string& message) override;
    void on_note(const std::string& message) override;
    void write_line(const std::string& line);
    void tell_progress(std::uint64_t done, double now_s);

    TextSink sink_;
    SecondsClock clock_;
    std::mutex mutex_;
    Stage stage_;
    JobOutlook outlook_;
    bool in_stage_ = false;
    std::atomic<double> next_event_s_{0};
    std::optional<Ticker> ticker_;  ///< last: it uses the others
};

/// {"event":"error",...}, without a line break.
[[nodiscard]] std::string error_event(ExitCode code, std::string_view message);

[[nodiscard]] TextSink stdout_sink();

}  // namespace voxtone
