// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress and cancellation. Long work takes a `Progress&`, reports stages and steps to it and asks `check_cancelled()`
// at least every few hundred milliseconds; a request to stop surfaces there as the exception `Cancelled`.
// All members may be called from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/error.h"

namespace voxtone {

class Progress {
public:
    Progress() = default;
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    virtual ~Progress() = default;

    /// Starts a stage of `steps` steps; `unit` names a step ("layers"). steps == 0: of unknown length.
    void begin_stage(std::string_view name, std::uint64_t steps, std::string_view unit = "steps") {
        done_ = 0;
        on_stage(name, steps, unit);
    }
    void advance(std::uint64_t steps = 1) { on_advance(done_.fetch_add(steps) + steps); }
    void end_stage() { on_stage_end(); }
    /// A message for the user that does not stop the work.
    void warn(const std::string& message) { on_warning(message); }
    void note(const std::string& message) { on_note(message); }

    /// Safe to call from a signal handler.
    void cancel() noexcept { cancelled_ = true; }
    /// After a request to stop was met with a result: the work goes on to bring it home.
    void forgive() noexcept { cancelled_ = false; }
    [[nodiscard]] bool cancelled() const noexcept { return cancelled_; }
    void check_cancelled() const {
        if (cancelled_) throw Cancelled();
    }

protected:
    /// Steps of this stage so far.
    [[nodiscard]] std::uint64_t done() const noexcept { return done_; }

    virtual void on_stage(std::string_view, std::uint64_t, std::string_view) {}
    virtual void on_advance(std::uint64_t) {}
    virtual void on_stage_end() {}
    virtual void on_warning(const std::string&) {}
    virtual void on_note(const std::string&) {}

private:
    std::atomic<std::uint64_t> done_{0};
    std::atomic<bool> cancelled_{false};
};

}  // namespace voxtone
