// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/tray_plan.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/core.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/plans/part_about.h"
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
    CHECK(plan.common.gap_mm == 2.5);
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
    CHECK(plan.parts[0].place.ends_with("tray.csv: line 2"));
    CHECK(plan.parts[0].copies == 4);
    CHECK(plan.parts[0].priority == 1);
    CHECK(plan.parts[0].options.size_mm == 20);
    CHECK(plan.parts[1].name == "b");
    const std::vector<std::string> files{"x/cow.obj", "y/cow.obj", "/z.png"};
    const std::string text = tray_plan_of({files, 1}, desk.folder.path());
    CHECK(io::schema_faults("tray", text) == std::vector<std::string>{});
    SliceOptions common;
    common.size_mm = 30;
    const TrayPlan models = read_tray_plan(desk.write(text), common);
    REQUIRE(models.parts.size() == 3);
    CHECK(models.parts[0].options.model == std::filesystem::absolute("x/cow.obj").string());
    CHECK(models.parts[0].options.size_mm == 30);
    CHECK(models.parts[2].options.size_mm == 30);  // of a picture, too
    CHECK(models.parts[1].name == "cow-2");
    CHECK(models.parts[2].name == "z");
    const std::string copies = tray_plan_of({files, 3}, desk.folder.path());
    CHECK(io::schema_faults("tray", copies) == std::vector<std::string>{});
    for (const TrayPart& part : read_tray_plan(desk.write(copies), common).parts) CHECK(part.copies == 3);
}

TEST_CASE("An order sheet's own columns are texts for labels, and a slip of the keyboard is none") {
    const Desk desk;
    const TrayPlan plan = read_tray_plan(
        desk.write(
            "model,copies,customer,serial,order no,label,first\na.obj,1,Klein,007,4711,{customer} {serial},true\n"
            "b.obj,2,Grün,,,,\n",
            "t.csv"),
        {});
    REQUIRE(plan.parts.size() == 2);
    CHECK(plan.parts[0].options.labels == std::vector<std::string>{"text=Klein 007"});
    CHECK(plan.parts[0].values.at("order no") == "4711");
    CHECK(plan.parts[0].first);
    CHECK_FALSE(plan.parts[1].first);
    REQUIRE(plan.notes.size() == 1);
    CHECK_THAT(plan.notes[0], Contains("customer, order no, serial are no key") && Contains("{customer}"));
    CHECK(about_part(plan.parts[0]) == "customer Klein; order no 4711; serial 007; label \"Klein 007\"");
    CHECK(about_part(plan.parts[1]) == "customer Grün");
    CHECK(customer_of(plan.parts[0]) == "Klein");
    // Words of an order sheet are near to no key.
    for (const char* word : {"customer",      "serial", "order", "number",  "material", "price",    "date",    "notes",
                             "status",        "email",  "phone", "address", "comment",  "delivery", "artikel", "kunde",
                             "Bestellnummer", "ref",    "id",    "colour",  "company",  "due"}) {
        CAPTURE(word);
        CHECK(desk.fault(std::string(R"([{"model": "a.obj", ")") + word + R"(": "x"}])") == "none");
    }
    for (const char* slip : {"modell", "copys", "siez", "labell", "priorty", "rotat", "Size", "iteration"}) {
        CAPTURE(slip);
        CHECK_THAT(desk.fault(std::string(R"([{"model": "a.obj", ")") + slip + R"(": "x"}])"),
                   Contains("did you mean") && Contains("in braces"));
    }
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "customer": {"name": "x"}}])"), Contains("customer"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "customer": "a", "{customer}": "b"}])"), Contains("in braces, too"));
    // A component has them, too: it is sorted with the others.
    CHECK(desk.fault(R"([{"box": [1, 2, 3], "resin": "W", "customer": "Klein"}])") == "none");
}

TEST_CASE("All parts of a plan that are wrong are said at once, one alone as it is") {
    const Desk desk;
    const std::string all = desk.fault(
        R"([{"model": "a.obj", "copies": 0}, {"model": "b.obj"}, {"model": "c.obj", "cuts": 7}, {"size": "2mm"}])");
    CHECK_THAT(all, Contains("3 of the 4 parts") && Contains("parts[0]") && Contains("parts[2]") &&
                        Contains("parts[3]") && !Contains("parts[1]"));
    CHECK(std::ranges::count(all, '\n') == 3);
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "copies": 0}, {"model": "b.obj"}])"), !Contains("1 of the 2"));
}

