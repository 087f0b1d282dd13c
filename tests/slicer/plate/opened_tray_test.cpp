// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/opened_tray.h"

#include <algorithm>
#include <filesystem>

#include <catch2/catch.hpp>

#include "tests/slicer/plate/common_job.h"
#include "tests/slicer/plate/tray_desk.h"
#include "tests/slicer/plate/written_stack.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

/// Models of whole voxels of the usual printer: cells of the nesting and voxels are told apart by them.
std::string voxel_box(std::array<int, 3> low, std::array<int, 3> high, int first_vertex = 1) {
    constexpr std::array pitch_mm{25.4 / 600, 25.4 / 300, 0.027}, corner_mm{7.0, -3.0, 2.0};
    std::array<double, 3> a{}, b{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        a[axis] = corner_mm[axis] + pitch_mm[axis] * low[axis], b[axis] = corner_mm[axis] + pitch_mm[axis] * high[axis];
    return soft_box(a, b, first_vertex);
}

/// Two boxes, one of them twice as large.
struct Models : TrayDesk {
    Models() {
        write("large.obj", soft_box({0, 0, 0}, {3, 2, 1.5}));
        write("small.obj", soft_box({0, 0, 0}, {2, 1.5, 1}));
    }
};

std::string all_of(const std::vector<std::string>& sentences) {
    std::string text;
    for (const std::string& sentence : sentences) text += sentence + "\n";
    return text;
}

double mm3(const PlacedTray& tray, std::uint64_t voxels) {
    return double(voxels) * tray.prepared.places.trays[0].voxel_volume_mm3();
}

}  // namespace

TEST_CASE("Parts of one look that overlap are joined and share, of others one has what both fill") {
    const Models desk;
    const OpenedTray alike = desk.open(R"({"model": "large.obj", "at": [0, 0]}, {"model": "small.obj", "at": [1, 1]})");
    const PlacedTray joined = TrayDesk::place(alike);
    CHECK_THAT(joined.notes, Contains("are in more than one of them"));
    REQUIRE(joined.prepared.parts.ready.size() == 3);
    CHECK(joined.prepared.parts.ready[2].is_joined);
    CHECK(joined.prepared.parts.ready[2].shared_mm3 == Approx(2 * 1 * 1).epsilon(0.05));

    const std::string both =
        R"({"model": "large.obj", "at": [0, 0]}, {"model": "small.obj", "depth": "0.8mm", "at": [1, 1])";
    const OpenedTray equals = desk.open(both + "}");
    PlacedTray equal = TrayDesk::place(equals);
    CHECK_THAT(equal.warnings, Contains("large and small lie within 2 mm") && Contains("their options differ"));
    const ComposedTray over = TrayDesk::compose(equals, equal.prepared);
    CHECK(mm3(equal, over.overlaps[0].to_equals) == Approx(2 * 1 * 1).epsilon(0.05));
    CHECK(over.overlaps[0].voxels == over.overlaps[0].to_equals);
    CHECK(over.overlaps[1].voxels == 0);
    CHECK_THAT(all_of(over.overlap_notes),
               Contains("large: ") && Contains("of the same priority") && Contains("[parts-overlap]"));

    const OpenedTray ranked = desk.open(both + R"(, "priority": 1})");
    PlacedTray higher = TrayDesk::place(ranked);
    const ComposedTray under = TrayDesk::compose(ranked, higher.prepared);
    CHECK(under.overlaps[0].voxels == over.overlaps[0].voxels);
    CHECK(under.overlaps[0].to_equals == 0);
    CHECK_THAT(all_of(under.overlap_notes),
               Contains("where another part is printed") && !Contains("of the same priority"));
}

