// SPDX-License-Identifier: GPL-3.0-or-later
//
// What must hold between phases, whatever the measured figures of the machine are.
#include "slicer/part/phase_estimates.h"

#include <algorithm>
#include <map>
#include <string>

#include <catch2/catch.hpp>

#include "slicer/look/prediction_time.h"
#include "slicer/part/job_plan.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;
using voxtone::test::body_of;
using voxtone::test::SampleJob;

namespace {

constexpr std::uint64_t resident = 300'000'000;

/// Red boxes of this size in a row.
JobBody boxes(const OpenedJob& job, const Vector3d& size_mm, int count = 1) {
    SolidMesh mesh = shapes::box(Vector3d::Zero(), size_mm);
    for (int n = 1; n < count; ++n)
        mesh = shapes::joined(
            mesh, shapes::box(Vector3d(n * (size_mm.x() + 1), 0, 0), size_mm + Vector3d(n * (size_mm.x() + 1), 0, 0)));
    return body_of(mesh, job.printer.sliced_pitch_mm(),
                   std::vector<Vector3f>(mesh.triangles.size(), Vector3f(1, 0, 0)));
}

LayerRange all_of(const JobBody& body) { return {0, body.grid.size[2] - 1}; }

/// Of these layers, as the job is planned.
std::vector<PhaseEstimate> estimates(const OpenedJob& job, const JobBody& body, const LayerRange& layers,
                                     std::size_t threads, std::uint64_t resident_bytes) {
    const JobPlan plan = plan_job(job, body);
    return phase_estimates(job, body, {layers, plan.loop, plan.prediction}, threads, resident_bytes);
}

std::vector<std::string> names(const std::vector<PhaseEstimate>& phases) {
    std::vector<std::string> found;
    for (const PhaseEstimate& phase : phases) found.emplace_back(name_of(phase.phase));
    return found;
}

const PhaseEstimate& phase_of(const std::vector<PhaseEstimate>& phases, Phase phase) {
    const auto found = std::ranges::find(phases, phase, &PhaseEstimate::phase);
    REQUIRE(found != phases.end());
    return *found;
}

}  // namespace

TEST_CASE("Threads share what can be shared, by Amdahl's law") {
    // G. M. Amdahl (1967): from one thread and two follow all others.
    const double one = seconds_on_threads(100, 1), two = seconds_on_threads(100, 2);
    CHECK(one == Approx(100));
    const double serial = 2 * two / one - 1;
    CHECK(serial > 0);
    CHECK(serial < 0.5);
    for (const std::size_t threads : {3, 8, 64, 1000}) {
        CHECK(seconds_on_threads(100, threads) == Approx(one * (serial + (1 - serial) / double(threads))));
        CHECK(seconds_on_threads(100, threads) > 100.0 / double(threads));
    }
    CHECK(seconds_on_threads(100, 0) == seconds_on_threads(100, 1));
}

TEST_CASE("A job has the phases that it will go through, in their order") {
    const auto phases_with = [](const std::string& iterations, const std::string& predict, bool report = true) {
        SampleJob sample(iterations, predict);
        sample.options.report = report;
        const OpenedJob job = sample.opened();
        const JobBody body = boxes(job, {6, 5, 4});
        return names(estimates(job, body, all_of(body), 4, resident));
    };
    using Names = std::vector<std::string>;
    CHECK(phases_with("0", "none") == Names{"separate colours", "layers", "report"});
    CHECK(phases_with("0", "none", false) == Names{"separate colours", "layers"});
    CHECK(phases_with("0", "transport") == Names{"separate colours", "layers", "predict", "report"});
    CHECK(phases_with("3", "none") ==
          Names{"separate colours", "prepare the loop", "appearance loop", "layers", "report"});
    CHECK(phases_with("3", "monte-carlo") ==
          Names{"separate colours", "prepare the loop", "appearance loop", "layers", "predict", "report"});
}

TEST_CASE("Layers take what there are of them, and something besides") {
    const SampleJob sample("0", "none");
    const OpenedJob job = sample.opened();
    const JobBody body = boxes(job, {12, 10, 8});
    const auto seconds = [&](int layers) {
        return phase_of(estimates(job, body, {0, layers - 1}, 1, resident), Phase::layers).cpu_s;
    };
    const int all = body.grid.size[2] / 4 * 4;
    const double whole = seconds(all), half = seconds(all / 2), quarter = seconds(all / 4);
    CHECK(quarter > 0);
    CHECK(half > quarter);
    CHECK(whole - half == Approx(2 * (half - quarter)));
    CHECK(whole < 2 * half);
    // What is left of no layers at all does not know how large the body is.
    const auto none = [&](const Vector3d& size_mm) {
        const JobBody other = boxes(job, size_mm);
        const auto of = [&](int layers) {
            return phase_of(estimates(job, other, {0, layers - 1}, 1, resident), Phase::layers).cpu_s;
        };
        return 2 * of(100) - of(200);
    };
    CHECK(none({12, 10, 8}) > 0);
    CHECK(none({24, 20, 16}) == Approx(none({12, 10, 8})));
    // Other phases do not know of layers.
    CHECK(phase_of(estimates(job, body, {0, 9}, 1, resident), Phase::separate).cpu_s ==
          phase_of(estimates(job, body, all_of(body), 1, resident), Phase::separate).cpu_s);
}

