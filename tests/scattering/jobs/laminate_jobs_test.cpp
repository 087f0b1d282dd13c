// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/profiles/layer_sequence_file.h"
#include "io/profiles/profile_file.h"
#include "scattering/design/laminate_search.h"
#include "scattering/jobs/laminate_dataset_job.h"
#include "scattering/jobs/laminate_factor_job.h"
#include "scattering/jobs/laminate_predict_job.h"
#include "scattering/jobs/laminate_print_job.h"
#include "scattering/jobs/laminate_search_job.h"
#include "scattering/jobs/laminate_targets_job.h"
#include "scattering/jobs/profile_plots.h"
#include "slicer/predict/stack_volume.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using io::text_of;

namespace {

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
    return found;
}

// Falls off by 1/e in `width_mm`; of all channels, or of one more or fewer.
io::ProfileFile falling(double R, double T, double width_mm, const optics::Channels& channels = {}) {
    io::ProfileFile file;
    file.name = "falling";
    file.channels = channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        optics::MeasuredProfile profile;
        for (auto* side : {&profile.R, &profile.T}) {
            if (side == &profile.T && T == 0) continue;
            side->spacing_mm = 0.05;
            for (int i = 0; i < 160; ++i) side->light.push_back(std::exp(-0.05 * i / width_mm));
            side->total = side == &profile.R ? R : T;
        }
        if (T > 0) profile.thickness_mm = 0.5;
        file.by_channel.push_back(profile);
    }
    return file;
}

struct Bench {
    io::TemporaryFolder folder;
    [[nodiscard]] std::string put(const std::string& name, const io::ProfileFile& profile) const {
        const auto file = folder.path() / name;
        io::write_whole_file(file, io::profile_text(profile));
        return file.string();
    }
    [[nodiscard]] LaminateSearchJob job(std::vector<std::string> targets, std::vector<std::string> materials) const {
        LaminateSearchJob job;
        job.targets = std::move(targets);
        job.setting.materials = std::move(materials);
        job.setting.coefficients = 16;
        job.out = (folder.path() / "out").string();
        job.overwrite = true;
        job.paths = 1 << 12;
        job.steps = 32;
        job.max_blocks = 4;
        job.rounds = 1;
        return job;
    }
};

struct Warnings final : Progress {
    std::string all;
    void on_warning(const std::string& message) override { all += message + '\n'; }
};

}  // namespace

TEST_CASE("A laminate is predicted, wanted, and found again, from resins and with Monte Carlo beside it", "[slow]") {
    const Bench bench;
    Progress quiet;
    LaminatePredictJob predict;
    predict.laminate = "W 0.5, K 0.3";
    predict.setting.surface = "matched";
    predict.setting.coefficients = 128;
    predict.paths = 1 << 13;
    predict.check = true;
    const std::string target = (bench.folder.path() / "wanted.json").string();
    predict.files = {target, (bench.folder.path() / "wanted.svg").string()};
    const JobResult predicted = run_laminate_predict(predict, quiet);
    CHECK(count(predicted.text, "Monte Carlo") == 3);
    CHECK(count(text_of(bench.folder.path() / "wanted.svg"), "<polyline") >=
          12);  // R and T, two curves, three channels

    LaminateSearchJob job = bench.job({target}, {"W", "K"});
    job.setting.surface = "matched";
    job.layer_mm = 0.027;
    const JobResult found = run_laminate_search(job, quiet);
    CHECK_THAT(found.text, Contains("nodes visited") && Contains("pruned") && Contains("in all directions"));
    const io::LayerSequence sequence = io::read_layer_sequence(bench.folder.path() / "out/wanted.laminate.json");
    CHECK(sequence.surface == "matched");
    REQUIRE(!sequence.layers.empty());  // white on the black backing is all but the same
    CHECK(sequence.layers[0].material == "W");
    CHECK(sequence.layers[0].mm == Approx(0.5).margin(0.06));
    CHECK(std::abs(sequence.layers[0].mm / 0.027 - std::round(sequence.layers[0].mm / 0.027)) < 1e-6);
    CHECK(count(text_of(bench.folder.path() / "out/wanted.svg"), "<polyline") >= 9);
}

