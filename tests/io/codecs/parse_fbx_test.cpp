// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_fbx.h"

#include "io/files/base64.h"
#include "tests/io/codecs/fbx_bytes.h"
#include "tests/io/models/model_test.h"

namespace {

using Records = std::vector<FbxRecord>;

/// A square in x and y of side 2 with a corner at the origin, and a triangle on it: five corners, two polygons.
const std::vector<double> places{0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0, 0, 5};
const std::vector<std::int32_t> polygons{0, 1, 2, ~3, 0, 1, ~4};

FbxRecord mesh(std::int64_t id, Records more = {}, bool packed = false) {
    more.insert(more.begin(), {FbxRecord{"Vertices", {fbx_reals(places, packed)}},
                               FbxRecord{"PolygonVertexIndex", {fbx_indices(polygons, packed)}}});
    return fbx_object("Geometry", id, "Plate", "Mesh", {}, std::move(more));
}

FbxRecord layer(const std::string& type, const std::string& mapping, const std::string& reference, Records arrays,
                const std::string& name = "") {
    arrays.insert(arrays.begin(),
                  {FbxRecord{"Name", {fbx_text(name)}}, FbxRecord{"MappingInformationType", {fbx_text(mapping)}},
                   FbxRecord{"ReferenceInformationType", {fbx_text(reference)}}});
    return {type, {fbx_number(std::int64_t{0})}, std::move(arrays)};
}

FbxRecord model(std::int64_t id, const Records& properties = {}, const std::string& kind = "Mesh") {
    return fbx_object("Model", id, "Plate", kind, properties);
}

FbxRecord material(std::int64_t id, const std::vector<double>& rgb, Records more = {}) {
    more.push_back(fbx_property("DiffuseColor", rgb));
    return fbx_object("Material", id, "Paint", "", more);
}

/// z up, as 3ds Max has it: nothing is turned.
const Records z_up{fbx_property("UpAxis", {2}),
                   fbx_property("UpAxisSign", {1}),
                   fbx_property("FrontAxis", {1}),
                   fbx_property("FrontAxisSign", {-1}),
                   fbx_property("CoordAxis", {0}),
                   fbx_property("CoordAxisSign", {1}),
                   fbx_property("UnitScaleFactor", {2.54})};

constexpr std::int64_t plate = 10, geometry = 20, paint = 30, picture = 40, film = 50;

ModelFile read_fbx(const std::string& bytes, const Files& others = {}) {
    return read_alone({{"a.fbx", bytes}}, others);
}

std::string error_of_fbx(const std::string& bytes) {
    return refusal_by([&] { return read_fbx(bytes); });
}

/// The corner (2, 2, 0) of the plate below models with these properties, outermost first.
Vector3d far_corner(const std::vector<Records>& models, const Records& settings = z_up) {
    Records objects{mesh(geometry)}, links;
    for (std::size_t i = 0; i < models.size(); ++i) {
        const auto id = static_cast<std::int64_t>(100 + i);
        objects.push_back(model(id, models[i]));
        links.push_back(fbx_link(id, i == 0 ? 0 : id - 1));
        if (i + 1 == models.size()) links.push_back(fbx_link(geometry, id));
    }
    return corner_place(read_fbx(fbx_scene(settings, objects, links)), 0, 2);
}

/// The plate with a layer more and a material.
ModelFile painted(const Records& layers, const std::vector<double>& rgb = {0.5, 0.25, 1}) {
    return read_fbx(fbx_scene(z_up, {mesh(geometry, layers), model(plate), material(paint, rgb)},
                              {fbx_link(plate, 0), fbx_link(geometry, plate), fbx_link(paint, plate)}));
}

}  // namespace

