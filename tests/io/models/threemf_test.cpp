// SPDX-License-Identifier: GPL-3.0-or-later
//
// 3MF packages as the world packs them, what is said of those that hold no body, and what slicers write into them.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/models/slicer_roles.h"
#include "tests/io/models/model_test.h"

namespace {

std::string object(const std::string& attributes, const std::vector<std::string>& triangles = {}) {
    return fmt::format("<object {}>{}</object>", attributes, threemf_tetrahedron(1, triangles));
}

std::string model_part(const std::string& resources, const std::string& build = R"(<item objectid="1"/>)") {
    return fmt::format(R"(<?xml version="1.0"?><model unit="millimeter" )"
                       R"(xmlns:q="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">)"
                       "<resources>{}</resources><build>{}</build></model>",
                       resources, build);
}

std::string relationships(const std::string& target) {
    return R"(<Relationships><Relationship Target=")" + target +
           R"(" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
}

/// Every second byte 0, behind a mark.
std::string utf16(const std::string& text) {
    std::string wide = "\xff\xfe";
    for (const char c : text) {
        wide += c;
        wide += '\0';
    }
    return wide;
}

ModelFile read_package(const Folder& folder, const Files& parts) {
    return read_model_here(folder.write({{"a.3mf", zip(parts)}}));
}

std::string refusal(const Folder& folder, const Files& parts) {
    return refusal_by([&] { return read_package(folder, parts); });
}

/// Of all corners of a triangle, which are alike.
Vector3f colour_of(const ModelFile& file, std::size_t t) {
    return file.mesh.corner_rgb.empty() ? Vector3f(1, 1, 1) : file.mesh.corner_rgb[t][0];
}

const Vector3f red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), white(1, 1, 1);
const std::string three_filaments = "; filament_colour = #FF0000;#00FF00;#0000FF\n";

}  // namespace

TEST_CASE("A package is read however it was packed") {
    const Folder folder;
    const std::string body = object(R"(id="1")");
    const std::string model = model_part(body), rels = relationships("/3D/3dmodel.model");
    for (const Files& parts : {
             Files{{"[Content_Types].xml", ""}, {"_rels/.rels", rels}, {"3D/3dmodel.model", model}},
             Files{{"_rels\\.rels", rels}, {"3D\\3dmodel.model", model}},
             Files{{"my part/_rels/.rels", rels}, {"my part/3D/3dmodel.model", model}},
             Files{{"a/[Content_Types].xml", ""},
                   {"a/_rels/.rels", rels},
                   {"a/3D/3dmodel.model", model},
                   {"__MACOSX/a/._x", "?"}},
             Files{{"a/b/_rels/.rels", rels}, {"a/b/3D/3dmodel.model", model}},
             Files{{"readme.txt", "?"}, {"a/3D/3dmodel.model", model}},
             Files{{"_rels/.rels", relationships("3D/3dmodel.model")}, {"3D/3dmodel.model", model}},
             Files{{"_rels/.rels", relationships("/3D/my%20part.model")}, {"3D/my part.model", model}},
             Files{{"_RELS/.rels", rels}, {"3d/3DModel.model", model}},
             Files{{"3D/3dmodel.model", model}},
             Files{{"_rels/.rels", relationships("/3D/gone.model")}, {"3D/other.model", model}},
             Files{{"_rels/.rels", rels}, {"3D/3dmodel.model", utf16(model)}},
             Files{{"_rels/.rels", utf16(rels)}, {"3D/3dmodel.model", model}},
         }) {
        INFO(parts.back().first);
        CHECK(read_package(folder, parts).mesh.triangles.size() == 4);
    }
    CHECK_THAT(warnings(read_package(folder, {{"a/_rels/.rels", rels}, {"a/3D/3dmodel.model", model}})),
               Contains("in a folder 'a'"));
    CHECK_THAT(
        warnings(read_package(folder, {{"_rels/.rels", relationships("/3D/gone.model")}, {"3D/x.model", model}})),
        Contains("/3D/gone.model") && Contains("'/3D/x.model', was taken"));
}

