// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/job_outlook.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include <fmt/core.h>

namespace voxtone {

namespace {

constexpr double least_share = 0.02;  // from which on a stage is measured by its own steps

}  // namespace

void expect_stages(Progress& progress, std::vector<ExpectedStage> stages) {
    if (auto* const shows = dynamic_cast<ShowsOutlook*>(&progress)) shows->expect(std::move(stages));
}

void expect_steps(Progress& progress, std::uint64_t steps) {
    if (auto* const shows = dynamic_cast<ShowsOutlook*>(&progress)) shows->expect_steps(steps);
}

void JobOutlook::expect(std::vector<ExpectedStage> stages) { to_come_ = std::move(stages); }

/// Stages that were expected before this one are over or were left out.
void JobOutlook::begin(std::string_view stage, double now_s) {
    began_s_ = reached_s_ = now_s;
    share_ = first_step_ = 0;
    marks_.assign(1, {0, now_s});
    running_ = true;
    expected_s_ = 0;
    const auto found =
        std::find_if(to_come_.begin(), to_come_.end(), [&](const ExpectedStage& one) { return one.name == stage; });
    if (found == to_come_.end()) return;
    expected_s_ = found->seconds;
    to_come_.erase(to_come_.begin(), found + 1);
}

void JobOutlook::end(double now_s) {
    if (running_ && expected_s_ > 0) {
        over_expected_s_ += expected_s_;
        over_taken_s_ += now_s - began_s_;
    }
    running_ = false;
    expected_s_ = 0;
}

double JobOutlook::pace() const {
    constexpr double weight_of_one_s = 10;
    return (over_taken_s_ + weight_of_one_s) / (over_expected_s_ + weight_of_one_s);
}

/// When the last step was done.
double JobOutlook::left_by_steps() const {
    const double expected_share = first_step_ > 0 ? 0.25 : 0.5;
    constexpr std::size_t one_step = 2;  // the beginning and it
    const double taken_s = reached_s_ - began_s_;
    if ((marks_.size() <= one_step || share_ <= first_step_) && expected_s_ > 0)
        return (taken_s + expected_share * expected_s_ * pace()) / (share_ + expected_share) * (1 - share_);
    const auto later =
        std::find_if(marks_.begin(), marks_.end(), [&](const auto& mark) { return mark.first > share_ / 2; });
    const auto& [share, at_s] = *std::prev(later);
    return (reached_s_ - at_s) / (share_ - share) * (1 - share_);
}

double JobOutlook::left_of_stage(double now_s) const {
    constexpr double longer = 0.1;
    if (!running_) return 0;
    const double taken_s = now_s - began_s_;
    if (share_ >= least_share) {
        const double left_s = left_by_steps();
        return std::max(left_s - (now_s - reached_s_), longer * left_s);
    }
    // One that takes longer than expected is taken to be near its end, but never at it.
    return std::max(expected_s_ * pace() - taken_s, expected_s_ > 0 ? longer * taken_s : 0.0);
}

/// Without steps of its own, at twice the time that was expected of it, nobody knows.
bool JobOutlook::overdue(double now_s) const {
    constexpr double twice = 2, slack_s = 10;
    return running_ && share_ < least_share && expected_s_ > 0 &&
           now_s - began_s_ > twice * expected_s_ * pace() + slack_s;
}

std::optional<double> JobOutlook::seconds_left(double share, double now_s, double first_step) {
    first_step_ = std::max(first_step_, first_step);
    if (to_come_.empty() && expected_s_ == 0) return std::nullopt;
    if (running_ && share > share_) {
        share_ = share;
        reached_s_ = now_s;
        constexpr double apart = 0.01;
        if (share >= marks_.back().first + apart) marks_.emplace_back(share, now_s);
    }
    if (overdue(now_s)) {
        told_s_.reset();
        return std::nullopt;
    }
    double later_s = 0;
    for (const ExpectedStage& stage : to_come_) later_s += stage.seconds;
    return steadily(left_of_stage(now_s) + later_s * pace());
}

double JobOutlook::steadily(double left_s) {
    const bool tells_parts = first_step_ > 0;
    const double gross = tells_parts ? 1.1 : 2, slack_s = tells_parts ? 1 : 10;
    if (!told_s_ || left_s < *told_s_ || left_s > gross * *told_s_ + slack_s) told_s_ = left_s;
    return *told_s_;
}

std::string left_text(double seconds) {
    const auto rounded = [&](double unit) { return static_cast<std::uint64_t>(std::round(seconds / unit)); };
    if (!(seconds < 1e9)) return "long";
    if (seconds < 20) return fmt::format("about {} s left", std::max<std::uint64_t>(1, rounded(1)));
    if (seconds < 90) return fmt::format("about {} s left", rounded(5) * 5);
    if (seconds < 5400) return fmt::format("about {} min left", rounded(60));
    return fmt::format("about {:.1f} h left", std::round(seconds / 360) / 10);
}

}  // namespace voxtone