TEST_CASE("FBX: meshes of both headers, packed or not, stand in mm and z up") {
    for (const std::uint32_t version : {7100u, 7400u, 7500u, 7700u})
        for (const bool packed : {false, true}) {
            INFO(version << " " << packed);
            const ModelFile file = read_fbx(fbx_scene(z_up, {mesh(geometry, {}, packed), model(plate)},
                                                      {fbx_link(plate, 0), fbx_link(geometry, plate)}, version));
            CHECK(file.format == "FBX");
            CHECK(file.mm_per_file_unit == Approx(25.4));
            CHECK_FALSE(file.has_colour);
            REQUIRE(file.mesh.triangles.size() == 3);
            CHECK(file.mesh.positions.size() == 5);
            CHECK(corner_place(file, 0, 2) == Vector3d(2, 2, 0));
            CHECK(file.warnings.empty());
        }
}

TEST_CASE("FBX: axes of the file are turned to z up, and mirrors turn the triangles") {
    CHECK(far_corner({{}}, {}) == Vector3d(2, 0, 2));  // y up where nothing is said
    const auto axes = [](double up, double up_sign, double front, double front_sign, double right, double right_sign) {
        return Records{fbx_property("UpAxis", {up}),       fbx_property("UpAxisSign", {up_sign}),
                       fbx_property("FrontAxis", {front}), fbx_property("FrontAxisSign", {front_sign}),
                       fbx_property("CoordAxis", {right}), fbx_property("CoordAxisSign", {right_sign})};
    };
    CHECK(far_corner({{}}, axes(1, 1, 2, 1, 0, 1)) == Vector3d(2, 0, 2));
    CHECK(far_corner({{}}, axes(0, 1, 2, 1, 1, -1)) == Vector3d(-2, 0, 2));
    CHECK(far_corner({{}}, axes(1, 1, 1, 1, 1, 1)) == Vector3d(2, 0, 2));  // no three axes
    const ModelFile file =
        read_fbx(fbx_scene(z_up, {mesh(geometry), model(plate, {fbx_property("Lcl Scaling", {-1, 1, 1})})},
                           {fbx_link(plate, 0), fbx_link(geometry, plate)}));
    CHECK(corner_place(file, 0, 1) == Vector3d(-2, 2, 0));
    CHECK(corner_place(file, 0, 2) == Vector3d(-2, 0, 0));
}

TEST_CASE("FBX: the chain of transformations") {
    const auto triple = [](const char* name, double x, double y, double z) { return fbx_property(name, {x, y, z}); };
    const auto alike = [](const Vector3d& a, const Vector3d& b) { return (a - b).norm() < 1e-12; };
    CHECK(far_corner({{triple("Lcl Translation", 1, 2, 3)}}) == Vector3d(3, 4, 3));
    CHECK(far_corner({{triple("Lcl Rotation", 90, 0, 0)}}) == Vector3d(2, 0, 2));
    CHECK(far_corner({{triple("Lcl Rotation", 90, 0, 90)}}) == Vector3d(0, 2, 2));  // x first
    CHECK(far_corner({{triple("Lcl Rotation", 90, 0, 90), fbx_property("RotationOrder", {5})}}) ==
          Vector3d(-2, 0, 2));  // z first
    CHECK(far_corner({{triple("PreRotation", 0, 0, 90), triple("Lcl Rotation", 90, 0, 0)}}) == Vector3d(0, 2, 2));
    CHECK(far_corner({{triple("PostRotation", 0, 0, 90)}}) == Vector3d(2, -2, 0));
    CHECK(far_corner({{triple("PreRotation", 0, 0, 90), fbx_property("RotationActive", {0})}}) == Vector3d(2, 2, 0));
    CHECK(far_corner({{triple("RotationPivot", 2, 0, 0), triple("Lcl Rotation", 0, 0, 90)}}) == Vector3d(0, 0, 0));
    CHECK(far_corner({{triple("RotationOffset", 0, 0, 7)}}) == Vector3d(2, 2, 7));
    CHECK(far_corner({{triple("ScalingPivot", 0, 2, 0), triple("ScalingOffset", 1, 0, 0),
                       triple("Lcl Scaling", 3, 3, 3)}}) == Vector3d(7, 2, 0));
    // Geometric ones move the mesh alone.
    CHECK(far_corner({{triple("GeometricTranslation", 0, 0, 4), triple("GeometricScaling", 2, 1, 1)}}) ==
          Vector3d(4, 2, 4));
    CHECK(far_corner({{triple("GeometricTranslation", 0, 0, 4)}, {}}) == Vector3d(2, 2, 0));
    // Floats of a quarter turn are one.
    CHECK(far_corner({{triple("Lcl Rotation", -90.000009334, 0, 0)}}) == Vector3d(2, 0, -2));
    SECTION("the parent's scale") {
        const Records above{triple("Lcl Scaling", 2, 1, 1)};
        const auto below = [&](double inherit) {
            return Records{triple("Lcl Rotation", 0, 0, 90), triple("Lcl Translation", 1, 0, 0),
                           fbx_property("InheritType", {inherit})};
        };
        CHECK(alike(far_corner({above, below(1)}), {2 + 2 * -2, 2, 0}));  // turned, then scaled
        CHECK(alike(far_corner({above, below(0)}), {2 - 2, 4, 0}));       // scaled, then turned
        CHECK(alike(far_corner({above, below(2)}), {2 - 2, 2, 0}));       // not scaled
    }
}

