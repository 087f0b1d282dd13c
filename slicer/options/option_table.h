// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every option of a slice job, declared in one place: how it is called, what it says, which values it takes, what it
// decides, beside what it would do nothing, and what becomes of it in the resolved job. The command line, the job file,
// `--dump-default`, `--help`, the manual, the shells' completion, job.json and the job's identity follow from the
// table. Its parts are table_of_body (what is printed, where), table_of_marks (labels, decals), table_of_colour,
// table_of_shows (other kinds of print, which floors above declare) and table_of_run.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slicer/options/option_spec.h"
#include "slicer/options/table_of_shows.h"

namespace voxtone::slicer {

[[nodiscard]] std::span<const OptionSpec> slice_option_table();
/// Another kind of print and its options. Before anybody looks at the table, by one thread.
void declare_show(OtherShow show);
/// The entry of this key; nullptr: there is none.
[[nodiscard]] const OptionSpec* find_option(std::string_view key);
/// All keys that a job file may have.
[[nodiscard]] std::vector<std::string> option_keys();

/// "key=value" lines of the options that are not at their defaults and decide as much as `least` says or more: what of
/// options goes into a job's identity. Names of files are left out, as their contents count. An option that is new in
/// the table and at its default changes nothing.
[[nodiscard]] std::string deciding_lines(const SliceOptions& options, Decides least,
                                         std::span<const OptionSpec> table = slice_option_table());

}  // namespace voxtone::slicer