TEST_CASE("A package that has no model is told by what it has") {
    const Folder folder;
    CHECK_THAT(refusal(folder, {{"box.obj", "v 0 0 0"}, {"box.mtl", ""}}), Contains("a ZIP archive and no 3MF file") &&
                                                                               Contains("are '/box.mtl', '/box.obj'") &&
                                                                               Contains("Unpack"));
    const std::string model = model_part(object(R"(id="1")"));
    CHECK_THAT(refusal(folder, {{"a/3D/x.model", model}, {"b/3D/y.model", model}}),
               Contains("no part '/3D/3dmodel.model'") && Contains("'/a/3D/x.model', '/b/3D/y.model'"));
    Files many;
    for (int i = 0; i < 20; ++i) many.emplace_back(fmt::format("{:02}.txt", i), "?");
    CHECK_THAT(refusal(folder, many), Contains("and 14 more"));
    CHECK_THAT(refusal(folder, {{"3D/3dmodel.model",
                                 model_part(R"(<object id="1"><components><component objectid="2" path="/3D/o.model"/>)"
                                            "</components></object>")}}),
               Contains("no part '/3D/o.model'; in it is '/3D/3dmodel.model'"));
}

TEST_CASE("A part of another unit is as large as it says") {
    const Folder folder;
    const auto part = [](const std::string& unit, const std::string& resources, const std::string& build) {
        return fmt::format(R"(<model {} xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">)"
                           "<resources>{}</resources><build>{}</build></model>",
                           unit, resources, build);
    };
    // A tetrahedron of 1, and again by a component that is moved by 1 in its own part and by 2 in the root.
    const std::string moved = R"(transform="1 0 0 0 1 0 0 0 1 {} 0 0"/>)",
                      twice = object(R"(id="1")") + R"(<object id="2"><components><component objectid="1" )" +
                              fmt::format(fmt::runtime(moved), 1) + "</components></object>";
    const auto read = [&](const std::string& unit, const std::string& of_part) {
        return read_package(
            folder,
            {{"3D/3dmodel.model", part(unit,
                                       R"(<object id="7"><components><component p:path="/3D/o.model" objectid="2" )" +
                                           fmt::format(fmt::runtime(moved), 2) + "</components></object>",
                                       R"(<item objectid="7"/><item p:path="/3D/o.model" objectid="1"/>)")},
             {"3D/o.model", part(of_part, twice, "")}});
    };
    for (const auto& [unit, mm] : std::vector<std::pair<std::string, double>>{
             {R"(unit="millimeter")", 1}, {R"(unit="micron")", 0.001}, {"", 1}, {R"(unit="inch")", 25.4}})
        for (const auto& [root, root_mm] :
             std::vector<std::pair<std::string, double>>{{R"(unit="centimeter")", 10}, {R"(unit="inch")", 25.4}}) {
            INFO(root << " and " << unit);
            const ModelFile file = read(root, unit);
            REQUIRE(file.mesh.positions.size() == 8);
            double least = 1e9, most = -1e9;
            for (const Eigen::Vector3d& p : file.mesh.positions) {
                least = std::min(least, p.x() * file.mm_per_file_unit);
                most = std::max(most, p.x() * file.mm_per_file_unit);
            }
            CHECK(least == Approx(0).margin(1e-12));
            CHECK(most == Approx(2 * root_mm + 2 * mm));
        }
}

TEST_CASE("Textures are found by any path that means them") {
    const Folder folder;
    const auto textured = [&](const std::string& path, const std::string& entry = "3D/Textures/a b.png") {
        return read_package(
            folder, {{"3D/3dmodel.model", model_part(R"(<q:texture2d id="5" path=")" + path +
                                                     R"(" contenttype="image/png"/><q:texture2dgroup id="3" texid="5">)"
                                                     R"(<q:tex2coord u="0.25" v="0.25"/></q:texture2dgroup>)" +
                                                     object(R"(id="1" pid="3" pindex="0")"))},
                     {entry, four_colours()}});
    };
    for (const char* path :
         {"/3D/Textures/a b.png", "3D/Textures/a b.png", "Textures/a b.png", "./Textures/a b.png",
          "../3D/Textures/a b.png", "/3D/Textures/a%20b.png", "Textures/a%20b.png", "\\3D\\Textures\\a b.png",
          "Textures\\a b.png", "/3d/textures/A B.PNG", "/3D/../3D/./Textures//a b.png"}) {
        INFO(path);
        const ModelFile file = textured(path);
        CHECK(file.lost_colour.empty());
        CHECK(file.mesh.materials[file.mesh.material_of_triangle[0]].texture != nullptr);
    }
    CHECK(textured("/3D/Textures/a b.png", "3D\\Textures\\a b.png").lost_colour.empty());
    CHECK(textured("/3D/Textures/a%20b.png", "3D/Textures/a%20b.png").lost_colour.empty());
    CHECK_THAT(textured("/3D/b.png").lost_colour, Contains("/3D/b.png") && Contains("/3D/Textures/a b.png"));
}