TEST_CASE("FBX: colours of materials, of what they cover, and their factor") {
    const ModelFile plain = painted({});
    CHECK(plain.has_colour);
    CHECK(near(corner_colour(plain.mesh, 0, 0), {linear(0.5), linear(0.25), 1}));
    const Records two{mesh(geometry, {layer("LayerElementMaterial", "ByPolygon", "IndexToDirect",
                                            {{"Materials", {fbx_indices(std::vector<std::int32_t>{1, 0})}}})}),
                      model(plate), material(paint, {1, 0, 0}, {fbx_property("DiffuseFactor", {0.5})}),
                      material(paint + 1, {0, 1, 0})};
    const Records links{fbx_link(plate, 0), fbx_link(geometry, plate), fbx_link(paint, plate),
                        fbx_link(paint + 1, plate)};
    const ModelFile file = read_fbx(fbx_scene(z_up, two, links));
    CHECK(near(corner_colour(file.mesh, 0, 0), {0, 1, 0}));
    CHECK(near(corner_colour(file.mesh, 2, 0), {linear(0.5), 0, 0}));
    // A material that the model does not have.
    const ModelFile lost = read_fbx(fbx_scene(z_up, two, {links[0], links[1], links[2]}));
    CHECK_THAT(lost.lost_colour, Contains("1 face of a.fbx") && Contains("LOST"));
    const ModelFile bare = painted({layer("LayerElementMaterial", "AllSame", "IndexToDirect",
                                          {{"Materials", {fbx_indices(std::vector<std::int32_t>{-1})}}})});
    CHECK(near(corner_colour(bare.mesh, 0, 0), {1, 1, 1}));
    CHECK(bare.lost_colour.empty());
    // What glows only.
    const ModelFile glow = read_fbx(fbx_scene(
        z_up, {mesh(geometry), model(plate), material(paint, {0, 0, 0}, {fbx_property("EmissiveColor", {0, 0, 1})})},
        {links[0], links[1], links[2]}));
    CHECK(near(corner_colour(glow.mesh, 0, 0), {0, 0, 1}));
    CHECK_THAT(warnings(glow), Contains("[which-colour]"));
    // Blender's are linear.
    std::string bytes = fbx_file({{"Creator", {fbx_text("Blender (stable FBX IO) - 3.4.1 - 4.37.5")}},
                                  {"Objects", {}, {mesh(geometry), model(plate), material(paint, {0.5, 0, 0})}},
                                  {"Connections", {}, {links[0], links[1], links[2]}}});
    CHECK(near(corner_colour(read_fbx(bytes).mesh, 0, 0), {0.5f, 0, 0}));
    // Half transparent: over white.
    const ModelFile glass = read_fbx(
        fbx_scene(z_up, {mesh(geometry), model(plate), material(paint, {0, 0, 0}, {fbx_property("Opacity", {0.25})})},
                  {links[0], links[1], links[2]}));
    CHECK(near(corner_colour(glass.mesh, 0, 0), {0.75f, 0.75f, 0.75f}));
    CHECK_THAT(warnings(glass), Contains("[transparent]"));
}

