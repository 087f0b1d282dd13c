// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which job a job is: the options that decide what it makes, and what its inputs hold. Two jobs of one identity make
// the same layers, wherever their files lie and however these are called, on any number of threads.
//
// Inputs are the model (or picture), the files beside it that it names, the printer's profile, the resins, and what a
// print without colours reads (part/other_print.h); those that come with the program count like files. Left out are
// the names of files, the output folder, options at their defaults (so that a new option makes no job of old a
// stranger), and what only says how the work is done (Decides::work in slicer/options/option_table.h). --memory is one
// of these: where it is too little for a loop, the job says so and stops.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/models/side_file.h"
#include "slicer/options/job_input.h"
#include "slicer/part/opened_job.h"

namespace voxtone::slicer {

struct JobIdentity {
    std::vector<JobInput> inputs;  ///< by key
    std::string job;               ///< SHA-256 of all that decides what the output folder holds in the end
    std::string loop;              ///< the same without what does not matter to the appearance loop's state
    std::string opened_loop;       ///< as `loop`, without the files beside the model
};

/// `beside_model`: what reading the model found. Reads the inputs. Throws FileError, Cancelled.
[[nodiscard]] JobIdentity identify(const OpenedJob& job, std::span<const io::SideFile> beside_model,
                                   const Progress* progress = nullptr);

/// As JobIdentity::loop, without the files beside the model: needs no model read. Reads the other inputs. Throws
/// FileError, Cancelled.
[[nodiscard]] std::string opened_loop_identity(const OpenedJob& job, const Progress* progress = nullptr);

/// Whether the job.json in `folder` is of this very job, with inputs that hold now what they held then. Needs no model
/// read. False in doubt: for another version's job.json, and where a file beside the model was missing then.
[[nodiscard]] bool is_same_job(const std::filesystem::path& folder, const OpenedJob& job,
                               const Progress* progress = nullptr);

/// JobIdentity::job of the job.json in `folder`, whatever its inputs hold now. Nothing where there is none.
[[nodiscard]] std::optional<std::string> recorded_identity(const std::filesystem::path& folder);

/// One sentence for each input that holds something else than the job file says which the options came from; inputs
/// that were given otherwise since, by another name, are left out.
[[nodiscard]] std::vector<std::string> changed_inputs(std::span<const JobInput> recorded,
                                                      std::span<const JobInput> now);

}  // namespace voxtone::slicer