TEST_CASE("A model with a resin is a body of it, with a model's options and no marks") {
    const Desk desk;
    const std::string text = R"({"format": "voxtone-tray", "version": 1, "size": "20mm", "label": "all", "parts": [
        {"model": "block.stl", "resin": "T", "scale": 2, "size": 0}, {"model": "cow.obj"},
        {"model": "coat.obj", "mixture": {"W": 1, "T": 3}, "name": "coat", "cuts": false}]})";
    CHECK(io::schema_faults("tray", text) == std::vector<std::string>{});
    const TrayPlan plan = read_tray_plan(desk.write(text), {});
    REQUIRE(plan.parts.size() == 3);
    REQUIRE(plan.parts[0].component);
    CHECK(plan.parts[0].component->kind == ComponentKind::body);
    CHECK(plan.parts[0].component->path == (desk.folder.path() / "block.stl").string());
    CHECK(plan.parts[0].options.scale == 2);
    CHECK(plan.parts[0].options.labels.empty());
    CHECK(plan.parts[0].name == "block");
    CHECK_FALSE(plan.parts[1].component);
    CHECK(plan.parts[1].options.labels.size() == 1);
    CHECK(plan.parts[2].component->mixture.size() == 2);
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "resin": "T", "label": "x"}])"), Contains("of what is coloured"));
    CHECK_THAT(desk.fault(R"([{"job": "a.json", "resin": "T"}])"), Contains("its own resins"));
}

TEST_CASE("What is wrong with a plan is said with its place") {
    const Desk desk;
    CHECK(desk.fault(R"([{"model": "a.obj"}])") == "none");
    CHECK_THAT(desk.fault("[]"), Contains("no part"));
    CHECK_THAT(desk.fault(R"([{"size": "2mm"}])"), Contains("model"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "copys": 2}])"), Contains("copys") && Contains("copies"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "count": 2}])"), Contains(".count`") && Contains("\"copies\": 3"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("copies": 2, )"), Contains("said in a part"));
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
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("gap": "wide", )"), Contains("gap"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "gap": "2mm"}])"), Contains("whole tray"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("gapp": "1mm", )"), Contains("gapp") && Contains("gap"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("model": "b.obj", )"), Contains("belongs to a part"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj"}])", R"("out": "x", )"), Contains("-o"));
    CHECK(io::schema_faults("tray", R"({"format": "voxtone-tray", "version": 1, "parts": []})").size() > 0);
}

TEST_CASE("A table says what an object would, and is wrong where that would be") {
    const Desk desk;
    const auto fault = [&](const std::string& table) -> std::string {
        try {
            (void)read_tray_plan(desk.write(table, "tray.csv"), {});
            return "none";
        } catch (const Error& error) {
            return error.what();
        }
    };
    CHECK(fault("model,at,turn\na.obj,10 20,true\n") == "none");
    // What is wrong with a column is told of the header, once.
    for (const std::string rows : {"a.obj,2\n", "a.obj,2\nb.obj,3\n"}) {
        const std::string said = fault("model,copys\n" + rows);
        CHECK_THAT(said, Contains("tray.csv: line 1: unknown key 'copys'; did you mean 'copies'?"));
        CHECK_THAT(said, !Contains("line 2"));
    }
    CHECK_THAT(fault("\nfile,size\na.obj,9mm\n"), Contains("line 2: has no column `model`") && Contains("file, size"));
    CHECK(fault("Model,SIZE,Copies,customer\na.obj,9mm,2,Ada\n") == "none");
    CHECK(fault("model,customer,Customer\na.obj,Ada,Bob\n") == "none");  // are the user's own, both
    CHECK_THAT(fault("model,size\n"), Contains("has no part") && Contains("a line below the header"));
    const std::string all = fault("model,copies,size\na.obj,x,9mm\nb.obj,2\nc.obj,1,9 parsec\n");
    for (const char* const one :
         {"3 of the 3 parts", "line 2: key `copies`", "line 3: has 2 cells", "line 4: key `size`"})
        CHECK_THAT(all, Contains(one));
    CHECK_THAT(all, !Contains("line 1"));
    CHECK_THAT(fault("model,printer\na.obj,generic\n"), Contains("whole tray"));
    CHECK_THAT(fault("model,copies\na.obj\n"), Contains("line 2"));
    CHECK_THAT(fault("model,name\na.obj,x\nb.obj,x\n"),
               Contains("line 3") && Contains("named 'x'") && Contains("line 2"));
    CHECK_THAT(fault("model,at\na.obj,10\n"), Contains("[x, y]"));
    const TrayPlan plan = read_tray_plan(desk.write("model,at\na.obj,10 20; 30 40 5.5\n", "tray.csv"), {});
    CHECK(plan.parts[0].at_mm == std::vector<std::array<double, 3>>{{10, 20, 0}, {30, 40, 5.5}});
    CHECK(plan.parts[0].copies == 2);
}

