// SPDX-License-Identifier: GPL-3.0-or-later
//
// How long a whole job will still take, from the stages that are expected and those that are over:
//
//   left = left of this stage + pace sum(expected seconds of later stages)
//
// pace: how much longer than expected the stages took that are over, weighted by their expected seconds (with ten
// seconds of weight for 1, so that a short first stage says little). The running stage is measured by its own steps
// where it has some (between two of them the clock counts down); else by what was expected of it. The first step of a
// stage is often unlike the others (it sets things up), so it alone counts with what was expected, as if half the stage
// had gone that way; later ones are measured since the stage was half as far. A time that was told is not taken back
// for a little more: it stands still until it is true, unless the work will take twice as long. A stage that tells of
// parts of its steps (base/step_part.h) is measured more often: what was expected counts half as much beside its first
// one, and a tenth more is enough.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/progress.h"

namespace voxtone {

/// A stage of a job that is known beforehand, and a guess of how long it takes.
struct ExpectedStage {
    std::string name;  ///< as Progress::begin_stage will have it
    double seconds = 0;
};

/// Progress that shows what is left of a whole job.
class ShowsOutlook {
public:
    virtual ~ShowsOutlook() = default;
    /// What is still to come, in this order; replaces what was expected before. Stages may be left out.
    virtual void expect(std::vector<ExpectedStage> stages) = 0;
    /// The running stage will be over after so many steps in all, fewer than it was begun with.
    virtual void expect_steps(std::uint64_t steps) = 0;
};

/// Tells it to progress that shows it; other progress does without.
void expect_stages(Progress& progress, std::vector<ExpectedStage> stages);
void expect_steps(Progress& progress, std::uint64_t steps);

class JobOutlook {
public:
    void expect(std::vector<ExpectedStage> stages);
    void begin(std::string_view stage, double now_s);
    void end(double now_s);

    /// Seconds; `share`: of the running stage's steps that are done, 0 where it has none. Nothing where no stage is
    /// expected, or one without steps takes twice as long as was expected. `first_step`: of the stage, where parts of
    /// steps are counted in `share`.
    [[nodiscard]] std::optional<double> seconds_left(double share, double now_s, double first_step = 0);

private:
    [[nodiscard]] double pace() const;
    [[nodiscard]] bool overdue(double now_s) const;
    [[nodiscard]] double steadily(double left_s);
    [[nodiscard]] double left_of_stage(double now_s) const;
    [[nodiscard]] double left_by_steps() const;

    std::vector<ExpectedStage> to_come_;
    double expected_s_ = 0;  ///< of the running stage; 0: it was not expected
    double began_s_ = 0;
    double share_ = 0, reached_s_ = 0, first_step_ = 0;  ///< the last share that was seen to be reached, and when
    std::vector<std::pair<double, double>> marks_;  ///< shares that were reached, in steps of a hundredth, and when
    bool running_ = false;
    double over_expected_s_ = 0, over_taken_s_ = 0;  ///< of expected stages that are over
    std::optional<double> told_s_;                   ///< what was said to be left
};

/// "about 3 min left", coarser the longer it is, so that it does not flicker.
[[nodiscard]] std::string left_text(double seconds);

}  // namespace voxtone
