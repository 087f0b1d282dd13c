// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far the running step of a stage is, for steps that take minutes: a prediction of a print tells its sweeps, or its
// light paths. Who works inside a step holds its progress const, to be asked whether to stop; what that shows of parts
// is found here, as ShowsOutlook is (base/job_outlook.h).
#pragma once

#include <atomic>
#include <mutex>

#include "base/progress.h"

namespace voxtone {

/// Progress that shows parts of steps.
class ShowsParts {
public:
    /// Where in the step the work lies that tells its own share.
    struct Range {
        double low = 0, high = 1;
    };
    virtual ~ShowsParts() = default;
    /// In [0, 1], of the range; less than was told within this step is passed over. From any thread.
    void tell(double share) const;
    [[nodiscard]] Range range() const noexcept { return {low_, high_}; }
    void set_range(Range range) const noexcept { low_ = range.low, high_ = range.high; }
    /// Of the running step, in [0, 1].
    [[nodiscard]] double part() const noexcept { return part_; }

protected:
    /// Another step begins.
    void begin_step() const noexcept {
        if (part_ > 0) part_ = 0;
    }
    virtual void on_part(double /*part*/) const {}

private:
    mutable std::mutex telling_;
    mutable std::atomic<double> part_{0}, low_{0}, high_{1};
};

/// Tells it to progress that shows it; other progress, and none, does without.
void tell_part(const Progress* progress, double share);

/// What is told while this lives is of this range of what was told before: nested work tells all of its own.
class PartRange {
public:
    PartRange(const Progress* progress, double low, double high);
    PartRange(const PartRange&) = delete;
    PartRange& operator=(const PartRange&) = delete;
    /// It is told to be over.
    ~PartRange();

private:
    const ShowsParts* shows_;
    ShowsParts::Range before_;
};

}  // namespace voxtone
