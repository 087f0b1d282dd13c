// SPDX-License-Identifier: GPL-3.0-or-later
//
// Dictionary and fit: profiles of known resins, rendered by another road, come back as these resins.
#include "calibration/edge/edge_fit.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/edge/dictionary_file.h"
#include "calibration/edge/dictionary_job.h"
#include "calibration/rehearsal/edge_simulation_job.h"
#include "calibration/resins/resin_coordinates.h"
#include "io/files/whole_file.h"
#include "optics/edge/edge_scene_paths.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

// Extinctions around the resins of the tests, in even steps.
EdgeGrid small_grid(double from, double to, std::uint32_t paths) {
    EdgeGrid grid;
    for (double s = from; s < to * 1.22; s *= 1.22) grid.sigma_t.push_back(s);
    grid.paths = paths;
    return grid;
}

std::shared_ptr<const EdgeDictionary> traced(const EdgeGrid& grid, const EdgeSetup& setup) {
    EdgeDictionary dictionary{setup, grid, {}};
    for (std::size_t run = 0; run < grid.runs(); ++run) dictionary.records.push_back(edge_record(setup, grid, run));
    return std::make_shared<const EdgeDictionary>(std::move(dictionary));
}

std::vector<std::uint8_t> bytes_of(const std::string& file) { return io::read_whole_file(file, 1u << 28); }

}  // namespace

TEST_CASE("profiles between the records are those of a renderer that knows no records", "[edge]") {
    // The table's own errors beyond its noise (interpolation, cells) are allowed 0.3 % of the brightest value.
    constexpr double allowed = 0.003;
    constexpr int renderings = 8;
    const EdgeSetup setup;
    EdgeGrid grid = small_grid(2, 9, 1u << 17);
    grid.thickness_mm = {0.5};
    EdgeProfileTable table(traced(grid, setup), setup);
    table.prepare(0.4, false);
    int rejected = 0;
    for (const auto& [sigma_t, albedo] : {std::pair{3.3, 0.96}, std::pair{5.7, 0.9987}, std::pair{7.1, 0.4}}) {
        const std::size_t channel = 1;
        std::vector<double> x, sum, squares;
        for (int k = 0; k < renderings; ++k) {
            const optics::EdgeScene scene{setup.assembly,
                                          0.5,
                                          sigma_t,
                                          albedo,
                                          0.4,
                                          setup.sheet(channel),
                                          1u << 15,
                                          77u + static_cast<std::uint64_t>(k)};
            const std::vector<double> rendered = optics::render_edge(scene, 4, 0.1);
            sum.resize(rendered.size()), squares.resize(rendered.size());
            for (std::size_t i = 0; i < rendered.size(); ++i) {
                sum[i] += rendered[i] / renderings, squares[i] += rendered[i] * rendered[i] / renderings;
                if (k == 0) x.push_back(-4 + (static_cast<double>(i) + 0.5) * 0.1);
            }
        }
        const EdgeMedium medium{sigma_t, albedo, 0.4};
        const Eigen::VectorXd seen =
            optics::pixels_from_cells(table.geometry(), x, {0.001, 0, 1}) * table.cells(0, channel, medium);
        const double noise = table.noise(0, medium), top = seen.maxCoeff();
        double worst = 0, worst_of_wrong = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double F = seen[static_cast<Eigen::Index>(i)];
            const double error = std::hypot(
                noise, std::sqrt(std::max(0.0, squares[i] - sum[i] * sum[i]) / (renderings - 1)), allowed * top / 5);
            worst = std::max(worst, std::abs(F - sum[i]) / error);
            worst_of_wrong = std::max(worst_of_wrong, std::abs(1.03 * F - sum[i]) / error);
        }
        INFO("sigma_t " << sigma_t << " albedo " << albedo << ": largest difference " << worst << " errors");
        CHECK(worst < 5);
        rejected += worst_of_wrong > 5;
    }
    CHECK(rejected >= 2);
}

