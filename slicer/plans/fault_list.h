// SPDX-License-Identifier: GPL-3.0-or-later
//
// All that is wrong with a plan at once: who has twelve parts reads twelve faults, not one twelve times.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"

namespace voxtone::slicer {

class FaultList {
public:
    /// Keeps what `work` throws for a part's own fault. What is none (the disk, a request to stop) is thrown on.
    void look(const std::function<void()>& work);
    [[nodiscard]] std::size_t size() const { return faults_.size(); }
    /// Throws where there are some, with the exit code of the first: that fault alone, or a line for each below `head`.
    void expect_none(const std::string& head) const;

private:
    std::vector<std::string> faults_;
    ExitCode exit_code_ = ExitCode::done;
};

}  // namespace voxtone::slicer
