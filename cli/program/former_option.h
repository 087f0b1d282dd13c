// SPDX-License-Identifier: GPL-3.0-or-later
//
// An option that was called otherwise: its earlier name is taken with a note, and told of nowhere.
#pragma once

#include <string>

#include "base/progress.h"

namespace CLI {
class App;
}  // namespace CLI

namespace voxtone::cli {

class FormerOption {
public:
    /// `option`: its name now, `former`: as it was, both with their dashes. Both set `value`, which must outlive
    /// `command`.
    void add(CLI::App& command, const std::string& option, const std::string& former, std::string& value);
    /// Throws UsageError where both names were given.
    void warn(Progress& progress) const;

private:
    const CLI::App* command_ = nullptr;
    std::string option_, former_;
};

}  // namespace voxtone::cli
