// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/cluster_options.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "farm/cluster/openjd_job.h"
#include "farm/cluster/slurm_job.h"

namespace voxtone::cli {

namespace {

constexpr const char* group = "Cluster";

std::vector<std::string> with_dashes(const std::vector<std::string>& words) {
    std::vector<std::string> dashed;
    for (const std::string& word : words) dashed.push_back(word.starts_with('-') ? word : "--" + word);
    return dashed;
}

/// Options of sbatch that voxtone says itself: what a task waits for, which it is, where it works and writes. Who said
/// them again would win. Names may be cut short, as in sbatch.
void expect_sbatch_options(const std::vector<std::string>& words) {
    struct Taken {
        std::string_view name;
        char letter;
    };
    constexpr Taken clusters{"clusters", 'M'};
    constexpr std::array taken{Taken{"array", 'a'},  Taken{"chdir", 'D'},   Taken{"dependency", 'd'},
                               Taken{"output", 'o'}, Taken{"test-only", 0}, Taken{"wait", 'W'},
                               Taken{"wrap", 0}};
    for (const std::string& word : words) {
        const bool is_letter = word.size() > 1 && word[0] == '-' && word[1] != '-';
        const std::size_t begin = std::min(word.find_first_not_of('-'), word.size());
        const std::string_view name = std::string_view(word).substr(begin, word.find_first_of("= ", begin) - begin);
        const auto is = [&](const Taken& option) {
            constexpr std::size_t shortest = 3;  // letters that no other option begins with
            return is_letter ? word[1] == option.letter : name.size() >= shortest && option.name.starts_with(name);
        };
        if (is(clusters))
            throw UsageError(fmt::format(
                "--sbatch-option {}: jobs that go to another cluster are not seen in the queue of this one, and would "
                "be handed over again; call voxtone there",
                word));
        if (const auto* const own = std::ranges::find_if(taken, is); own != taken.end())
            throw UsageError(fmt::format(
                "--sbatch-option {}: --{} is said by voxtone itself, and tasks would run in another order or place; "
                "leave it out",
                word, own->name));
    }
}

}  // namespace

void add_cluster_options(Verb& command, ClusterOptions& options) {
    command.add("--slurm", options.slurm,
                "hand the jobs to Slurm and end: for each the appearance loop, its layers as an array of shards and "
                "their merge, or one task where its estimate asks for no more; --threads: most cores of a task, 0: "
                "8. The same command again submits what is left",
                {.group = group});
    command.add("--openjd", options.openjd,
                "write what is left of the plan as a job template of Open Job Description (2023-09, JSON) for any "
                "render manager that speaks it, and end; --threads: most cores of a task, 0: 8; empty: do not",
                {.unit = "FILE", .group = group});
    command.add("--dry-run", options.dry_run, "with --slurm: print the scripts; write and submit nothing",
                {.group = group});
    command.add(
        "--shards", options.shards,
        "with --slurm or --openjd: cut each job's layers into so many parts; 0: so that none takes more than ten "
        "minutes by "
        "its estimate",
        {.range = {0, 100000}, .group = group});
    command.add("--throttle", options.throttle,
                "with --slurm: most tasks at once, of those submitted by this call; 0: as many as the cluster gives",
                {.range = {0, 1000000}, .group = group});
    command.add("--sbatch-option", options.sbatch,
                "with --slurm: an option for sbatch, which goes before the estimate's, without its dashes: "
                "partition=long; may be given several times; default: none",
                {.unit = "WORD", .one_each = true, .group = group});
}

void expect_cluster_options(const Verb::Said& said, const ClusterOptions& options) {
    if (options.slurm && !options.openjd.empty())
        throw UsageError("--slurm and --openjd hand the jobs over twice; give one of them");
    if (!options.slurm) {
        for (const char* const name : {"dry-run", "throttle", "sbatch-option"})
            if (said.contains(name))
                throw UsageError(
                    fmt::format("--{} goes with --slurm; `--print-commands` shows what would be run here", name));
        if (said.contains("shards") && !options.any())
            throw UsageError("--shards goes with --slurm or --openjd; here a job is not cut");
    }
    if (!options.any()) return;
    expect_sbatch_options(options.sbatch);
    const char* const kind = options.slurm ? "--slurm" : "--openjd";
    for (const char* const name : {"jobs", "memory", "fail-fast", "after", "print-commands"})
        if (said.contains(name))
            throw UsageError(fmt::format(
                "--{} does not go with {}, which leaves to the cluster what runs where and when; leave it out{}", name,
                kind,
                options.slurm && std::string_view(name) == "jobs" ? ", or bound the tasks at once with --throttle"
                                                                  : ""));
}

namespace {

farm::ChainOptions chain_options(const ClusterOptions& options, const RunOptions& run) {
    farm::ChainOptions chain;
    chain.shards = options.shards;
    if (options.shards > 0) chain.most_shards = options.shards;
    if (run.threads > 0) chain.most_cores = run.threads;
    return chain;
}

}  // namespace

int run_on_cluster(const farm::PlanOptions& plan, const farm::BatchOptions& batch, const ClusterOptions& options,
                   const RunOptions& run) {
    if (!options.openjd.empty()) {
        const farm::OpenJobOptions openjd{batch.out, batch.program, options.openjd, chain_options(options, run)};
        return run_on_console(run.console,
                              [&](Progress& progress) { return farm::run_openjd_job(plan, openjd, progress); });
    }
    farm::SlurmOptions slurm;
    slurm.out = batch.out;
    slurm.program = batch.program;
    slurm.chain = chain_options(options, run);
    slurm.throttle = options.throttle;
    slurm.retries = batch.retries;
    slurm.sbatch_words = with_dashes(options.sbatch);
    slurm.dry_run = options.dry_run;
    return run_on_console(run.console, [&](Progress& progress) { return farm::run_slurm_job(plan, slurm, progress); });
}

std::filesystem::path this_program() {
    std::error_code error;
    std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? "voxtone" : program;
}

}  // namespace voxtone::cli
