// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/arrangement.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/plate/component.h"
#include "tests/slicer/plate/common_job.h"
#include "tests/slicer/plate/tray_desk.h"

using namespace voxtone;
using namespace voxtone::slicer;
using namespace voxtone::test;
using Catch::Matchers::Contains;

namespace {

const Eigen::Vector3d usual_tray_mm(490, 390, 200);
constexpr double layer_mm = 0.027;

/// Boxes of resin, and where they come to stand.
struct Boxes {
    TrayPart& add(const std::string& name, const std::array<double, 3>& mm, int copies = 1) {
        TrayPart& part = parts.emplace_back();
        part.name = name;
        part.place = "tray.json: parts[" + std::to_string(parts.size() - 1) + "]";
        part.component = TrayComponent{ComponentKind::box, mm, {{"W", 1}}, {}};
        part.copies = copies;
        return part;
    }
    [[nodiscard]] Arrangement arranged(const Eigen::Vector3d& tray_mm, const TrayOptions& options = {},
                                       const HeadPasses& heads = {}) const {
        static const OpenedJob common = common_of();
        std::vector<ReadyComponent> made;
        Progress progress;
        for (const TrayPart& part : parts) made.push_back(prepare_component(part, common, progress));
        std::vector<StandingPart> standing;
        for (std::size_t p = 0; p < parts.size(); ++p) standing.push_back({&parts[p], nullptr, &made[p]});
        return arrange(standing, tray_mm, options, heads);
    }
    [[nodiscard]] std::string fault(const Eigen::Vector3d& tray_mm, const TrayOptions& options = {}) const {
        try {
            (void)arranged(tray_mm, options);
            return "none";
        } catch (const InputError& error) {
            return error.what();
        }
    }
    std::vector<TrayPart> parts;
};

std::string all_of(const std::vector<std::string>& sentences) {
    std::string text;
    for (const std::string& sentence : sentences) text += sentence + "\n";
    return text;
}

/// A model on a tray.
struct StandingModel {
    explicit StandingModel(const SliceOptions& options) {
        const OpenedJob job = open_job(options);
        Progress progress;
        part.options = options;
        body = std::make_unique<JobBody>(prepare_body(job.options, job.printer, progress));
    }
    [[nodiscard]] StandingPart standing() const { return {&part, body.get()}; }
    TrayPart part;
    std::unique_ptr<JobBody> body;
};

}  // namespace

TEST_CASE("A place that is no whole number of voxels is told of, one off the tray is refused") {
    Boxes boxes;
    boxes.add("marker", {6, 3, 5}).at_mm = {{0.33, 0.33, 0}};
    const Arrangement moved = boxes.arranged(usual_tray_mm);
    CHECK_THAT(all_of(moved.notes), Contains("marker: lies up to") && Contains("whole voxels"));
    CHECK(moved.corner_mm[0][0] == Approx(0.33).margin(25.4 / 600 / 2));
    CHECK(moved.corner_mm[0][1] == Approx(0.33).margin(25.4 / 300 / 2));
    CHECK(moved.corner_mm[0][2] == 0);
    for (const std::array<double, 3>& exact : {std::array{0.0, 0.0, 0.0}, {25.4 / 600 * 7, 25.4 / 300 * 5, 0.027}}) {
        boxes.parts[0].at_mm = {exact};
        CHECK(boxes.arranged(usual_tray_mm).notes.empty());
    }
    boxes.parts[0].at_mm = {{0, 0, 199}};
    CHECK_THAT(boxes.fault(usual_tray_mm), Contains("parts[0]") && Contains("along z") && Contains("built up to"));
    boxes.parts[0].at_mm = {{489, 0, 0}};
    CHECK_THAT(boxes.fault(usual_tray_mm), Contains("parts[0]") && Contains("along x") && Contains("ends at 490"));
    boxes.parts[0].at_mm = {{0, 388, 0}};
    CHECK_THAT(boxes.fault(usual_tray_mm), Contains("along y"));
}