TEST_CASE("What is done cell by cell takes as long as there is surface, and finer cells take longer") {
    SampleJob sample("5", "transport");
    sample.options.loop_method = "feedback";  // of large surfaces it is by itself
    OpenedJob job = sample.opened();
    const auto phases = [&](int count) {
        const JobBody body = boxes(job, {6, 5, 4}, count);
        return estimates(job, body, all_of(body), 1, resident);
    };
    const auto one = phases(1), two = phases(2), four = phases(4);
    for (const Phase name : {Phase::prepare_loop, Phase::loop, Phase::predict, Phase::report}) {
        CAPTURE(name_of(name));
        const double of_one = phase_of(one, name).cpu_s, of_two = phase_of(two, name).cpu_s,
                     of_four = phase_of(four, name).cpu_s;
        CHECK(of_two > of_one);
        CHECK(of_four - of_two == Approx(2 * (of_two - of_one)).epsilon(1e-3));
        CHECK(phase_of(two, name).memory_bytes > phase_of(one, name).memory_bytes);
    }
    CHECK(phase_of(one, Phase::loop).cpu_s == Approx(phase_of(two, Phase::loop).cpu_s / 2));
    job.options.prediction.cell_mm /= 2;
    CHECK(phase_of(phases(1), Phase::loop).cpu_s == Approx(4 * phase_of(one, Phase::loop).cpu_s));
}

TEST_CASE("Iterations of the loop take time each, and no memory") {
    std::map<int, PhaseEstimate> loops;
    for (const int iterations : {1, 3, 9, 10, 11}) {
        const SampleJob sample(std::to_string(iterations), "none");
        const OpenedJob job = sample.opened();
        const JobBody body = boxes(job, {6, 5, 4});
        loops[iterations] = phase_of(estimates(job, body, all_of(body), 2, resident), Phase::loop);
    }
    CHECK(loops[1].cpu_s > 0);
    CHECK(loops[3].cpu_s > loops[1].cpu_s);
    CHECK(loops[9].cpu_s > loops[3].cpu_s);
    CHECK(loops[11].cpu_s - loops[10].cpu_s == Approx(loops[10].cpu_s - loops[9].cpu_s));
    CHECK(loops[9].memory_bytes == loops[1].memory_bytes);
}

TEST_CASE("No phase holds less than the body, more threads hold more, and none holds more than is told of all") {
    for (const auto& [iterations, predict] :
         {std::pair{"0", "none"}, std::pair{"2", "none"}, std::pair{"0", "transport"}, std::pair{"2", "transport"}}) {
        CAPTURE(iterations, predict);
        const SampleJob sample(iterations, predict);
        const OpenedJob job = sample.opened();
        for (const int count : {1, 3}) {
            const JobBody body = boxes(job, {12, 9, 7}, count);
            const auto few = estimates(job, body, all_of(body), 1, resident),
                       many = estimates(job, body, all_of(body), 16, resident),
                       with_more = estimates(job, body, all_of(body), 1, 2 * resident);
            REQUIRE(few.size() == many.size());
            const double area = coloured_area_mm2(*body.surface);
            CHECK(area == Approx(count * 2 * (12 * 9 + 9 * 7 + 7 * 12)));
            const double most = most_bytes_of_surface(area, job.options.prediction.cell_mm);
            const double working = double(phase_of(few, Phase::separate).memory_bytes);
            for (std::size_t p = 0; p < few.size(); ++p) {
                CAPTURE(name_of(few[p].phase));
                CHECK(few[p].memory_bytes > resident);
                CHECK(many[p].memory_bytes > few[p].memory_bytes);
                CHECK(with_more[p].memory_bytes - few[p].memory_bytes == resident);
                CHECK(double(few[p].memory_bytes) <= working + most);
                CHECK(few[p].seconds == Approx(few[p].cpu_s));
                CHECK(many[p].cpu_s == few[p].cpu_s);
                CHECK(many[p].seconds == Approx(seconds_on_threads(few[p].cpu_s, 16)));
                CHECK_FALSE(few[p].measured);
            }
        }
    }
}

TEST_CASE("The time that is shown as left knows all phases, or those of a part") {
    std::vector<PhaseEstimate> phases{
        {Phase::separate, 1, 2, 0, false}, {Phase::layers, 3, 4, 0, false}, {Phase::report, 5, 6, 0, false}};
    const auto all = expected_stages(phases);
    REQUIRE(all.size() == 3);
    for (std::size_t n = 0; n < 3; ++n) {
        CHECK(all[n].name == name_of(phases[n].phase));
        CHECK(all[n].seconds == phases[n].seconds);
    }
    const auto part = expected_stages(phases, {Phase::report, Phase::layers, Phase::predict});
    REQUIRE(part.size() == 2);
    CHECK(part[0].name == "layers");
    CHECK(part[1].name == "report");
}

