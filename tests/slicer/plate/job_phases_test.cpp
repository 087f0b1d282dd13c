// SPDX-License-Identifier: GPL-3.0-or-later
//
// Phases that jobs have in common, of a print and of layers that are put down by hand.
#include "slicer/plate/job_phases.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "slicer/plate/ready_component.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/said_progress.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

/// Layers of 4 x 3 voxels in slabs of four, layer k all of material 1 + k % 3.
class Striped final : public LayerSource {
public:
    Striped() { grid_.size = {4, 3, 10}; }
    [[nodiscard]] const VoxelGrid& grid() const override { return grid_; }
    [[nodiscard]] int slab_layers() const override { return 4; }
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override {
        LayerCounts counts;
        for (int k = std::max(k_begin, 4 * slab); k < std::min({k_end, 4 * slab + 4, 10}); ++k) {
            io::LayerRuns layer(4, 3);
            for (int j = 0; j < 3; ++j) {
                layer.push(4, io::Material(1 + k % 3));
                layer.end_row();
            }
            counts.body_voxels += 12;
            sink(k, layer);
        }
        return counts;
    }

private:
    VoxelGrid grid_;
};

/// Takes layers as a print does.
class Taking final : public Print {
public:
    void prepare(Progress&) override {}
    void rearrange(Progress&) override {}
    [[nodiscard]] JobResult keep_loop() const override { return {}; }
    [[nodiscard]] std::unique_ptr<const LayerSource> layers() const override {
        return std::make_unique<const Striped>();
    }
    void expect_layers(const LayerRange& range) override { expected = range; }
    void take_layer(int k, const io::LayerRuns&) override {
        const std::scoped_lock lock(mutex);
        taken.push_back(k);
    }
    void evaluate(const io::StackDescription&, Progress&) override {}
    [[nodiscard]] std::vector<io::ReportStage> stages_before_layers() const override { return {}; }
    [[nodiscard]] std::vector<io::ReportStage> stages_after_layers() const override { return {}; }
    void add_to(io::Report&) const override {}
    void draw(io::Report& report, Progress&) const override { report.warnings.emplace_back("drawn"); }
    [[nodiscard]] std::string summary(const io::Report&) const override { return "  as asked\n"; }
    [[nodiscard]] std::string written_text() const override { return {}; }

    LayerRange expected{-1, -1};
    std::vector<int> taken;
    std::mutex mutex;
};

/// Materials by layer.
using Made = std::map<int, int>;
LayerTaker into(Made& made) {
    static std::mutex mutex;
    return [&made](int k, const io::LayerRuns& layer) {
        const std::scoped_lock lock(mutex);
        made[k] = layer.row(0)[0].material;
    };
}

}  // namespace

TEST_CASE("Layers of a range are made, each once, counted, and shown to who looks on") {
    LayerWatchers nobody;
    for (const auto& [first, last] : {std::pair{0, 9}, {3, 3}, {2, 8}, {4, 7}}) {
        CAPTURE(first, last);
        JobMeasurements figures;
        test::SaidProgress progress;
        Made made;
        make_layers(Striped(), {first, last}, into(made), nobody, figures, progress);
        CHECK(int(made.size()) == last - first + 1);
        for (const auto& [k, material] : made) CHECK((k >= first && k <= last && material == 1 + k % 3));
        CHECK(figures.counts.body_voxels == std::uint64_t(12 * (last - first + 1)));
        CHECK(figures.layers_s > 0);
        CHECK(figures.encode_s >= 0);
        // A print is told which there will be, and sees each.
        Taking print;
        made.clear();
        make_layers(print, {first, last}, into(made), nobody, figures, progress);
        CHECK((print.expected.first == first && print.expected.last == last));
        std::ranges::sort(print.taken);
        CHECK((int(print.taken.size()) == last - first + 1 && print.taken.front() == first));
        CHECK(int(made.size()) == last - first + 1);
    }
    test::SaidProgress stopped;
    stopped.cancel();
    JobMeasurements figures;
    Made made;
    CHECK_THROWS_AS(make_layers(Striped(), {0, 9}, into(made), nobody, figures, stopped), Cancelled);
}