TEST_CASE("The same bits for any number of threads, in files and figures", "[slow]") {
    const Bench bench;
    Progress quiet;
    const LaminateSearchJob job =
        bench.job({bench.put("a.json", falling(0.4, 0, 0.5)), bench.put("b.json", falling(0.6, 0, 0.3))}, {"W", "K"});
    std::string one;
    {
        const ThreadLimit limit(1);
        (void)run_laminate_search(job, quiet);
        one = text_of(bench.folder.path() / "out/a.laminate.json") + text_of(bench.folder.path() / "out/b.svg");
    }
    (void)run_laminate_search(job, quiet);
    CHECK(one == text_of(bench.folder.path() / "out/a.laminate.json") + text_of(bench.folder.path() / "out/b.svg"));
}

TEST_CASE("Measured materials are predicted to be what was measured, and are a target like any other") {
    const Bench bench;
    Progress quiet;
    const std::string white = bench.put("white.json", falling(0.6, 0.3, 0.4)),
                      black = bench.put("black.json", falling(0.05, 0.1, 0.2));
    LaminatePredictJob predict;
    predict.laminate = white + " 0.5";
    predict.setting.coefficients = 32;
    CHECK_THAT(run_laminate_predict(predict, quiet).text,
               Contains("surface matched") && Contains("R 0.6000") && Contains("T 0.3000"));
    predict.check = true;
    CHECK_THROWS_WITH(run_laminate_predict(predict, quiet), Contains("--check"));

    // What white reflects by itself is wanted: its R. Spectral channels of other materials do not fit.
    LaminateSearchJob job = bench.job({white}, {white, black});
    CHECK_THAT(run_laminate_search(job, quiet).text,
               Contains("distance 0.000") && Contains("not known to lie outside"));
    const std::string spectral = bench.put("spectral.json", falling(0.5, 0.2, 0.4, {{450, 550}}));
    job = bench.job({white}, {white, spectral});
    CHECK_THROWS_WITH(run_laminate_search(job, quiet), Contains("spectral.json") && Contains("450, 550 nm"));
    job = bench.job({spectral}, {white});
    CHECK_THROWS_WITH(run_laminate_search(job, quiet), Contains("spectral.json") && Contains("channels"));
    job = bench.job({bench.put("t.json", falling(0.5, 0, 0.4, {{450, 550}}))}, {spectral});
    CHECK_THAT(run_laminate_search(job, quiet).text, Contains("450 nm") && Contains("550 nm"));
}

