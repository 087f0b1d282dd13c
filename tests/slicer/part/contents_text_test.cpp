// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of files, to the word.
#include "slicer/part/contents_text.h"

#include <catch2/catch.hpp>

#include <array>
#include <string>

#include <nlohmann/json.hpp>

using namespace voxtone;
using namespace voxtone::slicer;
using nlohmann::json;

namespace {

ModelContents fox() {
    ModelContents contents;
    contents.file = "fox.obj", contents.format = "OBJ", contents.unit_is = "file", contents.mm_per_unit = 25.4;
    contents.size_mm = {12.34567, 8, 100.5};
    contents.triangles = 576, contents.vertices = 1, contents.parts = 2;
    contents.textures = {{64, 32}, {16, 8}};
    contents.materials = {{"fur", {1, 0.2158605, 0}, 1, 500}, {"", {0, 0, 1}, {}, 76}};
    contents.side_files = {{"fox.mtl", "ab"}, {"fur.png", ""}, {"eye.png", ""}};
    contents.vertex_colours = contents.material_colours = true;
    contents.notes = {"it is small"}, contents.warnings = {"a picture is not there"};
    contents.refused = "too large";
    return contents;
}

}  // namespace

TEST_CASE("What is in a model is told in lines") {
    CHECK(contents_text(std::array{fox()}) ==
          "fox.obj: OBJ, 12.35 x 8 x 100.5 mm (unit: 25.4 mm by the file)\n"
          "  2 parts, 576 triangles, 1 vertex\n"
          "  colour: textures 64 x 32 px, 16 x 8 px; colours of vertices; colours of materials\n"
          "  materials: fur texture 2, without a name #0000ff\n"
          "  not there: fur.png, eye.png\n"
          "  it is small\n"
          "  warning: a picture is not there\n"
          "  would be refused: too large\n");
    ModelContents plain;
    plain.file = "a.stl", plain.format = "STL", plain.unit_is = "assumed";
    plain.parts = plain.triangles = 1, plain.vertices = 3;
    CHECK(contents_text(std::array{plain}) ==
          "a.stl: STL (unit: mm assumed, the file says none)\n  1 part, 1 triangle, 3 vertices\n  colour: none\n");
    plain.unit_is = "asked", plain.mm_per_unit = 0.5, plain.textures = {{4, 2}};
    CHECK(contents_text(std::array{plain}) ==
          "a.stl: STL (unit: 0.5 mm as asked)\n  1 part, 1 triangle, 3 vertices\n  colour: texture 4 x 2 px\n");
}

TEST_CASE("Of many materials eight are told, and how many more there are") {
    ModelContents contents = fox();
    contents.materials.assign(8, {"m", {0, 0, 0}, {}, 1});
    const auto told = [&] { return contents_text(std::array{contents}); };
    CHECK_THAT(told(), Catch::Matchers::Contains("m #000000, m #000000\n"));
    CHECK_THAT(told(), !Catch::Matchers::Contains("more"));
    contents.materials.resize(10, {"m", {0, 0, 0}, {}, 1});
    CHECK_THAT(told(), Catch::Matchers::Contains("m #000000, and 2 more\n"));
}

TEST_CASE("Of a picture pixels are told, and of what cannot be read why") {
    ModelContents picture;
    picture.file = "p.png", picture.format = "picture", picture.picture_px = {20, 10}, picture.dpi = 299.6;
    picture.size_mm = {1.7, 0.85, 4};
    ModelContents broken;
    broken.file = "b.obj", broken.error = "it ends early", broken.exit_code = ExitCode::invalid_input;
    CHECK(contents_text(std::array{picture, broken}) ==
          "p.png: picture, 20 x 10 px of 300 dpi, 1.7 x 0.85 x 4 mm\nb.obj\n  cannot be read: it ends early\n");
    const json told = json::parse(contents_json(std::array{picture, broken}));
    CHECK((told.at("format") == "voxtone-contents" && told.at("version") == 1));
    REQUIRE(told.at("files").size() == 2);
    const json &first = told["files"][0], &second = told["files"][1];
    CHECK(first.at("picture") == json{{"size_px", {20, 10}}, {"dpi", 299.6}});
    CHECK(first.at("colour") == json{"picture"});
    CHECK(first.at("size_mm") == json{1.7, 0.85, 4});
    CHECK_FALSE(first.contains("triangles"));
    CHECK(second == json{{"file", "b.obj"}, {"error", "it ends early"}, {"exit_code", int(ExitCode::invalid_input)}});
    picture.dpi = 0, picture.size_mm.reset();
    CHECK(contents_text(std::array{picture}) == "p.png: picture, 20 x 10 px\n");
    CHECK_FALSE(json::parse(contents_json(std::array{picture}))["files"][0]["picture"].contains("dpi"));
}

TEST_CASE("Programs are told the same of a model") {
    const json told = json::parse(contents_json(std::array{fox()}))["files"][0];
    CHECK(told.at("unit") == json{{"mm", 25.4}, {"is", "file"}});
    CHECK((told.at("parts") == 2 && told.at("triangles") == 576 && told.at("vertices") == 1));
    CHECK(told.at("colour") == json{"textures", "vertices", "materials"});
    CHECK(told.at("textures") == json::array({{{"size_px", {64, 32}}}, {{"size_px", {16, 8}}}}));
    CHECK(told.at("materials") ==
          json::array({{{"name", "fur"}, {"colour", "#ff8000"}, {"texture", 1}, {"triangles", 500}},
                       {{"name", ""}, {"colour", "#0000ff"}, {"triangles", 76}}}));
    CHECK(told.at("beside") == json::array({{{"file", "fox.mtl"}, {"found", true}},
                                            {{"file", "fur.png"}, {"found", false}},
                                            {{"file", "eye.png"}, {"found", false}}}));
    CHECK(told.at("warnings") == json{"a picture is not there"});
    CHECK(told.at("notes") == json{"it is small"});
    CHECK(told.at("refused") == "too large");
}
