// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes its JSON by hand: the floor has no JSON library, io/files/json_writer.h lies above it, and an event is one
// flat object of numbers and of strings that `json_quoted` has made safe.
#include "base/progress_events.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/core.h>

#include "base/printable.h"
#include "base/warning.h"

namespace voxtone {

namespace {

constexpr double seconds_between_events = 0.1;

/// JSON strings hold no raw line breaks, so every one of them is layout, as is the indentation behind it.
std::string on_one_line(std::string_view json) {
    std::string line;
    bool at_line_start = false;
    for (const char c : json) {
        if (c == '\n' || c == '\r')
            at_line_start = true;
        else if (!(at_line_start && (c == ' ' || c == '\t'))) {
            at_line_start = false;
            line += c;
        }
    }
    return line;
}

}  // namespace

ProgressEvents::ProgressEvents(TextSink sink, SecondsClock clock, bool ticks)
    : sink_(std::move(sink)), clock_(std::move(clock)) {
    constexpr double period_s = 0.5;
    if (ticks) ticker_.emplace(period_s, [this] { tick(); });
}

void ProgressEvents::tick() {
    constexpr double silence_s = 0.9;  // so that ticks of half a second tell every second
    const std::lock_guard lock(mutex_);
    const double now_s = clock_();
    if (in_stage_ && now_s >= next_event_s_ + silence_s - seconds_between_events) tell_progress(done(), now_s);
}

void ProgressEvents::expect(std::vector<ExpectedStage> stages) {
    const std::lock_guard lock(mutex_);
    outlook_.expect(std::move(stages));
}

void ProgressEvents::expect_steps(std::uint64_t steps) {
    const std::lock_guard lock(mutex_);
    stage_.shorten(steps, done());
}

void ProgressEvents::result(std::string_view json) {
    write_line(fmt::format(R"({{"event":"result","result":{}}})", on_one_line(json)));
}

void ProgressEvents::on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) {
    {
        const std::lock_guard lock(mutex_);
        stage_ = {json_quoted(name), steps, json_quoted(unit), clock_()};
        outlook_.begin(name, stage_.began_s);
        begin_step();
        in_stage_ = true;
        next_event_s_ = stage_.began_s + seconds_between_events;
    }
    write_line(fmt::format(R"({{"event":"stage","stage":{},"state":"begin","steps":{},"unit":{}}})", stage_.name, steps,
                           stage_.unit));
}

void ProgressEvents::on_advance(std::uint64_t done) {
    begin_step();
    const double now_s = clock_();
    if (now_s < next_event_s_.load(std::memory_order_relaxed)) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || now_s < next_event_s_) return;
    tell_progress(done, now_s);
}

void ProgressEvents::tell_progress(std::uint64_t done, double now_s) {
    next_event_s_ = now_s + seconds_between_events;
    const std::optional<double> left_s =
        outlook_.seconds_left(stage_.share(done, part()), now_s, part() > 0 ? stage_.first_step() : 0);
    sink_(fmt::format("{{\"event\":\"progress\",\"stage\":{},\"done\":{},\"steps\":{}{},\"seconds\":{:.2f}{}}}\n",
                      stage_.name, done, stage_.steps, part() > 0 ? fmt::format(",\"part\":{:.3f}", part()) : "",
                      now_s - stage_.began_s, left_s ? fmt::format(",\"job_seconds_left\":{:.0f}", *left_s) : ""));
}

void ProgressEvents::on_stage_end() {
    {
        const std::lock_guard lock(mutex_);
        in_stage_ = false;
        outlook_.end(clock_());
    }
    write_line(fmt::format(R"({{"event":"stage","stage":{},"state":"end","done":{},"seconds":{:.2f}}})", stage_.name,
                           done(), clock_() - stage_.began_s));
}

void ProgressEvents::on_warning(const std::string& message) {
    write_line(fmt::format(R"({{"event":"warning","name":{},"message":{}}})", json_quoted(message_name(message)),
                           json_quoted(with_part_name(message))));
}

void ProgressEvents::on_note(const std::string& message) {
    write_line(fmt::format(R"({{"event":"note","message":{}}})", json_quoted(message)));
}

void ProgressEvents::write_line(const std::string& line) {
    const std::lock_guard lock(mutex_);
    sink_(line + "\n");
}

std::string error_event(ExitCode code, std::string_view message) {
    return fmt::format(R"({{"event":"error","exit_code":{},"name":{},"message":{}}})", static_cast<int>(code),
                       json_quoted(message_name(message)), json_quoted(message));
}

TextSink stdout_sink() {
    return [](std::string_view text) {
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
    };
}

}  // namespace voxtone