TEST_CASE("Two parts for which the plan has one name are a mistake") {
    const Desk desk;
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "name": "x"}, {"model": "b.obj", "name": "x"}])"),
               Contains("parts[1]") && Contains("parts[0]") && Contains("named 'x'"));
}

TEST_CASE("What the command line names wins over what the plan says of all parts, not over what it says of one") {
    const Desk desk;
    SliceOptions said;
    said.gap_mm = 5;
    said.depth_mm = 2;
    said.named = {"gap", "depth"};
    const TrayPlan plan = read_tray_plan(desk.write(R"({"format": "voxtone-tray", "version": 1, "gap": "3mm",
        "depth": "0.5mm", "seed": 7, "turn": true,
        "parts": [{"model": "a.obj"}, {"model": "b.obj", "depth": "0.8mm", "turn": false}]})"),
                                         said);
    CHECK(plan.common.gap_mm == 5);
    CHECK(plan.common.seed == 7);
    CHECK(plan.parts[0].options.depth_mm == 2);
    CHECK(plan.parts[1].options.depth_mm == 0.8);
    CHECK(plan.parts[0].options.gap_mm == 2);  // which is the tray's
    CHECK(plan.parts[0].turn);
    CHECK_FALSE(plan.parts[1].turn);
    CHECK_FALSE(plan.parts[0].options.turn);
}

TEST_CASE("A tray's plan is known by what it says") {
    const Desk desk;
    CHECK(is_tray_plan(desk.write(R"({"format": "voxtone-tray"})")));
    CHECK_FALSE(is_tray_plan(desk.write(R"({"format": "voxtone-job"})")));
    CHECK_FALSE(is_tray_plan(desk.write("{broken")));
    CHECK(is_tray_plan(desk.write("model,copies\n", "a.csv")));
    CHECK_FALSE(is_tray_plan(desk.write("model,size\n", "a.csv")));  // of a batch
    CHECK_FALSE(is_tray_plan(desk.folder.path() / "none.json"));
}

TEST_CASE("Plans of trays are read as Windows writes them") {
    const Desk desk;
    std::filesystem::create_directories(desk.folder.path() / "models");
    desk.write("", "models/a.obj");
    const std::string text = "model\tcopies\tlabel\t{serial}\t\r\nmodels\\a.obj\t2\t{serial}\t007\t\r\n\t\t\t\t\r\n";
    std::string utf16 = "\xFF\xFE", semicolons = "\xEF\xBB\xBF" + text;
    for (const char c : text) utf16 += {c, '\0'};
    std::ranges::replace(semicolons, '\t', ';');
    for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{{"t.csv", text},
                                                                                      {"t.tsv", text},
                                                                                      {"t.txt", text},
                                                                                      {"t.txt", utf16},
                                                                                      {"t.csv", utf16},
                                                                                      {"t.csv", semicolons}}) {
        CAPTURE(name, bytes);
        const std::string file = desk.write(bytes, name);
        CHECK(is_tray_plan(file));
        const TrayPlan plan = read_tray_plan(file, {});
        REQUIRE(plan.parts.size() == 1);
        CHECK(plan.parts[0].copies == 2);
        CHECK(plan.parts[0].options.model == (desk.folder.path() / "models/a.obj").string());
        CHECK(plan.parts[0].options.labels == std::vector<std::string>{"text=007"});
    }
    std::string json = "\xFF\xFE";
    for (const char c : R"({"format": "voxtone-tray", "version": 1, "parts": [{"model": "models\\a.obj"}]})")
        if (c != '\0') json += {c, '\0'};
    const std::string file = desk.write(json);
    CHECK(is_tray_plan(file));
    CHECK(read_tray_plan(file, {}).parts.at(0).options.model == (desk.folder.path() / "models/a.obj").string());
}

