// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_values.h"

#include <initializer_list>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "slicer/options/model_choice.h"
#include "slicer/options/option_words.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

template <class Enum>
void check_round_trip() {
    for (const Named<Enum>& entry : NamesOf<Enum>::table) {
        INFO(entry.name);
        CHECK(parse_choice<Enum>("key", entry.name) == entry.value);
        CHECK(name_of(entry.value) == entry.name);
    }
    CHECK_THROWS_AS(parse_choice<Enum>("key", ""), UsageError);
    CHECK_THROWS_WITH(parse_choice<Enum>("key", "other"), Catch::Matchers::StartsWith("--key: 'other' is none of "));
}

}  // namespace

TEST_CASE("Every word among the options is a value, and that value has its name") {
    check_round_trip<Mixing>();
    check_round_trip<ScreenKind>();
    check_round_trip<LoopMethod>();
    check_round_trip<PredictedView>();
    check_round_trip<RepairMode>();
    check_round_trip<halftone::Intent>();
    check_round_trip<optics::Backing>();
    check_round_trip<PredictionModel>();
}

TEST_CASE("Rotations are right-handed, in the order written, and exact at right angles") {
    CHECK(parse_rotation("z90") * Eigen::Vector3d::UnitX() == Eigen::Vector3d::UnitY());
    CHECK(parse_rotation("x90") * Eigen::Vector3d::UnitY() == Eigen::Vector3d::UnitZ());
    CHECK(parse_rotation("y90") * Eigen::Vector3d::UnitZ() == Eigen::Vector3d::UnitX());
    CHECK(parse_rotation("z90,x90") * Eigen::Vector3d::UnitX() == Eigen::Vector3d::UnitZ());
    CHECK(parse_rotation("z30").isApprox(
        Eigen::AngleAxisd(3.14159265358979323846 / 6, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
    for (const char* bad : {"w90", "z", "z9x", "90", "zinf"}) CHECK_THROWS_AS(parse_rotation(bad), UsageError);
}

TEST_CASE("Layer ranges lie within the print") {
    CHECK(range_within(parse_layer_range(""), 10).last == 9);
    CHECK(range_within(parse_layer_range("3-5"), 10).first == 3);
    CHECK(range_within(parse_layer_range("7"), 10).last == 7);
    for (const char* bad : {"5-3", "a-b", "-1", "3-", "3-4-5"}) CHECK_THROWS_AS(parse_layer_range(bad), UsageError);
    CHECK(range_within(parse_layer_range("3-10"), 10).last == 9);  // a scheduler's last chunk may overshoot
    CHECK_THROWS_WITH(range_within(parse_layer_range("10"), 10), Catch::Matchers::Contains("--layers 10: "));
    CHECK_THROWS_AS(range_within(parse_layer_range("10-12"), 10), InputError);
}

TEST_CASE("The loop's iterations are a number or its own choice") {
    CHECK_FALSE(parse_iterations("auto"));
    CHECK(parse_iterations("0") == 0);
    CHECK(parse_iterations("1000") == 1000);
    for (const char* bad : {"-1", "1001", "often", "", "2.5"}) CHECK_THROWS_AS(parse_iterations(bad), UsageError);
}

TEST_CASE("A unit of the file is named, or the file's own") {
    CHECK_FALSE(parse_file_unit("auto"));
    CHECK(parse_file_unit("in")->mm == 25.4);
    CHECK(parse_file_unit("in")->name == "in");
    CHECK_THROWS_AS(parse_file_unit("mile"), UsageError);
}

TEST_CASE("What stands in a model's place is told by its name, of a text by its first line") {
    using Kind = ModelKind;
    const io::TemporaryFolder folder;
    const std::string parts = folder.path() / "parts.txt", story = folder.path() / "story.txt";
    io::write_whole_file(parts, std::string("model,copies\na.obj,2\n"));
    io::write_whole_file(story, std::string("It was a dark and stormy night, model and all.\n"));
    for (const auto& [model, kind] : std::initializer_list<std::pair<std::string, Kind>>{{"a.obj", Kind::mesh},
                                                                                         {"A.GLB", Kind::mesh},
                                                                                         {"a.zip/b.ply", Kind::mesh},
                                                                                         {"a.png", Kind::picture},
                                                                                         {"a", Kind::picture},
                                                                                         {"", Kind::picture},
                                                                                         {"tray.json", Kind::tray_plan},
                                                                                         {"tray.CSV", Kind::tray_plan},
                                                                                         {"tray.tsv", Kind::tray_plan},
                                                                                         {parts, Kind::tray_plan},
                                                                                         {story, Kind::picture}}) {
        CAPTURE(model);
        CHECK(model_kind(model) == kind);
    }
}
