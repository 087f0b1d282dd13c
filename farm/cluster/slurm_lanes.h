// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a batch keeps to a number of tasks at once without asking anything of the cluster: its jobs stand in lanes, one
// behind the other, and each array is throttled to what its lane has. Lanes times tasks of a lane are never more than
// what is allowed; a lane whose jobs are done early stays empty.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace voxtone::farm {

struct Lane {
    int throttle = 0;                 ///< most tasks of an array; 0: any number
    std::vector<std::string> before;  ///< the jobs that must have ended before the next of this lane begins
    double busy_s = 0;                ///< that it is expected to be

    /// The lane's next job, in so many of Slurm's.
    void take(std::vector<std::string> numbers, double seconds) {
        if (throttle > 0) before = std::move(numbers);
        busy_s += seconds;
    }
};

class Lanes {
public:
    /// `throttle`: most tasks at once, 0: any number; `widest`: most shards of a job.
    Lanes(int throttle, int widest) {
        const int width = std::min(std::max(throttle, 1), std::max(widest, 1));
        lanes_.resize(throttle > 0 ? std::size_t(std::max(1, throttle / width)) : 1);
        for (Lane& lane : lanes_) lane.throttle = throttle > 0 ? width : 0;
    }

    [[nodiscard]] std::size_t count() const { return lanes_.size(); }
    /// The one that is expected to be free first.
    [[nodiscard]] Lane& next() {
        return *std::min_element(lanes_.begin(), lanes_.end(),
                                 [](const Lane& a, const Lane& b) { return a.busy_s < b.busy_s; });
    }

private:
    std::vector<Lane> lanes_;
};

}  // namespace voxtone::farm