TEST_CASE("A file that holds no body says what it holds") {
    const Folder folder;
    const auto refused = [&](const std::string& resources) {
        return refusal(folder, {{"3D/3dmodel.model", model_part(resources)}});
    };
    for (const char* type : {"support", "solidsupport", "other"})
        CHECK_THAT(refused(object(fmt::format(R"(id="1" type="{}")", type))),
                   Contains("no faces to print") && Contains(fmt::format("of the type '{}'", type)));
    const std::string beams =
        R"(<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/></vertices>)"
        R"(<b:beamlattice><b:beams><b:beam v1="0" v2="1"/></b:beams></b:beamlattice></mesh></object>)";
    CHECK_THAT(refused(beams), Contains("only a beam lattice") && Contains("export it as a mesh"));
    CHECK_THAT(refused(R"(<object id="1"><v:levelset meshid="2"/></object>)"), Contains("kind 'levelset'"));
    CHECK_THAT(refused(R"(<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/></vertices></mesh></object>)"),
               Contains("points without triangles"));
    CHECK_THAT(
        refusal(folder, {{"3D/3dmodel.model", model_part(object(R"(id="1")"))},
                         {"Metadata/Slic3r_PE_model.config",
                          R"(<config><object id="1"><volume firstid="0" lastid="3">)"
                          R"(<metadata key="volume_type" value="SupportBlocker"/></volume></object></config>)"}}),
        Contains("only modifiers or blockers"));
    CHECK_THAT(refusal(folder, {{"3D/3dmodel.model",
                                 R"(<model requiredextensions="b" xmlns:b="http://schemas.microsoft.com/)"
                                 R"(3dmanufacturing/beamlattice/2017/02"><resources>)" +
                                     beams + R"(</resources><build><item objectid="1"/></build></model>)"}}),
               Contains("has a beam lattice, without which it is not to be read"));
    CHECK_THAT(refusal(folder, {{"3D/3dmodel.model", model_part("", "")}, {"Metadata/plate_1.gcode", "G1"}}),
               Contains("only instructions for a printer"));
    // A body that is not read is told beside one that is.
    const auto beside = [&](const std::string& other) {
        return read_package(folder, {{"3D/3dmodel.model", model_part(object(R"(id="1")") + other,
                                                                     R"(<item objectid="1"/><item objectid="2"/>)")}})
            .lost_colour;
    };
    CHECK_THAT(beside(R"(<object id="2"><v:levelset meshid="1"/></object>)"),
               Contains("a body whose shape is a 'levelset'") && Contains("LOST"));
    CHECK(beside(R"(<object id="2"><v:note/>)" + threemf_tetrahedron(1, {}) + "</object>").empty());
    // Two reasons, in the order in which they were found.
    CHECK_THAT(refusal(folder, {{"3D/3dmodel.model", model_part(beams + object(R"(id="2" type="support")"),
                                                                R"(<item objectid="1"/><item objectid="2"/>)")}}),
               Contains("a beam lattice") && Contains("; and an object of the type 'support'"));
}

TEST_CASE("Volumes that are no body are counted, not their triangles") {
    const Folder folder;
    const ModelFile file = read_package(
        folder, {{"3D/3dmodel.model", model_part(object(R"(id="1")"))},
                 {"Metadata/Slic3r_PE_model.config",
                  R"(<config><object id="1"><volume firstid="0" lastid="0"/><volume firstid="1" lastid="3">)"
                  R"(<metadata key="volume_type" value="SupportBlocker"/></volume></object></config>)"}});
    CHECK(file.mesh.triangles.size() == 1);
    CHECK_THAT(warnings(file), Contains("1 volume that is no part of the body"));
}

