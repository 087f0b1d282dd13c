// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options of `batch` for a cluster's machines.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/common_options.h"
#include "farm/batch/plan.h"
#include "farm/batch/queued_job.h"

namespace voxtone::cli {

struct ClusterOptions {
    bool slurm = false, dry_run = false;
    int shards = 0, throttle = 0;
    std::vector<std::string> sbatch;  ///< options of sbatch without their dashes
    std::string openjd;               ///< file of a template; empty: none
    [[nodiscard]] bool any() const { return slurm || !openjd.empty(); }
};

void add_cluster_options(Verb& command, ClusterOptions& options);

/// Throws UsageError for options that do not go together with others of the command.
void expect_cluster_options(const Verb::Said& said, const ClusterOptions& options);

/// Hands the plan over.
int run_on_cluster(const farm::PlanOptions& plan, const farm::BatchOptions& batch, const ClusterOptions& options,
                   const RunOptions& run);

/// `voxtone` as it was started, absolute.
[[nodiscard]] std::filesystem::path this_program();

}  // namespace voxtone::cli
