// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress_bar.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/printable.h"

namespace voxtone {

namespace {

constexpr double seconds_between_drawings = 0.1;
constexpr int widest_bar = 30, narrowest_bar = 8;
constexpr double seconds_before_estimate = 1;  // an estimate from less jumps about
constexpr std::string_view erase_line = "\r\x1b[K";

/// "1842/3920 layers", "1842 layers" where the length is unknown.
std::string count_text(const Stage& stage, std::uint64_t done) {
    return stage.steps == 0 ? fmt::format("{} {}", done, stage.unit)
                            : fmt::format("{}/{} {}", done, stage.steps, stage.unit);
}

/// Three significant digits, without an exponent.
std::string rate_text(double per_second) {
    if (per_second >= 1e6) return fmt::format("{:.3g}M/s", per_second * 1e-6);
    if (per_second >= 1e3) return fmt::format("{:.3g}k/s", per_second * 1e-3);
    return fmt::format("{:.3g}/s", per_second);
}

std::string time_left_text(const Stage& stage, std::uint64_t done, double elapsed_s) {
    if (stage.steps == 0 || done == 0 || elapsed_s < seconds_before_estimate) return "";
    const double left = static_cast<double>(stage.steps > done ? stage.steps - done : 0);
    return duration_text(left * elapsed_s / static_cast<double>(done)) + " left";
}

/// "layers: 3920 layers in 65 s (60.3/s)"; a stage without steps has only its time.
std::string ending(const Stage& stage, std::uint64_t done, double elapsed_s) {
    if (done == 0) return fmt::format("{}: {}\n", stage.name, duration_text(elapsed_s));
    const std::string rate =
        elapsed_s > 0 ? fmt::format(" ({})", rate_text(static_cast<double>(done) / elapsed_s)) : std::string();
    return fmt::format("{}: {} {} in {}{}\n", stage.name, done, stage.unit, duration_text(elapsed_s), rate);
}

std::string bar_text(double share, int width, bool unicode) {
    const double filled = share * width;
    const int whole = static_cast<int>(filled);
    std::string bar;
    if (unicode) {
        static constexpr std::string_view eighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
        for (int i = 0; i < whole; ++i) bar += "█";
        const std::string_view part = whole < width ? eighths[static_cast<int>((filled - whole) * 8)] : "";
        bar += part;
        bar.append(static_cast<std::size_t>(width - whole - (part.empty() ? 0 : 1)), ' ');
        return "▕" + bar + "▏";
    }
    bar.assign(static_cast<std::size_t>(whole), '=');
    if (whole < width) bar += '>';
    bar.resize(static_cast<std::size_t>(width), ' ');
    return "[" + bar + "]";
}

/// Columns that a text takes, counting one per code point.
int columns_of(std::string_view text) {
    return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & '\xC0') != '\x80'; }));
}

int terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool locale_is_utf8() {
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"})
        if (const char* value = std::getenv(name); value && *value) {
            const std::string_view locale(value);
            return locale.find("UTF-8") != locale.npos || locale.find("utf8") != locale.npos;
        }
    return false;
}

}  // namespace

std::string ShowsPartNames::set_part_name(std::string name) {
    const std::scoped_lock lock(naming_);
    return std::exchange(part_name_, std::move(name));
}

std::string ShowsPartNames::with_part_name(const std::string& warning) const {
    const std::scoped_lock lock(naming_);
    return warning_of_part(part_name_, warning);
}

WarningsOfPart::WarningsOfPart(Progress& progress, std::string name)
    : shows_(dynamic_cast<ShowsPartNames*>(&progress)) {
    if (shows_) before_ = shows_->set_part_name(std::move(name));
}

WarningsOfPart::~WarningsOfPart() {
    if (shows_) shows_->set_part_name(std::move(before_));
}

std::string warning_of_part(const std::string& name, const std::string& warning) {
    const std::string lead = name + ": ";
    return name.empty() || warning.starts_with(lead) ? warning : lead + warning;
}

TextSink stderr_sink() {
    return [](std::string_view text) {
        std::fwrite(text.data(), 1, text.size(), stderr);
        std::fflush(stderr);
    };
}

