// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole job: what it leaves and says, when it does nothing, and in how many parts it may be made.
#include "small_print.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/models/model_reader.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/print/estimate_job.h"
#include "slicer/print/shard_task.h"
#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;

std::map<std::string, std::uint64_t> voxels_of(const json& resins) {
    std::map<std::string, std::uint64_t> voxels;
    for (const json& resin : resins) voxels[resin.at("role")] = resin.at("voxels");
    return voxels;
}

const json* section_of(const json& report, const std::string& title) {
    for (const json& section : report.at("sections"))
        if (section.at("title") == title) return &section;
    return nullptr;
}

ExitCode refused(PrintDesk& desk, const SliceOptions& options, const std::string& words) {
    try {
        (void)desk.print(options);
    } catch (const Error& error) {
        CHECK_THAT(error.what(), Contains(words));
        return error.exit_code();
    }
    FAIL("not refused: " + words);
    return ExitCode::done;
}

MergeOptions merging(const fs::path& out, bool report = true) {
    MergeOptions options;
    options.out = out;
    options.report = report;
    return options;
}

/// Asks the work to stop after so many predictions of the loop.
class StopsAfter final : public Progress {
public:
    explicit StopsAfter(std::uint64_t predictions) : predictions_(predictions) {}

private:
    void on_stage(std::string_view name, std::uint64_t, std::string_view) override {
        in_loop_ = name == "appearance loop";
    }
    void on_advance(std::uint64_t done) override {
        if (in_loop_ && done == predictions_) cancel();
    }
    std::uint64_t predictions_;
    bool in_loop_ = false;
};

}  // namespace

TEST_CASE("The report of a print says what its layers hold, and the estimate said so before") {
    PrintDesk desk;
    const SliceOptions options = desk.options("out");
    const JobEstimate estimate = estimate_print({options}, desk.said);
    const JobResult result = desk.print(options);
    CHECK(result.exit_code == ExitCode::done);
    CHECK(io::schema_faults("report", result.json) == std::vector<std::string>{});
    const json report = json::parse(result.json);
    CHECK(report == desk.json("out/report.json"));
    CHECK(report.at("title") == "box.obj");
    CHECK(report.at("printer").at("id") == "stratasys-j750-hm");
    CHECK(report.at("pitch_um")[2] == 27);
    CHECK(report.at("warnings").empty());

    const StackVolume stack = read_stack_volume({.stack = desk.path("out").string()}, desk.said);
    const auto [nx, ny, nz] = stack.volume.size();
    std::map<std::string, std::uint64_t> counted;
    for (const optics::Resin& resin : stack.resins.resins) counted[resin.role] = 0;
    std::uint64_t all = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                if (const auto material = stack.volume.at(x, y, z); material != 0)
                    ++counted[stack.resins.resins[std::size_t(material) - 1].role], ++all;
    CHECK(voxels_of(report.at("resins")) == counted);
    CHECK(report.at("size_px") == json({nx, ny}));
    CHECK(report.at("layers") == nz);
    const auto pitch = stack.volume.pitch_mm();
    const double voxel_ml = pitch[0] * pitch[1] * pitch[2] / 1000;
    CHECK(report.at("resin_ml").get<double>() == Approx(double(all) * voxel_ml));
    // The box, within half a voxel on each side.
    CHECK(report.at("resin_ml").get<double>() == Approx(0.009).epsilon(0.02));
    CHECK(report.at("printing").at("passes").get<int>() == nz * report["printing"]["passes_per_layer"].get<int>());

    CHECK(estimate.size_px == std::array<std::uint32_t, 3>{std::uint32_t(nx), std::uint32_t(ny), std::uint32_t(nz)});
    CHECK(estimate.layers == std::uint32_t(nz));
    CHECK(estimate.body_ml == Approx(report["resin_ml"].get<double>()).epsilon(0.02));
    CHECK(estimate.printing.passes == report["printing"]["passes"].get<std::uint64_t>());
    CHECK(estimate.surface_mm2 == Approx(2 * (2 * 3 + 2 * 1.5 + 3 * 1.5)));
    CHECK_FALSE(estimate.loop);
    CHECK_FALSE(estimate.prediction);
    double estimated_ml = 0;
    for (const ResinEstimate& resin : estimate.resins) estimated_ml += resin.ml;
    CHECK(estimated_ml == Approx(estimate.body_ml));
    for (const char* name : {"report.html", "for-customer.html", "job.json", "manifest.json", "target.glb",
                             "predicted.glb", "preview.webp", "preview-target.webp", "printer"})
        CHECK(fs::exists(desk.path(std::string("out/") + name)));
    // What was asked for is as fine as printer and eye are: a label's letters are seen in it.
    const io::ModelFile target = io::read_model(desk.path("out/target.glb"));
    CHECK(double(target.mesh.triangles.size()) > estimate.surface_mm2 / (0.17 * 0.17));
    CHECK_THAT(result.text, Contains(desk.path("out").string()));

    SliceOptions bare = desk.options("bare");
    bare.report = false;
    bare.for_printer = desk.path("usb").string();
    (void)desk.print(bare);
    CHECK(desk.content("bare") == desk.content("out"));
    CHECK(fs::exists(desk.path("bare/report.json")));
    CHECK_FALSE(fs::exists(desk.path("bare/report.html")));
    CHECK(fs::exists(desk.path("usb/HOW-TO-PRINT.html")));
}

