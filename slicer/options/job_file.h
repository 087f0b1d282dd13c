// SPDX-License-Identifier: GPL-3.0-or-later
//
// The job file: {"format": "voxtone-job", "version": 1, <key>: <value>, ...} with the keys of the option table. One
// that a job left has also "inputs": [{"input": "model", "file": "../spot.obj", "sha256": "..."}, ...]; without "file"
// it came with the program, without "sha256" it was not there.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "io/files/json_object.h"
#include "io/layers/stack_folder.h"
#include "slicer/options/option_spec.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// What `slice` calls the one that it leaves beside its layers.
using io::job_file_name;

/// What JSON has for the option: truth for flags, numbers, lists, else text.
using OptionValue = std::variant<std::string, bool, std::uint64_t, double, std::vector<std::string>>;
[[nodiscard]] OptionValue option_value(const OptionSpec& spec, const SliceOptions& options);

/// A job file as text, complete: every key with its value, and for presets what they stand for. Paths are made
/// absolute, so that it may lie anywhere.
[[nodiscard]] std::string job_json(const SliceOptions& options);
/// The job file that a job leaves in `folder`, beside what it made: paths relative to that folder, the SHA-256 of every
/// input, and no option that was said to that run alone (Decides::this_run).
[[nodiscard]] std::string job_record(const SliceOptions& options, std::span<const JobInput> inputs,
                                     const std::filesystem::path& folder);

/// What a job file in `folder` means by this name of an input, seen from here: a file's path, or a word of the
/// program's own as it is.
[[nodiscard]] std::string input_named_in(const std::filesystem::path& folder, const std::string& name);

/// What users call copies, which no job makes: they are a tray's.
[[nodiscard]] bool is_word_for_copies(std::string_view key);
/// Throws InputError, with what to do, where the object asks for copies.
void refuse_copies(const io::JsonObject& of_job);

/// Reads a job file into `options`: only the keys that it has. Unknown keys are errors that name the nearest known key.
/// All relative paths in it are relative to the job file. Throws FileError, InputError.
void read_job(const std::string& path, SliceOptions& options);

/// The options among this object's keys, all others being somebody else's: sets those that it has, and gives back their
/// keys. Relative paths in it are relative to `folder`. A preset such as
/// `quality` comes first: what it sets is set otherwise by a value that is not the default, as complete job files name
/// all defaults. Throws InputError.
std::vector<std::string> take_options(const io::JsonObject& from, const std::filesystem::path& folder,
                                      SliceOptions& options);

/// The same options with every path absolute, as seen from the current folder.
[[nodiscard]] SliceOptions with_absolute_paths(SliceOptions options);

}  // namespace voxtone::slicer
