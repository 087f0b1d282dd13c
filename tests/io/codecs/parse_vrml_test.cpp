// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_vrml.h"

#include <numbers>

#include <zlib.h>
#include "io/files/base64.h"
#include "tests/io/models/model_test.h"

namespace {

const std::string vrml_2 = "#VRML V2.0 utf8\n";

ModelFile read_vrml_of(const std::string& nodes, const Files& others = {}) {
    return read_alone({{"a.wrl", vrml_2 + nodes}}, others);
}

std::string error_of_wrl(const std::string& bytes, const std::string& name = "a.wrl") {
    return refusal_by([&] { return read_alone({{name, bytes}}); });
}

/// A square in x and y, corners 0 1 2 3, cut in two along its diagonal, with more fields.
std::string square(const std::string& fields, const std::string& index = "0 1 2 -1 0 2 3 -1") {
    return "geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0] } coordIndex [" + index +
           "] " + fields + " }";
}
std::string shape(const std::string& appearance, const std::string& geometry) {
    return "Shape { appearance Appearance { " + appearance + " } " + geometry + " }\n";
}
const std::string red_material = "material Material { diffuseColor 0.5 0 0 }";

/// Corners that are one: of a closed surface there are two more than edges less faces.
bool is_closed_ball(const ModelFile& file) { return 2 * file.mesh.positions.size() == file.mesh.triangles.size() + 4; }

std::string packed_by_gzip(const std::string& text) {
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, text.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

const Vector3f red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), white(1, 1, 1);

}  // namespace

TEST_CASE("VRML: colours of shapes, of vertices and of faces, straight and by an index") {
    const ModelFile plain = read_vrml_of(shape(red_material, square("")));
    CHECK(plain.format == "VRML");
    CHECK(plain.mm_per_file_unit == 0);
    CHECK(plain.has_colour);
    REQUIRE(plain.mesh.triangles.size() == 2);
    CHECK(corner_place(plain, 0, 2) == Vector3d(1, 0, 1));  // y up to z up
    CHECK(near(corner_colour(plain.mesh, 0, 0), {linear(0.5), 0, 0}));
    const std::string colours = "color Color { color [1 0 0, 0 1 0, 0 0 1, 1 1 1] } ";
    const auto colour = [&](const std::string& fields, std::size_t t, std::size_t c) {
        return corner_colour(read_vrml_of(shape(red_material, square(colours + fields))).mesh, t, c);
    };
    CHECK(near(colour("", 1, 1), blue));
    CHECK(near(colour("colorIndex [3 2 1 -1 0 0 0 -1]", 0, 1), blue));
    CHECK(near(colour("colorPerVertex FALSE", 1, 0), green));
    CHECK(near(colour("colorPerVertex FALSE colorIndex [2 3]", 0, 2), blue));
    const ModelFile few = read_vrml_of(shape("", square("color Color { color [1 0 0] }")));
    CHECK_THAT(few.lost_colour, Contains("have no colour") && Contains("LOST"));
    // As many as faces, where vertices would want more: VTK's of faces.
    const ModelFile by_count = read_vrml_of(shape("", square("color Color { color [1 0 0, 0 0 1] }")));
    CHECK(near(corner_colour(by_count.mesh, 1, 2), blue));
    CHECK_THAT(warnings(by_count), Contains("those of the faces") && Contains("[which-colour]"));
    CHECK(by_count.lost_colour.empty());
    // Of 0 to 255, as some write them.
    const ModelFile bytes = read_vrml_of(shape("", square("color Color { color [255 0 0, 0 128 0, 0 0 255, 9 9 9] }")) +
                                         shape("material Material { diffuseColor 0 128 0 }", square("")));
    CHECK(near(corner_colour(bytes.mesh, 0, 1), {0, linear(128 / 255.0), 0}));
    CHECK(near(corner_colour(bytes.mesh, 2, 1), {0, linear(128 / 255.0), 0}));
    CHECK_THAT(warnings(bytes), Contains("0 to 255") && Contains("[colour-range]"));
    const ModelFile none = read_vrml_of("Shape { " + square("") + " }");
    CHECK_FALSE(none.has_colour);
    // What glows and has no colour; half transparent.
    const ModelFile glow = read_vrml_of(shape("material DEF lamp Material { emissiveColor 0 0 1 }", square("")));
    CHECK(near(corner_colour(glow.mesh, 0, 0), blue));
    CHECK_THAT(warnings(glow), Contains("'lamp'") && Contains("[which-colour]"));
    const ModelFile glass =
        read_vrml_of(shape("material Material { diffuseColor 0 0 0 transparency 0.25 }", square("")));
    CHECK(near(corner_colour(glass.mesh, 0, 0), {0.25f, 0.25f, 0.25f}));
}