TEST_CASE("Targets that no laminate reaches get the nearest one and the distance to the gamut") {
    const Bench bench;
    Progress quiet;
    // One material, brighter than it can be, and wider.
    LaminateSearchJob job =
        bench.job({bench.put("bright.json", falling(1.0, 0, 0.1)), bench.put("wide.json", falling(0.9, 0, 3))}, {"K"});
    job.rounds = 0;
    job.setting.surface = "matched";
    const JobResult result = run_laminate_search(job, quiet);
    CHECK(count(result.text, "outside of the gamut by at least") == 2);
    CHECK(count(result.text, "K ") >= 1);

    // Every thickness that four blocks of 1, 2, 4, ... steps make, none of them twice: the nearest; and the least and
    // the most that any of them reflects, coefficient by coefficient, between which the gamut lies.
    const LaminateSetting setting(job.setting);
    const auto materials = setting.materials(job.known_mm, job.thickness_mm, {job.paths, job.seed}, quiet);
    const nlohmann::json json = nlohmann::json::parse(result.json);
    for (std::size_t t = 0; t < 2; ++t) {
        const auto wanted = setting.target(io::read_profile(job.targets[t]), job.targets[t], quiet);
        double least = 1e9;
        scattering::ChannelProfiles low, high;
        for (std::uint32_t steps = 0; steps <= job.steps; ++steps) {
            if (std::popcount(steps) > int(job.max_blocks)) continue;
            std::vector<scattering::LaminateLayer> layers;
            if (steps > 0) layers.push_back({0, steps * job.thickness_mm / job.steps});
            const scattering::ChannelProfiles reflected = scattering::laminate_reflection(materials, layers, {});
            least = std::min(least, scattering::profile_distance(reflected, wanted, job.dc_weight));
            if (low.empty()) low = high = reflected;
            for (std::size_t c = 0; c < wanted.size(); ++c)
                for (std::size_t k = 0; k < wanted[c].size(); ++k) {
                    low[c][k] = std::min(low[c][k], reflected[c][k]);
                    high[c][k] = std::max(high[c][k], reflected[c][k]);
                }
        }
        // The nearest that a reflection could be whose coefficients are each one of a laminate's.
        scattering::ChannelProfiles clamped = wanted;
        for (std::size_t c = 0; c < wanted.size(); ++c)
            for (std::size_t k = 0; k < wanted[c].size(); ++k)
                clamped[c][k] = std::clamp(wanted[c][k], low[c][k], high[c][k]);
        const double bound = scattering::profile_distance(clamped, wanted, job.dc_weight);
        CAPTURE(t, least, bound);
        const double outside = json["results"][t]["outside_of_gamut"], distance = json["results"][t]["distance"];
        CHECK(bound > 0.05);
        CHECK(outside == Approx(bound).epsilon(1e-4));  // single precision in its tables
        CHECK(outside <= least + 1e-9);
        CHECK(distance <= least + 1e-5);
    }
}

TEST_CASE("Bad input to the laminate search is refused in one sentence") {
    const Bench bench;
    Progress quiet;
    const std::string target = bench.put("target.json", falling(0.4, 0, 0.5));
    const auto refused = [&](LaminateSearchJob job, const char* word) {
        CHECK_THROWS_WITH(run_laminate_search(job, quiet), Contains(word));
    };
    LaminateSearchJob job = bench.job({target}, {"W", "K"});
    job.thickness_mm = 0;
    refused(job, "--thickness");
    refused(bench.job({target}, {}), "--materials");
    refused(bench.job({target}, {"W", "W"}), "twice");
    refused(bench.job({target}, {"W", "Q"}), "Q");
    refused(bench.job({target}, {"W", target}), "one kind");
    refused(bench.job({target}, {target}), "what is wanted");
    refused(bench.job({}, {"W"}), "no target");
    job = bench.job({target}, {"W"});
    job.clear_top = {"K=0.2mm"};
    refused(job, "--clear-top");
    job.clear_top.clear();
    job.setting.backing = "blue";
    refused(job, "--backing");
    job.setting.backing = "black";
    job.setting.surface = "water";
    refused(job, "--surface");
    job = bench.job({target, bench.put("sub.json", falling(0.4, 0, 0.5))}, {"W"});
    std::filesystem::create_directory(bench.folder.path() / "sub");
    io::write_whole_file(bench.folder.path() / "sub/target.json", text_of(target));
    job.targets.push_back((bench.folder.path() / "sub/target.json").string());
    refused(job, "two targets");

    io::ProfileFile loud = falling(0.4, 0, 0.5);
    for (auto& channel : loud.by_channel) {
        channel.R.total.reset();
        for (double& light : channel.R.light) light *= 50;
    }
    refused(bench.job({bench.put("loud.json", loud)}, {"W"}), "more than it got");
    for (auto& channel : loud.by_channel)
        for (double& light : channel.R.light) light *= -0.01;
    refused(bench.job({bench.put("under.json", loud)}, {"W"}), "less than nothing");

    job = bench.job({target}, {"W"});
    job.rounds = 0;
    (void)run_laminate_search(job, quiet);
    job.overwrite = false;
    refused(job, "--overwrite");

    LaminatePredictJob predict;
    predict.laminate = "W 0";
    CHECK_THROWS_AS(run_laminate_predict(predict, quiet), UsageError);
    predict.laminate = "W 0.1";
    predict.files = {"x.png"};
    CHECK_THROWS_WITH(run_laminate_predict(predict, quiet), Contains("x.png"));
}

