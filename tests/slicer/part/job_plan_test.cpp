// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/job_plan.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/progress.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/print/estimate_job.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/slicer/options/declared_show.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// A cube of 10 mm, of one colour.
class Cube {
public:
    explicit Cube(const std::string& rgb) {
        std::ofstream out(file());
        for (int corner = 0; corner < 8; ++corner)
            out << "v " << 10 * (corner & 1) << ' ' << 10 * (corner >> 1 & 1) << ' ' << 10 * (corner >> 2) << ' ' << rgb
                << '\n';
        out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    }
    [[nodiscard]] std::string file() const { return (folder_.path() / "cube.obj").string(); }
    [[nodiscard]] SliceOptions options() const {
        SliceOptions options;
        options.model = file();
        options.unit = "mm";
        options.out = (folder_.path() / "out").string();
        return options;
    }

private:
    io::TemporaryFolder folder_;
};

struct Planned {
    explicit Planned(const SliceOptions& options)
        : job(open_job(options)), body(prepare_body(job.options, job.printer, progress)), plan(plan_job(job, body)) {}
    Progress progress;
    OpenedJob job;
    JobBody body;
    JobPlan plan;
};

std::set<Phase> phases_of(const JobPlan& plan) {
    std::set<Phase> phases;
    for (const PhaseEstimate& phase : plan.phases) phases.insert(phase.phase);
    return phases;
}

}  // namespace

TEST_CASE("A skin over nothing is planned solid, with a warning, unless its void is to be kept") {
    const Cube cube("1 0 0");
    const auto lined = [&](double wall) {
        std::ofstream out(cube.file(), std::ios::app);
        for (int corner = 0; corner < 8; ++corner)
            out << "v " << (corner & 1 ? 10 - wall : wall) << ' ' << (corner >> 1 & 1 ? 10 - wall : wall) << ' '
                << (corner >> 2 & 1 ? 10 - wall : wall) << " 0 0 1\n";
        out << "f 10 12 11 9\nf 15 16 14 13\nf 13 14 10 9\nf 12 16 15 11\nf 11 15 13 9\nf 14 16 12 10\n";
    };
    const Planned solid(cube.options());
    CHECK(solid.body.repair.voids.empty());
    lined(0.2);
    SliceOptions options = cube.options();
    const Planned filled(options);
    REQUIRE(filled.body.repair.voids.size() == 1);
    REQUIRE_FALSE(filled.body.warnings.empty());
    CHECK_THAT(filled.body.warnings.back(), Catch::Contains("was filled with resin") && Catch::Contains("[cavity]"));
    CHECK(filled.body.solid->triangles == solid.body.solid->triangles);
    CHECK(filled.body.surface->triangles.size() == solid.body.surface->triangles.size());
    options.cavities = "keep";
    const Planned kept(options);
    CHECK(std::ranges::any_of(kept.body.warnings, [](const std::string& warning) {
        return warning.find("was kept") != std::string::npos && warning.find("[cavity]") != std::string::npos;
    }));
    CHECK(kept.body.solid->triangles.size() == 2 * solid.body.solid->triangles.size());
    // The coloured shell decides.
    options.cavities = "auto", options.depth_mm = 0.1;
    CHECK_FALSE(Planned(options).body.repair.voids[0].filled);
}

TEST_CASE("What is printed does not depend on the memory that there is") {
    const Cube cube("1 0 0");
    SliceOptions options = cube.options();
    options.memory_gib = 64;
    const Planned roomy(options);
    options.memory_gib = 0.01;
    const Planned tight(options);
    CHECK(roomy.plan.loop.wanted);
    CHECK(roomy.plan.loop.does_not_fit.empty());
    CHECK(tight.plan.loop.wanted);
    CHECK(tight.plan.loop.descent == roomy.plan.loop.descent);
    CHECK(tight.plan.loop.why_not.empty());
    CHECK(tight.plan.loop.does_not_fit.find("--memory") != std::string::npos);
    CHECK(phases_of(tight.plan) == phases_of(roomy.plan));
    const auto warnings_of = [](const Planned& planned) {
        std::string all;
        for (const std::string& warning :
             estimate_print({planned.job, planned.body, planned.plan}, {}, nullptr, planned.progress).warnings)
            all += warning + '\n';
        return all;
    };
    CHECK_THAT(warnings_of(roomy), !Catch::Contains("[loop-left-out]"));
    CHECK_THAT(warnings_of(tight), Catch::Contains("allow more (--memory)") && Catch::Contains("[loop-left-out]"));

    options.iterations = "3";  // asked for by number: tried all the same
    CHECK(Planned(options).plan.loop.does_not_fit.empty());
}

TEST_CASE("A body goes by feedback however small it is, downhill where that or contrast is asked for") {
    const Cube cube("1 0 0");
    SliceOptions options = cube.options();
    options.size_mm = 5;
    const auto descends = [&] { return Planned(options).plan.loop.descent; };
    CHECK_FALSE(descends());
    options.intent = "contrast";
    CHECK(descends());
    options.size_mm = 20;  // 24 cm2
    CHECK_FALSE(descends());
    options.loop_method = "descent";
    CHECK(descends());
}