TEST_CASE("VRML: textures by name, by the first of several that is there, by pixels") {
    const std::string quarters = "texCoord TextureCoordinate { point [0.25 0.25, 0.75 0.25, 0.75 0.75, 0.25 0.75] } ";
    const Files picture{{"skin.png", four_colours()}};  // red, green / blue, white
    const std::string image = "texture ImageTexture { url [\"gone.png\" \"skin.png\"] }";
    const ModelFile file = read_vrml_of(shape(image, square(quarters)), picture);
    CHECK(near(corner_colour(file.mesh, 0, 0), blue));
    CHECK(near(corner_colour(file.mesh, 0, 2), green));
    CHECK(warnings(file).empty());
    const ModelFile indexed =
        read_vrml_of(shape(image, square(quarters + "texCoordIndex [3 3 3 -1 0 0 0 -1]")), picture);
    CHECK(near(corner_colour(indexed.mesh, 0, 1), red));
    CHECK(near(corner_colour(indexed.mesh, 1, 1), blue));
    // Moved by half a picture; turned by a quarter about the corner that moved to.
    const ModelFile moved = read_vrml_of(
        shape(image + " textureTransform TextureTransform { translation 0.5 0 }", square(quarters)), picture);
    CHECK(near(corner_colour(moved.mesh, 0, 0), white));
    const ModelFile turned = read_vrml_of(
        shape(image + " textureTransform TextureTransform { rotation 1.5707963 scale 1 2 }", square(quarters)),
        picture);
    CHECK((turned.mesh.corner_uv[0][1] - Vector2f(-0.25f, 1.5f)).norm() < 1e-5f);
    const std::string png = four_colours(),
                      inside = "data:image/png;base64," +
                               base64({reinterpret_cast<const std::uint8_t*>(png.data()), png.size()});
    const ModelFile within = read_vrml_of(shape("texture ImageTexture { url \"" + inside + "\" }", square(quarters)));
    CHECK(near(corner_colour(within.mesh, 0, 0), blue));
    CHECK(warnings(within).empty());
    const ModelFile spoilt =
        read_vrml_of(shape("texture ImageTexture { url \"data:image/png,none\" }", square(quarters)));
    CHECK_THAT(spoilt.lost_colour, Contains("'data:image/png (1)'") && !Contains("none"));
    const ModelFile gone =
        read_vrml_of(shape(red_material + " texture ImageTexture { url \"gone.png\" }", square(quarters)));
    CHECK_THAT(gone.lost_colour, Contains("gone.png"));
    CHECK(near(corner_colour(gone.mesh, 0, 0), {linear(0.5), 0, 0}));
    const ModelFile both = read_vrml_of(
        shape(red_material + image, square(quarters + "color Color { color [1 1 0, 1 1 0, 1 1 0, 1 1 0] }")), picture);
    CHECK(near(corner_colour(both.mesh, 0, 0), blue));
    CHECK_THAT(warnings(both), Contains("[which-colour]"));
    SECTION("without coordinates they lie along the longest sides") {
        const ModelFile laid = read_vrml_of(
            shape(image,
                  "geometry IndexedFaceSet { coord Coordinate { point [1 1 0, 1 3 0, 1 3 4, 1 1 4] } coordIndex [0 1 2 "
                  "3] }"),
            picture);
        CHECK(laid.mesh.corner_uv[0][0] == Vector2f(0, 0));
        CHECK(laid.mesh.corner_uv[0][1] == Vector2f(0, 0.5f));
        CHECK(laid.mesh.corner_uv[0][2] == Vector2f(1, 0.5f));
    }
    SECTION("pixels run from the lower left, in one to four components") {
        const auto pixels = [&](const std::string& numbers, std::size_t corner) {
            return corner_colour(
                read_vrml_of(
                    shape("material Material { diffuseColor 1 0 0 } texture PixelTexture { image " + numbers +
                              " repeatS FALSE repeatT FALSE }",
                          square("texCoord TextureCoordinate { point [0.25 0.25, 0.75 0.25, 0.75 0.75, 0 0] }")))
                    .mesh,
                0, corner);
        };
        CHECK(near(pixels("2 2 3 0x00FF00 0x0000FF 0xFF0000 16777215", 0), green));
        CHECK(near(pixels("2 2 3 0x00FF00 0x0000FF 0xFF0000 16777215", 1), blue));
        CHECK(near(pixels("2 2 3 0x00FF00 0x0000FF 0xFF0000 16777215", 2), white));
        CHECK(near(pixels("1 1 4 0x0000FF80", 0), {1 - 128 / 255.0f, 1 - 128 / 255.0f, 1}));
        CHECK(near(pixels("1 1 1 0x80", 0), {linear(128 / 255.0), 0, 0}));  // greys shade the material
        CHECK(near(pixels("1 1 2 0xFFFF", 0), red));
        CHECK(near(pixels("0 0 0", 0), red));
        const ModelFile cut = read_vrml_of(shape("texture PixelTexture { image 9 9 3 1 2 3 }", square(quarters)));
        CHECK_THAT(cut.lost_colour, Contains("3 pixels for 9 x 9"));
    }
}

