// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/colour_range.h"

#include <cmath>

#include <fmt/format.h>
#include "tests/io/models/model_test.h"

using Eigen::Vector4d;
using Eigen::Vector4f;

namespace {

const Vector3f red(linear(200 / 255.0), linear(40 / 255.0), linear(40 / 255.0));

std::string ply(const std::string& vertex, const std::string& face, const std::string& colour_of_vertex,
                const std::string& colour_of_face) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float X\nproperty float Y\nproperty float z\n" + vertex +
           "element face 1\nproperty list uchar int vertex_indices\n" + face + "end_header\n0 0 0" + colour_of_vertex +
           "\n1 0 0" + colour_of_vertex + "\n0 1 0" + colour_of_vertex + "\n3 0 1 2" + colour_of_face + "\n";
}

/// "property TYPE red" and so on.
std::string properties(const std::string& type, const std::string& prefix = "") {
    std::string text;
    for (const char* name : {"red", "green", "blue"}) text += "property " + type + " " + prefix + name + "\n";
    return text;
}

}  // namespace

TEST_CASE("the range of colours goes by type and by what occurs") {
    using enum ColourNumbers;
    CHECK(colour_range(1, bytes) == 255);
    CHECK(colour_range(1, integers) == 255);
    CHECK(colour_range(256, integers) == 255);
    CHECK(colour_range(300, integers) == 65535);
    CHECK(colour_range(4e9, integers) == 4294967295.0);
    CHECK(colour_range(1.02, reals) == 1);
    CHECK(colour_range(1.7, reals, false) == 1);
    CHECK(colour_range(2, reals, true) == 255);
    CHECK(colour_range(30.5, reals, false) == 255);
    CHECK(colour_range(230, reals) == 255);
    CHECK(colour_range(51400, reals) == 65535);
}

TEST_CASE("colours are settled, and what is not usual is said") {
    std::vector<std::string> said;
    const auto settle = [&](const FileColours& colours) {
        said.clear();
        return settled_colours(colours, "vertex", "a.obj", said);
    };
    const auto rgb = [](const Vector4f& rgba) { return Vector3f(rgba.head<3>()); };
    FileColours colours{{Vector4d(200, 40, 40, 255), Vector4d(0, 0, 0, 0)}};
    colours.has_alpha = true;
    CHECK(near(rgb(settle(colours)[0]), red));
    CHECK(settle(colours)[0].w() == 1);
    CHECK(settle(colours)[1].w() == 0);
    REQUIRE(said.size() == 1);
    CHECK_THAT(said[0], Contains("vertex colours of a.obj") && Contains("200") && Contains("0 to 255"));

    colours.value = {Vector4d(200, 40, 40, 1), Vector4d(200, 40, 40, 0.5)};  // alpha has a range of its own
    CHECK(settle(colours)[0].w() == 1);
    CHECK(settle(colours)[1].w() == 0.5f);

    colours.value = {Vector4d(1.7, 0.25, -1, 1)};
    CHECK(near(rgb(settle(colours)[0]), {1, linear(0.25), 0}));
    REQUIRE(said.size() == 1);
    CHECK_THAT(said[0], Contains("1 vertex colours") && Contains("clamped"));

    colours.value = {Vector4d(std::nan(""), 0, 0, 1), Vector4d(0.5, 0.5, 0.5, 1)};
    CHECK(std::isnan(settle(colours)[0].x()));
    CHECK(said.empty());
    CHECK(settle({}).empty());
    CHECK(said.empty());
}

