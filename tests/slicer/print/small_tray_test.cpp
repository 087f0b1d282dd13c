// SPDX-License-Identifier: GPL-3.0-or-later
//
// A whole tray: where its parts lie, what its layers hold and what is told of it.
#include <array>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/stopwatch.h"
#include "io/disk/disk_space.h"
#include "io/files/read_bytes.h"
#include "io/printer/printer_folder.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/print/estimate_job.h"
#include "small_print.h"
#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;

struct TraysDesk : PrintDesk {
    TraysDesk() { write_box("small.obj", {1, 1.2, 1}); }

    [[nodiscard]] SliceOptions of_tray(const std::string& out) const {
        SliceOptions options = this->options(out);
        options.model.clear();
        return options;
    }
    StackVolume volume(const std::string& out) { return read_stack_volume({.stack = path(out).string()}, said); }
};

/// Whether a box of a stack is solid where another stack is, which it is as large as. Dots lie as the tray's screen
/// has them.
bool holds(const StackVolume& tray, const StackVolume& part, const std::array<int, 3>& at) {
    const auto [nx, ny, nz] = part.volume.size();
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                if ((tray.volume.at(x + at[0], y + at[1], z + at[2]) == 0) != (part.volume.at(x, y, z) == 0))
                    return false;
    return true;
}

std::uint64_t solid_voxels(const StackVolume& stack) {
    const auto [nx, ny, nz] = stack.volume.size();
    return std::uint64_t(nx) * std::uint64_t(ny) * std::uint64_t(nz) - stack.volume.count()[0];
}

}  // namespace

TEST_CASE("Each part of a tray is printed as it would be alone, where the tray says, and nothing else is") {
    TraysDesk desk;
    SliceOptions alone = desk.options("alone");
    alone.report = false;
    (void)desk.print(alone);
    const StackVolume part = desk.volume("alone");
    const JobResult result = desk.tray(desk.of_tray("out"), {"box.obj"}, 3);
    CHECK(result.exit_code == ExitCode::done);
    CHECK(io::schema_faults("tray-stack", result.json) == std::vector<std::string>{});
    const json says = json::parse(result.json);
    CHECK(says == desk.json("out/tray.json"));
    CHECK(says.at("content_sha256") == desk.content("out"));
    CHECK((says.at("tray") == 1 && says.at("trays") == 1));
    CHECK(says.at("failed").empty());
    REQUIRE(says.at("parts").size() == 1);
    const json& of = says["parts"][0];
    CHECK(of.at("name") == "box");
    REQUIRE(of.at("at_px").size() == 3);
    const StackVolume tray = desk.volume("out");
    CHECK(solid_voxels(tray) == 3 * solid_voxels(part));
    for (const json& at : of["at_px"]) CHECK(holds(tray, part, at.get<std::array<int, 3>>()));
    // 2 mm between neighbours.
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const auto a = of["at_mm"][i].get<std::array<double, 3>>(), b = of["at_mm"][j].get<std::array<double, 3>>();
            CHECK((std::abs(a[0] - b[0]) > 2 + 1.95 || std::abs(a[1] - b[1]) > 3 + 1.95));
        }
    // Within the screen's noise as much of each resin.
    const auto counts = tray.volume.count(), of_one = part.volume.count();
    for (std::size_t m = 1; m < of_one.size(); ++m)
        CHECK(double(counts[m]) == Approx(3.0 * double(of_one[m])).epsilon(0.01).margin(200));
    const json report = desk.json("out/report.json");
    CHECK(io::schema_faults("report", report.dump()) == std::vector<std::string>{});
    CHECK(report.at("layers") == 56);
    std::uint64_t voxels = 0;
    for (const json& resin : report.at("resins")) voxels += resin.at("voxels").get<std::uint64_t>();
    CHECK(voxels == solid_voxels(tray));
    const json manifest = desk.json("out/manifest.json");
    CHECK(manifest.dump().find("\"box\"") != std::string::npos);
    for (const char* name : {"tray.png", "report.html", "parts/box/report.html", "job.json"})
        CHECK(fs::exists(desk.path(std::string("out/") + name)));
    CHECK_THAT(result.text, Contains(desk.path("out").string()));
    const JobResult again = desk.tray(desk.of_tray("out"), {"box.obj"}, 3);
    CHECK_THAT(again.text, Contains("holds this tray already"));
    CHECK(json::parse(again.json) == says);
}