TEST_CASE("A container's preview is the body's mesh, or empty where there is no container") {
    const JobBody body = test::body_of(shapes::box({1, 2, 3}, {4, 6, 8}), {0.1, 0.1, 0.1});
    const BodyPreview wanted(body, true), none(body, false);
    REQUIRE(wanted.mesh().vertices_mm.size() == 8);
    CHECK(wanted.mesh().vertices_mm[7] == std::array{4.0f, 6.0f, 8.0f});
    CHECK(wanted.mesh().vertices_mm[1] == std::array{4.0f, 2.0f, 3.0f});
    CHECK(wanted.mesh().triangles.size() == 12);
    CHECK((none.mesh().vertices_mm.empty() && none.mesh().triangles.empty()));
}

TEST_CASE(
    "What a job ends with: its report as files, its verdict's sentence where it is bad, its exit code if strict") {
    const io::TemporaryFolder folder;
    OpenedJob job;
    job.options.out = folder.path();
    const Taking print;
    std::optional<VoxelSample> voxels;
    const Stopwatch since;
    test::SaidProgress progress;
    const auto exists = [&](const char* name) { return std::filesystem::exists(folder.path() / name); };
    io::Report report;
    job.options.report = false;
    JobResult result = write_report(job, print, report, voxels, since, progress);
    CHECK((exists("report.json") && !exists("report.html") && !exists("for-customer.html")));
    CHECK((report.stages.empty() && report.warnings.empty()));
    CHECK(report.total_seconds > 0);
    CHECK(result.exit_code == ExitCode::done);
    CHECK_THAT(result.text, Contains("  as asked\n") && !Contains("report: "));
    const std::vector<std::uint8_t> file = io::read_whole_file(folder.path() / "report.json", 1 << 20);
    CHECK(std::string(file.begin(), file.end()) == result.json);
    job.options.report = true;
    report.verdict.emplace().level = io::VerdictLevel::bad;
    report.verdict->sentence = "It will not look as asked.";
    result = write_report(job, print, report, voxels, since, progress);
    CHECK((exists("report.html") && exists("for-customer.html")));
    REQUIRE(report.stages.size() == 1);
    CHECK(report.stages[0].name == "draw the report");
    CHECK(report.warnings == std::vector<std::string>{"drawn"});
    CHECK(result.exit_code == ExitCode::done);
    CHECK_THAT(result.text, Contains("report: "));
    job.options.strict = true;
    CHECK(write_report(job, print, report, voxels, since, progress).exit_code == ExitCode::check_failed);
    report.verdict->level = io::VerdictLevel::fair;
    CHECK(write_report(job, print, report, voxels, since, progress).exit_code == ExitCode::done);
}

TEST_CASE(
    "A resin is found by its names before its role, in any case of letters, and one that is not loaded is refused") {
    LoadedResins resins;
    resins.set.resins = {{"VeroCyan", "C", {1}, {1}}, {"Agilus", "W", {1}, {1}}};
    resins.entries = {{"White", "C", {}, 0, 0}, {"Agilus30", "W", {}, 0, 0}};
    CHECK(loaded_resin(resins, "verocyan") == 0u);
    CHECK(loaded_resin(resins, "WHITE") == 0u);
    CHECK(loaded_resin(resins, "w") == 1u);
    CHECK(loaded_resin(resins, "agilus30") == 1u);
    CHECK(loaded_resin(resins, "Agilus") == 1u);
    CHECK_FALSE(loaded_resin(resins, "K").has_value());
    std::string said;
    try {
        refuse_resin("Tango", resins);
    } catch (const InputError& error) {
        said = error.what();
    }
    CHECK(said ==
          "is of Tango, which is not loaded: loaded are White (C), Agilus30 (W); say \"load\" beside \"parts\" "
          "(or --load C,W) with its role, if the printer has room for it");
    CHECK(ReadyComponent{nullptr, Outline(1, 1), {3, 4, 5}, {}}.all_voxels() == 12);
}
