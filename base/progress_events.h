// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress for programs: one JSON object per line (NDJSON), each with an "event":
//   {"event":"stage","stage":"layers","state":"begin","steps":3920,"unit":"layers"}   ("steps" 0: unknown)
//   {"event":"progress","stage":"layers","done":1842,"steps":3920,"seconds":30.21}    at most ten a second
//   {"event":"stage","stage":"layers","state":"end","done":3920,"seconds":64.80}
//   {"event":"warning","message":"..."}   {"event":"note","message":"..."}
//   {"event":"result","result":{...}}     once, the last line
//   {"event":"error","exit_code":3,"message":"..."}   instead of a result, whatever failed
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>

#include "voxtone/base/progress_bar.h"

namespace voxtone {

class ProgressEvents final : public Progress {
public:
    ProgressEvents(TextSink sink, SecondsClock clock);

    /// `json` is one valid JSON value; line breaks in it are taken out.
    void result(std::string_view json);

private:
    void on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) override;
    void on_advance(std::uint64_t done) override;
    void on_stage_end() override;
    void on_warning(const std::string& message) override;
    void on_note(const std::string& message) override;
    void say(const std::string& line);

    TextSink sink_;
    SecondsClock clock_;
    std::mutex mutex_;
    Stage stage_;
    std::atomic<double> next_event_s_{0};
};

/// {"event":"error",...}, without a line break.
[[nodiscard]] std::string error_event(ExitCode code, std::string_view message);

[[nodiscard]] TextSink stdout_sink();

}  // namespace voxtone