TEST_CASE("A tray's page has the warnings of its parts, and the places that their own verdicts name", "[slow]") {
    TraysDesk desk;
    SliceOptions options = desk.of_tray("out");
    options.predict = "transport";
    (void)desk.tray(options, {"small.obj", "box.obj"});
    const std::string page = io::read_text(desk.path("out/report.html"), 1 << 26);
    CHECK_THAT(page, Contains("small: the print is only 1.2 mm large") && !Contains("box: the print is only"));
    for (const std::string name : {"small", "box"}) {
        const json verdict = desk.json("out/parts/" + name + "/report.json").at("verdict");
        REQUIRE(verdict.contains("worst"));
        const auto place = verdict.at("regions").at(0).at("place").get<std::string>();
        CHECK_THAT(verdict.at("worst").get<std::string>(), Contains(place));
        CHECK_THAT(page, Contains("disabled>" + place));
    }
}

TEST_CASE("A tray of one part has the layers of the part, each once") {
    TraysDesk desk;
    SliceOptions alone = desk.options("alone"), one = desk.of_tray("one");
    alone.report = false;
    (void)desk.print(alone);
    const json says = json::parse(desk.tray(one, {"box.obj"}).json);
    CHECK(says.at("layers") == 56);
    // Its report is the body's.
    const json report = desk.json("one/report.json");
    CHECK(report.at("title") == "box.obj");
    CHECK(report.at("gamut").at("de2000").contains("mean"));
    CHECK_FALSE(report.at("sections").empty());
    CHECK(desk.content("one") == desk.content("alone"));
}

TEST_CASE("A tray's page tells of components, and of bodies that had no room in memory beside the others") {
    TraysDesk desk;
    std::ofstream(desk.path("tray.json")) << R"({"format": "voxtone-tray", "version": 1, "parts": [
        {"model": "box.obj"}, {"model": "small.obj"}, {"box": [1, 1, 1.5], "resin": "W", "name": "spacer-17"}]})";
    SliceOptions options = desk.of_tray("out");
    options.model = desk.path("tray.json").string();
    options.memory_gib = 0.02;  // half of it holds one page's pictures, of 16 MB
    CHECK(desk.print(options).exit_code == ExitCode::done);
    const auto body_mm3 = [&](const char* part) {
        std::uint64_t voxels = 0;
        const json report = desk.json(fmt::format("out/parts/{}/report.json", part));
        for (const json& resin : report.at("resins")) voxels += resin.at("voxels").get<std::uint64_t>();
        const auto um = report.at("pitch_um").get<std::array<double, 3>>();
        return double(voxels) * um[0] * um[1] * um[2] * 1e-9;
    };
    CHECK(body_mm3("box") == Approx(2 * 3 * 1.5).epsilon(0.05));
    CHECK(body_mm3("small") == Approx(1 * 1.2 * 1).epsilon(0.05));
    // What its layers took was measured when they were made again.
    double layers_s = 0;
    const json small = desk.json("out/parts/small/report.json");
    for (const json& stage : small.at("stages"))
        if (stage.at("name") == std::string(name_of(Phase::layers))) layers_s += stage.at("seconds").get<double>();
    CHECK(layers_s > 0);
    CHECK_THAT(io::text_of(desk.path("out/report.html")), Contains("spacer-17"));
}

