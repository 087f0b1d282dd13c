// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_plan.h"

#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/files/schema.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

struct Desk {
    std::string write(const std::string& text, const std::string& name = "tray.json") const {
        std::ofstream(folder.path() / name) << text;
        return (folder.path() / name).string();
    }
    [[nodiscard]] std::string fault(const std::string& parts, const std::string& besides = "") const {
        try {
            (void)read_tray_plan(
                write(R"({"format": "voxtone-tray", "version": 1, )" + besides + R"("parts": )" + parts + "}"), {});
            return "none";
        } catch (const Error& error) {
            return error.what();
        }
    }
    io::TemporaryFolder folder;
};

}  // namespace

TEST_CASE("A plan of a tray: options for all, options of a part, places and copies") {
    const Desk desk;
    const std::string text = R"({"format": "voxtone-tray", "version": 1, "gap": "2.5mm", "iterations": 0,
        "parts": [{"model": "a.obj", "size": "20mm", "copies": 3},
                  {"model": "sub/a.obj", "iterations": 4, "at": [10, 20]},
                  {"name": "tag", "model": "/tags/t.png", "at": [[1, 2, 3], [4, 5]], "priority": -2, "cuts": true}]})";
    CHECK(io::schema_faults("tray", text) == std::vector<std::string>{});
    SliceOptions common;
    common.size_mm = 50;
    const TrayPlan plan = read_tray_plan(desk.write(text), common);
    CHECK(plan.gap_mm == 2.5);
    REQUIRE(plan.parts.size() == 3);
    CHECK(plan.parts[0].name == "a-1");  // two are called a
    CHECK(plan.parts[1].name == "a-2");
    CHECK(plan.parts[2].name == "tag");
    CHECK(plan.parts[0].options.model == (desk.folder.path() / "a.obj").string());
    CHECK(plan.parts[2].options.model == "/tags/t.png");
    CHECK(plan.parts[0].options.size_mm == 20);
    CHECK(plan.parts[1].options.size_mm == 50);
    CHECK(plan.parts[0].options.iterations == "0");
    CHECK(plan.parts[1].options.iterations == "4");
    CHECK(plan.parts[0].copies == 3);
    CHECK(plan.parts[0].at_mm.empty());
    CHECK(plan.parts[1].at_mm == std::vector<std::array<double, 3>>{{10, 20, 0}});
    CHECK(plan.parts[2].copies == 2);
    CHECK(plan.parts[2].at_mm == std::vector<std::array<double, 3>>{{1, 2, 3}, {4, 5, 0}});
    CHECK(plan.parts[2].priority == -2);
    CHECK(plan.parts[2].cuts);
    CHECK_FALSE(plan.parts[0].cuts);
}

TEST_CASE("A table is a plan, too, and so are models") {
    const Desk desk;
    const TrayPlan plan =
        read_tray_plan(desk.write("model,size,copies,priority\na.obj,20mm,4,1\nb.png,,1,0\n", "tray.csv"), {});
    REQUIRE(plan.parts.size() == 2);
    CHECK(plan.parts[0].copies == 4);
    CHECK(plan.parts[0].priority == 1);
    CHECK(plan.parts[0].options.size_mm == 20);
    CHECK(plan.parts[1].name == "b");
    SliceOptions common;
    common.size_mm = 30;
    const TrayPlan models = tray_of_models({"x/cow.obj", "y/cow.obj", "z.png"}, common);
    REQUIRE(models.parts.size() == 3);
    CHECK(models.parts[0].options.size_mm == 30);
    CHECK(models.parts[2].options.size_mm == 0);  // a picture has no size, which is no fault of what is said for all
    CHECK(models.parts[1].name == "cow-2");
    CHECK(models.parts[2].name == "z");
}

TEST_CASE("What is wrong with a plan is said with its place") {
    const Desk desk;
    CHECK(desk.fault(R"([{"model": "a.obj"}])") == "none");
    CHECK_THAT(desk.fault("[]"), Contains("no part"));
    CHECK_THAT(desk.fault(R"([{"size": "2mm"}])"), Contains("model"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "copys": 2}])"), Contains("copys") && Contains("copies"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "copies": 0}])"), Contains("from 1 to 10000"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "copies": 2.5}])"), Contains("whole number"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "copies": 3, "at": [1, 2]}])"), Contains("1 places for 3 copies"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "cuts": "yes"}])"), Contains("true or false"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "at": [1]}])"), Contains("[x, y]"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "at": [-1, 2]}])"), Contains("at"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "printer": "generic"}])"), Contains("whole tray"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "name": "../up"}])"), Contains("../up"));
    CHECK_THAT(
        desk.fault(R"([{"model": "a.obj", "name": "b"}, {"model": "b.obj", "name": "b-1"}, {"model": "b.obj"}])"),
        Contains("b-1"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("gap": "-1mm", )"), Contains("gap"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("model": "b.obj", )"), Contains("belongs to a part"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("out": "x", )"), Contains("-o"));
    CHECK(io::schema_faults("tray", R"({"format": "voxtone-tray", "version": 1, "parts": []})").size() > 0);
}
