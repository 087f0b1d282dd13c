// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress for a worker that speaks Open Job Description: the messages on stdout of its specification, one a line
// (github.com/OpenJobDescription/openjd-specifications, "How Jobs Are Run").
//
//   openjd_status: layers, 1842 of 3920 layers      when a stage begins, and at least every 10 s
//   openjd_progress: 41.7                           percent of the whole job, where its stages are known; never less
//                                                   than before, and 100 only with the result
//   openjd_fail: no triangles                       instead of a result
//
// Warnings and notes are lines of their own, for the log.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "base/progress_bar.h"

namespace voxtone {

class OpenJobProgress final : public Progress, public ShowsOutlook, public ShowsParts, public ShowsPartNames {
public:
    OpenJobProgress(TextSink sink, SecondsClock clock, bool ticks = false);

    /// Tells how far the job is, unless that was told within the last 10 s or no stage has begun.
    void tick();
    /// The work has come to its result.
    void finish();

    void expect(std::vector<ExpectedStage> stages) override;
    void expect_steps(std::uint64_t steps) override;

private:
    void on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) override;
    void on_advance(std::uint64_t done) override;
    void on_stage_end() override;
    void on_warning(const std::string& message) override;
    void on_note(const std::string& message) override;
    void write_state(double now_s);

    TextSink sink_;
    SecondsClock clock_;
    std::mutex mutex_;
    Stage stage_;
    JobOutlook outlook_;
    double began_s_, written_s_ = 0, written_percent_ = 0;
    bool in_stage_ = false, has_begun_ = false;
    std::optional<Ticker> ticker_;  ///< last: it uses the others
};

/// "openjd_fail: ...", without a line break.
[[nodiscard]] std::string openjd_failure(std::string_view message);

}  // namespace voxtone