TEST_CASE("The same job again does nothing, another asks before it takes the folder") {
    PrintDesk desk;
    SliceOptions options = desk.options("out");
    options.report = false;
    const JobResult first = desk.print(options);
    const auto written = fs::last_write_time(desk.path("out/manifest.json"));
    const std::string content = desk.content("out");
    const JobResult again = desk.print(options);
    CHECK_THAT(again.text, Contains("nothing was done"));
    CHECK(json::parse(again.json) == json::parse(first.json));
    CHECK(fs::last_write_time(desk.path("out/manifest.json")) == written);
    options.for_printer = desk.path("for-printer").string();
    CHECK_THAT(desk.print(options).text, Contains("nothing was done"));
    CHECK(fs::exists(desk.path("for-printer")));
    options.for_printer.clear();

    options.overwrite = true;
    CHECK_THAT(desk.print(options).text, !Contains("nothing was done"));
    CHECK(desk.content("out") == content);
    options.overwrite = false;
    options.depth_mm = 0.5;
    CHECK(refused(desk, options, "--overwrite") == ExitCode::invalid_input);
    CHECK(desk.content("out") == content);
    options.overwrite = true;
    (void)desk.print(options);
    CHECK(desk.content("out") != content);
}

TEST_CASE("A print that is judged bad fails where it is asked to, also when it was done before") {
    PrintDesk desk;
    SliceOptions options = desk.options("out");
    options.predict = "transport";
    options.predict_cell_mm = 0.4;
    options.verdict_good = 0.01, options.verdict_bad = 0.02;
    const JobResult lenient = desk.print(options);
    CHECK(lenient.exit_code == ExitCode::done);
    CHECK(json::parse(lenient.json).at("verdict").at("level") == "bad");
    CHECK(desk.print(options).exit_code == ExitCode::done);
    options.strict = true;
    CHECK(desk.print(options).exit_code == ExitCode::check_failed);
    CHECK_THAT(desk.print(options).text, Contains("nothing was done"));
    options.overwrite = true;
    CHECK(desk.print(options).exit_code == ExitCode::check_failed);
    options.verdict_good = 50, options.verdict_bad = 60;
    const JobResult good = desk.print(options);
    CHECK(good.exit_code == ExitCode::done);
    CHECK(json::parse(good.json).at("verdict").at("level") == "good");
}