TEST_CASE("VRML: groups place their shapes, and names are used again") {
    const std::string inner = shape("", square(""));
    const auto far = [&](const std::string& before, const std::string& behind = "}") {
        return corner_place(read_vrml_of(before + " children [ " + inner + "] " + behind), 0, 2);
    };
    const auto alike = [](const Vector3d& a, const Vector3d& b) { return (a - b).norm() < 1e-7; };
    CHECK(alike(far("Transform { translation 1 2 3"), {2, -3, 3}));
    CHECK(alike(far("Transform { rotation 0 0 1 1.5707963268"), {-1, 0, 1}));
    CHECK(alike(far("Transform { center 1 0 0 rotation 0 0 1 1.5707963268"), {0, 0, 0}));
    CHECK(alike(far("Transform { scale 2 1 1 scaleOrientation 0 0 1 0.7853981634"), {2, 0, 2}));
    CHECK(alike(far("Transform { center 1 1 0 scale 3 3 3"), {1, 0, 1}));
    CHECK(alike(far("Transform { translation 1 0 0 children Transform { scale 2 2 2", "} }"), {3, 0, 2}));
    for (const char* group : {"Group {", "Anchor { url \"x.wrl\"", "Collision {", "Billboard {"})
        CHECK(alike(far(group), {1, 0, 1}));
    // A mirror turns the triangles.
    const ModelFile mirrored = read_vrml_of("Transform { scale -1 1 1 children " + inner + "}");
    CHECK(alike(corner_place(mirrored, 0, 1), {-1, 0, 1}));
    const ModelFile clockwise = read_vrml_of(shape("", square("ccw FALSE")));
    CHECK(alike(corner_place(clockwise, 0, 1), {1, 0, 0}));
    const ModelFile twice = read_vrml_of(
        "DEF one Transform { children DEF two " + inner + "}\nTransform { translation 0 0 5 children [ USE two ] }\n" +
        "Shape { appearance Appearance { material DEF paint Material { diffuseColor 0 1 0 } } " + square("") + " }" +
        "Shape { appearance Appearance { material USE paint } " + square("") + " } USE one");
    CHECK(twice.mesh.triangles.size() == 10);
    CHECK(near(corner_colour(twice.mesh, 6, 0), green));
    SECTION("of choices what is shown, of levels the first") {
        CHECK(read_vrml_of("LOD { range [5] level [" + inner + inner + "] }").mesh.triangles.size() == 2);
        CHECK(read_vrml_of("Switch { whichChoice 1 choice [ Group { } " + inner + "] }").mesh.triangles.size() == 2);
        CHECK_THAT(error_of_wrl(vrml_2 + "Switch { choice " + inner + "}"), Contains("show nothing"));
    }
    SECTION("what has no shape is passed over") {
        const ModelFile file = read_vrml_of(
            "WorldInfo { info [\"a # b\", \"c\\\"}\"] } # a } comment\nViewpoint { position 0 0 9 }\n"
            "DEF s Script { url \"x.js\" eventIn SFTime go field SFNode at NULL directOutput TRUE eventOut SFBool is "
            "}" +
            inner + "DEF t TimeSensor { } DEF i PositionInterpolator { key [0 1] keyValue [0 0 0, 1 1 1] }\n" +
            "ROUTE t.fraction_changed TO i.set_fraction\nMyOwnLight { power 5 }");
        CHECK(file.mesh.triangles.size() == 2);
        CHECK_THAT(warnings(file), Contains("animations") && Contains("MyOwnLight") && Contains("[left-out]"));
    }
}