TEST_CASE("A part is turned only where its labels stay where they are asked for") {
    const Models desk;
    const auto turned = [&](const std::string& more) {
        SliceOptions said = desk.options("tray.json");
        said.turn = true;
        const OpenedTray tray = desk.open(R"({"model": "bar.obj")" + more + "}", said);
        const PlacedTray placed = TrayDesk::place(tray);
        REQUIRE(placed.prepared.parts.ready.size() == 1);
        return std::pair(placed.prepared.parts.ready[0].grid().size, placed.notes);
    };
    desk.write("bar.obj", soft_box({0, 0, 0}, {12, 2.2, 1}));
    const auto [lies, note] = turned("");
    CHECK_THAT(note, Contains("bar: is turned by"));
    CHECK(lies[0] < lies[1]);
    // Its front would be another face.
    const auto [front, front_note] = turned(R"(, "label": "i; size=0.8mm; place=front")");
    CHECK_THAT(front_note, Contains("bar: is not turned, for its labels"));
    CHECK(front[0] > front[1]);
    CHECK_THAT(turned(R"(, "label": "i; size=0.8mm")").second, Contains("bar: is turned by"));
}

TEST_CASE("A component cuts, has priority, and is told of where it is overlapped") {
    const Models desk;
    const OpenedTray tray = desk.open(R"({"box": [5, 3, 3], "mixture": {"W": 1, "C": 1}, "at": [0, 0], "name": "old"},
        {"box": [2, 3.2, 1], "cuts": true, "at": [1, 0, 1], "priority": 1, "name": "slot"},
        {"box": [1, 1, 1], "resin": "W", "at": [4, 0], "priority": -1, "name": "below"})");
    PlacedTray placed = TrayDesk::place(tray);
    const ComposedTray made = TrayDesk::compose(tray, placed.prepared);
    const ReadyPart& slot = placed.prepared.parts.ready[1];
    const std::array<int, 3>&at = slot.copies[0].at, &size = slot.grid().size;
    std::size_t filled = 0;
    for (int k = 0; k < size[2]; ++k)
        for (int j = 0; j < size[1]; ++j)
            for (int i = 0; i < size[0]; ++i)
                filled += made.print.at(at[0] + i, at[1] + j, at[2] + k) != io::background;
    CHECK(filled == 0);
    const auto members = members_of(placed.prepared, 0);
    REQUIRE(members.size() == 3);
    CHECK(members[1].ml == 0);
    CHECK(members[0].ml == Approx(0.045).epsilon(0.03));
    CHECK(members[0].verdict == "none: component");
    CHECK(mm3(placed, made.overlaps[0].voxels) == Approx(2 * 3 * 1).epsilon(0.03));
    CHECK(mm3(placed, made.overlaps[2].voxels) == Approx(1).epsilon(0.05));
    CHECK_THAT(all_of(made.overlap_notes), Contains("below: ") && Contains("where another part is printed"));
}

TEST_CASE("A component beside a coloured part is warned of, two plain ones are not") {
    const Models desk;
    const auto warnings = [&](const char* parts) { return TrayDesk::place(desk.open(parts)).warnings; };
    CHECK_THAT(warnings(R"({"model": "small.obj", "at": [0, 0]}, {"box": [2, 2, 2], "resin": "W", "at": [3, 0]})"),
               Contains("small and box lie within 2 mm") && Contains("box is a component"));
    CHECK_THAT(warnings(R"({"model": "small.obj", "at": [0, 0]}, {"box": [2, 2, 2], "resin": "W", "at": [4.2, 0]})"),
               !Contains("within 2 mm"));
    CHECK_THAT(
        warnings(
            R"({"box": [2, 2, 2], "resin": "K", "at": [0, 0], "name": "a"}, {"box": [2, 2, 2], "resin": "W", "at": [2.5, 0]})"),
        !Contains("within 2 mm"));
    // A print that is there already shows something, too.
    const OpenedJob common = common_of();
    SourceVoxels print{{40, 20, 36}, {}};
    print.materials.assign(40 * 20 * 36, io::Material(2));
    write_stack(desk / "old", common, print);
    CHECK_THAT(warnings(R"({"stack": "old", "at": [0, 0]}, {"box": [2, 2, 2], "resin": "W", "at": [2.5, 0]})"),
               Contains("old and box lie within 2 mm"));
}