TEST_CASE("In shards and merged a print is what it is whole, and says where it was made") {
    PrintDesk desk;
    const JobResult whole = desk.print(desk.options("whole"));
    for (const int n : {1, 3}) {
        CAPTURE(n);
        const std::string out = fmt::format("in{}", n);
        int layers = 0;
        for (int i = n; i >= 1; --i) {
            SliceOptions options = desk.options(out);
            options.shard = fmt::format("{}/{}", i, n);
            const JobResult made = desk.print(options);
            const json record = desk.json(fmt::format("{}/shards/{:04}-of-{:04}.json", out, i, n));
            CHECK(io::schema_faults("shard", record.dump()) == std::vector<std::string>{});
            layers += record.at("layers").get<int>();
            CHECK_THAT(desk.print(options).text, Contains("made already"));
        }
        // Of another job is neither a shard nor a whole print.
        SliceOptions other = desk.options(out);
        other.depth_mm = 0.5;
        CHECK(refused(desk, other, "shards of another job") == ExitCode::invalid_input);
        other.shard = fmt::format("1/{}", n);
        CHECK(refused(desk, other, "shards of another job") == ExitCode::invalid_input);
        const json before = json::parse(whole.json);
        CHECK(layers == before.at("layers"));
        const MergeOptions options = merging(desk.path(out));
        const json merged = json::parse(run_merge(options, desk.said).json);
        CHECK(desk.content(out) == desk.content("whole"));
        CHECK(io::schema_faults("report", merged.dump()) == std::vector<std::string>{});
        for (const char* key : {"title", "pitch_um", "size_px", "layers", "voxels", "resins", "printing", "gamut"})
            CHECK(merged.at(key) == before.at(key));
        CHECK(section_of(before, "Shards") == nullptr);
        REQUIRE(section_of(merged, "Shards"));
        const json rows = section_of(merged, "Shards")->at("tables")[0].at("rows");
        REQUIRE(rows.size() == std::size_t(n));
        CHECK(rows[0][1].get<std::string>().starts_with("0 to "));
        CHECK(rows[std::size_t(n) - 1][1].get<std::string>().ends_with(fmt::format(" to {}", layers - 1)));
        CHECK_THAT(run_merge(options, desk.said).text, Contains("merged already, with its report"));
        CHECK_THAT(run_merge(merging(desk.path(out), false), desk.said).text,
                   Contains("merged already") && !Contains("report"));
    }
    CHECK_THROWS_AS(run_merge(merging(desk.path("nowhere")), desk.said), FileError);
}

TEST_CASE("A task of a scheduler's array is the shard of its place") {
    const PrintDesk desk;
    const auto task = [&](int id, int first, int last, int count) {
        setenv("SLURM_ARRAY_TASK_ID", std::to_string(id).c_str(), 1);
        setenv("SLURM_ARRAY_TASK_MIN", std::to_string(first).c_str(), 1);
        setenv("SLURM_ARRAY_TASK_MAX", std::to_string(last).c_str(), 1);
        setenv("SLURM_ARRAY_TASK_COUNT", std::to_string(count).c_str(), 1);
        const auto clear = [] {
            for (const char* name : {"ID", "MIN", "MAX", "COUNT"})
                unsetenv(fmt::format("SLURM_ARRAY_TASK_{}", name).c_str());
        };
        try {
            const ShardTask made = task_of_scheduler(desk.path("shards"));
            clear();
            return made;
        } catch (...) {
            clear();
            throw;
        }
    };
    for (const int first : {0, 1, 7})
        for (int n = 0; n < 4; ++n) {
            const ShardTask made = task(first + n, first, first + 3, 4);
            CHECK(made.number.shard == std::uint32_t(n + 1));
            CHECK(made.number.of == 4);
            CHECK(made.first_task == std::uint32_t(first));
        }
    CHECK_THROWS_AS(task(9, 3, 9, 4), UsageError);  // tasks 3 and 7 to 9, of nothing that is there
    CHECK_THROWS_AS(task(2, 3, 6, 4), UsageError);  // outside of its array
    CHECK_THROWS_AS(task(7, 3, 6, 4), UsageError);
    CHECK_THROWS_WITH(task_of_scheduler(desk.path("shards")), Contains("SLURM_ARRAY_TASK_ID"));
}