TEST_CASE("VRML: simple shapes are closed, and as large as they say") {
    const auto made = [](const std::string& geometry) { return read_vrml_of("Shape { geometry " + geometry + " }"); };
    const ModelFile box = made("Box { size 15 10 6 }");
    CHECK(volume_of(box.mesh) == Approx(900));
    CHECK(is_closed_ball(box));
    CHECK(volume_of(made("Box { }").mesh) == Approx(8));
    const double round = 48 * std::sin(std::numbers::pi / 48);  // of a polygon of 96 corners
    const ModelFile cylinder = made("Cylinder { radius 2 height 3 }"), cone = made("Cone { bottomRadius 2 height 3 }");
    CHECK(volume_of(cylinder.mesh) == Approx(round * 4 * 3));
    CHECK(is_closed_ball(cylinder));
    CHECK(volume_of(cone.mesh) == Approx(round * 4));
    CHECK(is_closed_ball(cone));
    const ModelFile ball = made("Sphere { radius 5 }");
    CHECK(volume_of(ball.mesh) == Approx(4 * std::numbers::pi / 3 * 125).epsilon(0.003));
    CHECK(is_closed_ball(ball));
    CHECK(made("Cylinder { top FALSE bottom FALSE }").mesh.triangles.size() == 192);
    const ModelFile grid = made(
        "ElevationGrid { xDimension 3 zDimension 2 xSpacing 2 zSpacing 3 height [1 1 1 1 1 4] "
        "colorPerVertex FALSE color Color { color [1 0 0, 0 0 1] } }");
    CHECK(grid.mesh.triangles.size() == 4);
    CHECK(near(corner_colour(grid.mesh, 3, 0), blue));
    CHECK(corner_place(grid, 0, 1) == Vector3d(0, -3, 1));
    const Vector3d up = (corner_place(grid, 0, 1) - corner_place(grid, 0, 0))
                            .cross(corner_place(grid, 0, 2) - corner_place(grid, 0, 0));
    CHECK(up.z() > 0);
    CHECK_THAT(error_of_wrl(vrml_2 + "Shape { geometry ElevationGrid { xDimension 3 zDimension 3 height [1 2] } }"),
               Contains("3 x 3 has 2 heights"));
    CHECK_THAT(error_of_wrl(vrml_2 + "Shape { geometry Sphere { radius -1 } }"), Contains("radius of a Sphere is -1"));
    SECTION("a concave face is cut along its outline") {
        const ModelFile arrow = made(
            "IndexedFaceSet { convex FALSE coord Coordinate { point [0 0 0, 4 0 0, 1 1 0, 0 4 0] "
            "} coordIndex [0 1 2 3 -1] }");
        double area = 0;
        for (std::size_t t = 0; t < 2; ++t)
            area += (corner_place(arrow, t, 1) - corner_place(arrow, t, 0))
                        .cross(corner_place(arrow, t, 2) - corner_place(arrow, t, 0))
                        .norm() /
                    2;
        CHECK(area == Approx(4));
    }
    SECTION("their own way of laying a picture") {
        const auto seen = [](const std::string& geometry, const Vector3d& place) {
            const ModelFile file =
                read_vrml_of(shape("texture ImageTexture { url \"skin.png\" }", "geometry " + geometry),
                             {{"skin.png", four_colours()}});
            std::vector<Vector2f> found;  // near the place
            for (std::size_t t = 0; t < file.mesh.triangles.size(); ++t)
                for (std::size_t c = 0; c < 3; ++c)
                    if ((corner_place(file, t, c) - place).norm() < 1e-9) found.push_back(file.mesh.corner_uv[t][c]);
            return found;
        };
        const auto has = [](const std::vector<Vector2f>& found, float u, float v) {
            return std::any_of(found.begin(), found.end(),
                               [&](const Vector2f& uv) { return (uv - Vector2f(u, v)).norm() < 1e-6f; });
        };
        // z up: the front is -y
        CHECK(has(seen("Box { }", {-1, -1, -1}), 0, 0));
        CHECK(has(seen("Box { }", {-1, 1, 1}), 0, 1));  // of the upper side
        CHECK(has(seen("Sphere { }", {0, -1, 0}), 0.5f, 0.5f));
        CHECK(has(seen("Cylinder { }", {1, 0, -1}), 0.75f, 0));
        CHECK(has(seen("Cylinder { }", {0, -1, 1}), 0.5f, 0));  // of the upper disc: its lower edge
        CHECK(has(seen("Cone { }", {-1, 0, -1}), 0.25f, 0));
    }
}

