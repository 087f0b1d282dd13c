// SPDX-License-Identifier: GPL-3.0-or-later
//
// A batch as a job template of Open Job Description, version 2023-09
// (github.com/OpenJobDescription/openjd-specifications, "Template Schemas"), in JSON: for any render manager that
// speaks it. Each job of the batch is a chain of steps (task_chain.h); layers are one step with a task for each shard,
// whose layers are its chunk. One step more depends on the ends of all chains. Every action is `voxtone task`
// (cluster_task.h), told to speak Open Job Description.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

struct OpenJobFrame {
    std::filesystem::path program;  ///< `voxtone`, as every worker finds it; absolute
    std::filesystem::path out;      ///< of the batch, as every worker finds it; absolute
};

/// A job that is to be done.
struct OpenJobChain {
    std::string job;  ///< its name in the batch
    TaskChain chain;
};

/// The template, with a line break at its end. Throws InputError where a name cannot stand in a template: one with
/// "{{", which begins a reference there and cannot be quoted, or with a control character.
[[nodiscard]] std::string openjd_template(std::span<const OpenJobChain> jobs, const OpenJobFrame& frame);

}  // namespace voxtone::farm
