// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/shard_job.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "io/shards/shard_folder.h"
#include "slicer/job/prepared_job.h"
#include "slicer/kept/prepared_body.h"
#include "slicer/plan/phase_estimates.h"
#include "slicer/prepare/phase.h"
#include "slicer/print/run_shard.h"
#include "slicer/print/shard_cut.h"

namespace voxtone::slicer {

namespace {

/// As the first shard left it.
std::optional<JobBody> kept_body(const OpenedJob& job) {
    const std::filesystem::path& out = job.options.out;
    std::optional<JobBody> kept = read_prepared(out, recorded_identity(io::shards_folder(out)).value_or(""));
    if (kept && job.options.strict && !kept->warnings.empty()) kept.reset();  // one may be a reason to stop
    return kept;
}

class ShardedBody final : public ShardedPrint {
public:
    ShardedBody(const OpenedJob& opened, std::optional<JobBody> kept, Progress& progress)
        : is_kept_(kept.has_value()), ready_(opened, std::move(kept), progress) {
        check_layer_count(ready_.plan.grid.size[2], ready_.job.printer, "larger (--size), or thicker (--thickness)");
        ready_.print->prepare(progress);
        slab_layers_ = ready_.print->layers()->slab_layers();
    }

    [[nodiscard]] const OpenedJob& job() const override { return ready_.job; }
    [[nodiscard]] const JobIdentity& identity() const override { return ready_.identity; }
    [[nodiscard]] const VoxelGrid& grid() const override { return ready_.plan.grid; }
    [[nodiscard]] LayerRange layers() const override { return ready_.plan.layers; }
    [[nodiscard]] int slab_layers() const override { return slab_layers_; }
    [[nodiscard]] std::vector<double> work() const override {
        return slab_work(ready_.body, ready_.job.options.colour.depth_mm, slab_layers_);
    }
    [[nodiscard]] const JobBody* body() const override { return &ready_.body; }

    void expect_disk(const LayerRange& mine, Progress& progress) const override {
        expect_disk_space(ready_.job.options.out, disk_bytes(ready_.job, ready_.body, mine, {}), progress);
    }
    void keep() const override {
        if (!is_kept_) keep_prepared(ready_.job.options.out, ready_.identity.job, ready_.body);
    }
    void make(const LayerRange& mine, const LayerTaker& take, LayerWatchers& watchers, JobMeasurements& figures,
              Progress& progress) override {
        std::vector<ExpectedStage> stages = expected_stages(ready_.plan.phases, {Phase::layers});
        for (ExpectedStage& stage : stages) stage.seconds *= double(mine.layers()) / ready_.plan.layers.layers();
        expect_stages(progress, std::move(stages));
        make_layers(*ready_.print, mine, take, watchers, figures, progress);
    }

private:
    bool is_kept_;
    PreparedJob ready_;
    int slab_layers_ = 0;
};

}  // namespace

JobResult run_shard_job(const SliceOptions& requested, Progress& progress) {
    // What is made of the layers; the prediction and the report are the merged stack's.
    const OpenedJob opened = open_job(requested, [](const OpenedJob&, JobRun& run) {
        run.why_unpredicted = "A part of the layers is not predicted.";
    });
    expect_shardable(opened);
    const auto prepare = [&](bool same_job_before) {
        for (const std::string& warning : opened.printer.warnings()) progress.warn(warning);
        return std::make_unique<ShardedBody>(opened, same_job_before ? kept_body(opened) : std::nullopt, progress);
    };
    return run_shard(opened, {[&] { expect_own_loop(opened, &progress); }, prepare}, progress);
}

}  // namespace voxtone::slicer