TEST_CASE("Labels of parts get their values, and copies whose labels differ are parts of their own") {
    const Desk desk;
    const std::string text = R"({"format": "voxtone-tray", "version": 1, "{order}": "4711",
        "parts": [{"model": "cow.obj", "copies": 2, "at": [[1, 2], [30, 4]], "label": "{job} {order}/{copy:02}"},
                  {"model": "card.png", "copies": 3, "{order}": "12", "label": [{"qr": "{part}; {order}", "size": "9mm"}]}]})";
    CHECK(io::schema_faults("tray", text) == std::vector<std::string>{});
    SliceOptions common;
    common.out = "shelf/monday";
    const TrayPlan plan = read_tray_plan(desk.write(text), common);
    REQUIRE(plan.parts.size() == 3);
    CHECK(plan.parts[0].name == "cow-1");
    CHECK(plan.parts[1].name == "cow-2");
    CHECK(plan.parts[1].copies == 1);
    CHECK(plan.parts[1].at_mm == std::vector<std::array<double, 3>>{{30, 4, 0}});
    CHECK(plan.parts[0].options.labels == std::vector<std::string>{"text=monday 4711/01"});
    CHECK(plan.parts[1].options.labels == std::vector<std::string>{"text=monday 4711/02"});
    CHECK(plan.parts[2].copies == 3);
    CHECK(plan.parts[2].options.labels == std::vector<std::string>{"qr=card\\; 12; size=9mm"});
    CHECK(plan.notes.size() == 1);
    const TrayPlan table = read_tray_plan(desk.write("model,label,{n}\na.obj,No. {n},7\nb.obj,,\n", "t.csv"), {});
    CHECK(table.parts[0].options.labels == std::vector<std::string>{"text=No. 7"});
    CHECK(table.parts[1].options.labels.empty());
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "label": 7}])"), Contains("label"));
    CHECK_THAT(desk.fault(R"([{"model": "a.obj", "labell": "x"}])"), Contains("label"));
}

TEST_CASE("A part may be a box, a cylinder or a finished print") {
    const Desk desk;
    const std::string text = R"({"format": "voxtone-tray", "version": 1, "size": "20mm", "parts": [
        {"model": "a.obj"},
        {"box": [10, 5, 2.5], "resin": "VeroClear", "copies": 2},
        {"cylinder": {"diameter": 8, "height": 2}, "mixture": {"VeroWhite": 1, "T": 3, "K": 0}, "name": "puck"},
        {"box": [1, 2, 3], "cuts": true, "at": [1, 2], "priority": 5},
        {"stack": "other/OUT/"}, {"gcvf": "/x/print.gcvf"}]})";
    CHECK(io::schema_faults("tray", text) == std::vector<std::string>{});
    const TrayPlan plan = read_tray_plan(desk.write(text), {});
    REQUIRE(plan.parts.size() == 6);
    CHECK_FALSE(plan.parts[0].component);
    const TrayPart& box = plan.parts[1];
    REQUIRE(box.component);
    CHECK(box.name == "box-1");
    CHECK(box.copies == 2);
    CHECK(box.component->kind == ComponentKind::box);
    CHECK(box.component->size_mm == std::array<double, 3>{10, 5, 2.5});
    REQUIRE(box.component->mixture.size() == 1);
    CHECK(box.component->mixture[0].resin == "VeroClear");
    CHECK(plan.parts[2].name == "puck");
    CHECK(plan.parts[2].component->size_mm == std::array<double, 3>{8, 8, 2});
    REQUIRE(plan.parts[2].component->mixture.size() == 2);  // in the order of their names
    CHECK(plan.parts[2].component->mixture[0].resin == "T");
    CHECK(plan.parts[2].component->mixture[0].share == 3);
    CHECK(plan.parts[3].cuts);
    CHECK(plan.parts[3].component->mixture.empty());
    CHECK(plan.parts[4].name == "OUT");
    CHECK(plan.parts[4].component->path == (desk.folder.path() / "other/OUT").string());
    CHECK(plan.parts[5].name == "print");
    CHECK(plan.parts[5].component->path == "/x/print.gcvf");

    const std::string table = desk.write(
        "box,cylinder,stack,resin,mixture,cuts\n10 5 2,,,W,,\n,8 x 2,,,W:1+VeroCyan:2.5,\n,,old,,,\n1 1 1,,,,,true\n",
        "t.csv");
    CHECK(is_tray_plan(table));
    const TrayPlan rows = read_tray_plan(table, {});
    REQUIRE(rows.parts.size() == 4);
    CHECK(rows.parts[0].component->size_mm == std::array<double, 3>{10, 5, 2});
    CHECK(rows.parts[1].component->size_mm == std::array<double, 3>{8, 8, 2});
    CHECK(rows.parts[1].component->mixture[1].resin == "VeroCyan");
    CHECK(rows.parts[1].component->mixture[1].share == 2.5);
    CHECK(rows.parts[2].name == "old");
    CHECK(rows.parts[3].cuts);
}

