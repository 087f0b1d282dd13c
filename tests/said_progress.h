// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>
#include <string>

#include "base/progress.h"
#include "base/progress_bar.h"

namespace voxtone::test {

/// Keeps what the user would read.
class SaidProgress final : public Progress, public ShowsPartNames {
public:
    /// A line each.
    [[nodiscard]] std::string warnings() const { return warnings_; }
    [[nodiscard]] std::string notes() const { return notes_; }
    /// As stderr has it.
    [[nodiscard]] std::string said() const { return said_; }

private:
    void on_warning(const std::string& message) override {
        const std::scoped_lock lock(mutex_);
        warnings_ += with_part_name(message) + "\n";
        said_ += "warning: " + with_part_name(message) + "\n";
    }
    void on_note(const std::string& message) override {
        const std::scoped_lock lock(mutex_);
        notes_ += message + "\n";
        said_ += message + "\n";
    }
    std::mutex mutex_;
    std::string warnings_, notes_, said_;
};

}  // namespace voxtone::test