TEST_CASE("Runs of triangles are laid over each other in time that does not go with their number") {
    SlicerRoles roles;
    roles.extruder[7] = 5;
    auto& runs = roles.runs[7];
    runs.push_back({2, 9, {SlicerRole::part, 1}});
    runs.push_back({4, 5, {SlicerRole::modifier, 0}});
    runs.push_back({8, 1000, {SlicerRole::part, 2}});
    runs.push_back({3, 1, {SlicerRole::part, 9}});    // ends before it begins
    runs.push_back({50, 60, {SlicerRole::part, 9}});  // behind the last triangle
    const std::vector<SlicerSpan> spans = roles.spans(7, 7, 12);
    std::vector<int> extruders;
    std::size_t t = 0;
    for (const SlicerSpan& span : spans)
        for (; t < span.end; ++t) extruders.push_back(span.volume.role == SlicerRole::part ? span.volume.extruder : -1);
    CHECK(extruders == std::vector<int>{5, 5, 1, 1, -1, -1, 1, 1, 2, 2, 2, 2});
    CHECK(roles.spans(7, 8, 3).size() == 1);
    CHECK(roles.spans(1, 2, 0).size() == 1);
    // A hundred thousand runs, each over a million triangles.
    SlicerRoles many;
    for (std::size_t i = 0; i < 100'000; ++i) many.runs[1].push_back({i, 1'000'000, {SlicerRole::part, 1}});
    CHECK(many.spans(1, 1, 1'000'000).size() == 100'000);
    CHECK_FALSE(many.tells_colours());
}

TEST_CASE("Paint of a slicer is a tree of divisions, read from the end") {
    const auto paint = [](const std::string& text) {
        const auto found = triangle_paint(text);
        return found ? std::pair<int, bool>(found->extruder, found->is_divided) : std::pair<int, bool>(-1, false);
    };
    // As PrusaSlicer and Bambu Studio write the first extruders for a whole triangle.
    const std::vector<const char*> whole{"0", "4", "8", "0C", "1C", "2C", "3C", "4C"};
    for (std::size_t i = 0; i < whole.size(); ++i) {
        INFO(whole[i]);
        CHECK(paint(whole[i]) == std::pair<int, bool>(static_cast<int>(i), false));
    }
    CHECK(paint("0c").first == 3);
    CHECK(paint("FC").first == 18);
    CHECK(paint("4443") == std::pair<int, bool>(-1, false));  // a child is missing
    CHECK(paint("44443") == std::pair<int, bool>(1, false));  // divided in four of one colour
    CHECK(paint("84443") == std::pair<int, bool>(1, true));
    CHECK(paint("881") == std::pair<int, bool>(2, false));
    CHECK(paint("0C81").second);
    CHECK(paint("8444384443844434443").first == -1);
    for (const char* no_tree : {"", "C", "3", "44", "X", "4x", " 4"}) CHECK(paint(no_tree).first == -1);
    CHECK(paint(std::string(100'000, '1')).first == -1);  // does not exhaust the stack
}

TEST_CASE("Painted triangles have the colours of their filaments") {
    const Folder folder;
    const auto painted = [&](const std::vector<std::string>& triangles, const Files& others) {
        Files parts{{"3D/3dmodel.model", model_part(object(R"(id="1")", triangles))}};
        parts.insert(parts.end(), others.begin(), others.end());
        return read_package(folder, parts);
    };
    for (const char* key : {"slic3rpe:mmu_segmentation", "paint_color"}) {
        INFO(key);
        const auto as = [&](const char* code) { return fmt::format(R"({}="{}")", key, code); };
        const ModelFile file = painted({as("8"), as("0C"), as("4")}, {{"Metadata/Slic3r_PE.config", three_filaments}});
        CHECK(file.has_colour);
        CHECK(file.lost_colour.empty());
        CHECK(colour_of(file, 0) == green);
        CHECK(colour_of(file, 1) == blue);
        CHECK(colour_of(file, 2) == red);
        CHECK(colour_of(file, 3) == red);  // what is not painted is printed by the first
        const ModelFile parts =
            painted({as("8"), as("84443"), as("84")}, {{"Metadata/Slic3r_PE.config", three_filaments}});
        CHECK_THAT(parts.lost_colour, Contains("1 of 3 painted triangles") && Contains("in a way that is not known"));
        CHECK_THAT(painted({as("8")}, {}).lost_colour, Contains("1 triangle") && Contains("LOST"));
        CHECK_THAT(painted({as("4C")}, {{"Metadata/Slic3r_PE.config", three_filaments}}).lost_colour,
                   Contains("extruder 7 and does not say"));
        // Said to be painted by none: no paint.
        CHECK_FALSE(painted({as("0")}, {{"Metadata/Slic3r_PE.config", three_filaments}}).has_colour);
    }
    // What is not painted has its volume's extruder; a colour of the model's own stays.
    const ModelFile both = read_package(
        folder, {{"3D/3dmodel.model", model_part(R"(<q:colorgroup id="9"><q:color color="#00FF00"/></q:colorgroup>)" +
                                                 object(R"(id="1")", {R"(paint_color="4")", R"(pid="9" p1="0")", ""}))},
                 {"Metadata/project_settings.config", R"({"filament_colour": ["#FF0000", "#0000FF"]})"},
                 {"Metadata/model_settings.config",
                  R"(<config><object id="1"><metadata key="extruder" value="2"/></object></config>)"}});
    CHECK(colour_of(both, 0) == red);
    CHECK(colour_of(both, 1) == green);
    CHECK(colour_of(both, 2) == blue);
}

TEST_CASE("A triangle that is painted in parts has the colours of all of them") {
    const Folder folder;
    for (const char* key : {"slic3rpe:mmu_segmentation", "paint_color"}) {
        const auto as = [&](const char* code) { return fmt::format(R"({}="{}")", key, code); };
        const Files filaments{{"Metadata/Slic3r_PE.config", three_filaments}};
        const auto painted = [&](const std::string& attributes) {
            return read_package(folder,
                                {{"3D/3dmodel.model", model_part(object(R"(id="1")", {attributes}))}, filaments[0]});
        };
        const ModelFile four = painted(as("48883"));
        CHECK(four.lost_colour.empty());
        CHECK(four.mesh.triangles.size() == 4 + 3 * 2);  // its neighbours are cut at the sides that they share
        for (std::size_t t = 0; t < 3; ++t) CHECK(colour_of(four, t) == green);
        CHECK(colour_of(four, 3) == red);
        for (std::size_t t = 4; t < 10; ++t) CHECK(colour_of(four, t) == red);
        CHECK(painted(as("4")).mesh.triangles.size() == 4);
        CHECK(painted(as("44443")).mesh.triangles.size() == 4);  // of one colour
        // A colour of the model's own comes first.
        const ModelFile own = read_package(
            folder,
            {{"3D/3dmodel.model", model_part(R"(<q:colorgroup id="9"><q:color color="#0000FF"/></q:colorgroup>)" +
                                             object(R"(id="1" pid="9" pindex="0")", {as("48883")}))},
             filaments[0]});
        CHECK(own.mesh.triangles.size() == 4);
        CHECK(colour_of(own, 0) == blue);
    }
}

TEST_CASE("Colours and shapes that a volume gives are lost by its name") {
    const Folder folder;
    const auto with = [&](const std::string& volume, const std::string& mesh_attribute, const std::string& child = "") {
        std::string mesh = object(R"(id="1")");
        mesh.replace(mesh.find("<mesh"), 5, "<mesh " + mesh_attribute);
        mesh.insert(mesh.find("</mesh>"), child);
        return read_package(
            folder, {{"3D/3dmodel.model",
                      R"(<model unit="millimeter" xmlns:v="http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01">)"
                      "<resources>" +
                          volume + mesh + R"(</resources><build><item objectid="1"/></build></model>)"}});
    };
    const std::string coloured = R"(<v:volumedata id="9"><v:color functionid="8" channel="color"/></v:volumedata>)";
    const ModelFile lost = with(coloured, R"(v:volumeid="9")");
    CHECK_THAT(lost.lost_colour, Contains("volumedata 9") && Contains("LOST"));
    CHECK(lost.has_colour);
    CHECK(with(coloured, "").lost_colour.empty());  // nobody's
    CHECK(with(R"(<v:volumedata id="9"><v:property name="density"/></v:volumedata>)", R"(v:volumeid="9")")
              .lost_colour.empty());
    const std::string shaped = R"(<v:volumedata id="9"><v:boundary functionid="8" channel="shape"/></v:volumedata>)";
    const ModelFile whole = with(shaped, R"(v:volumeid="9")");
    CHECK_THAT(whole.lost_colour, Contains("boundary of volumedata 9") && Contains("LOST"));
    CHECK_THAT(whole.lost_colour, !Contains("gives colours"));
    CHECK(with(shaped, "").lost_colour.empty());
    // Within a mesh, as the first drafts had it.
    const auto within = [&](const std::string& child) {
        return with("", "", "<v:volumedata><v:" + child + "/></v:volumedata>").lost_colour;
    };
    CHECK_THAT(within("color"), Contains("gives colours") && !Contains("boundary"));
    CHECK_THAT(within("boundary"), Contains("boundary") && !Contains("gives colours"));
    CHECK(within("property").empty());
}

TEST_CASE("Colours of filaments are found by their key, each at its place") {
    const auto colours = [](std::string_view text) {
        SlicerRoles roles;
        read_slicer_colours(text, roles);
        return roles.colours;
    };
    const auto list = [&](std::string_view text) {
        std::string all;
        for (const auto& colour : colours(text))
            all += !colour ? "-" : *colour == red ? "r" : *colour == green ? "g" : *colour == blue ? "b" : "?";
        return all;
    };
    CHECK(list(three_filaments) == "rgb");
    CHECK(list("; filament_colour = #FF0000;#00FF00FF\n; other = #0000FF\n") == "rg");
    // Those of extruders come before; where they are not given, the filaments'.
    CHECK(list("; extruder_colour = ;;\n; filament_colour = #FF0000;#00FF00;#0000FF\n") == "rgb");
    CHECK(list("; extruder_colour = ;#0000FF\n; filament_colour = #FF0000;#00FF00\n") == "rb");
    CHECK(list("; filament_colour = ;#00FF00\n") == "-g");
    CHECK(list("; filament_colour = \n").empty());
    // JSON, with longer keys before it and the colour of the machine's extruder.
    CHECK(list(R"({"default_filament_colour": [""], "extruder_colour": ["#018001"],
                  "filament_colour": ["#FF0000", "", "#0000FF"], "filament_colour_type": ["1"]})") == "r-b");
    CHECK(list("{\n    \"filament_colour\": [\n        \"#FF0000\",\n        \"#00FF00\"\n    ],\n    \"x\": "
               "\"#0000FF\"\n}") == "rg");
    CHECK(list(R"({"default_filament_colour": ["#FF0000"]})").empty());
    const Folder folder;
    CHECK_THAT(read_package(folder, {{"3D/3dmodel.model",
                                      model_part(object(R"(id="1")", {R"(paint_color="4")", R"(paint_color="8")"}))},
                                     {"Metadata/project_settings.config", R"({"filament_colour": ["", "#00FF00"]})"}})
                   .lost_colour,
               Contains("extruder 1 and does not say what colour"));
}

TEST_CASE("Elements and attributes of other namespaces are passed over with all in them") {
    const Folder folder;
    const auto read = [&](const std::string& namespaces, const std::string& resources,
                          const std::string& build = R"(<item objectid="1"/>)") {
        return read_package(folder, {{"3D/3dmodel.model", fmt::format("<model {}><resources>{}</resources><build>{}"
                                                                      "</build></model>",
                                                                      namespaces, resources, build)}});
    };
    const std::string core = R"(xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02")",
                      other = R"(xmlns:q="urn:x")";
    const auto body = [](const std::string& vertex, const std::string& triangle, const std::string& mesh) {
        return R"(<object id="1"><mesh><vertices><vertex q:x="9" x="0" y="0" z="0"/>)" + vertex +
               R"(<vertex x="5" y="0" z="0"/><vertex x="0" y="5" z="0"/><vertex x="0" y="0" z="5"/></vertices>)"
               R"(<triangles><triangle v1="0" v2="2" v3="1"/>)" +
               triangle +
               R"(<triangle v1="0" v2="1" v3="3" q:mmu_segmentation="8"/><triangle v1="1" v2="2" v3="3"/>)"
               R"(<triangle v1="2" v2="0" v3="3"/></triangles>)" +
               mesh + "</mesh></object>";
    };
    const auto size_of = [](const ModelFile& file) {
        Eigen::Vector3d low = file.mesh.positions.at(0), high = low;
        for (const Eigen::Vector3d& p : file.mesh.positions) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        return Eigen::Vector3d(high - low);
    };
    const std::string foreign_vertex = R"(<q:vertex x="0" y="0" z="1"/>)";
    for (const std::string& resources :
         {body(foreign_vertex, "", ""), body(R"(<vertex xmlns="urn:x" x="0" y="0" z="1"/>)", "", ""),
          body("<q:note><vertex x=\"0\" y=\"0\" z=\"1\"/></q:note>", "", ""),
          body(R"(<vertices xmlns="urn:x"><vertex x="0" y="0" z="1"/></vertices>)", "", ""),
          body("", R"(<q:triangle v1="0" v2="0" v3="0"/><q:x><triangle v1="7" v2="8" v3="9"/></q:x>)", ""),
          body("", "", R"(<q:beamlattice><q:beams><q:beam v1="0" v2="1"/></q:beams></q:beamlattice>)"),
          R"(<q:object id="1"/><q:thing id="no number"/><q:basematerials id="1"><base/></q:basematerials>)" +
              body("", "", "")}) {
        INFO(resources);
        const ModelFile file = read(core + " " + other, resources);
        CHECK(file.mesh.triangles.size() == 4);
        CHECK(size_of(file) == Eigen::Vector3d(5, 5, 5));
        CHECK(file.lost_colour.empty());
        CHECK_FALSE(file.has_colour);
    }
    CHECK(read(core + " " + other, body("", "", ""), R"(<q:item objectid="7"/><item objectid="1" q:path="/3D/none"/>)")
              .mesh.triangles.size() == 4);
    // A vertex that is of the materials, by name only, is none.
    CHECK(size_of(read(core + R"( xmlns:q="http://schemas.microsoft.com/3dmanufacturing/material/2015/02")",
                       body(foreign_vertex, "", ""))) == Eigen::Vector3d(5, 5, 5));
    // Another address for the core, none at all, or by a prefix: it is what <model> is of.
    for (const char* namespaces : {"", R"(xmlns="http://schemas.microsoft.com/3dmanufacturing/2013/01")",
                                   R"(xmlns="http://schemas.3mf.io/3dmanufacturing/core/2031/02")"})
        CHECK(read(std::string(namespaces) + " " + other, body(foreign_vertex, "", "")).mesh.triangles.size() == 4);
    const std::string prefixed =
        R"(<c:model xmlns:c="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" )"
        R"(xmlns="urn:x"><c:resources><c:object id="1"><c:mesh><c:vertices>)"
        R"(<c:vertex x="0" y="0" z="0"/><vertex x="9" y="9" z="9"/><c:vertex x="1" y="0" z="0"/>)"
        R"(<c:vertex x="0" y="1" z="0"/></c:vertices><c:triangles>)"
        R"(<c:triangle v1="0" v2="1" v3="2"/></c:triangles></c:mesh></c:object></c:resources>)"
        R"(<c:build><c:item objectid="1"/></c:build></c:model>)";
    CHECK(size_of(read_package(folder, {{"3D/3dmodel.model", prefixed}})) == Eigen::Vector3d(1, 1, 0));
    // Materials by any prefix, by their own alone where it is not declared, or without.
    for (const auto& [namespaces, prefix] : std::vector<std::pair<std::string, std::string>>{
             {R"(xmlns:z="http://schemas.microsoft.com/3dmanufacturing/material/2015/02")", "z:"},
             {"", "m:"},
             {"", ""}}) {
        INFO(namespaces << prefix);
        const ModelFile file =
            read(core + " " + namespaces,
                 fmt::format(R"(<{0}colorgroup id="9"><{0}color color="#FF0000"/></{0}colorgroup>)", prefix) +
                     object(R"(id="1" pid="9" pindex="0")"));
        CHECK(file.has_colour);
        CHECK(colour_of(file, 0) == red);
    }
    // Properties of somebody else's are lost, and said to be.
    CHECK_THAT(read(core + " " + other, R"(<q:colorgroup id="9"><q:color color="#FF0000"/></q:colorgroup>)" +
                                            object(R"(id="1" pid="9" pindex="0")"))
                   .lost_colour,
               Contains("of the kind 'colorgroup', which cannot be read"));
}

TEST_CASE("What a part requires is refused where it is not understood, declared or not") {
    const Folder folder;
    const auto refused = [&](const std::string& attributes) {
        return refusal(folder, {{"3D/3dmodel.model", fmt::format("<model {}><resources>{}</resources><build>"
                                                                 R"(<item objectid="1"/></build></model>)",
                                                                 attributes, object(R"(id="1")"))}});
    };
    CHECK_THAT(refused(R"(requiredextensions="z" xmlns:z="urn:material")"), Contains("extension urn:material"));
    CHECK_THAT(refused(R"(requiredextensions="m z")"), Contains("not known here") && Contains("extension z"));
    CHECK(refused(R"(requiredextensions="z p" xmlns:z="http://schemas.3mf.io/3dmanufacturing/material/2031/02")") ==
          "no error");
}