TEST_CASE("colours of every type and name, of vertices and of faces") {
    const Folder folder;
    for (const auto& [type, colour] : {std::pair{"uchar", " 200 40 40"},
                                       {"char", " -56 40 40"},
                                       {"ushort", " 200 40 40"},
                                       {"ushort", " 51400 10280 10280"},
                                       {"short", " 200 40 40"},
                                       {"short", " -14136 10280 10280"},
                                       {"int", " 200 40 40"},
                                       {"uint", " 200 40 40"},
                                       {"uint", " 3368601800 673720360 673720360"},
                                       {"float", " 0.784314 0.156863 0.156863"},
                                       {"float", " 200 40 40"},
                                       {"double", " 200.0 40.25 40.25"},
                                       {"double", " 0.784314 0.156863 0.156863"}})
        for (const std::string prefix : {"", "diffuse_", "ambient_", "vertex_", "Diffuse_"}) {
            CAPTURE(type, colour, prefix);
            const std::string names = properties(type, prefix);
            for (const bool of_face : {false, true}) {
                const ModelFile file = read(folder, {{"a.ply", ply(of_face ? "" : names, of_face ? names : "",
                                                                   of_face ? "" : colour, of_face ? colour : "")}});
                CHECK(near(corner_colour(file.mesh, 0, 0), red, 2e-3f));
                CHECK(file.lost_colour.empty());
            }
        }
    SECTION("one of several kinds") {
        const std::string both = properties("uchar", "ambient_") + properties("uchar", "diffuse_");
        CHECK(near(corner_colour(read(folder, {{"a.ply", ply(both, "", " 1 2 3 200 40 40", "")}}).mesh, 0, 0), red));
        const std::string alpha = properties("uchar") + "property float alpha\n";
        CHECK(near(corner_colour(read(folder, {{"a.ply", ply(alpha, "", " 200 40 40 1.0", "")}}).mesh, 0, 0), red));
    }
    SECTION("names that are not read are said") {
        for (const std::string name :
             {"property uint rgba\n", "property list uchar uchar colours\n", "property uchar red\n"}) {
            CAPTURE(name);
            const std::string value = name.find("list") != std::string::npos ? " 1 7" : " 7";
            CHECK_THAT(read(folder, {{"a.ply", ply(name, "", value, "")}}).lost_colour,
                       Contains(name.substr(name.rfind(' ') + 1, 3)) && Contains("red, green and blue"));
        }
    }
    SECTION("an element of materials") {
        const auto materials = [&](const std::string& indices, const std::string& index, const std::string& values,
                                   int count) {
            return read(
                folder,
                {{"m.ply",
                  ply("", indices + fmt::format("element material {}\n", count) + properties("uchar", "diffuse_"), "",
                      index + values)}});
        };
        const std::string number = "property int material_index\n";
        CHECK(near(corner_colour(materials("", "", "\n200 40 40", 1).mesh, 0, 0), red));
        CHECK(near(corner_colour(materials(number, " 1", "\n0 0 255\n200 40 40", 2).mesh, 0, 0), red));
        CHECK_THAT(materials("", "", "\n0 0 255\n200 40 40", 2).lost_colour, Contains("1 faces"));
    }
    SECTION("decimal commas are said") {
        const ModelFile file =
            read(folder, {{"a.ply", ply(properties("float"), "", " 0,784314 0,156863 0,156863", "")}});
        CHECK(near(corner_colour(file.mesh, 0, 0), red));
        CHECK_THAT(warnings(file), Contains("commas"));
    }
    SECTION("strips of unsigned numbers begin anew at the largest") {
        const ModelFile file =
            read(folder, {{"s.ply",
                           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                           "property float z\nelement tristrips 1\nproperty list uint uint vertex_indices\n"
                           "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n7 0 1 2 4294967295 2 1 3\n"}});
        CHECK(file.mesh.triangles.size() == 2);
    }
}

TEST_CASE("vertices without a colour beside others are white, and lost") {
    const Folder folder;
    const std::string corners = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
    const ModelFile some = read(folder, {{"a.obj", corners + "f 1 2 3\nf 4 5 6\n"}});
    CHECK(near(corner_colour(some.mesh, 0, 0), {1, 0, 0}));
    CHECK(near(corner_colour(some.mesh, 1, 0), {1, 1, 1}));
    CHECK_THAT(some.lost_colour, Contains("3 vertices of a.obj") && Contains("LOST"));
    CHECK_THAT(read(folder, {{"a.obj", corners + "f 1 2 4\n"}}).lost_colour, Contains("1 vertices"));
    // What nobody uses, or what a material colours, is not lost.
    CHECK(read(folder, {{"a.obj", corners + "f 1 2 3\n"}}).lost_colour.empty());
    const Files with_kd{{"a.obj", "mtllib a.mtl\n" + corners + "f 1 2 3\nusemtl m\nf 4 5 6\n"},
                        {"a.mtl", "newmtl m\nKd 0 1 0\n"}};
    CHECK(read(folder, with_kd).lost_colour.empty());
    CHECK(near(corner_colour(read(folder, with_kd).mesh, 1, 0), {0, 1, 0}));
    CHECK_THAT(read(folder, {{"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n#MRGB ffc82828ffc82828\n"}}).lost_colour,
               Contains("1 vertices"));
    const std::string holes = ply(properties("float"), "", " 0.5 0.5 0.5", "");
    const std::size_t last = holes.rfind("0.5 0.5 0.5");
    CHECK_THAT(read(folder, {{"n.ply", holes.substr(0, last) + "nan nan nan" + holes.substr(last + 11)}}).lost_colour,
               Contains("1 vertices of n.ply"));
}