TEST_CASE("resins come back from their profiles, with what the bench does wrong", "[edge]") {
    // Three of Vero's, off the grid, on a bench that differs from the setup that is assumed.
    optics::ResinSet set = optics::vero_opaque().subset(std::vector<std::string>{"M", "K", "W"});
    EdgeSetup bench;
    bench.assembly.gel_above_mm = 0.045;
    bench.assembly.gel_below_mm = 0.015;
    bench.blur_mm = 0.0276;
    EdgeSetup setup;
    setup.blur_mm = 0.0276;
    EdgeBench faults;
    faults.bias = 0.913;
    faults.thickness_off = 0.02;
    faults.paths = 1u << 17;
    const auto profiles = simulate_edge_profiles(set, bench, {0.5, 1}, faults);
    EdgeProfileTable table(traced(small_grid(1.7, 26, 1u << 16), setup), setup);
    EdgeFitOptions options;
    options.name = "test";
    const EdgeFit fit = fit_edges(profiles, table, options);
    INFO("mu " << fit.mu << " +- " << fit.mu_error);
    CHECK(fit.mu == Approx(0.913).margin(0.012));
    int values = 0, within_one = 0, within_two = 0, close = 0;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            const EdgeValue& v = fit.resins[r].channel[c];
            const double sigma_t = set.resins[r].sigma_t_per_mm[c], albedo = set.resins[r].albedo[c];
            if (!v.told) continue;
            INFO(set.resins[r].role << " " << c << ": " << v.sigma_t.value << " +- " << v.sigma_t.standard_error
                                    << " for " << sigma_t << ", albedo " << v.albedo.value << " for " << albedo);
            const double ln_error = std::sqrt(v.covariance(1, 1)),
                         ln_off = std::abs(std::log(v.sigma_t.value / sigma_t));
            CHECK(ln_off < 2.5 * ln_error);
            if (ln_error < 0.03) CHECK(ln_off < 0.05);
            close += ln_off < 0.05;
            // White's 1 - albedo, 0.0003, needs its level within 0.1 %: it is held to its error instead.
            const double v_error = std::sqrt(v.covariance(0, 0));
            const double off = std::abs(v_of_albedo(v.albedo.value, 0.4) - v_of_albedo(albedo, 0.4));
            CHECK((std::abs((1 - v.albedo.value) / (1 - albedo) - 1) < 0.12 || off < 2.5 * v_error));
            CHECK(v_error < 0.03);
            const double z = ln_off / ln_error;
            within_one += z < 1, within_two += z < 2;
            ++values;
        }
    CHECK(values >= 6);
    INFO(within_one << " and " << within_two << " of " << values << " extinctions within one and two errors");
    CHECK(within_two >= values - 1);
    CHECK(close >= values - 2);
    // Errors that are not so large that all is within them.
    for (const EdgeResinFit& resin : fit.resins)
        if (resin.role == "W")
            for (const EdgeValue& v : resin.channel) CHECK(v.sigma_t.standard_error / v.sigma_t.value < 0.1);
}

TEST_CASE("a fit refuses what it cannot use", "[edge]") {
    // Made once for all sections.
    static const EdgeSetup setup;
    static const auto dictionary = traced(small_grid(2, 12, 8192), setup);
    static const auto profiles = [] {
        EdgeBench faults;
        faults.paths = 16384;
        return simulate_edge_profiles(optics::vero_opaque().subset(std::vector<std::string>{"M", "K"}), setup, {0.5, 1},
                                      faults);
    }();
    EdgeProfileTable table(dictionary, setup);
    EdgeFitOptions options;
    SECTION("one resin") {
        const std::vector<EdgeProfile> one(profiles.begin(), profiles.begin() + 2);
        CHECK_THROWS_WITH(fit_edges(one, table, options), Contains("at least two"));
    }
    SECTION("a thickness that the dictionary does not have") {
        auto thick = profiles;
        thick[0].thickness_mm = 0.7;
        CHECK_THROWS_WITH(fit_edges(thick, table, options), Contains("0.7 mm") && Contains("make a dictionary"));
    }
    SECTION("one slab a resin is used, and said") {
        const std::vector<EdgeProfile> single{profiles[0], profiles[2]};
        CHECK_THAT(fit_edges(single, table, options).warnings.at(0),
                   Contains("one thickness only") && Contains("[one-slab]"));
    }
    SECTION("a channel that is clipped in one slab is told, in all slabs refused") {
        auto clipped = profiles;
        clipped[0].value[0][100] = std::nan("");
        CHECK_THAT(fit_edges(clipped, table, options).warnings.at(0),
                   Contains("M of 0.5 mm, R: 1 samples are not known"));
        for (EdgeProfile& p : clipped) p.value[0][100] = std::nan("");
        CHECK_THROWS_WITH(fit_edges(clipped, table, options), Contains("nothing is clipped"));
    }
    SECTION("every channel clipped in every slab") {
        auto clipped = profiles;
        for (EdgeProfile& p : clipped)
            for (auto& channel : p.value) channel[100] = std::nan("");
        CHECK_THROWS_WITH(fit_edges(clipped, table, options), Contains("nothing is clipped"));
    }
    SECTION("a dictionary of another setup, or one that is not whole") {
        EdgeSetup other;
        other.assembly.glass = false;
        CHECK_THROWS_WITH(EdgeProfileTable(dictionary, other), Contains("another setup"));
        EdgeDictionary shard = *dictionary;
        shard.records[1] = {};
        CHECK_THROWS_WITH(EdgeProfileTable(std::make_shared<const EdgeDictionary>(shard), setup),
                          Contains("lacks 1 of"));
    }
    SECTION("slabs of two resins that were swapped are told") {
        auto swapped = profiles;
        std::swap(swapped[0].resin, swapped[2].resin);
        const EdgeFit fit = fit_edges(swapped, table, options);
        REQUIRE_FALSE(fit.warnings.empty());
        CHECK_THAT(fit.warnings[0], Contains("no resin has these profiles") && Contains("[misfit]"));
        for (const std::string& warning : fit_edges(profiles, table, options).warnings)
            CHECK_THAT(warning, !Contains("no resin has these profiles"));
    }
    SECTION("a g that the dictionary does not have") {
        options.g = 0.6;
        CHECK_THROWS_WITH(fit_edges(profiles, table, options), Contains("outside the dictionary"));
        options.anisotropy = EdgeAnisotropy::shared;
        CHECK_THROWS_WITH(fit_edges(profiles, table, options), Contains("at least three"));
    }
    SECTION("mu at the end of its range") {
        options.mu_from = 1.02;
        options.mu_to = 1.05;
        CHECK_THAT(fit_edges(profiles, table, options).warnings.back(),
                   Contains("end of its range") && Contains("[bias]"));
    }
}