TEST_CASE("What is as long as the tray fits it, wherever and however it is put there") {
    for (const Eigen::Vector3d& tray_mm : {usual_tray_mm, Eigen::Vector3d(254.9, 212.3, 100.1)}) {
        CAPTURE(tray_mm.transpose());
        const double x = tray_mm.x(), y = tray_mm.y(), z = tray_mm.z();
        const auto ends_within_a_voxel = [&](const Arrangement& made) {
            for (int axis = 0; axis < 2; ++axis) {
                const VoxelGrid& grid = made.trays[0];
                const double end =
                    made.corner_mm[0][std::size_t(axis)] + grid.size[std::size_t(axis)] * grid.pitch_mm[axis];
                CHECK(end < tray_mm[axis] + grid.pitch_mm[axis]);
            }
        };
        for (const double gap_mm : {0.0, 2.0}) {
            CAPTURE(gap_mm);
            TrayOptions options;
            options.gap_mm = gap_mm;
            Boxes along, across, beside;
            along.add("bed", {x, 6, 1});
            along.add("other", {6, 4, 1});
            ends_within_a_voxel(along.arranged(tray_mm, options));
            across.add("bed", {6, y, 1});
            ends_within_a_voxel(across.arranged(tray_mm, options));
            if (gap_mm == 0) continue;
            beside.add("half", {(x - gap_mm) / 2, 6, z}, 2);
            if (std::fmod(x, 1) == 0) ends_within_a_voxel(beside.arranged(tray_mm, options));
        }
        Boxes boxes;
        boxes.add("a", {6, 4, 5}).at_mm = {{x - 6, y - 4, z - 5}, {0, 0, 0}, {x - 6, 0, 0}};
        const Arrangement made = boxes.arranged(tray_mm);
        ends_within_a_voxel(made);
        // A size and a place that both round up.
        boxes.parts[0].component->size_mm = {6.01, 4.05, 1};
        boxes.parts[0].at_mm = {{x - 6.01, y - 4.05, 0}};
        ends_within_a_voxel(boxes.arranged(tray_mm));
        boxes.parts[0].component->size_mm = {6, 4, 5};
        for (int axis = 0; axis < 3; ++axis) {
            std::array<double, 3> over{x - 6, y - 4, z - 5};
            over[std::size_t(axis)] += 0.01;
            boxes.parts[0].at_mm = {over};
            CHECK_THAT(boxes.fault(tray_mm), Contains(fmt::format("reaches to {:g} mm", tray_mm[axis] + 0.01)) &&
                                                 Contains(fmt::format("{:g}, 10 um less", tray_mm[axis])));
        }
    }
}

TEST_CASE("What finds no room on the plate goes over it, or onto the next tray, or is named") {
    Boxes boxes;
    boxes.add("ramp", {5, 3, 3}, 5);
    // Two times two that lie 6 mm apart, and in no place a fifth.
    const Eigen::Vector3d tray_mm(16, 12, 20);
    TrayOptions options;
    options.gap_mm = 6;
    const std::string full = boxes.fault(tray_mm, options);
    CHECK_THAT(full, Contains("1 of ramp find no room on the tray of 16 x 12 x 20 mm") && Contains("--trays") &&
                         Contains("--arrange stacked"));

    options.trays = 2;
    const Arrangement two = boxes.arranged(tray_mm, options);
    REQUIRE(two.trays.size() == 2);
    CHECK(std::ranges::count(two.copies[0], 0, &PlacedCopy::tray) == 4);
    CHECK(std::ranges::count(two.copies[0], 1, &PlacedCopy::tray) == 1);
    for (const PlacedCopy& copy : two.copies[0]) CHECK(copy.at[2] == 0);
    CHECK(two.trays[0].size[2] == 111);

    options.trays = 1;
    options.arrange = Arrange::stacked;
    const Arrangement over = boxes.arranged(tray_mm, options);
    REQUIRE(over.trays.size() == 1);
    std::vector<int> bottoms;
    for (const PlacedCopy& copy : over.copies[0]) bottoms.push_back(copy.at[2]);
    std::ranges::sort(bottoms);
    CHECK(std::ranges::count(bottoms, 0) == 4);
    // A gap above them, where slabs of 32 layers begin.
    const int floor = bottoms.back();
    CHECK(floor % 32 == 0);
    CHECK(floor * layer_mm >= 3 + 6);
    CHECK((floor - 32) * layer_mm < 3 + 6);
    CHECK(over.trays[0].size[2] == floor + 111);
    // No copy is nearer to another of its level than the gap.
    const double pitch[] = {25.4 / 600, 25.4 / 300};
    for (std::size_t a = 0; a < 5; ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const PlacedCopy &one = over.copies[0][a], &other = over.copies[0][b];
            if (one.at[2] != other.at[2]) continue;
            CHECK((std::abs(one.at[0] - other.at[0]) * pitch[0] >= 5 + 6 - 0.1 ||
                   std::abs(one.at[1] - other.at[1]) * pitch[1] >= 3 + 6 - 0.1));
        }
    // What is too high for what is left of the tray goes to none.
    CHECK_THAT(boxes.fault({16, 12, 11}, options), Contains("1 of ramp"));
}

