// SPDX-License-Identifier: GPL-3.0-or-later
//
// Seconds of wall clock, for reports. No result depends on them.
#pragma once

#include <chrono>
#include <utility>

namespace voxtone {

class Stopwatch {
public:
    /// Seconds since it was made.
    [[nodiscard]] double total() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    /// Seconds since the last lap, or since it was made.
    double lap() {
        const Clock::time_point now = Clock::now();
        return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace voxtone
