// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/model_archive.h"

#include <filesystem>

#include <fmt/format.h>

#include "io/files/zip_reader.h"
#include "tests/io/models/model_test.h"

namespace fs = std::filesystem;

namespace {

std::string obj_with(const std::string& library) {
    return "mtllib " + library + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
}

std::string mtl_with(const std::string& texture) { return "newmtl m\nmap_Kd " + texture + "\n"; }

const std::string stl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";

ModelFile read_zip(const Files& parts, const std::string& inner = "", const ReadOptions& options = {}) {
    const Folder folder;
    const fs::path archive = folder.write({{"a.zip", zip(parts)}});
    return read_model_here(inner.empty() ? archive : archive / inner, options);
}

ModelFile read_zip(const Files& parts, const std::string& inner, std::uint64_t most_bytes) {
    ReadOptions options;
    options.max_unpacked_bytes = most_bytes;
    return read_zip(parts, inner, options);
}

std::string refusal_of(const Files& parts, const std::string& inner = "", const ReadOptions& options = {}) {
    return refusal_by([&] { return read_zip(parts, inner, options); });
}

/// Of a sample with one picture, whose coordinates reach over it.
bool has_texture(const ModelFile& file) {
    return file.lost_colour.empty() && file.mesh.materials[file.mesh.material_of_triangle[0]].texture != nullptr;
}

/// The model that is taken of an archive, and what is said of it.
struct Taken {
    std::string model, notes;
};
Taken taken_of(const Files& parts, const std::string& inner = "") {
    const Folder folder;
    const ModelArchive archive(folder.write({{"a.zip", zip(parts)}}), inner, {});
    std::string notes;
    for (const std::string& note : archive.notes()) notes += note + "\n";
    return {archive.model().generic_string(), notes};
}

}  // namespace

TEST_CASE("A path behind an archive names a file in it", "[zip]") {
    const Folder folder;
    const fs::path archive = folder.write({{"a.ZIP", zip({{"b", "c"}})}, {"folder.zip/c.obj", "v 0 0 0\n"}});
    CHECK(path_in_zip(archive).is_zip);
    CHECK(path_in_zip(archive).inner.empty());
    const PathInZip inner = path_in_zip(archive / "b/c.obj");
    CHECK(inner.is_zip);
    CHECK(inner.file == archive);
    CHECK(inner.inner == "b/c.obj");
    CHECK(path_in_zip(archive / "b.zip/c.obj").inner == "b.zip/c.obj");
    CHECK(path_in_zip(archive / "b.zip").inner == "b.zip");
    const fs::path plain = folder.path() / "folder.zip/c.obj";
    CHECK_FALSE(path_in_zip(plain).is_zip);
    CHECK(path_in_zip(plain).file == plain);
    CHECK_FALSE(path_in_zip("c.obj").is_zip);
    CHECK(path_in_zip("gone.zip").is_zip);
}