TEST_CASE("The report tells the mesh as it was read and as it is printed") {
    PrintDesk desk;
    {
        // A face is missing, and one is there twice.
        std::ofstream out(desk.path("box.obj"));
        for (int c = 0; c < 8; ++c)
            out << fmt::format("v {} {} {} 0.5 0.4 0.4\n", c & 1 ? 2 : 0, c & 2 ? 2 : 0, c & 4 ? 1 : 0);
        out << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n"
               "f 2 8 6\n";
    }
    const json report = json::parse(desk.print(desk.options("out")).json);
    REQUIRE(section_of(report, "The mesh"));
    std::map<std::string, std::pair<std::string, std::string>> rows;
    for (const json& row : section_of(report, "The mesh")->at("tables")[0].at("rows"))
        rows[row[0]] = {row[1].get<std::string>(), row[2].get<std::string>()};
    CHECK(rows.at("triangles") == std::pair<std::string, std::string>{"12", "12"});
    CHECK(rows.at("doubled faces") == std::pair<std::string, std::string>{"1", "0"});
    CHECK(rows.at("boundary edges").first == "3");
    CHECK(rows.at("boundary edges").second == "0");
    CHECK(rows.at("edges that do not close").second == "0");
    CHECK(rows.at("edges that do not close").first != "0");
    CHECK(rows.at("shells").second == "1");
}

TEST_CASE("A loop that was stopped goes on by itself and ends where it would have") {
    PrintDesk desk;
    SliceOptions options = desk.options("whole");
    options.report = false;
    options.iterations.assign(1, '2');
    const json whole = json::parse(desk.print(options).json);
    REQUIRE(whole.at("loop").at("iterations").size() == 3);
    options.out = desk.path("stopped").string();
    StopsAfter stop(2);
    CHECK_THROWS_AS(run_print({options}, stop), Error);
    CHECK(fs::exists(desk.path("stopped/loop.checkpoint")));
    CHECK_FALSE(fs::exists(desk.path("stopped/manifest.json")));
    SliceOptions other = options;
    other.depth_mm = 0.5;
    (void)refused(desk, other, "--overwrite");
    const json went_on = json::parse(desk.print(options).json);
    CHECK_THAT(desk.said.notes(), Contains("it goes on"));
    CHECK(desk.content("stopped") == desk.content("whole"));
    CHECK_FALSE(fs::exists(desk.path("stopped/loop.checkpoint")));
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(went_on["loop"]["iterations"][k]["seen_de2000"] == whole["loop"]["iterations"][k]["seen_de2000"]);
    CHECK(went_on["loop"]["best"] == whole["loop"]["best"]);
}

TEST_CASE("What a loop came to is kept for another job, and is the same print") {
    PrintDesk desk;
    SliceOptions options = desk.options("whole");
    options.report = false;
    options.iterations.assign(1, '1');
    options.keep_loop = true;
    (void)desk.print(options);
    REQUIRE(fs::exists(desk.path("whole/skin.mixtures")));
    options.keep_loop = false;
    SliceOptions alone = options;
    alone.out = desk.path("alone").string();
    alone.until = "loop";
    (void)desk.print(alone);
    CHECK(fs::exists(desk.path("alone/skin.mixtures")));
    CHECK_FALSE(fs::exists(desk.path("alone/manifest.json")));
    SliceOptions later = options;
    later.out = desk.path("later").string();
    later.mixtures = desk.path("alone/skin.mixtures").string();
    (void)desk.print(later);
    CHECK(desk.content("later") == desk.content("whole"));
    CHECK_FALSE(fs::exists(desk.path("later/skin.mixtures")));
}