TEST_CASE("Small parts lie in one pass of the heads along x, and what must be on the first tray is there") {
    const auto passes_of = [](const Arrangement& made, const HeadPasses& heads) {
        return heads.of_layer(length_of(made.trays[0]));
    };
    const HeadPasses heads{0, 50, {}, "a guide"};
    Boxes boxes;
    boxes.add("small", {25, 9, 3}, 15);
    const Arrangement before = boxes.arranged(usual_tray_mm);
    CHECK(passes_of(before, heads) > 3);
    const Arrangement along = boxes.arranged(usual_tray_mm, {}, heads);
    CHECK(passes_of(along, heads) == 1);
    CHECK(length_of(along.trays[0]).x() > 50);

    // Two large ones fill a tray, the small one that comes last is to be on it.
    Boxes orders;
    orders.add("large", {30, 20, 3}, 3);
    orders.add("rush", {12, 8, 3}).first = true;
    TrayOptions options;
    options.trays = 3;
    const Eigen::Vector3d small_tray_mm(40, 44, 20);
    for (const bool first : {false, true}) {
        orders.parts[1].first = first;
        const Arrangement made = orders.arranged(small_tray_mm, options);
        CHECK((made.copies[1][0].tray == 0) == first);
        CHECK(made.copies[0].size() == 3);
    }
    orders.parts[0].first = true;
    CHECK_THAT(orders.fault(small_tray_mm, options),
               Contains("of large") && Contains("on the first tray") && Contains("\"first\""));
}

TEST_CASE("What the plan places is left where it is, and the others keep off it") {
    for (const double at_mm : {0.0, 1.25, 2.71}) {  // on cells of the nesting, and not
        CAPTURE(at_mm);
        Boxes boxes;
        boxes.add("there", {4, 4, 1}).at_mm = {{at_mm, at_mm, 0}};
        boxes.add("other", {4, 4, 1}, 3);
        TrayOptions options;
        options.gap_mm = 0;
        const Arrangement made = boxes.arranged({20, 20, 20}, options);
        const Eigen::Vector2d pitch(25.4 / 600, 25.4 / 300);
        const auto mm = [&](const PlacedCopy& copy) {
            return Eigen::Vector2d(copy.at[0] * pitch[0] + made.corner_mm[0][0],
                                   copy.at[1] * pitch[1] + made.corner_mm[0][1]);
        };
        const Eigen::Vector2d fixed = mm(made.copies[0][0]);
        CHECK((fixed - Eigen::Vector2d(at_mm, at_mm)).cwiseAbs().maxCoeff() < 0.05);
        for (const PlacedCopy& copy : made.copies[1]) {
            const Eigen::Vector2d apart = (mm(copy) - fixed).cwiseAbs();
            CHECK(apart.maxCoeff() >= 4 - pitch.maxCoeff());  // sizes are whole voxels
        }
    }
}