TEST_CASE("A model in an archive is read with what it names, wherever that lies in it", "[zip]") {
    const std::string png = four_colours();
    CHECK(has_texture(read_zip({{"a.obj", obj_with("a.mtl")}, {"a.mtl", mtl_with("t.png")}, {"t.png", png}})));
    SECTION("in a folder") {
        CHECK(has_texture(
            read_zip({{"x/a.obj", obj_with("a.mtl")}, {"x/a.mtl", mtl_with("maps\\t.png")}, {"x/maps/t.png", png}})));
    }
    SECTION("beside the model's folder, named so: nothing is to be said") {
        const ModelFile file = read_zip({{"source/a.obj", obj_with("a.mtl")},
                                         {"source/a.mtl", mtl_with("../textures/t.png")},
                                         {"textures/t.png", png}});
        CHECK(has_texture(file));
        CHECK(file.warnings.empty());
    }
    SECTION("elsewhere, which is said") {
        for (const char* name : {"t.png", "C:\\Users\\me\\t.png", "/home/me/T.PNG", "../../../t.png", "maps/t.png"}) {
            INFO(name);
            const ModelFile file = read_zip(
                {{"source/a.obj", obj_with("a.mtl")}, {"source/a.mtl", mtl_with(name)}, {"textures/t.png", png}});
            CHECK(has_texture(file));
            CHECK_THAT(warnings(file), Contains("textures/t.png") && Contains("[side-file]"));
        }
    }
    SECTION("of several of one name that in the folder called alike") {
        const ModelFile file = read_zip({{"a.obj", obj_with("a.mtl")},
                                         {"a.mtl", mtl_with("Q:/maps/t.png")},
                                         {"again/t.png", "no picture"},
                                         {"x/maps/t.png", png}});
        CHECK(has_texture(file));
    }
    SECTION("glTF with its buffer") {
        const std::string json =
            R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"scene.bin"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
            R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"nodes":[{"mesh":0}],)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
        const std::string bin = raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
        CHECK(read_zip({{"scene.gltf", json}, {"scene.bin", bin}, {"license.txt", "CC"}}).mesh.triangles.size() == 1);
        CHECK_THAT(refusal_of({{"scene.gltf", json}}), Contains("scene.bin"));
    }
    SECTION("what is missing is lost, as beside a model") {
        const ModelFile file = read_zip({{"a.obj", obj_with("a.mtl")}, {"a.mtl", mtl_with("t.png")}});
        CHECK_THAT(file.lost_colour, Contains("t.png"));
    }
}

TEST_CASE("The model of an archive is taken, and said", "[zip]") {
    const Taken one = taken_of({{"__MACOSX/._a.obj", "x"},
                                {".hidden.obj", "x"},
                                {"x/.git/b.obj", "x"},
                                {"Thumbs.db", "x"},
                                {"x/a.stl", stl},
                                {"x/read me.txt", "x"}});
    CHECK(one.model == "x/a.stl");
    CHECK_THAT(one.notes, Contains("a.zip") && Contains("'x/a.stl'"));
    SECTION("one in several formats: that which carries colours best") {
        const Taken best =
            taken_of({{"stl/Model.stl", stl}, {"obj/model.obj", stl}, {"model.glb", stl}, {"model.mtl", ""}});
        CHECK(best.model == "model.glb");
        CHECK_THAT(best.notes, Contains("3 formats") && Contains("a.zip/"));
    }
    SECTION("several: their names, and how to choose") {
        CHECK_THAT(refusal_of({{"a.stl", stl}, {"b/c.stl", stl}}),
                   Contains("2 models ('a.stl', 'b/c.stl')") && Contains("a.zip/a.stl"));
        Files many;
        for (int i = 0; i < 1000; ++i) many.push_back({fmt::format("part_{:03}.stl", i), stl});
        const std::string why = refusal_of(many);
        CHECK_THAT(why, Contains("1000 models") && Contains("994 more"));
        CHECK(why.size() < 500);
    }
    SECTION("the one that is named: by its path, in any case, by its name") {
        const Files two{{"x/a.stl", stl}, {"y/b.stl", stl}, {"y/a.stl", stl}};
        for (const char* name : {"y/b.stl", "Y/B.STL", "b.stl"}) CHECK(taken_of(two, name).model == "y/b.stl");
        CHECK_THAT(taken_of(two, "b.stl").notes, Contains("'y/b.stl'"));
        CHECK(taken_of(two, "y/b.stl").notes.empty());
        CHECK_THAT(refusal_of(two, "a.stl"), Contains("no model 'a.stl'") && Contains("'x/a.stl'"));
        CHECK_THAT(refusal_of(two, "../a.stl"), Contains("no model") || Contains("does not exist"));
        CHECK(read_zip(two, "x/a.stl").mesh.triangles.size() == 1);
    }
}