TEST_CASE("VRML: what is not read is refused by name, what is damaged with its line") {
    const std::string inner = shape("", square(""));
    const auto fails = [&](const std::string& nodes) { return error_of_wrl(vrml_2 + nodes); };
    CHECK_THAT(error_of_wrl("#VRML V1.0 ascii\nSeparator { Cube { } }"), Contains("VRML 1.0") && Contains("export"));
    CHECK_THAT(error_of_wrl("Shape { }"), Contains("does not begin with '#VRML V2.0'"));
    CHECK_THAT(fails("Inline { url \"part.wrl\" }"), Contains("line 2") && Contains("'part.wrl'"));
    CHECK_THAT(
        fails("PROTO Bolt [ field SFFloat r 1 ] { Group { children [ Shape { geometry Box { } } ] } }\nBolt { }"),
        Contains("line 3") && Contains("'Bolt'") && Contains("PROTO"));
    CHECK_THAT(fails("EXTERNPROTO Bolt [ field SFFloat r ] [ \"b.wrl\" ]\nGroup { children Bolt { r 2 } }"),
               Contains("'Bolt'"));
    // Prototypes that nothing uses are none.
    CHECK(fails("PROTO Bolt [ ] { Sphere { } }\nEXTERNPROTO Nut [ ] \"n.wrl\"\n" + inner) == "no error");
    for (const char* type : {"Extrusion", "NurbsSurface", "IndexedTriangleSet"})
        CHECK_THAT(fails(inner + "Shape { geometry " + type + " { } }"), Contains(std::string("'") + type + "'"));
    CHECK_THAT(fails("HAnimHumanoid { skin [ " + inner + "] }"), Contains("'HAnimHumanoid'"));
    CHECK_THAT(fails("Shape { geometry IndexedLineSet { } }"), Contains("no faces to print"));
    CHECK_THAT(fails("Group { children [ USE nothing ] }"), Contains("USE names 'nothing'"));
    CHECK_THAT(fails("DEF a Group { children [ USE a ] }"), Contains("USE names 'a'"));
    CHECK_THAT(fails("\n\nShape { geometry"), Contains("line 4") && Contains("its end"));
    CHECK_THAT(fails("Shape { geometry Box { size 1 2 3 }"), Contains("its end"));
    CHECK_THAT(fails("Shape }"), Contains("'{' is wanted"));
    CHECK_THAT(fails("WorldInfo { title \"a }"), Contains("a string has no end"));
    CHECK_THAT(fails(shape("", square("", "0 1 7"))), Contains("uses point 7") && Contains("only 4"));
    std::string deep, ends;
    for (int i = 0; i < 2000; ++i) deep += "Group { children ", ends += "}";
    CHECK_THAT(fails(deep + inner + ends), Contains("nested"));
    // Names that double what they name, again and again.
    std::string doubled = "DEF n0 " + inner;
    for (int i = 0; i < 40; ++i)
        doubled += "DEF n" + std::to_string(i + 1) + " Group { children [ USE n" + std::to_string(i) + " USE n" +
                   std::to_string(i) + " ] }\n";
    CHECK_THAT(fails(doubled), Contains("USE"));
}

