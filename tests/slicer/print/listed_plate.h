// SPDX-License-Identifier: GPL-3.0-or-later
//
// A plate of which every call is written down, and whose layers cost nothing: what the runs of prints do with plates.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/shards/shard_folder.h"
#include "slicer/plate/output_folder.h"
#include "slicer/print/plate.h"

namespace voxtone::test {

class ListedPlate final : public slicer::Plate {
public:
    using JobResult = voxtone::JobResult;
    /// Five slabs of ten layers, of which the first half is not asked for; the last is as much work as all others.
    static constexpr int first = 5, end = 50, slab = 10;

    explicit ListedPlate(const slicer::SliceOptions& options)
        : job_(slicer::open_job(options)), identity_(slicer::identify(job_, {})) {
        grid_.size = {3, 2, end};
        grid_.pitch_mm = job_.printer.sliced_pitch_mm();
    }

    std::vector<std::string> calls;
    std::string ends_at, throws_at;                ///< a call
    std::function<void(const std::string&)> at{};  ///< each call
    bool same_job_before = false;
    slicer::LayerRange made{}, disk{};
    std::size_t threads = 0;

    io::StackFolder take_folder(Progress& progress) override {
        come("take");
        return slicer::take_output(job_.options.out, {}, progress);
    }
    std::optional<JobResult> done_before(const io::StackFolder& /*folder*/, Progress& /*progress*/) override {
        return come("done");
    }
    void expect_replaceable(const io::StackFolder& /*folder*/, Progress& /*progress*/) override { come("replaceable"); }
    void prepare(Progress& /*progress*/) override {
        threads = thread_count();
        come("prepare");
    }
    std::optional<JobResult> rearrange(Progress& /*progress*/) override { return come("rearrange"); }
    JobResult print(io::StackFolder folder, const Stopwatch& since_begin, Progress& /*progress*/) override {
        come("print");
        is_own_folder = folder.path() == job_.options.out && since_begin.total() < 60;
        return {"{}", "printed", ExitCode::done};
    }
    bool is_own_folder = false;

    [[nodiscard]] const slicer::OpenedJob& job() const override { return job_; }
    void expect_loops(Progress& /*progress*/) override { come("loops"); }
    slicer::ShardedPrint prepare_for_shards(bool same_before, Progress& /*progress*/) override {
        same_job_before = same_before;
        threads = thread_count();
        come("prepare");
        slicer::ShardedPrint print{.job = job_,
                                   .identity = identity_,
                                   .grid = grid_,
                                   .layers = {first, end - 1},
                                   .slab_layers = slab,
                                   .work = {1, 1, 1, 1, 4},
                                   .make = {},
                                   .expect_disk = {}};
        print.make = [this](const slicer::LayerRange& mine, const slicer::LayerTaker& take, slicer::LayerWatchers&,
                            slicer::JobMeasurements& figures) {
            made = mine;
            come("make");
            for (int k = mine.first; k <= mine.last; ++k) take(k, layer(k));
            figures.counts.body_voxels = std::uint64_t(mine.layers()) * 4;
            figures.counts.shell_s = mine.layers();
            figures.encode_s = 2.0 * mine.layers();
            figures.layers_s = 0.5 * mine.layers();
        };
        print.expect_disk = [this](const slicer::LayerRange& mine) {
            disk = mine;
            come("disk");
        };
        print.keep = [this] {
            io::write_whole_file(io::prepared_file(job_.options.out, identity_.job), "kept");
            come("keep");
        };
        return print;
    }
    [[nodiscard]] const std::string& identity() const { return identity_.job; }

private:
    std::optional<JobResult> come(const std::string& call) {
        calls.push_back(call);
        if (at) at(call);
        if (throws_at == call) throw InputError("refused at " + call);
        return ends_at == call ? std::optional(JobResult{"{}", "ended at " + call, ExitCode::done}) : std::nullopt;
    }
    /// Each another one.
    static io::LayerRuns layer(int k) {
        io::LayerRuns runs(3, 2);
        for (int row = 0; row < 2; ++row) {
            runs.push(1, io::Material(1 + k % 4));
            runs.push(1, io::background);
            runs.push(1, io::Material(1 + k / 4 % 4));
            runs.end_row();
        }
        return runs;
    }

    const slicer::OpenedJob job_;
    const slicer::JobIdentity identity_;
    slicer::VoxelGrid grid_;
};

}  // namespace voxtone::test
