// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/task_chain.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include <fmt/core.h>

#include "base/counted.h"
#include "io/files/read_options.h"
#include "slicer/options/command_words.h"
#include "slicer/options/model_choice.h"
#include "slicer/options/resolve_job.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/phase_estimates.h"

namespace voxtone::farm {

namespace {

constexpr double time_factor = 3, time_added_s = 600;  // estimates are within 1.5 as a rule, and were off by 3.7 once
constexpr double least_s_per_core = 60;
constexpr std::uint64_t beside_bytes = 64'000'000;  // what watches over a task, and its shell

class StageSums {
public:
    explicit StageSums(const slicer::JobEstimate& estimate) : estimate_(estimate) {}

    /// `share` of these phases.
    void add(std::initializer_list<slicer::Phase> those, double share = 1) {
        for (const slicer::PhaseEstimate& phase : estimate_.phases)
            if (std::find(those.begin(), those.end(), phase.phase) != those.end()) add(phase, share);
    }
    void add_all() {
        for (const slicer::PhaseEstimate& phase : estimate_.phases) add(phase, 1);
    }

    [[nodiscard]] double cpu_s() const { return cpu_s_ + measured_cpu_s_; }
    [[nodiscard]] std::uint64_t memory_bytes() const { return memory_bytes_; }
    [[nodiscard]] double seconds_on(int cores) const {
        return slicer::seconds_on_threads(cpu_s_, std::size_t(cores)) +
               std::max(measured_s_, slicer::seconds_on_threads(measured_cpu_s_, std::size_t(cores)));
    }

private:
    void add(const slicer::PhaseEstimate& phase, double share) {
        (phase.measured ? measured_cpu_s_ : cpu_s_) += share * phase.cpu_s;
        if (phase.measured) measured_s_ += share * phase.seconds;
        memory_bytes_ = std::max(memory_bytes_, phase.memory_bytes);
    }