TEST_CASE("a dictionary goes on where it was stopped, and shards make the same file", "[edge]") {
    Progress progress;
    // Traced once for all sections.
    static const io::TemporaryFolder folder;
    static const DictionaryJob job = [&] {
        DictionaryJob traced;
        traced.grid.sigma_t = {2, 4, 8};
        traced.grid.thickness_mm = {0.5};
        traced.grid.g = {0.2, 0.4};
        traced.grid.paths = 2048;
        traced.out = folder.path() / "whole.dict";
        static_cast<void>(run_dictionary_job(traced, progress));
        return traced;
    }();
    const auto whole = bytes_of(job.out);
    CHECK(missing_runs(read_dictionary(job.out)).empty());
    CHECK_FALSE(fs::exists(job.out + ".partial"));

    SECTION("stopped in the middle of a record") {
        DictionaryJob again = job;
        again.out = folder.path() / "again.dict";
        io::write_whole_file(again.out + ".partial", std::span(whole).first(whole.size() / 2));
        const JobResult result = run_dictionary_job(again, progress);
        CHECK(bytes_of(again.out) == whole);
        CHECK_THAT(result.json, !Contains("\"traced\":6,"));
    }
    SECTION("runs of another grid are kept until they may be replaced") {
        DictionaryJob other = job;
        other.grid.sigma_t = {3};
        other.grid.g = {0.2};
        other.out = folder.path() / "other.dict";
        const std::string left = other.out + ".partial";
        io::write_whole_file(left, std::span(whole).first(whole.size() / 2));
        const auto before = bytes_of(left);
        CHECK_THROWS_WITH(run_dictionary_job(other, progress), Contains("other.dict.partial") &&
                                                                   Contains("another grid or setup") &&
                                                                   Contains("--overwrite"));
        CHECK(bytes_of(left) == before);
        class Warnings final : public Progress {
        public:
            std::string all;

        private:
            void on_warning(const std::string& message) override { all += message; }
        } warnings;
        other.overwrite = true;
        static_cast<void>(run_dictionary_job(other, warnings));
        CHECK_THAT(warnings.all, Contains("its runs are replaced") && Contains("[other-grid]"));
        CHECK(missing_runs(read_dictionary(other.out)).empty());
        CHECK_FALSE(fs::exists(left));
    }
    SECTION("in shards") {
        DictionaryJob part = job;
        part.shards = 2;
        DictionaryJob join = job;
        join.out = folder.path() / "joined.dict";
        for (part.shard = 1; part.shard <= 2; ++part.shard) {
            part.out = folder.path() / fmt::format("part{}.dict", part.shard);
            static_cast<void>(run_dictionary_job(part, progress));
            CHECK(missing_runs(read_dictionary(part.out)).size() == 3);
            join.merge.push_back(part.out);
        }
        static_cast<void>(run_dictionary_job(join, progress));
        CHECK(bytes_of(join.out) == whole);
    }
    SECTION("what was written is what was traced, but for rounding") {
        const EdgeDictionary read = read_dictionary(job.out);
        const EdgeRecord fresh = edge_record(EdgeSetup(), job.grid, 4);
        for (std::size_t k = 0; k < albedo_nodes; ++k) {
            const optics::EdgeKernels &a = read.records[4].kernels[k], &b = fresh.kernels[k];
            CHECK(a.from_camera == Approx(b.from_camera).epsilon(1e-6).margin(1e-12));
            CHECK((a.P - b.P).cwiseAbs().maxCoeff() <= 1e-5 * b.P.maxCoeff());
            CHECK((a.K - b.K).cwiseAbs().maxCoeff() <= 1e-5 * b.K.maxCoeff() + 1e-300);
        }
    }
    SECTION("a damaged file is refused at every byte that is cut off, and where a bit turned") {
        for (std::size_t size = 0; size < whole.size(); size += size < 2000 ? 37 : 997) {
            io::write_whole_file(folder.path() / "cut.dict", std::span(whole).first(size));
            bool seems_whole = false;
            try {
                seems_whole = missing_runs(read_dictionary(folder.path() / "cut.dict")).empty();
            } catch (const InputError&) {
            }
            CHECK_FALSE(seems_whole);
        }
        auto turned = whole;
        turned[turned.size() - 100] ^= 4;
        io::write_whole_file(folder.path() / "turned.dict", turned);
        CHECK_THROWS_WITH(read_dictionary(folder.path() / "turned.dict"), Contains("checksum"));
    }
}