SecondsClock steady_seconds() {
    return [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
}

std::string duration_text(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<std::uint64_t>(std::min(std::round(seconds), 1e15));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

ProgressBar::ProgressBar(TextSink sink, SecondsClock clock, Look look)
    : sink_(std::move(sink)), clock_(std::move(clock)), look_(std::move(look)) {
    constexpr double period_s = 0.5;
    if (look_.ticks) ticker_.emplace(period_s, [this] { tick(); });
}

ProgressBar::~ProgressBar() {
    ticker_.reset();
    if (on_screen_) sink_(erase_line);
}

void ProgressBar::tick() {
    const std::lock_guard lock(mutex_);
    if (!in_stage_) return;
    shown_ = std::max(shown_, done());
    write("");
}

void ProgressBar::expect(std::vector<ExpectedStage> stages) {
    const std::lock_guard lock(mutex_);
    outlook_.expect(std::move(stages));
}

void ProgressBar::expect_steps(std::uint64_t steps) {
    const std::lock_guard lock(mutex_);
    stage_.shorten(steps, done());
}

void ProgressBar::on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) {
    const std::lock_guard lock(mutex_);
    stage_ = {printable(name), steps, printable(unit), clock_()};
    outlook_.begin(name, stage_.began_s);
    shown_ = 0;
    begin_step();
    in_stage_ = true;
    next_draw_s_ = stage_.began_s + seconds_between_drawings;
    write("");
}

void ProgressBar::on_advance(std::uint64_t done) {
    begin_step();
    const double now_s = clock_();
    if (now_s < next_draw_s_.load(std::memory_order_relaxed)) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);  // another thread draws already: let it
    if (!lock || now_s < next_draw_s_) return;
    next_draw_s_ = now_s + seconds_between_drawings;
    shown_ = std::max(shown_, done);
    write("");
}

void ProgressBar::on_stage_end() {
    const std::lock_guard lock(mutex_);
    in_stage_ = false;
    outlook_.end(clock_());
    write(ending(stage_, done(), clock_() - stage_.began_s));
}

void ProgressBar::on_warning(const std::string& message) {
    const std::lock_guard lock(mutex_);
    write("warning: " + printable(with_part_name(message)) + "\n");
}

void ProgressBar::on_note(const std::string& message) {
    const std::lock_guard lock(mutex_);
    write(printable(message) + "\n");
}

/// Replaces the bar by `text` and draws it anew below, in one write, so that nothing flickers.
void ProgressBar::write(std::string_view text) {
    std::string piece(on_screen_ ? erase_line : std::string_view());
    piece += text;
    if (in_stage_) piece += drawing();
    on_screen_ = in_stage_;
    sink_(piece);
}

/// What is left of the job, else of the stage, else how long the stage has taken.
std::string ProgressBar::time_text() {
    const double now_s = clock_(), elapsed_s = now_s - stage_.began_s;
    std::string left = time_left_text(stage_, shown_, elapsed_s);
    if (const auto job =
            outlook_.seconds_left(stage_.share(shown_, part()), now_s, part() > 0 ? stage_.first_step() : 0))
        left = left_text(*job);
    const bool counts = stage_.steps > 0 && shown_ > 0;
    if (left.empty()) return duration_text(elapsed_s);
    return counts ? left : duration_text(elapsed_s) + "  " + left;
}

/// As much of name, bar, count, rate and time left as the terminal is wide for, in this order of importance:
/// name, percentage, time left, count, bar, rate.
std::string ProgressBar::drawing() {
    const int columns = look_.columns() - 1;  // the last column would wrap on some terminals
    const double elapsed_s = clock_() - stage_.began_s;
    const double share = stage_.share(shown_, part());
    const std::string percent = stage_.steps || share > 0 ? fmt::format("  {:3.0f} %", std::floor(share * 100)) : "";
    const std::string time = "  " + time_text();
    const std::string count = shown_ || stage_.steps ? "  " + count_text(stage_, shown_) : "";
    const std::string rate = shown_ && elapsed_s >= seconds_before_estimate
                                 ? "  " + rate_text(static_cast<double>(shown_) / elapsed_s)
                                 : std::string();
    int room = columns - columns_of(stage_.name);
    const auto fits = [&room](const std::string& part) {
        if (columns_of(part) > room) return false;
        room -= columns_of(part);
        return true;
    };
    if (room < 0) return "";
    const bool with_percent = fits(percent), with_time = fits(time), with_count = fits(count), with_rate = fits(rate);
    constexpr int frame = 4;  // two spaces and two brackets
    const int bar = stage_.steps || share > 0 ? std::min(widest_bar, room - frame) : 0;
    return stage_.name + (bar >= narrowest_bar ? "  " + bar_text(share, bar, look_.unicode) : "") +
           (with_percent ? percent : "") + (with_count ? count : "") + (with_rate ? rate : "") +
           (with_time ? time : "");
}

