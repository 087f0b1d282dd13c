// SPDX-License-Identifier: GPL-3.0-or-later
//
// Three ways to show progress to a person (programs: base/progress_events.h): a bar, lines in a log, warnings only. All
// write whole texts to a sink, one at a time, from whichever thread reports, made harmless first (base/printable.h).
// Why our own: `indicators`, the usual library, is no Debian package, and knows bars alone.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "base/job_outlook.h"
#include "base/progress.h"
#include "base/step_part.h"
#include "base/ticker.h"

namespace voxtone {

/// Takes one piece of text; never called by two threads at once.
using TextSink = std::function<void(std::string_view)>;
/// Seconds that have passed since some fixed moment; monotonic.
using SecondsClock = std::function<double()>;

[[nodiscard]] TextSink stderr_sink();
[[nodiscard]] SecondsClock steady_seconds();

/// The stage that runs: its name, its length and when it began.
struct Stage {
    std::string name;
    std::uint64_t steps = 0;  ///< 0: unknown
    std::string unit;
    double began_s = 0;
    /// To so many steps in all, but not to fewer than are done.
    /// `part`: of the step that runs. Of a stage of unknown length, that is taken for one step.
    [[nodiscard]] double share(std::uint64_t done, double part) const {
        return steps == 0 ? part : std::min(1.0, (static_cast<double>(done) + part) / static_cast<double>(steps));
    }
    [[nodiscard]] double first_step() const { return share(1, 0) > 0 ? share(1, 0) : 1; }
    void shorten(std::uint64_t to, std::uint64_t done) { steps = std::min(steps, std::max(to, done)); }
};

/// "4.2 s", "3 min 05 s", "2 h 07 min".
[[nodiscard]] std::string duration_text(double seconds);

/// Progress that shows whose a warning is. Of a job of many parts each is warned of while it is worked on, and its name
/// stands before that: "cow: the print is only 1 mm large ... [tiny]".
class ShowsPartNames {
public:
    virtual ~ShowsPartNames() = default;
    /// Of what is warned of from now on; empty: of no part. What it was before.
    std::string set_part_name(std::string name);

protected:
    /// The warning, with the name unless it begins with it.
    [[nodiscard]] std::string with_part_name(const std::string& warning) const;

private:
    mutable std::mutex naming_;
    std::string part_name_;
};

/// What is warned of while this lives is of this part; other progress does without.
class WarningsOfPart {
public:
    WarningsOfPart(Progress& progress, std::string name);
    WarningsOfPart(const WarningsOfPart&) = delete;
    WarningsOfPart& operator=(const WarningsOfPart&) = delete;
    ~WarningsOfPart();

private:
    ShowsPartNames* shows_;
    std::string before_;
};

/// "cow: ...", where the sentence does not begin so.
[[nodiscard]] std::string warning_of_part(const std::string& name, const std::string& warning);

/// A bar that is redrawn in place at most ten times a second, twice a second while nothing is reported, and one line
/// per stage when it is done:
///     layers  [=========>          ]  47 %  1842/3920 layers  61/s  34 s left
/// The time left is that of the whole job where its stages are expected (base/job_outlook.h): "about 2 min left".
class ProgressBar final : public Progress, public ShowsOutlook, public ShowsParts, public ShowsPartNames {
public:
    struct Look {
        std::function<int()> columns;  ///< width of the terminal now
        bool unicode = false;          ///< draw with block characters
        bool ticks = false;            ///< also while nothing is reported
    };
    ProgressBar(TextSink sink, SecondsClock clock, Look look);
    ~ProgressBar() override;

    /// Draws anew, as a clock's tick does.
    void tick();
    void expect(std::vector<ExpectedStage> stages) override;
    void expect_steps(std::uint64_t steps) override;

private:
    void on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) override;
    void on_advance(std::uint64_t done) override;
    void on_stage_end() override;
    void on_warning(const std::string& message) override;
    void on_note(const std::string& message) override;
    void write(std::string_view text);
    [[nodiscard]] std::string time_text();
    [[nodiscard]] std::string drawing();

    TextSink sink_;
    SecondsClock clock_;
    Look look_;
    std::mutex mutex_;
    Stage stage_;
    JobOutlook outlook_;
    std::uint64_t shown_ = 0;  ///< steps done as drawn
    bool in_stage_ = false, on_screen_ = false;
    std::atomic<double> next_draw_s_{0};
    std::optional<Ticker> ticker_;  ///< last: it uses the others
};

/// Lines for a log, as few as tell that the work goes on: tenths of a stage and its end, nothing of what takes less
/// than a second, no two tenths within two seconds, and a sign of life every 20 s (some schedulers end silent jobs).
class ProgressLines final : public Progress, public ShowsOutlook, public ShowsParts, public ShowsPartNames {
public:
    ProgressLines(TextSink sink, SecondsClock clock, bool ticks = false);

    /// Says something if nothing was said for 20 s.
    void tick();
    void expect(std::vector<ExpectedStage> stages) override;
    void expect_steps(std::uint64_t steps) override;

private:
    void on_stage(std::string_view name, std::uint64_t steps, std::string_view unit) override;
    void on_advance(std::uint64_t done) override;
    void on_stage_end() override;
    void on_warning(const std::string& message) override;
    void on_note(const std::string& message) override;

    TextSink sink_;
    SecondsClock clock_;
    std::mutex mutex_;
    void write(const std::string& text);
    [[nodiscard]] std::string time_text(double now_s);

    Stage stage_;
    JobOutlook outlook_;
    bool in_stage_ = false;
    double said_s_ = 0;
    std::atomic<std::uint64_t> next_line_{0};  ///< steps that make the next tenth
    std::optional<Ticker> ticker_;             ///< last: it uses the others
};

/// Warnings only.
class ProgressQuiet final : public Progress, public ShowsPartNames {
public:
    explicit ProgressQuiet(TextSink sink);

private:
    void on_warning(const std::string& message) override;
    TextSink sink_;
    std::mutex mutex_;
};

/// What suits stderr: warnings only when `quiet`, a bar on a terminal that can move its cursor, lines elsewhere.
[[nodiscard]] std::unique_ptr<Progress> make_console_progress(bool quiet);

}  // namespace voxtone