TEST_CASE("FBX: colours of corners, vertices and polygons, straight and by an index") {
    const auto colours = [](std::size_t count) {
        std::vector<double> all;
        for (std::size_t i = 0; i < count; ++i) all.insert(all.end(), {i == 2 ? 0.5 : 0.0, i == 4 ? 1.0 : 0.0, 0, 1});
        return FbxRecord{"Colors", {fbx_reals(all)}};
    };
    const Vector3f red(linear(0.5), 0, 0), green(0, 1, 0), black(0, 0, 0);
    const ModelFile corners = painted({layer("LayerElementColor", "ByPolygonVertex", "Direct", {colours(7)})});
    CHECK(near(corner_colour(corners.mesh, 0, 2), red));
    CHECK(near(corner_colour(corners.mesh, 2, 0), green));
    const ModelFile vertices = painted({layer("LayerElementColor", "ByVertice", "Direct", {colours(5)})});
    CHECK(near(corner_colour(vertices.mesh, 1, 1), red));
    CHECK(near(corner_colour(vertices.mesh, 2, 2), green));
    const ModelFile faces =
        painted({layer("LayerElementColor", "ByPolygon", "IndexToDirect",
                       {colours(5), {"ColorIndex", {fbx_indices(std::vector<std::int32_t>{2, 4})}}})});
    CHECK(near(corner_colour(faces.mesh, 1, 0), red));
    CHECK(near(corner_colour(faces.mesh, 2, 0), green));
    const ModelFile same = painted({layer("LayerElementColor", "AllSame", "Direct", {colours(1)})});
    CHECK(near(corner_colour(same.mesh, 2, 0), black));
    // All white: as editors leave it beside a colour of the material.
    const ModelFile white = painted(
        {layer("LayerElementColor", "AllSame", "Direct", {{"Colors", {fbx_reals(std::vector<double>{1, 1, 1, 1})}}})});
    CHECK(near(corner_colour(white.mesh, 0, 0), {linear(0.5), linear(0.25), 1}));
    // Of 0 to 255, as some write them.
    const ModelFile bytes = painted({layer("LayerElementColor", "AllSame", "Direct",
                                           {{"Colors", {fbx_reals(std::vector<double>{255, 0, 128, 255})}}})});
    CHECK(near(corner_colour(bytes.mesh, 0, 0), {1, 0, linear(128 / 255.0)}));
    const ModelFile few = painted({layer("LayerElementColor", "ByVertex", "Direct", {colours(3)})});
    CHECK_THAT(few.lost_colour, Contains("LOST"));
}