ProgressLines::ProgressLines(TextSink sink, SecondsClock clock, bool ticks)
    : sink_(std::move(sink)), clock_(std::move(clock)), said_s_(clock_()) {
    constexpr double period_s = 1;
    if (ticks) ticker_.emplace(period_s, [this] { tick(); });
}

void ProgressLines::tick() {
    constexpr double longest_silence_s = 19.5;
    const std::lock_guard lock(mutex_);
    const double now_s = clock_();
    if (!in_stage_ || now_s - said_s_ < longest_silence_s) return;
    const std::string count = stage_.steps ? count_text(stage_, done()) : "";
    const std::string percent =
        part() > 0 ? fmt::format("{:.0f} %", std::floor(100 * stage_.share(done(), part()))) : "";
    const std::string so_far = percent.empty() || count.empty() ? percent + count : percent + " (" + count + ")";
    write(fmt::format("{}{} after {}{}\n", stage_.name, so_far.empty() ? "" : ": " + so_far,
                      duration_text(now_s - stage_.began_s), time_text(now_s)));
}

void ProgressLines::expect(std::vector<ExpectedStage> stages) {
    const std::lock_guard lock(mutex_);
    outlook_.expect(std::move(stages));
}

void ProgressLines::expect_steps(std::uint64_t steps) {
    const std::lock_guard lock(mutex_);
    stage_.shorten(steps, done());
}

void ProgressLines::on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) {
    const std::lock_guard lock(mutex_);
    stage_ = {printable(name), steps, printable(unit), clock_()};
    outlook_.begin(name, stage_.began_s);
    begin_step();
    in_stage_ = true;
    next_line_ = std::max<std::uint64_t>(1, (steps + 9) / 10);
}

void ProgressLines::on_advance(std::uint64_t done) {
    constexpr double shortest_pause_s = 2;
    begin_step();
    if (done < next_line_.load(std::memory_order_relaxed)) return;
    const std::lock_guard lock(mutex_);
    if (stage_.steps == 0 || done < next_line_ || done >= stage_.steps) return;
    const std::uint64_t tenth = done * 10 / stage_.steps;
    next_line_ = ((tenth + 1) * stage_.steps + 9) / 10;
    const double now_s = clock_();
    if (now_s - std::max(said_s_, stage_.began_s) < shortest_pause_s) return;
    write(fmt::format("{}: {} % ({}) after {}{}\n", stage_.name, tenth * 10, count_text(stage_, done),
                      duration_text(now_s - stage_.began_s), time_text(now_s)));
}

void ProgressLines::on_stage_end() {
    constexpr double worth_a_line_s = 1;
    const std::lock_guard lock(mutex_);
    const double now_s = clock_(), elapsed_s = now_s - stage_.began_s;
    in_stage_ = false;
    outlook_.end(now_s);
    if (elapsed_s >= worth_a_line_s) write(ending(stage_, done(), elapsed_s));
}

void ProgressLines::on_warning(const std::string& message) {
    const std::lock_guard lock(mutex_);
    write("warning: " + printable(with_part_name(message)) + "\n");
}

void ProgressLines::on_note(const std::string& message) {
    const std::lock_guard lock(mutex_);
    write(printable(message) + "\n");
}

void ProgressLines::write(const std::string& text) {
    said_s_ = clock_();
    sink_(text);
}

/// ", about 2 min left", of the job, else of the stage.
std::string ProgressLines::time_text(double now_s) {
    std::string left = time_left_text(stage_, done(), now_s - stage_.began_s);
    if (const auto job =
            outlook_.seconds_left(stage_.share(done(), part()), now_s, part() > 0 ? stage_.first_step() : 0))
        left = left_text(*job);
    return left.empty() ? left : ", " + left;
}

ProgressQuiet::ProgressQuiet(TextSink sink) : sink_(std::move(sink)) {}

void ProgressQuiet::on_warning(const std::string& message) {
    const std::lock_guard lock(mutex_);
    sink_("warning: " + printable(with_part_name(message)) + "\n");
}

std::unique_ptr<Progress> make_console_progress(bool quiet) {
    if (quiet) return std::make_unique<ProgressQuiet>(stderr_sink());
    const char* terminal = std::getenv("TERM");
    const bool can_move_cursor = terminal && std::string_view(terminal) != "dumb";
    if (isatty(STDERR_FILENO) && can_move_cursor)
        return std::make_unique<ProgressBar>(stderr_sink(), steady_seconds(),
                                             ProgressBar::Look{terminal_columns, locale_is_utf8(), true});
    return std::make_unique<ProgressLines>(stderr_sink(), steady_seconds(), true);
}

}  // namespace voxtone