TEST_CASE("Targets between two laminates have one albedo and rising width, and are found again") {
    const Bench bench;
    Warnings warnings;
    LaminateTargetsJob job;
    job.narrow = "W 1";
    job.wide = "W 0.2, T 0.5, W 0.3";
    job.setting.resins = "vero-opaque-clear";
    job.setting.coefficients = 32;
    job.setting.reach_mm = 8;
    job.count = 3;
    job.paths = 1 << 12;
    job.out = (bench.folder.path() / "targets").string();
    (void)run_laminate_targets(job, warnings);
    CHECK(warnings.all.empty());
    std::vector<std::vector<double>> totals, widths;
    const optics::HankelGrid grid(8, 32);
    for (int t = 1; t <= 3; ++t) {
        const io::ProfileFile file = io::read_profile(bench.folder.path() / fmt::format("targets/target-{}.json", t));
        CHECK(file.is_target());
        totals.emplace_back(), widths.emplace_back();
        for (const auto& channel : file.by_channel) {
            optics::MeasuredSummary ignored;
            const std::vector<double> R = optics::measured_reflection(channel.R, grid, ignored);
            totals.back().push_back(R[0]);
            widths.back().push_back(optics::radius_of_share(grid, R, 0.8));
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(totals[1][c] == Approx(totals[0][c]).epsilon(1e-3));
        CHECK(totals[2][c] == Approx(totals[0][c]).epsilon(1e-3));
        CHECK(widths[1][c] > 1.02 * widths[0][c]);
        CHECK(widths[2][c] > 1.02 * widths[1][c]);
    }
    CHECK(count(text_of(bench.folder.path() / "targets/targets.svg"), "<polyline") >= 9);
    CHECK_THROWS_WITH(run_laminate_targets(job, warnings), Contains("is there already") && Contains("--overwrite"));
    job.overwrite = true;
    std::swap(job.narrow, job.wide);
    (void)run_laminate_targets(job, warnings);
    CHECK_THAT(warnings.all, Contains("spreads less in W 1 ") && Contains("[narrower-target]"));
    job.wide = "W 0.1, Q 0.1";
    CHECK_THROWS_WITH(run_laminate_targets(job, warnings), Contains("Q"));
    job.wide = "W 0.1";
    job.count = 0;
    CHECK_THROWS_WITH(run_laminate_targets(job, warnings), Contains("--count"));
}

TEST_CASE("Laminates are printed side by side, layer by layer, on their base") {
    const Bench bench;
    Warnings warnings;
    LaminatePrintJob job;
    job.laminates = {"W 0.1, K 0.05", "W 0.3, K 0.004"};
    job.base = "K=0.6mm";
    job.width_mm = 1.016;  // 24 voxels
    job.depth_mm = 0.847;  // 10
    job.gap_mm = 0.5;
    job.out = (bench.folder.path() / "print").string();
    const JobResult result = run_laminate_print(job, warnings);
    CHECK_THAT(result.text, Contains("W 0.108, K 0.054, K 0.594 mm") && Contains("W 0.297, K 0.594 mm"));
    CHECK_THAT(warnings.all,
               Contains("1 of its 2 layers are thinner than half a printed layer") && Contains("[laminate-layers]"));
    StackVolumeOptions options;
    options.stack = job.out;
    Progress quiet;
    const StackVolume print = read_stack_volume(options, quiet);
    CHECK(print.volume.size() == std::array<int, 3>{60, 10, 33});
    const auto role = [&](int x, int z) {
        const optics::Material material = print.volume.at(x, 5, z);
        return material == optics::air ? std::string("air") : print.resins.resins[material - 1u].role;
    };
    for (const auto& [x, white_from, top] : {std::array{5, 24, 28}, std::array{50, 22, 33}})
        for (int z = 0; z < 33; ++z) CHECK(role(x, z) == (z >= top ? "air" : z >= white_from ? "W" : "K"));
    CHECK(role(30, 3) == "air");

    const auto refused = [&](const LaminatePrintJob& wrong, const char* word) {
        CHECK_THROWS_WITH(run_laminate_print(wrong, quiet), Contains(word));
    };
    job.overwrite = true;
    job.laminates = {bench.put("white.json", falling(0.6, 0.3, 0.4)) + " 0.5"};
    refused(job, "white.json");
    job.laminates = {"W 0.3, Q 1"};
    refused(job, "role Q");
    job.laminates = {"W 0.005"};
    refused(job, "thinner than one printed layer");
    job.laminates = {"W 0.3"};
    job.base = "K";
    refused(job, "--base K");
    job.base = "K=0mm";
    refused(job, "thicker than 0");
    job.base.clear();
    job.width_mm = 0;
    refused(job, "--width");
    job.width_mm = 1;
    job.gap_mm = -1;
    refused(job, "--gap");
    job.laminates.clear();
    refused(job, "no laminate");
}

TEST_CASE("Noisy and cut tails are warned of, not hidden") {
    const Bench bench;
    Warnings warnings;
    io::ProfileFile noisy = falling(0.4, 0, 0.5), cut = falling(0.4, 0, 8);
    for (auto& channel : noisy.by_channel)
        for (std::size_t i = 40; i < channel.R.light.size(); ++i) channel.R.light[i] = i % 2 == 0 ? 0.05 : -0.05;
    LaminateSearchJob job = bench.job({bench.put("noisy.json", noisy), bench.put("cut.json", cut)}, {"W"});
    job.rounds = 0;
    (void)run_laminate_search(job, warnings);
    CHECK_THAT(warnings.all, Contains("noisy.json, R, reflection") && Contains("below zero") && Contains("cut.json") &&
                                 Contains("beyond the last sample"));
}

TEST_CASE("Profiles are drawn where they are bright enough, one plot a channel and row") {
    const optics::HankelGrid grid(5, 32);
    std::vector<double> wide(32);
    for (std::size_t i = 0; i < 32; ++i) wide[i] = 0.5 * std::exp(-0.5 * static_cast<double>(i));
    const std::string svg =
        profile_plots(grid, {"R", "G"}, {{"one", {{"wanted", "black", {wide, wide}, false}}}, {"two", {}}}, 4);
    CHECK(count(svg, "<polyline") == 2);
    CHECK(count(svg, ">wanted<") == 2);
    CHECK_THAT(svg, Contains("one, R") && Contains("two, G"));
    CHECK(count(svg, "<svg") == count(svg, "</svg>"));
}

TEST_CASE("A data set and its factors are refused by the name of what is wrong, before anything is traced or read") {
    Progress quiet;
    LaminateDatasetJob dataset;
    dataset.radius = 65;
    CHECK_THROWS_WITH(run_laminate_dataset(dataset, quiet), Contains("radius") && Contains("65"));
    dataset.radius = 10;
    dataset.paths = 0;
    CHECK_THROWS_WITH(run_laminate_dataset(dataset, quiet), Contains("paths"));
    dataset.paths = 1;
    dataset.slab.width = dataset.slab.height = 4096;
    dataset.radius = 64;
    CHECK_THROWS_WITH(run_laminate_dataset(dataset, quiet), Contains("--points"));

    LaminateFactorJob factor;
    factor.out = "map.txt";
    CHECK_THROWS_WITH(run_laminate_factor(factor, quiet), Contains("map.txt") && Contains(".json"));
    factor.out = "map.json";
    factor.map.max_albedo = 1.5;
    CHECK_THROWS_WITH(run_laminate_factor(factor, quiet), Contains("albedo") && Contains("1.5"));
}