TEST_CASE("FBX: textures within the file and beside it, by the coordinates that they name") {
    const std::vector<double> uv{0.25, 0.25, 0.75, 0.25, 0.75, 0.75, 0.25, 0.75};  // blue, white / red, green
    const FbxRecord first = layer("LayerElementUV", "AllSame", "Direct",
                                  {{"UV", {fbx_reals(std::vector<double>{0.25, 0.75})}}}, "other"),
                    second = layer("LayerElementUV", "ByPolygonVertex", "IndexToDirect",
                                   {{"UV", {fbx_reals(uv)}},
                                    {"UVIndex", {fbx_indices(std::vector<std::int32_t>{0, 1, 2, 3, 2, 2, 2})}}},
                                   "skin");
    const auto scene = [&](const Records& textures, const Records& links, const Records& layers) {
        Records objects{mesh(geometry, layers), model(plate), material(paint, {1, 1, 1})},
            all{fbx_link(plate, 0), fbx_link(geometry, plate), fbx_link(paint, plate)};
        objects.insert(objects.end(), textures.begin(), textures.end());
        all.insert(all.end(), links.begin(), links.end());
        return fbx_scene(z_up, objects, all);
    };
    const auto texture = [](const Records& properties, const std::string& file = "") {
        return fbx_object("Texture", picture, "skin", "", properties, {{"RelativeFilename", {fbx_text(file)}}});
    };
    const Vector3f blue(0, 0, 1), white(1, 1, 1), red(1, 0, 0), green(0, 1, 0);
    SECTION("embedded") {
        const FbxRecord video = fbx_object(
            "Video", film, "skin", "Clip", {},
            {{"RelativeFilename", {fbx_text("gone.png")}}, {"Content", {'R' + fbx_text(four_colours()).substr(1)}}});
        const ModelFile file =
            read_fbx(scene({texture({fbx_word("UVSet", "skin")}), video},
                           {fbx_link(picture, paint, "DiffuseColor"), fbx_link(film, picture)}, {first, second}));
        CHECK(near(corner_colour(file.mesh, 0, 0), blue));
        CHECK(near(corner_colour(file.mesh, 0, 1), white));
        CHECK(near(corner_colour(file.mesh, 0, 2), green));
        CHECK(near(corner_colour(file.mesh, 1, 2), red));
        CHECK(near(corner_colour(file.mesh, 2, 0), green));
        CHECK(file.lost_colour.empty());
    }
    SECTION("beside it, with backslashes, and by the first coordinates where none are named") {
        const ModelFile file = read_fbx(
            scene({texture({}, "maps\\skin.png")}, {fbx_link(picture, paint, "DiffuseColor")}, {first, second}),
            {{"maps/skin.png", four_colours()}});
        CHECK(near(corner_colour(file.mesh, 0, 1), red));
        CHECK(warnings(file).empty());
    }
    SECTION("gone, or without coordinates") {
        const std::string bytes =
            scene({texture({}, "C:\\maps\\gone.png")}, {fbx_link(picture, paint, "Maya|baseColor")}, {first});
        CHECK_THAT(read_fbx(bytes).lost_colour, Contains("gone.png") && Contains("LOST"));
        const ModelFile bare =
            read_fbx(scene({texture({}, "skin.png")}, {fbx_link(picture, paint, "DiffuseColor")}, {}),
                     {{"skin.png", four_colours()}});
        CHECK_THAT(bare.lost_colour, Contains("no texture coordinates"));
    }
    SECTION("in tiles: by a mark in the name, or where neighbours of the one that is named are there") {
        // The square in the first tile, the triangle in the second, or over both.
        const auto lying = [&](double u) {
            std::vector<double> places = uv;
            places.insert(places.end(), {1.25, 0.25, u, 0.25});
            return layer("LayerElementUV", "ByPolygonVertex", "IndexToDirect",
                         {{"UV", {fbx_reals(places)}},
                          {"UVIndex", {fbx_indices(std::vector<std::int32_t>{0, 1, 2, 3, 4, 4, 5})}}});
        };
        const auto tiled = [&](const std::string& name, double u, const Files& there) {
            return read_fbx(scene({texture({}, name)}, {fbx_link(picture, paint, "DiffuseColor")}, {lying(u)}), there);
        };
        const Files both{{"s.1001.png", png(1, 1, {255, 0, 0, 255})}, {"s.1002.png", four_colours()}};
        for (const char* name : {"s.<UDIM>.png", "s.1001.png"}) {
            const ModelFile file = tiled(name, 1.75, both);
            CHECK(near(corner_colour(file.mesh, 0, 0), red));
            CHECK(near(corner_colour(file.mesh, 2, 0), blue));
            CHECK(near(corner_colour(file.mesh, 2, 2), white));
            CHECK(file.lost_colour.empty());
            CHECK(warnings(file).empty() == (name[2] == '<'));
        }
        CHECK_THAT(warnings(tiled("s.1001.png", 1.75, both)), Contains("UDIM") && Contains("[which-colour]"));
        CHECK(
            near(corner_colour(tiled("s.1001.png", 0.75, both).mesh, 2, 0), red));  // repeated, as a face is over both
        CHECK(near(corner_colour(tiled("s.1001.png", 1.75, {both[0]}).mesh, 2, 0), red));
        CHECK_THAT(tiled("s.<UDIM>.png", 0.75, both).lost_colour, Contains("1 faces") && Contains("<UDIM>"));
        CHECK_THAT(tiled("s.<UDIM>.png", 1.75, {both[0]}).lost_colour, Contains("s.1002.png") && Contains("LOST"));
    }
    SECTION("placed on the surface: coordinates move the other way") {
        const ModelFile file = read_fbx(scene({texture({fbx_property("Translation", {0, 0.5, 0})}, "skin.png")},
                                              {fbx_link(picture, paint, "DiffuseColor")}, {first}),
                                        {{"skin.png", four_colours()}});
        CHECK(near(corner_colour(file.mesh, 0, 0), blue));
    }
    SECTION("as Blender writes it: coordinates are moved, and scaled the other way") {
        const std::string bytes = fbx_file(
            {{"Creator", {fbx_text("Blender (stable FBX IO) - 3.4.1")}},
             {"Objects",
              {},
              {mesh(geometry, {first}), model(plate), material(paint, {1, 1, 1}),
               texture({fbx_property("Translation", {0.5, 0, 0}), fbx_property("Scaling", {1, 0.5, 1})}, "skin.png")}},
             {"Connections",
              {},
              {fbx_link(plate, 0), fbx_link(geometry, plate), fbx_link(paint, plate),
               fbx_link(picture, paint, "DiffuseColor")}}});
        const ModelFile file = read_fbx(bytes, {{"skin.png", four_colours()}});
        CHECK(file.mesh.corner_uv[0][0] == Vector2f(0.75f, 1.5f));
    }
    SECTION("alpha of a picture counts where it hangs on transparency, too") {
        const Files clear{{"skin.png", png(1, 1, {0, 0, 255, 64})}};
        const Records hangs{fbx_link(picture, paint, "DiffuseColor")},
            shines{hangs[0], fbx_link(picture, paint, "TransparencyFactor")};
        const ModelFile opaque = read_fbx(scene({texture({}, "skin.png")}, hangs, {first}), clear);
        CHECK(near(corner_colour(opaque.mesh, 0, 0), blue));
        CHECK(warnings(opaque).empty());
        const ModelFile glass = read_fbx(scene({texture({}, "skin.png")}, shines, {first}), clear);
        CHECK(corner_colour(glass.mesh, 0, 0).x() > 0.7f);
        CHECK_THAT(warnings(glass), Contains("[transparent]"));
    }
    SECTION("no picture") {
        const ModelFile file = read_fbx(scene({texture({})}, {fbx_link(picture, paint, "DiffuseColor")}, {first}));
        CHECK_THAT(file.lost_colour, Contains("'skin'") && Contains("no picture"));
    }
    SECTION("several over each other") {
        const FbxRecord layered = fbx_object("LayeredTexture", film, "all", "", {}),
                        other = fbx_object("Texture", picture + 1, "more", "", {});
        const ModelFile file = read_fbx(
            scene({texture({}, "skin.png"), other, layered},
                  {fbx_link(film, paint, "DiffuseColor"), fbx_link(picture, film), fbx_link(picture + 1, film)},
                  {first}),
            {{"skin.png", four_colours()}});
        CHECK(near(corner_colour(file.mesh, 0, 0), red));
        CHECK_THAT(warnings(file), Contains("2 textures over each other"));
    }
}