TEST_CASE("The disk is asked for more the more there is to write") {
    SampleJob sample;
    const OpenedJob job = sample.opened();
    const JobBody small = boxes(job, {6, 5, 4}), large = boxes(job, {12, 10, 8});
    const std::uint64_t whole = disk_bytes(job, small, all_of(small), {});
    CHECK(disk_bytes(job, small, {0, 49}, {}) < whole);
    CHECK(disk_bytes(job, large, all_of(large), {}) > whole);
    sample.options.report = false;
    CHECK(disk_bytes(sample.opened(), small, all_of(small), {}) < whole);
    // The layers cannot take more than their bitmaps would without compression, four bytes a voxel.
    CHECK(disk_bytes(sample.opened(), small, all_of(small), {}) < 4 * small.grid.voxels());
}

TEST_CASE("What a job is said to take are the figures that were measured: they change with a measurement alone") {
    // Regression values, of docs/estimate.md's jobs: a box of 12 x 9 x 7 mm, all its layers, one thread.
    SampleJob sample("5", "transport");
    OpenedJob job = sample.opened();
    job.options.loop.method = LoopMethod::descent;
    job.options.prediction.memory_bytes = 0;
    const JobBody body = boxes(job, {12, 9, 7});
    const double area = 2 * (12 * 9 + 9 * 7 + 7 * 12), cells = area / (0.085 * 0.085);
    const double of_rgb = double(job.resins.set.channels.size()) / 3;
    const auto phases = estimates(job, body, all_of(body), 1, resident);
    const auto cpu = [&](Phase phase) { return phase_of(phases, phase).cpu_s; };
    CHECK(cpu(Phase::separate) == Approx(0.3));
    CHECK(cpu(Phase::prepare_loop) == Approx(0.5 + 1.1e-5 * cells));
    CHECK(cpu(Phase::loop) == Approx(of_rgb * cells * (1e-4 + 3 * 2.3e-5 + 2 * 5.3e-5)));
    const double shell = area * job.options.shell_mm() / body.grid.voxel_volume_mm3();
    CHECK(cpu(Phase::layers) == Approx(0.4 + 6e-10 * double(body.grid.voxels()) + 8e-8 * shell));
    CHECK(cpu(Phase::report) == Approx(0.25 + 1.15e-5 * cells));
    const auto bytes = [&](Phase phase) { return double(phase_of(phases, phase).memory_bytes) - double(resident); };
    const double working = 4e7 + 8e6, looping = working + 1.6e8 + 6400 * cells;
    CHECK(bytes(Phase::separate) == Approx(working));
    CHECK(bytes(Phase::prepare_loop) == Approx(working + 900 * cells));
    CHECK(bytes(Phase::loop) == Approx(looping));
    CHECK(bytes(Phase::layers) == Approx(looping + 2.0 * body.grid.size[0] * body.grid.size[1]));
    CHECK(bytes(Phase::predict) == Approx(working + 1.5e8 + 6000 * cells + 5e7 + 1800 * cells));
    CHECK(bytes(Phase::report) == Approx(std::max(looping, working + 1e8 + 2500 * cells)));
    // By feedback, and without a loop or a prediction.
    job.options.loop.method = LoopMethod::feedback;
    const auto by_feedback = estimates(job, body, all_of(body), 1, resident);
    CHECK(phase_of(by_feedback, Phase::loop).cpu_s == Approx(of_rgb * cells * (1e-4 + 5 * 2.3e-5)));
    CHECK(double(phase_of(by_feedback, Phase::loop).memory_bytes) - double(resident) ==
          Approx(working + 1.4e8 + 2700 * cells));
    const SampleJob bare("0", "none");
    const OpenedJob alone = bare.opened();
    CHECK(phase_of(estimates(alone, body, all_of(body), 1, resident), Phase::report).cpu_s ==
          Approx(0.25 + 2e-6 * cells));
    CHECK(seconds_on_threads(100, 4) == Approx(100 * (0.05 + 0.95 / 4)));
    CHECK(most_bytes_of_surface(area, 0.085) ==
          Approx(std::max(1.5e8 + 6000 * cells + 5e7 + 1800 * cells, 1.6e8 + 6400 * cells)));
    // What is left of a tile waits in few bits: 0.4 million cells.
    CHECK(prediction_bytes(1e6) == Approx(1.5e8 + 6000 * 4e5 + 1500 * 6e5));
    CHECK(most_bytes_of_surface(1e6 * 0.01, 0.1) == Approx(1.6e8 + 6400 * 1e6));
    CHECK(double(bytes_of_voxels(job, body, all_of(body))) ==
          Approx(std::min(double(body.grid.voxels()), 3 * shell)).epsilon(1e-6));
}