TEST_CASE("VRML: numbers that are left over are no points, places or colours") {
    // A comma stands between numbers, so that it makes two of one.
    CHECK_THAT(refusal_by([] {
                   return read_vrml_of(shape("",
                                             "geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1,5 0 0, "
                                             "0 1 0] } coordIndex [0 1 2] }"));
               }),
               Contains("line 2") && Contains("coord has 10 numbers") && Contains("three each") && Contains("comma"));
    CHECK_THAT(refusal_by([] {
                   return read_vrml_of(shape("", square("texCoord TextureCoordinate { point [0 0, 1 0, 1] }")));
               }),
               Contains("texCoord has 5 numbers") && Contains("two each"));
    CHECK_THAT(refusal_by([] { return read_vrml_of(shape("", square("color Color { color [1 0 0 1] }"))); }),
               Contains("color has 4 numbers"));
}

TEST_CASE("VRML: packed by gzip, whatever its name, and cut anywhere") {
    const std::string text = vrml_2 + shape(red_material, square("")), packed = packed_by_gzip(text);
    for (const char* name : {"a.wrl", "a.wrz", "a.VRML"}) {
        CHECK(error_of_wrl(packed, name) == "no error");
        CHECK(error_of_wrl(packed + packed_by_gzip("# more\n"), name) == "no error");
    }
    for (std::size_t length = 0; length < packed.size(); ++length) {
        const std::string said = error_of_wrl(packed.substr(0, length));
        INFO(length << ": " << said);
        CHECK_THAT(said, Contains("a.wrl"));
    }
    for (std::size_t length = 0; length + 2 < text.size(); ++length) {  // its end is a line's
        const std::string said = error_of_wrl(text.substr(0, length));
        INFO(length << ": " << said);
        CHECK_THAT(said, Contains("a.wrl"));
    }
    const Folder folder;
    ReadOptions options;
    options.max_unpacked_bytes = 1000;
    CHECK_THROWS_WITH(
        read_model_here(folder.write({{"a.wrz", packed_by_gzip(vrml_2 + std::string(2000, ' '))}}), options),
        Contains("more than 1000 bytes"));
}
