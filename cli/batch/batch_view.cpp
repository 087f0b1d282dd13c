// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/batch_view.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/printable.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "cli/program/outcome.h"
#include "io/files/json_writer.h"

namespace voxtone::cli {

namespace {

using farm::BatchSnapshot;
using farm::JobEvent;
using Kind = JobEvent::Kind;

std::string_view word_of(Kind kind) {
    switch (kind) {
        case Kind::started:
            return "started";
        case Kind::done:
            return "done";
        case Kind::unchanged:
            return "unchanged";
        case Kind::failed:
            return "failed";
        case Kind::again:
            return "again";
        case Kind::stopped:
            return "stopped";
        case Kind::elsewhere:
            return "elsewhere";
        case Kind::warned:
            break;
    }
    return "warned";
}

std::string line_of(const JobEvent& event) {
    switch (event.kind) {
        case Kind::started:
            return fmt::format("{}: started on {}{}", event.name, counted(std::uint64_t(event.threads), "thread"),
                               event.attempt > 1 ? fmt::format(", attempt {}", event.attempt) : std::string());
        case Kind::done:
            return fmt::format("{}: done in {}", event.name, duration_text(event.seconds));
        case Kind::unchanged:
            return fmt::format("{}: done before, and unchanged", event.name);
        case Kind::failed:
            return fmt::format("{}: FAILED (exit code {}): {}", event.name, event.exit_code, event.message);
        case Kind::again:
            return fmt::format("{}: will be tried again: {}", event.name, event.message);
        case Kind::stopped:
            return fmt::format("{}: stopped: {}", event.name, event.message);
        case Kind::elsewhere:
            return fmt::format("{}: another batch works on it", event.name);
        case Kind::warned:
            break;
    }
    return fmt::format("{}: warning: {}", event.name, event.message);
}

class EventsView final : public farm::BatchView {
public:
    void notify(const JobEvent& event) override {
        io::JsonWriter json;
        json.begin_object().add("event", "job").add("job", event.name).add("state", word_of(event.kind));
        json.add("attempt", event.attempt);
        if (event.kind == Kind::started)
            json.add("threads", event.threads);
        else
            json.add("exit_code", event.exit_code).add("seconds", event.seconds);
        if (!event.message.empty()) json.add("message", event.message);
        print_out(json.end_object().text() + "\n");
        std::fflush(stdout);
    }
    void arrived(const farm::ArrivedModel& of) override {
        io::JsonWriter json;
        json.begin_object().add("event", "arrived").add("model", of.model).add("beside", of.beside);
        print_out(json.add("again", of.again).end_object().text() + "\n");
        std::fflush(stdout);
    }
};

class LinesView final : public farm::BatchView {
public:
    explicit LinesView(bool quiet) : quiet_(quiet) {}
    void notify(const JobEvent& event) override {
        const bool matters = event.kind == Kind::failed || event.kind == Kind::again || event.kind == Kind::warned;
        if (quiet_ && !matters) return;
        unchanged_ += event.kind == Kind::unchanged;
        if (event.kind == Kind::unchanged && unchanged_ > most_unchanged) return;  // the result counts them
        std::fputs(printable(line_of(event) + "\n").c_str(), stderr);
    }

    void arrived(const farm::ArrivedModel& of) override {
        std::fputs(printable(fmt::format("{}: has arrived\n", of.model)).c_str(), stderr);
    }

private:
    static constexpr int most_unchanged = 20;
    bool quiet_;
    int unchanged_ = 0;
};

/// Events that matter scroll by above a table of what runs.
class TableView final : public farm::BatchView {
public:
    ~TableView() override { wipe(); }
    void notify(const JobEvent& event) override {
        if (event.kind == Kind::started || event.kind == Kind::unchanged) return;
        wipe();
        std::fputs(printable(line_of(event) + "\n").c_str(), stderr);
    }
    void arrived(const farm::ArrivedModel& of) override {
        wipe();
        std::fputs(printable(fmt::format("{}: has arrived\n", of.model)).c_str(), stderr);
    }
    bool wants_snapshot() override { return since_drawn_.total() > 0.25; }
    void show(const BatchSnapshot& all) override {
        since_drawn_ = Stopwatch();
        std::string text = fmt::format("{} of {} done", all.done, counted(all.jobs, "job"));
        if (all.failed > 0) text += fmt::format(", {} failed", all.failed);
        text += fmt::format(", {} running, {} to come, {}\n", all.running.size(), all.left(),
                            duration_text(since_begin_.total()));
        std::size_t widest = 0;
        for (const auto& job : all.running) widest = std::max(widest, std::min<std::size_t>(job.name.size(), 30));
        for (const auto& job : all.running)
            text += fmt::format("  {:<{}}  {:>8}  {}\n", job.name, widest, duration_text(job.seconds), job.says);
        draw(text);
    }

private:
    static std::size_t columns() {
        winsize size{};
        return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
    }
    void wipe() {
        if (lines_ > 0) std::fputs(fmt::format("\x1b[{}A\x1b[J", lines_).c_str(), stderr);
        lines_ = 0;
    }
    void draw(const std::string& text) {
        wipe();
        const std::size_t most = columns() - 1;
        std::string shown;
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t end = text.find('\n', at);
            std::string line = printable(text.substr(at, end - at));
            if (line.size() > most) line = valid_utf8(line.substr(0, most));
            shown += line + "\n";
            ++lines_;
            at = end + 1;
        }
        std::fputs(shown.c_str(), stderr);
        std::fflush(stderr);
    }

    Stopwatch since_begin_, since_drawn_;
    int lines_ = 0;
};

bool can_move_cursor() {
    const char* const terminal = std::getenv("TERM");
    return isatty(STDERR_FILENO) && terminal && std::string_view(terminal) != "dumb";
}

}  // namespace

std::unique_ptr<farm::BatchView> make_batch_view(const ConsoleOptions& options) {
    if (options.json) return std::make_unique<EventsView>();
    if (!options.quiet && can_move_cursor()) return std::make_unique<TableView>();
    return std::make_unique<LinesView>(options.quiet);
}

}  // namespace voxtone::cli