    const slicer::JobEstimate& estimate_;
    double cpu_s_ = 0, measured_cpu_s_ = 0, measured_s_ = 0;
    std::uint64_t memory_bytes_ = 0;
};

StageSums sums_of(TaskStage stage, const slicer::JobEstimate& estimate, int shards) {
    StageSums sums(estimate);
    switch (stage) {
        case TaskStage::whole:
            sums.add_all();
            return sums;
        case TaskStage::prepare:
            sums.add({slicer::Phase::read, slicer::Phase::separate, slicer::Phase::prepare_loop, slicer::Phase::loop});
            return sums;
        case TaskStage::layers:
            sums.add({slicer::Phase::read, slicer::Phase::separate});
            sums.add({slicer::Phase::layers}, 1.0 / shards);
            return sums;
        case TaskStage::merge:
            break;
    }
    sums.add({slicer::Phase::read, slicer::Phase::separate, slicer::Phase::report});
    if (estimate.prediction)
        sums.add({slicer::Phase::layers, slicer::Phase::predict});  // it makes the layers once more, in memory
    return sums;
}

/// In steps that are written in few digits.
double gib_of(std::uint64_t bytes) {
    constexpr double gib = 1 << 30, steps = 1024;
    return std::max(1.0, std::floor(double(bytes) / gib * steps)) / steps;
}

int cores_for(double cpu_s, int most) {
    int cores = 1;
    while (2 * cores <= most && cpu_s / (2 * cores) >= least_s_per_core) cores *= 2;
    return cores;
}

/// Why the layers cannot be made in parts; empty: they can.
std::string why_not_cut(const PlannedJob& job) {
    const slicer::OpenedJob opened = slicer::open_job(job.options);
    if (opened.other) return opened.other->why_whole();
    const io::StackOutputs outputs = opened.outputs();
    if (outputs.gcvf || outputs.vdb)
        return fmt::format("{} is one file of the whole stack", outputs.gcvf ? io::gcvf_name : io::vdb_name);
    return {};
}

/// Whether shards ask for what a loop came to, or for why there was none.
bool loop_comes_first(const slicer::SliceOptions& options) {
    const slicer::JobLoopOptions loop = slicer::resolve(options).loop;
    return loop.iterations != 0 && !loop.mixtures_named;
}

/// Whether how much its loop or prediction may take is half of what the machine has.
bool asks_machine_for_memory(const slicer::SliceOptions& options) {
    if (options.memory_gib != 0) return false;
    const slicer::ResolvedJob job = slicer::resolve(options);
    return job.loop.iterations != 0 || job.prediction.automatic || job.prediction.model;
}

int shards_for(const slicer::JobEstimate& estimate, const ChainOptions& options) {
    const int most = std::clamp(int(estimate.layers), 1, options.most_shards);
    if (options.shards > 0) return std::min(options.shards, most);
    StageSums layers(estimate);
    layers.add({slicer::Phase::layers});
    const int cores = cores_for(layers.cpu_s(), options.most_cores);
    return int(std::clamp(std::ceil(layers.seconds_on(cores) / options.shard_s), 1.0, double(most)));
}

std::vector<std::string> with(std::vector<std::string> arguments, std::initializer_list<const char*> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

ChainStage stage_of(TaskStage stage, std::vector<std::string> arguments, int tasks, const PlannedJob& job,
                    const slicer::JobEstimate& estimate, const ChainOptions& options) {
    const StageSums sums = sums_of(stage, estimate, tasks);
    ChainStage made;
    made.stage = stage;
    made.arguments = std::move(arguments);
    made.tasks = tasks;
    made.cores = job.options.threads > 0 ? job.options.threads : cores_for(sums.cpu_s(), options.most_cores);
    made.memory_bytes = sums.memory_bytes() + sums.memory_bytes() / 8 + beside_bytes;
    made.expected_s = sums.seconds_on(made.cores);
    made.limit_s = time_added_s + time_factor * made.expected_s;
    return made;
}

}  // namespace

slicer::SliceOptions options_on_cluster(const slicer::SliceOptions& options) {
    slicer::SliceOptions settled = options;
    if (asks_machine_for_memory(options)) settled.memory_gib = gib_of(slicer::memory_budget(0));
    if (settled.read_memory_gib == 0) settled.read_memory_gib = gib_of(io::default_read_memory());
    return settled;
}

std::string note_of_memory(std::span<const PlannedJob> jobs) {
    const auto asking =
        std::ranges::count_if(jobs, [](const PlannedJob& j) { return asks_machine_for_memory(j.options); });
    if (asking == 0) return {};
    return fmt::format(
        "loop and prediction of {} may take {:.1f} GiB, what a job allows itself on this machine, "
        "whatever the nodes have; \"memory\" in the plan says another",
        counted(std::uint64_t(asking), "job"), gib_of(slicer::memory_budget(0)));
}

bool keeps_what_it_did(TaskStage stage, const slicer::SliceOptions& options) {
    return (stage == TaskStage::whole || stage == TaskStage::prepare) && loop_comes_first(options);
}

std::vector<std::string> arguments_of(const ChainStage& stage, int index) {
    if (stage.stage != TaskStage::layers) return stage.arguments;
    std::vector<std::string> arguments = stage.arguments;
    arguments.insert(arguments.end(), {"--shard", fmt::format("{}/{}", index, stage.tasks)});
    return arguments;
}

TaskChain task_chain(const PlannedJob& job, const slicer::JobEstimate& estimate, const ChainOptions& options) {
    TaskChain chain;
    chain.shards = shards_for(estimate, options);
    chain.cpu_s = estimate.cpu_s;
    if (chain.shards > 1) {
        chain.why_whole = why_not_cut(job);
        if (!chain.why_whole.empty()) chain.shards = 1;
        if (options.shards == 0) chain.why_whole.clear();
    }
    const std::vector<std::string> slice = slicer::command_words(options_on_cluster(job.options));
    const auto add = [&](TaskStage stage, std::vector<std::string> arguments, int tasks) {
        chain.stages.push_back(stage_of(stage, std::move(arguments), tasks, job, estimate, options));
    };
    if (chain.shards == 1) {
        add(TaskStage::whole, slice, 1);
        return chain;
    }
    if (loop_comes_first(job.options)) add(TaskStage::prepare, with(slice, {"--until", "loop"}), 1);
    add(TaskStage::layers, slice, chain.shards);
    std::vector<std::string> merge{"merge", job.out.string(), "--shards", std::to_string(chain.shards)};
    if (estimate.prediction) merge.emplace_back("--predict");
    add(TaskStage::merge, std::move(merge), 1);
    return chain;
}

}  // namespace voxtone::farm