TEST_CASE("What a component cannot be, and what cannot be asked of it, is a sentence") {
    const Desk desk;
    CHECK_THAT(desk.fault(R"([{"box": [1, 2], "resin": "W"}])"), Contains("three sizes"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 0], "resin": "W"}])"), Contains("0.001 to 10000"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3]}])"), Contains("of no resin") && Contains("cuts"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3], "model": "a.obj"}])"), Contains("one thing"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3], "stack": "a"}])"), Contains("\"box\"") && Contains("one thing"));
    CHECK_THAT(desk.fault(R"([{"cylinder": {"diameter": 3}, "resin": "W"}])"), Contains("height"));
    CHECK_THAT(desk.fault(R"([{"cylinder": {"diameter": 3, "hight": 3}, "resin": "W"}])"), Contains("hight"));
    CHECK_THAT(desk.fault(R"([{"cylinder": [3, 4], "resin": "W"}])"), Contains("diameter"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3], "mixture": {"W": 0}}])"), Contains("mixes nothing"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3], "mixture": {"W": -1}}])"), Contains("W") && Contains("-1"));
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3], "mixture": {"W": 1}, "resin": "W"}])"), Contains("leave one"));
    CHECK_THAT(desk.fault(R"([{"stack": "a", "resin": "W"}])"), Contains("its own resins"));
    for (const char* option :
         {R"("size": "2mm")", R"("scale": 2)", R"("turn": true)", R"("rotate": "z90")", R"("label": "x")"}) {
        CAPTURE(option);
        CHECK_THAT(desk.fault(fmt::format(R"([{{"stack": "a", {}}}])", option)),
                   Contains("is for a model") && Contains("sliced already"));
    }
    CHECK_THAT(desk.fault(R"([{"box": [1, 2, 3], "resin": "W", "size": "2mm"}])"), Contains("plain voxels"));
    CHECK_THAT(desk.fault(R"([{"stack": ""}])"), Contains("names nothing"));
    CHECK_THAT(desk.fault(R"([{"name": "x"}])"), Contains("model") && Contains("stack"));
    CHECK(io::schema_faults("tray",
                            R"({"format": "voxtone-tray", "version": 1, "parts": [{"box": [1, 2, 3], "stack": "a"}]})")
              .size() > 0);
}

TEST_CASE("A part may have the options of a job file, and say otherwise") {
    const Desk desk;
    std::filesystem::create_directories(desk.folder.path() / "jobs/done");
    desk.write(R"({"format": "voxtone-job", "version": 1, "model": "cow.obj", "size": "30mm", "depth": "0.8mm",
                   "printer": "stratasys-j55", "load": "C,M,W", "out": "elsewhere", "threads": 7, "seed": 5})",
               "jobs/cow.json");
    desk.write(R"({"format": "voxtone-job", "version": 1, "model": "../../tray.json"})", "jobs/done/job.json");
    const std::string text = R"({"format": "voxtone-tray", "version": 1, "seed": 3, "printer": "stratasys-j750-hq",
        "parts": [{"job": "jobs/cow.json", "depth": "0.6mm", "copies": 2},
                  {"job": "jobs/cow.json", "model": "calf.obj", "name": "calf"}]})";
    CHECK(io::schema_faults("tray", text) == std::vector<std::string>{});
    const TrayPlan plan = read_tray_plan(desk.write(text), {});
    REQUIRE(plan.parts.size() == 2);
    const TrayPart& cow = plan.parts[0];
    CHECK(cow.name == "cow");
    CHECK(cow.options.model == (desk.folder.path() / "jobs/cow.obj").string());
    CHECK(plan.parts[1].options.model == (desk.folder.path() / "calf.obj").string());
    CHECK(cow.options.size_mm == 30);
    CHECK(cow.options.depth_mm == 0.6);
    CHECK(cow.options.seed == 5);
    // What is the whole tray's stays so; which printer the job was for is kept, to be compared.
    CHECK(cow.options.printer == "stratasys-j750-hq");
    CHECK(cow.options.out.empty());
    CHECK(cow.options.threads == 0);
    CHECK(cow.options.load == std::vector<std::string>{"C", "M", "W"});
    REQUIRE(cow.job);
    CHECK(cow.job->printer == "stratasys-j55");
    CHECK(cow.job->folder.empty());
    CHECK(plan.parts[1].options.depth_mm == 0.8);

    CHECK_THAT(desk.fault(R"([{"job": "jobs"}])"), Contains("holds no job.json"));
    CHECK_THAT(desk.fault(R"([{"job": "gone.json"}])"), Contains("gone.json"));
    CHECK_THAT(desk.fault(R"([{"job": "jobs/done"}])"), Contains("whole tray"));
    CHECK_THAT(desk.fault(R"([{"job": "jobs/cow.json", "stack": "x"}])"), Contains("one thing"));
}