TEST_CASE("An archive in an archive is opened, one level deep", "[zip]") {
    const std::string inner = zip({{"a.obj", obj_with("a.mtl")}, {"a.mtl", mtl_with("t.png")}});
    const Files sketchfab{{"source/model.zip", inner}, {"textures/t.png", four_colours()}};
    CHECK(has_texture(read_zip(sketchfab)));
    CHECK(taken_of(sketchfab).model == "source/model.zip/a.obj");
    const Files two{{"one.zip", inner}, {"two.zip", zip({{"b.stl", stl}})}};
    CHECK_THAT(refusal_of(two), Contains("2 archives") && Contains("a.zip/one.zip"));
    CHECK(taken_of(two, "two.zip").model == "two.zip/b.stl");
    CHECK(taken_of(two, "two.zip/b.stl").model == "two.zip/b.stl");
    const Files beside{{"c.stl", stl}, {"two.zip", zip({{"b.stl", stl}})}};
    CHECK(taken_of(beside).model == "c.stl");
    CHECK(taken_of(beside, "two.zip").model == "two.zip/b.stl");
    CHECK_THAT(refusal_of({{"x.zip", zip({{"y.zip", inner}})}}),
               Contains("'x.zip/y.zip'") && Contains("archive within an archive") && Contains("unpack it"));
    CHECK_THAT(refusal_of({{"x.zip", "no archive"}}), Contains("x.zip") && Contains("no ZIP archive"));
}

TEST_CASE("An archive without a model, or that is none, is refused in a sentence", "[zip]") {
    CHECK_THAT(refusal_of({{"textures/t.png", four_colours()}}),
               Contains("holds no model") && Contains("textures/t.png"));
    CHECK_THAT(refusal_of({{"license.txt", "x"}, {"source/scene.blend", "x"}}),
               Contains("a Blender file") && Contains("export it"));
    CHECK_THAT(refusal_of({{"source/model.rar", "x"}}), Contains("RAR") && Contains("unpack"));
    CHECK_THAT(refusal_of({{"3D/3dmodel.model", "x"}}), Contains("3MF") && Contains("rename it a.3mf"));
    CHECK_THAT(refusal_of({{"../../a.stl", stl}}),
               Contains("'../../a.stl'") && Contains("could lead out of the archive"));
    CHECK_THAT(refusal_of({{"x\\..\\..\\a.stl", stl}, {"b.stl", stl}}), Contains("could lead out of the archive"));
    const Folder folder;
    CHECK_THROWS_WITH(read_model_here(folder.write({{"a.zip", "no archive"}})),
                      Contains("a.zip") && Contains("no ZIP archive"));
    CHECK_THROWS_AS(read_model_here(folder.path() / "gone.zip"), FileError);
    const std::string whole = zip({{"a.stl", stl}});
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const fs::path cut = folder.write({{"cut.zip", whole.substr(0, length)}});
        CHECK_THROWS_AS(read_model_here(cut), Error);
    }
}

TEST_CASE("Of an archive no more is unpacked than may be, and what is not taken does not count", "[zip]") {
    std::string large = stl;
    large.append(100'000, '\n');
    const Files parts{{"a.stl", large}, {"film.mp4", std::string(300'000, 'x')}};
    CHECK(read_zip(parts, "", 200'000).mesh.triangles.size() == 1);
    CHECK_THROWS_WITH(read_zip(parts, "", 50'000), Contains("a.stl") && Contains("50000"));
    const std::string png = four_colours();
    const Files textured{{"a.obj", obj_with("a.mtl")}, {"a.mtl", mtl_with("t.png")}, {"t.png", png}};
    const std::size_t all = textured[0].second.size() + textured[1].second.size() + png.size();
    CHECK(has_texture(read_zip(textured, "", all)));
    CHECK_THAT(read_zip(textured, "", all - 1).lost_colour, Contains("t.png"));
    // 70 MB of zeros in 70 kB
    CHECK_THAT(refusal_of({{"a.stl", std::string(70 << 20, '\0')}}), Contains("200 times"));
}
