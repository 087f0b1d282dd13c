// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of a whole stack in the hands of what makes one: a body, a tray, shards that are laid together. What may
// refuse it is asked in one order: another's stack, shards of another job, a printer's folder that is in the way.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "io/layers/stack_folder.h"
#include "slicer/part/opened_job.h"

namespace voxtone::slicer {

/// Takes it, and says what is doubtful of its lock. `besides` the files of a report these names go with an old stack.
[[nodiscard]] io::StackFolder take_output(const std::filesystem::path& out, std::vector<std::string_view> besides,
                                          Progress& progress);

/// Whether it holds this very job's stack, whole, though perhaps without its report.
[[nodiscard]] bool holds_stack_of(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress);

/// What was said there of this very job, in the file of that name; nothing where it is not done.
[[nodiscard]] std::optional<std::string> said_before(const OpenedJob& job, const io::StackFolder& folder,
                                                     std::string_view name, const Progress& progress);

struct Replacing {
    bool overwrite = false;
    bool goes_on = false;                 ///< what lies there is what the job goes on from
    std::filesystem::path for_printer{};  ///< where OUT/printer goes besides; empty: nowhere
};
/// Throws InputError where the folder holds what the job may not replace.
void expect_replaceable(const OpenedJob& job, const io::StackFolder& folder, const Replacing& how, Progress& progress);

/// Which strange files among the old layers will be set aside.
void say_strangers(const io::StackFolder& folder, Progress& progress);

/// OUT/shards holds shards of another job. Throws InputError.
void expect_no_other_shards(const std::filesystem::path& out, const OpenedJob& job, const Progress* progress);

}  // namespace voxtone::slicer