TEST_CASE("FBX: what is left aside is said, and what would be missing refuses the file") {
    const Records links{fbx_link(plate, 0), fbx_link(geometry, plate)};
    const auto with = [&](Records objects, Records more, const Records& properties = {}) {
        objects.insert(objects.begin(), {mesh(geometry), model(plate, properties)});
        more.insert(more.begin(), links.begin(), links.end());
        return fbx_scene(z_up, objects, more);
    };
    CHECK_THAT(warnings(read_fbx(with({fbx_object("Deformer", 60, "skin", "Skin", {})}, {fbx_link(60, geometry)}))),
               Contains("skinned") && Contains("[left-out]"));
    CHECK_THAT(warnings(read_fbx(with({fbx_object("AnimationCurve", 60, "", "", {})}, {}))), Contains("animation"));
    const Records lines{fbx_object("Geometry", 61, "wire", "Line", {})}, to_plate{fbx_link(61, plate)};
    CHECK_THAT(warnings(read_fbx(with(lines, to_plate))), Contains("[no-volume]"));
    CHECK_THAT(error_of_fbx(with({fbx_object("Geometry", 61, "sail", "NurbsSurface", {})}, to_plate)),
               Contains("NurbsSurface") && Contains("polygons"));
    CHECK_THAT(error_of_fbx(with({}, {}, {fbx_property("Visibility", {0})})), Contains("hidden"));
    CHECK_THAT(error_of_fbx(with({}, {}, {fbx_property("Show", {0})})), Contains("hidden"));
    // Levels of detail are one.
    const Records levels{model(1, {}, "LodGroup"), fbx_object("NodeAttribute", 2, "", "LodGroup", {}), model(plate),
                         model(plate + 1), mesh(geometry)};
    const ModelFile file =
        read_fbx(fbx_scene(z_up, levels,
                           {fbx_link(1, 0), fbx_link(2, 1), fbx_link(plate, 1), fbx_link(plate + 1, 1),
                            fbx_link(geometry, plate), fbx_link(geometry, plate + 1)}));
    CHECK(file.mesh.triangles.size() == 3);
    CHECK_THAT(warnings(file), Contains("LOD group"));
}