TEST_CASE("A loop keeps to the memory that it is allowed, with the help of the disk, and says so beforehand") {
    const LoopPlan plan{.wanted = true, .descent = false, .why_not = "", .does_not_fit = ""};
    constexpr double cow_of_60mm = 6960, cell_mm = 0.085, gib = 1 << 30;
    const auto cost = [&](double allowed) {
        return expected_cost(plan, cow_of_60mm, cell_mm, static_cast<std::uint64_t>(allowed));
    };
    CHECK(cost(16 * gib).disk_bytes == 0);
    CHECK(cost(0).disk_bytes == 0);
    const LoopCost tight = cost(2 * gib);
    CHECK(tight.most_bytes == 2 * gib);
    CHECK(tight.disk_bytes > 0.7e9);  // the light of 963,000 cells in three channels alone
    CHECK(tight.cpu_seconds > cost(0).cpu_seconds);
    CHECK(cost(0.01 * gib).most_bytes > gib);  // the state of the loop is not put there
    CHECK(bytes_for_predictions(0, 1'000'000) == 0);
    CHECK(bytes_for_predictions(2'000'000'000, 1'000'000) < 1'100'000'000);
}

TEST_CASE("A plan says which phases a job goes through") {
    const Cube red("1 0 0"), white("1 1 1");
    const std::set<Phase> without{Phase::separate, Phase::layers, Phase::report};
    const auto and_also = [](std::set<Phase> phases, std::initializer_list<Phase> more) {
        phases.insert(more);
        return phases;
    };
    SliceOptions options = red.options();
    const Planned usual(options);
    CHECK(phases_of(usual.plan) == and_also(without, {Phase::prepare_loop, Phase::loop}));
    CHECK((usual.plan.prediction.by == PredictionPlan::By::loop && usual.plan.loop.last_look));
    CHECK(usual.plan.all_layers);
    CHECK_FALSE(usual.plan.all_white);
    CHECK(usual.plan.grid.size == usual.body.grid.size);

    options.iterations = "0";
    CHECK(phases_of(Planned(options).plan) == and_also(without, {Phase::predict}));
    options.report = false;
    CHECK(phases_of(Planned(options).plan) == std::set<Phase>{Phase::separate, Phase::layers});

    // A part of the layers is not predicted, and costs its share.
    options = red.options();
    options.layers = "0-99";
    const Planned part(options);
    CHECK(part.plan.layers.layers() == 100);
    CHECK_FALSE(part.plan.all_layers);
    CHECK(part.plan.prediction.by == PredictionPlan::By::nothing);
    CHECK(part.plan.disk_bytes < usual.plan.disk_bytes);

    // White on white: nothing to rearrange, nothing to predict, unless it was asked for.
    const Planned plain(white.options());
    CHECK(plain.plan.all_white);
    CHECK(phases_of(plain.plan) == without);
    CHECK(plain.plan.loop.why_not.find("white") != std::string::npos);

    options.layers = "5000-6000";
    CHECK_THROWS_AS(Planned(options), InputError);
}

TEST_CASE("What another print has to do is a phase of its plan") {
    class Carved final : public OtherPrint {
        std::string usual_resins(const PrinterProfile&) const override { return "vero-opaque"; }
        void check(const LoadedResins&) const override {}
        std::vector<JobInput> inputs() const override { return {}; }
        std::vector<Work> work(const LoadedResins&) const override { return {{Phase::search, 30}}; }
        std::string what() const override { return "a carving"; }
        std::string why_no_resins() const override { return "Nobody knows."; }
        std::string why_whole() const override { return "it is one"; }
        std::unique_ptr<Print> make(const OpenedJob&, const JobBody&, Progress&) const override { return nullptr; }
    };
    const Cube cube("1 0 0");
    SliceOptions options = cube.options();
    declare_relics();
    const std::string bone = (std::filesystem::path(options.model).parent_path() / "carving.json").string();
    std::ofstream(bone) << "x";
    options = with_relic(options, bone);
    register_other_print([](ResolvedJob&) -> std::unique_ptr<const OtherPrint> { return std::make_unique<Carved>(); });
    const OpenedJob job = open_job(options);
    register_other_print(nullptr);
    Progress progress;
    const JobBody body = prepare_body(job.options, job.printer, progress);
    const JobPlan plan = plan_job(job, body);
    CHECK(phases_of(plan) == std::set<Phase>{Phase::search, Phase::layers, Phase::report});
    for (const PhaseEstimate& phase : plan.phases)
        if (phase.phase == Phase::search) CHECK(phase.cpu_s == Approx(30));
}

TEST_CASE("What a plan says of time and memory grows with the work") {
    const Cube cube("0 0.5 1");
    SliceOptions options = cube.options();
    const auto total = [&](double size_mm) {
        options.size_mm = size_mm;
        const Planned planned(options);
        double seconds = 0;
        std::uint64_t bytes = 0;
        for (const PhaseEstimate& phase : planned.plan.phases) {
            CHECK(phase.seconds <= phase.cpu_s);
            CHECK_FALSE(phase.measured);
            seconds += phase.cpu_s;
            bytes = std::max(bytes, phase.memory_bytes);
        }
        return std::pair(seconds, bytes);
    };
    const auto [small_s, small_bytes] = total(5);
    const auto [large_s, large_bytes] = total(10);
    // Four times the surface: more work, though not more than four times of it.
    CHECK(large_s > 1.5 * small_s);
    CHECK(large_s < 4.5 * small_s);
    CHECK(large_bytes > small_bytes);
    CHECK(large_bytes < 4 * small_bytes);

    // Stages by phase, in the order of the phases.
    options.size_mm = 5;
    const Planned planned(options);
    const auto stages = expected_stages(planned.plan.phases, {Phase::report, Phase::layers});
    REQUIRE(stages.size() == 2);
    CHECK(stages[0].name == "layers");
    CHECK(stages[1].name == "report");
}