TEST_CASE("Parts that a tray has no more are set aside, and another tray asks before it takes the folder") {
    TraysDesk desk;
    SliceOptions options = desk.of_tray("out");
    (void)desk.tray(options, {"box.obj", "small.obj"});
    const json both = desk.json("out/tray.json");
    CHECK(both.at("parts").size() == 2);
    CHECK_THROWS_WITH(desk.tray(options, {"small.obj"}), Contains("--overwrite"));
    CHECK(desk.json("out/tray.json") == both);
    options.overwrite = true;
    (void)desk.tray(options, {"small.obj"});
    CHECK(desk.json("out/tray.json").at("parts").size() == 1);
    CHECK(fs::exists(desk.path("out/parts/small")));
    CHECK_FALSE(fs::exists(desk.path("out/parts/box")));
    CHECK(fs::exists(desk.path("out/parts/earlier/box/report.html")));
    CHECK_THAT(desk.said.notes(), Contains("box: of an earlier tray, and set aside"));
}

TEST_CASE(
    "A part that cannot be made is told, and the others are printed all the same, or nothing where that is asked") {
    TraysDesk desk;
    std::ofstream(desk.path("broken.obj")) << "v 0 0 0\nf 1 2 3\n";
    SliceOptions options = desk.of_tray("out");
    options.report = false;
    const JobResult result = desk.tray(options, {"small.obj", "broken.obj"});
    CHECK(result.exit_code != ExitCode::done);
    const json says = json::parse(result.json);
    CHECK(io::schema_faults("tray-stack", result.json) == std::vector<std::string>{});
    REQUIRE(says.at("parts").size() == 1);
    CHECK(says["parts"][0].at("name") == "small");
    REQUIRE(says.at("failed").size() == 1);
    CHECK(says["failed"][0].at("name") == "broken");
    // It is tried again: a tray of which something failed is not done.
    CHECK_THAT(desk.tray(options, {"small.obj", "broken.obj"}).text, !Contains("already"));
    options.out = desk.path("strict").string();
    options.fail_fast = true;
    CHECK_THROWS_AS(desk.tray(options, {"small.obj", "broken.obj"}), Error);
    CHECK_FALSE(fs::exists(desk.path("strict/manifest.json")));
}

TEST_CASE("A tray in shards and merged is what it is whole") {
    TraysDesk desk;
    SliceOptions whole = desk.of_tray("whole");
    whole.report = false;
    (void)desk.tray(whole, {"box.obj", "small.obj"});
    for (const int i : {2, 1}) {
        SliceOptions options = desk.of_tray("parts");
        options.report = false;
        options.shard = fmt::format("{}/2", i);
        (void)desk.tray(options, {"box.obj", "small.obj"});
    }
    MergeOptions merging;
    merging.out = desk.path("parts");
    const JobResult merged = run_merge(merging, desk.said);
    CHECK(desk.content("parts") == desk.content("whole"));
    json mine = desk.json("parts/tray.json"), wanted = desk.json("whole/tray.json");
    CHECK(mine.at("parts") == wanted.at("parts"));
    CHECK_THAT(run_merge(merging, desk.said).text, Contains("merged already"));
}