TEST_CASE("FBX: files of other kinds and damaged ones are refused in one sentence") {
    CHECK_THAT(error_of_fbx(fbx_file({}, 6100)), Contains("version 6100") && Contains("export"));
    CHECK_THAT(error_of_fbx("; FBX 6.1.0 project file\nFBXHeaderExtension: {\n FBXVersion: 6100\n}\n"),
               Contains("version 6100"));
    CHECK_THAT(error_of_fbx("nothing of the kind"), Contains("no FBX file"));
    CHECK_THAT(error_of_fbx(fbx_scene({}, {}, {})), Contains("no faces"));
    FbxRecord deep{"a", {}, {}};
    for (int i = 0; i < 200; ++i) deep = {"a", {}, {deep}};
    CHECK_THAT(error_of_fbx(fbx_file({deep})), Contains("nested"));
    const auto with_polygons = [](const std::vector<std::int32_t>& index) {
        return fbx_scene({},
                         {fbx_object("Geometry", geometry, "Plate", "Mesh", {},
                                     {{"Vertices", {fbx_reals(places)}}, {"PolygonVertexIndex", {fbx_indices(index)}}}),
                          model(plate)},
                         {fbx_link(plate, 0), fbx_link(geometry, plate)});
    };
    CHECK_THAT(error_of_fbx(with_polygons({0, 1, ~5})), Contains("uses vertex 5") && Contains("only 5"));
    CHECK_THAT(error_of_fbx(with_polygons({0, 1, 2})), Contains("has no end"));
    // A model above itself hangs on nothing.
    CHECK_THAT(error_of_fbx(
                   fbx_scene({}, {mesh(geometry), model(plate)}, {fbx_link(plate, plate), fbx_link(geometry, plate)})),
               Contains("no faces"));
}

TEST_CASE("FBX: a file that is small and unpacks to much is refused") {
    const Folder folder;
    const std::vector<double> zeros(3 << 16, 0.0);
    const auto path = folder.write({{"a.fbx", fbx_scene({},
                                                        {fbx_object("Geometry", geometry, "Plate", "Mesh", {},
                                                                    {{"Vertices", {fbx_reals(zeros, true)}},
                                                                     {"PolygonVertexIndex", {fbx_indices(polygons)}}}),
                                                         model(plate)},
                                                        {fbx_link(plate, 0), fbx_link(geometry, plate)})}});
    ReadOptions options;
    options.max_unpacked_bytes = 1 << 20;
    CHECK_THROWS_WITH(read_model_here(path, options), Contains("unpacks to more"));
    CHECK(read_model_here(path).mesh.triangles.size() == 3);
}