TEST_CASE("Files of an assembly stand where their coordinates put them, and what has no place of its own is refused") {
    const TrayDesk desk;
    // Of whole voxels, in the coordinates of a larger assembly.
    const Eigen::Vector3d pitch_mm(25.4 / 600, 25.4 / 300, 0.027), corner_mm(7, -3, 2);
    const auto box = [&](std::array<int, 3> low, std::array<int, 3> high) {
        std::array<double, 3> a{}, b{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto n = Eigen::Index(axis);
            a[axis] = corner_mm[n] + pitch_mm[n] * low[axis], b[axis] = corner_mm[n] + pitch_mm[n] * high[axis];
        }
        return soft_box(a, b);
    };
    const std::array<int, 3> low{70, 12, 15};
    desk.write("first.obj", box({0, 0, 0}, {60, 18, 40}));
    desk.write("second.obj", box(low, {90, 30, 60}));
    StandingModel first(desk.options("first.obj")), second(desk.options("second.obj"));
    first.part.name = first.part.place = "first", second.part.name = second.part.place = "second";
    TrayOptions options;
    options.arrange = Arrange::none;
    const auto arranged = [&] {
        return arrange(std::vector{second.standing(), first.standing()}, usual_tray_mm, options);
    };
    const Arrangement made = arranged();
    CHECK(made.copies[0][0].at == low);
    CHECK(made.copies[1][0].at == std::array<int, 3>{});
    CHECK(made.trays[0].size == std::array{90, 30, 60});
    // Arranged they lie beside each other on the plate.
    options.arrange = Arrange::plate;
    CHECK(arranged().copies[0][0].at[2] == 0);
    options.arrange = Arrange::none;

    second.part.options.size_mm = 4;
    CHECK_THROWS_WITH(arranged(), Contains("second") && Contains("\"scale\"") && Contains("--arrange plate"));
    second.part.options.size_mm = 0;
    first.part.copies = 2;
    CHECK_THROWS_WITH(arranged(), Contains("first") && Contains("several copies") && Contains("\"at\""));
    first.part.copies = 1;
    first.body->is_picture = true;
    CHECK_THROWS_WITH(arranged(), Contains("first") && Contains("a picture, which has no place of its own"));
    Boxes boxes;
    boxes.add("box", {1, 1, 2});
    CHECK_THAT(boxes.fault(usual_tray_mm, options), Contains("a component, which has no place of its own"));
    boxes.parts[0].at_mm = {{1, 2, 3}};
    CHECK(boxes.fault(usual_tray_mm, options) == "none");
}

TEST_CASE("A part is turned where it lies closer so, all its copies alike, and no other part") {
    const TrayDesk desk;
    desk.write("bar.obj", soft_box({0, 0, 0}, {12, 3, 2}));
    StandingModel turned(desk.options("bar.obj")), still(desk.options("bar.obj"));
    turned.part.turn = true;
    turned.part.copies = 3;
    // Along x a printer takes more passes.
    const std::vector<int> turns = turns_on_plate(std::vector{turned.standing(), still.standing()}, usual_tray_mm, 2);
    CHECK((turns[0] == 1 || turns[0] == 3));
    CHECK(turns[1] == 0);
    turned.part.turn = false;
    CHECK(turns_on_plate(std::vector{turned.standing(), still.standing()}, usual_tray_mm, 2) == std::vector{0, 0});
}

TEST_CASE("A turn comes after what the part's options turn, and before its mirrors") {
    SliceOptions options;
    CHECK(turned_further(options, 0).empty());
    CHECK(turned_further(options, 1) == "z90");
    CHECK(turned_further(options, 3) == "z270");
    options.rotate = "x90";
    CHECK(turned_further(options, 0) == "x90");
    CHECK(turned_further(options, 1) == "x90,z90");
    options.flip_x = true;
    CHECK(turned_further(options, 1) == "x90,z270");
    CHECK(turned_further(options, 2) == "x90,z180");
    options.swap_xy = true;
    CHECK(turned_further(options, 1) == "x90,z90");
}

TEST_CASE("A place between cells that is a whole number of voxels is that") {
    // 127 cells of 0.5 mm are 1500 columns, and 750 rows. The corner is where the plate's is.
    Boxes boxes;
    boxes.add("first", {63.5, 63.5, 1});
    boxes.add("second", {60, 60, 1});
    TrayOptions options;
    options.gap_mm = 0;
    const auto second = [&](const Eigen::Vector3d& tray_mm) {
        const Arrangement made = boxes.arranged(tray_mm, options);
        CHECK(made.corner_mm[0] == std::array{0.0, 0.0, 0.0});
        return made.copies[1][0].at;
    };
    CHECK(second({70, 140, 20}) == std::array{0, 750, 0});
    CHECK(second({140, 70, 20}) == std::array{1500, 0, 0});
}