TEST_CASE("A tray's estimate is what its stack comes to") {
    TraysDesk desk;
    PrintRequest request{
        desk.of_tray("out"), {{desk.path("box.obj").string(), desk.path("small.obj").string()}, 2}, true};
    const JobEstimate estimate = estimate_print(request, desk.said);
    request.options.report = false;
    (void)run_print(request, desk.said);
    const json manifest = desk.json("out/manifest.json");
    CHECK(estimate.size_px[2] == manifest.at("layers").get<std::uint32_t>());
    CHECK(estimate.size_px[0] == manifest.at("size_px")[0].get<std::uint32_t>());
    CHECK(estimate.size_px[1] == manifest.at("size_px")[1].get<std::uint32_t>());
    double ml = 0;
    for (const json& resin : manifest.at("resins")) ml += resin.at("ml").get<double>();
    CHECK(estimate.body_ml == Approx(ml).epsilon(0.03));
    CHECK(estimate.body_ml == Approx(2 * (2 * 3 * 1.5 + 1 * 1.2 * 1) / 1000).epsilon(0.05));
    double sum = 0;
    for (const ResinEstimate& resin : estimate.resins) sum += resin.ml;
    CHECK(sum == Approx(estimate.body_ml).epsilon(1e-6));
    CHECK(estimate.layer_um == Approx(27));
    // What its parts take is added up, phase by phase.
    const JobEstimate box = estimate_print({desk.options("one")}, desk.said);
    const auto cpu_of = [](const JobEstimate& of, Phase phase) {
        double cpu_s = 0;
        for (const PhaseEstimate& one : of.phases)
            if (one.phase == phase) cpu_s += one.cpu_s;
        return cpu_s;
    };
    CHECK(cpu_of(estimate, Phase::separate) == Approx(2 * cpu_of(box, Phase::separate)));
    CHECK(cpu_of(estimate, Phase::layers) > cpu_of(box, Phase::layers));
    CHECK_FALSE(fs::exists(desk.path("out/parts/none")));
}

TEST_CASE("A tray says what it takes of the disk before its layers are made, and so does a shard of it") {
    for (const char* shard : {"", "1/1"}) {
        TraysDesk desk;
        SliceOptions options = desk.of_tray("out");
        const std::vector<std::string> models{desk.path("box.obj").string()};
        const JobEstimate estimate = estimate_print({options, {models, 3}, true}, desk.said);
        CHECK_THAT(desk.said.said(), !Contains("has free"));
        // Its report is of a part, and not of each copy.
        const std::uint64_t one = estimate_print({options, {models, 1}, true}, desk.said).disk_bytes;
        CHECK((estimate.disk_bytes > one && estimate.disk_bytes - one < 1'000'000));
        CHECK(one > 6'000'000);
        options.shard = shard;
        (void)desk.tray(options, {"box.obj"}, 3);
        // Beside OUT/printer there are no copies, for the folder's disk has hard links.
        REQUIRE(io::has_hard_links(desk.path("out")));
        CHECK_THAT(desk.said.said(),
                   Contains("the stack takes up to " + io::bytes_text(estimate.disk_bytes) + " of the"));
    }
}

TEST_CASE("The seconds that a tray's layers took are shared out to its parts") {
    class Clock final : public Progress {
    public:
        double until_last_layer_s = 0, until_next_stage_s = 0;

    private:
        void on_stage(std::string_view name, std::uint64_t, std::string_view) override {
            if (in_layers_) until_next_stage_s = since_.total();
            in_layers_ = name == name_of(Phase::layers) && until_next_stage_s == 0;
            if (in_layers_) since_ = Stopwatch();
        }
        void on_advance(std::uint64_t) override {
            if (in_layers_) until_last_layer_s = since_.total();
        }
        bool in_layers_ = false;
        Stopwatch since_;
    } clock;
    TraysDesk desk;
    const SliceOptions options = desk.of_tray("out");
    (void)run_print({options, {{desk.path("box.obj").string(), desk.path("small.obj").string()}, 1}, true}, clock);
    double sum = 0;
    for (const char* part : {"box", "small"}) {
        const json report = desk.json(fmt::format("out/parts/{}/report.json", part));
        for (const json& stage : report.at("stages"))
            if (stage.at("name").get<std::string>() == name_of(Phase::layers)) sum += stage.at("seconds").get<double>();
    }
    REQUIRE(clock.until_last_layer_s > 0);
    // Their clock begins a little before the stage is told, and ends before the next is.
    CHECK(sum > clock.until_last_layer_s / 2);
    CHECK(sum < 2 * clock.until_next_stage_s);
}