TEST_CASE("FBX as text is the same file") {
    const std::string text =
        "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXVersion: 7300\n\tCreator: \"a &quot;b&quot;\"\n}\n"
        "GlobalSettings:  {\n Properties70:  {\n  P: \"UpAxis\", \"int\", \"Integer\", \"\",2\n"
        "  P: \"FrontAxis\", \"int\", \"Integer\", \"\",1\n  P: \"FrontAxisSign\", \"int\", \"Integer\", \"\",-1\n "
        "}\n}\n"
        "Objects:  {\n Geometry: 20, \"Geometry::\", \"Mesh\" {\n  Vertices: *15 {\n"
        "   a: 0,0,0,2,0,0,\n2,2,0,0,2,0,0,0,5.0e0\n  }\n  PolygonVertexIndex: *7 {\n   a: 0,1,2,-4,0,1,-5\n  }\n"
        "  LayerElementUV: 0 {\n   Name: \"\"\n   MappingInformationType: \"AllSame\"\n"
        "   ReferenceInformationType: \"Direct\"\n   UV: *2 {\n    a: 0.25,0.75\n   }\n  }\n }\n"
        " Model: 10, \"Model::Plate\", \"Mesh\" {\n  Shading: T\n  Culling: \"CullingOff\"\n }\n"
        " Material: 30, \"Material::Paint\", \"\" {\n }\n Texture: 40, \"Texture::skin\", \"\" {\n }\n"
        " Video: 50, \"Video::skin\", \"Clip\" {\n  Filename: \"skin.png\"\n  Content: , \"CONTENT\"\n }\n}\n"
        "Connections:  {\n ;Model::Plate, Model::RootNode\n C: \"OO\",10,0\n C: \"OO\",20,10\n C: \"OO\",30,10\n"
        " C: \"OP\",40,30, \"DiffuseColor\"\n C: \"OO\",50,40\n}\n";
    const std::string picture_bytes = four_colours();
    std::string with = text;
    with.replace(with.find("CONTENT"), 7,
                 base64({reinterpret_cast<const std::uint8_t*>(picture_bytes.data()), picture_bytes.size()}));
    const ModelFile file = read_fbx(with);
    REQUIRE(file.mesh.triangles.size() == 3);
    CHECK(corner_place(file, 0, 2) == Vector3d(2, 2, 0));
    CHECK(near(corner_colour(file.mesh, 0, 0), {1, 0, 0}));
    // Cut anywhere: a model, where all behind the faces is gone, or a sentence.
    for (std::size_t length = 0; length < with.size(); ++length) {
        const std::string said = error_of_fbx(with.substr(0, length));
        INFO(length << ": " << said);
        CHECK((said == "no error" || Contains("a.fbx").match(said)));
    }
}

TEST_CASE("FBX: every truncation is refused in a sentence that names the file") {
    const std::string bytes = fbx_scene(z_up,
                                        {mesh(geometry,
                                              {layer("LayerElementUV", "AllSame", "Direct",
                                                     {{"UV", {fbx_reals(std::vector<double>{0.25, 0.75}, true)}}})},
                                              true),
                                         model(plate), material(paint, {1, 0, 0})},
                                        {fbx_link(plate, 0), fbx_link(geometry, plate), fbx_link(paint, plate)}, 7500);
    const std::size_t behind = bytes.size() - std::string("footer").size();
    for (std::size_t length = 0; length < behind; ++length) {
        const std::string said = error_of_fbx(bytes.substr(0, length));
        INFO(length << ": " << said);
        CHECK_THAT(said, Contains("a.fbx"));
    }
    CHECK(error_of_fbx(bytes.substr(0, behind)) == "no error");
}
