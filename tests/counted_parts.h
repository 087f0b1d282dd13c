// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress that counts what it is told of parts of its steps.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "base/progress.h"
#include "base/step_part.h"

namespace voxtone::test {

class CountedParts final : public Progress, public ShowsParts {
public:
    /// Of each step that was told of and is over, and of the one that runs: all shares that were told, in their order.
    std::vector<std::vector<double>> told{{}};

private:
    void on_part(double part) const override {
        const std::lock_guard lock(mutex_);
        const_cast<CountedParts*>(this)->told.back().push_back(part);
    }
    void on_advance(std::uint64_t) override { next(); }
    void on_stage(std::string_view, std::uint64_t, std::string_view) override { next(); }
    void next() {
        begin_step();
        const std::lock_guard lock(mutex_);
        if (!told.back().empty()) told.emplace_back();
    }
    mutable std::mutex mutex_;
};

}  // namespace voxtone::test
