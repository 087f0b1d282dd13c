// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

namespace voxtone::slicer {

/// Seconds since the last call, or since it was made.
class Lap {
public:
    double operator()() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return seconds;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace voxtone::slicer