TEST_CASE("A part that fails is left out and told of, or is the end of the tray") {
    const Models desk;
    const std::string parts = R"({"model": "small.obj"}, {"model": "gone.obj", "name": "gone"})";
    const PlacedTray rest = TrayDesk::place(desk.open(parts));
    CHECK_THAT(rest.warnings, Contains("gone: fails, and the tray is made without it") && Contains("[part-failed]"));
    REQUIRE(rest.prepared.parts.ready.size() == 1);
    CHECK(rest.prepared.parts.ready[0].part.name == "small");
    REQUIRE(rest.prepared.parts.failed.size() == 1);
    CHECK(rest.prepared.parts.failed[0].name == "gone");
    CHECK(rest.prepared.parts.failed[0].exit_code == ExitCode::file);

    SliceOptions strict = desk.options("tray.json");
    strict.fail_fast = true;
    CHECK_THAT(desk.fault(parts, strict), Contains("parts[1]") && Contains("gone.obj"));
    // Where no part is left there is no tray.
    CHECK_THAT(desk.fault(R"({"model": "gone.obj"})", desk.options("tray.json")),
               Contains("none of the tray's parts can be printed"));
}

TEST_CASE("A warning says whose it is, also where nothing else is said") {
    const Models desk;
    const std::string warnings =
        TrayDesk::place(desk.open(R"({"model": "large.obj", "size": "1.9mm"}, {"model": "small.obj", "size": "1.8mm"},
            {"model": "gone.obj", "name": "gone", "customer": "Klein"})"))
            .warnings;
    CHECK_THAT(warnings, Contains("large: the print is only 1.9 mm large") &&
                             Contains("small: the print is only 1.8 mm large") &&
                             Contains("gone (for Klein): fails, and the tray is made without it"));
}

TEST_CASE("Faults of models that were named without a plan are told of by their files") {
    const Models desk;
    const std::string model = desk / "small.obj", gone = desk / "gone.obj";
    const PlacedTray rest = TrayDesk::place(open_tray(with_plan(desk.options(""), {{model, gone}, 1})));
    REQUIRE(rest.prepared.parts.failed.size() == 1);
    const std::string& fault = rest.prepared.parts.failed[0].message;
    CHECK_THAT(fault, Catch::Matchers::StartsWith(gone) && !Contains("tray-plan.json"));
}

TEST_CASE("A tray ends as its parts do") {
    const Models desk;
    OpenedTray tray = desk.open(R"({"model": "small.obj"})");
    const std::vector<FailedPart> failed{{"a", "is not there", ExitCode::file}};
    CHECK(exit_code_of(tray, {}, {"good", "bad"}) == ExitCode::done);
    CHECK(exit_code_of(tray, failed, {"good"}) == ExitCode::file);
    tray.plan.common.strict = true;
    CHECK(exit_code_of(tray, {}, {"good", "bad"}) == ExitCode::check_failed);
    CHECK(exit_code_of(tray, {}, {"good", "fair"}) == ExitCode::done);
    CHECK(exit_code_of(tray, {}, {}) == ExitCode::done);
    CHECK(exit_code_of(tray, failed, {"bad"}) == ExitCode::file);
}

TEST_CASE("Files of an assembly are printed as one file of all would be, where their coordinates put them") {
    const TrayDesk desk;
    const std::array<int, 3> low{70, 12, 15};
    const std::string first = voxel_box({0, 0, 0}, {60, 18, 40});
    desk.write("first.obj", first);
    desk.write("second.obj", voxel_box(low, {90, 30, 60}));
    desk.write("whole.obj", first + voxel_box(low, {90, 30, 60}, 9));
    SliceOptions options = desk.options("tray.json");
    options.arrange = "none";
    const std::string parts = R"({"model": "second.obj"}, {"model": "first.obj"})";
    const OpenedTray tray = desk.open(parts, options);
    PlacedTray assembled = TrayDesk::place(tray);
    CHECK(TrayDesk::compose(tray, assembled.prepared).print == TrayDesk::print_of(desk.options("whole.obj")));
    CHECK(assembled.prepared.parts.ready[0].copies[0].at == low);
    CHECK(assembled.prepared.parts.ready[1].copies[0].at == std::array<int, 3>{});
    // Arranged they lie elsewhere, and a plan may say so itself.
    PlacedTray arranged = TrayDesk::place(desk.open(parts));
    CHECK(arranged.prepared.parts.ready[0].copies[0].at != low);
}

TEST_CASE("A turned part is the body that slice would turn") {
    const TrayDesk desk;
    desk.write("bar.obj", soft_box({0, 0, 0}, {6, 1.5, 1}));
    SliceOptions options = desk.options("tray.json");
    PlacedTray still = TrayDesk::place(desk.open(R"({"model": "bar.obj"})", options));
    CHECK(still.prepared.parts.ready[0].ready->job.options.raw.rotate.empty());
    options.turn = true;
    const OpenedTray tray = desk.open(R"({"model": "bar.obj"})", options);
    PlacedTray turned = TrayDesk::place(tray);
    CHECK_THAT(turned.notes, Contains("bar: is turned by"));
    SliceOptions alone = desk.options("bar.obj");
    alone.rotate = turned.prepared.parts.ready[0].ready->job.options.raw.rotate;
    CHECK((alone.rotate == "z90" || alone.rotate == "z270"));
    alone.out = desk / "alone";
    const SourceVoxels print = TrayDesk::compose(tray, turned.prepared).print;
    CHECK(print == TrayDesk::print_of(alone));
    CHECK(print.size[0] == 35);  // of 25.4 / 600 mm: 1.5 mm

    // In a plan it is said of a part, and all its copies are turned alike.
    const PlacedTray some = TrayDesk::place(
        desk.open(R"({"model": "bar.obj", "turn": true, "copies": 3}, {"model": "bar.obj", "name": "still"})"));
    const auto& parts = some.prepared.parts.ready;
    CHECK_FALSE(parts[0].ready->job.options.raw.rotate.empty());
    CHECK(parts[0].copies.size() == 3);
    CHECK(parts[0].grid().size[0] == Approx(1.5 * 600 / 25.4).margin(1));
    CHECK(parts[1].ready->job.options.raw.rotate.empty());
    CHECK(parts[1].grid().size[0] == Approx(6 * 600 / 25.4).margin(1));
}

TEST_CASE("A tray is another where its plan or a file of its parts is, and the same elsewhere") {
    const Models desk;
    const auto identity = [&](const std::string& parts, const SliceOptions& options) {
        const PlacedTray placed = TrayDesk::place(desk.open(parts, options));
        return placed.prepared.identity.job;
    };
    const SliceOptions options = desk.options("tray.json");
    const std::string parts = R"({"model": "small.obj"}, {"box": [2, 2, 2], "resin": "W"})";
    const std::string first = identity(parts, options);
    CHECK(first.size() == 64);
    SliceOptions elsewhere = options;
    elsewhere.out = desk / "elsewhere";
    elsewhere.threads = 1;
    CHECK(identity(parts, elsewhere) == first);
    CHECK(identity(R"({"model": "small.obj"}, {"box": [2, 2, 2], "resin": "C"})", options) != first);
    SliceOptions other = options;
    other.gap_mm = 3;
    CHECK(identity(parts, other) != first);
    desk.write("small.obj", soft_box({0, 0, 0}, {2, 1.6, 1}));
    CHECK(identity(parts, options) != first);
    desk.write("small.obj", soft_box({0, 0, 0}, {2, 1.5, 1}));
    CHECK(identity(parts, options) == first);
}

TEST_CASE("What is of one body is refused of a tray") {
    const Models desk;
    SliceOptions options = desk.options("tray.json");
    options.layers = "0-5";
    CHECK_THAT(desk.fault(R"({"model": "small.obj"})", options), Contains("--layers"));
    options.layers.clear();
    options.mixtures = "x";
    CHECK_THAT(desk.fault(R"({"model": "small.obj"})", options), Contains("--mixtures"));
    options.mixtures.clear();
    options.fail_fast = true;
    // A stack in the folder that the tray is made in would be replaced while it is read.
    std::filesystem::create_directories(desk / "out");
    CHECK_THAT(desk.fault(R"({"box": [1, 1, 2], "resin": "W"}, {"stack": "out"})", options),
               Contains("parts[1]") && Contains("cannot be a part of it"));
    options.arrange = "none";
    CHECK_THAT(desk.fault(R"({"box": [1, 1, 2], "resin": "W"})", options), Contains("no place of its own"));
    options.arrange = "plate";
    // A tray for a printer is no lower than its printer allows.
    CHECK_THAT(desk.fault(R"({"box": [1, 1, 0.5], "resin": "W"})", options), Contains("no fewer than 30"));
}
