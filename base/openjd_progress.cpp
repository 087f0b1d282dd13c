// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/openjd_progress.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/printable.h"

namespace voxtone {

namespace {

/// A message ends where its line ends.
std::string printable_line(std::string_view text) {
    std::string line(text);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return printable(line);
}

std::string status(std::string_view text) { return fmt::format("openjd_status: {}\n", printable_line(text)); }

}  // namespace

OpenJobProgress::OpenJobProgress(TextSink sink, SecondsClock clock, bool ticks)
    : sink_(std::move(sink)), clock_(std::move(clock)), began_s_(clock_()) {
    constexpr double period_s = 1;
    if (ticks) ticker_.emplace(period_s, [this] { tick(); });
}

void OpenJobProgress::tick() {
    constexpr double silence_s = 10;  // workers take a silence of 20 s for a hang
    const std::lock_guard lock(mutex_);
    const double now_s = clock_();
    if (has_begun_ && now_s - written_s_ >= silence_s) write_state(now_s);
}

void OpenJobProgress::write_state(double now_s) {
    written_s_ = now_s;
    const std::uint64_t steps_done = std::min(done(), stage_.steps);
    std::string text = in_stage_ ? stage_.name : "between two stages";
    if (in_stage_ && stage_.steps > 0) text += fmt::format(", {} of {} {}", steps_done, stage_.steps, stage_.unit);
    sink_(status(text));
    const std::optional<double> left_s =
        in_stage_ ? outlook_.seconds_left(stage_.share(steps_done, part()), now_s, part() > 0 ? stage_.first_step() : 0)
                  : std::nullopt;
    if (!left_s) return;
    constexpr double most = 99.9;  // until the result is there
    const double gone_s = now_s - began_s_, percent = 100 * gone_s / std::max(gone_s + *left_s, 1e-3);
    written_percent_ = std::max(written_percent_, std::min(percent, most));
    sink_(fmt::format("openjd_progress: {:.1f}\n", written_percent_));
}

void OpenJobProgress::finish() {
    const std::lock_guard lock(mutex_);
    written_s_ = clock_();
    sink_("openjd_progress: 100\n");
}

void OpenJobProgress::expect(std::vector<ExpectedStage> stages) {
    const std::lock_guard lock(mutex_);
    outlook_.expect(std::move(stages));
}

void OpenJobProgress::expect_steps(std::uint64_t steps) {
    const std::lock_guard lock(mutex_);
    stage_.shorten(steps, done());
}

void OpenJobProgress::on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) {
    const std::lock_guard lock(mutex_);
    stage_ = {std::string(name), steps, std::string(unit), clock_()};
    outlook_.begin(name, stage_.began_s);
    begin_step();
    in_stage_ = has_begun_ = true;
    write_state(stage_.began_s);
}

void OpenJobProgress::on_advance(std::uint64_t /*done*/) { begin_step(); }

void OpenJobProgress::on_stage_end() {
    const std::lock_guard lock(mutex_);
    in_stage_ = false;
    outlook_.end(clock_());
}

void OpenJobProgress::on_warning(const std::string& message) {
    const std::lock_guard lock(mutex_);
    sink_(fmt::format("warning: {}\n", printable_line(with_part_name(message))));
}

void OpenJobProgress::on_note(const std::string& message) {
    const std::lock_guard lock(mutex_);
    sink_(fmt::format("note: {}\n", printable_line(message)));
}

std::string openjd_failure(std::string_view message) { return fmt::format("openjd_fail: {}", printable_line(message)); }

}  // namespace voxtone
