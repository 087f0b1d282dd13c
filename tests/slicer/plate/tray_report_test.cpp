// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a tray's report says of its parts, whose own reports are put down by hand.
#include "slicer/plate/tray_report.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tray_desk.h"

using namespace voxtone;
using namespace voxtone::slicer;
using nlohmann::json;

namespace {

/// Two parts: two copies of "fox", and "cow" on them or beside.
struct ToldTray {
    ToldTray() {
        desk.write("fox.obj", test::soft_box({0, 0, 0}, {3, 2, 1.5}));
        desk.write("cow.obj", test::soft_box({0, 0, 0}, {2, 2, 1}));
        placed = desk.place(desk.open(R"({"model": "fox.obj", "name": "fox", "copies": 2},
                                         {"model": "cow.obj", "name": "cow"})"));
        for (ReadyPart& part : placed.prepared.parts.ready) {
            part.alone.clear();
            for (int n = 0; n < part.part.copies; ++n)
                part.alone.push_back({{part.part.name == "fox" ? 100 * n : 300, 20, 0}, 0});
        }
        grid = {Eigen::Vector3d::Zero(), {0.05, 0.1, 0.02}, {400, 100, 75}};
        stack.pitch_um = {50, 100, 20}, stack.size_px = {400, 100}, stack.layers = 75;
        stack.resins = {{"MakersWhite", "W", {4, 5, 6}, 300, 0.75}};
        own[0].resins.resize(2), own[0].resins[0].ml = 0.25, own[0].resins[1].ml = 0.5;
        own[0].verdict.emplace().level = io::VerdictLevel::good;
        own[0].verdict->headline = "On the whole good, 1.2", own[0].verdict->seen_mean = 1.2;
        own[0].printing.support_ml = 0.125;
        own[1].verdict.emplace().level = io::VerdictLevel::bad;
        own[1].verdict->headline = "On the whole bad, 6", own[1].verdict->but = "Worst: red is blue.";
        own[1].verdict->regions.emplace_back().good = false;
        own[1].verdict->regions[0].place = "upper left", own[1].verdict->regions[0].from = "from above";
        own[1].printing.support_ml = 0.5;
        own[1].warnings = {"its own [fragile]"};
    }
    [[nodiscard]] ReadyPart& part(std::size_t n) { return placed.prepared.parts.ready[n]; }
    /// report.json of the tray.
    [[nodiscard]] json written(int number = 0, std::vector<FailedPart> failed = {}) {
        TrayReport report(3, "tray-1", false);
        for (std::size_t n = 0; n < 2; ++n) report.add(part(n), own[n], progress);
        LayerWatchers nobody;
        report.write({desk.folder.path(), number, part(0).ready->job, stack, grid, {"of the tray"}, std::move(failed)},
                     nobody, 12.5, progress);
        std::ifstream in(desk.folder.path() / "report.json");
        return json::parse(in);
    }
    test::TrayDesk desk;
    test::PlacedTray placed;
    VoxelGrid grid;
    io::StackDescription stack;
    std::array<io::Report, 2> own;
    test::SaidProgress progress;
};

ToldTray& told() {
    static ToldTray one;
    return one;
}

}  // namespace

TEST_CASE("A tray is told with its size, resins and verdict, and warnings of parts by their names") {
    const json report = told().written();
    INFO(report.dump(1));
    CHECK(report.at("seconds") == 12.5);
    CHECK(report.at("size_mm") == json{20.0, 10.0, 1.5});
    CHECK(report.at("pitch_um") == json{50, 100, 20});
    CHECK((report.at("size_px") == json{400, 100} && report.at("layers") == 75 && report.at("voxels") == 300));
    CHECK(report.at("resins")[0].at("ml") == 0.75);
    CHECK(report.at("printer").at("id") == told().part(0).ready->job.printer.id);
    const std::string warnings = report.at("warnings").dump();
    CHECK_THAT(warnings, Catch::Matchers::Contains("cow: its own [fragile]"));
    CHECK_THAT(warnings, Catch::Matchers::Contains("of the tray"));
    CHECK(report.at("verdict").at("headline") == "1 of 2 bodies will not look as asked");
}

TEST_CASE("Support of a tray is that of its copies, unless one stands above others or nobody knows its own") {
    CHECK(told().written().at("support_ml").get<double>() == Approx(2 * 0.125 + 0.5));
    told().part(1).alone[0].at[2] = 5;
    CHECK_FALSE(told().written().contains("support_ml"));
    told().part(1).alone[0].at[2] = 0;
    told().own[0].printing.support_ml.reset();
    CHECK_FALSE(told().written().contains("support_ml"));
    told().own[0].printing.support_ml = 0.125;
}

TEST_CASE("A second tray tells what stands on it") {
    told().part(0).alone[1].tray = 1;
    const json first = told().written(0), second = told().written(1);
    told().part(0).alone[1].tray = 0;
    CHECK(first.at("support_ml").get<double>() == Approx(0.125 + 0.5));
    CHECK(first.at("verdict").at("headline") == "1 of 2 bodies will not look as asked");
    CHECK(second.at("support_ml").get<double>() == Approx(0.125));
    CHECK(second.at("verdict").at("headline") == "It will look as asked");
}

TEST_CASE("What is not on the tray is told before all else") {
    const json report =
        told().written(0, {{"hen", "it is empty", ExitCode::invalid_input, "Klein"}, {"ox", "too large"}});
    CHECK(report.at("verdict").at("headline") ==
          "Not on the tray: hen (for Klein), ox. 1 of 2 bodies will not look as asked");
    CHECK(report.at("verdict").at("level") == "bad");
    const std::string warnings = report.at("warnings").dump();
    CHECK_THAT(warnings, Catch::Matchers::Contains("hen (for Klein) is not on the tray: it is empty [part-failed]"));
    CHECK_THAT(warnings, Catch::Matchers::Contains("ox is not on the tray: too large [part-failed]"));
}

TEST_CASE("The page's room is shared out among copies, and each has some") {
    CHECK(TrayReport(1, "", false).surface_share() == 3'600'000);
    CHECK(TrayReport(100, "", false).surface_share() == 36'000);
    CHECK(TrayReport(0, "", false).surface_share() == 3'600'000);
    CHECK(TrayReport(1000, "", false).surface_share() == 12'000);
}
