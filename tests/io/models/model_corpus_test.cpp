// SPDX-License-Identifier: GPL-3.0-or-later
//
// Real models, where the folder of them lies beside the source tree (its INDEX.md says what each is). The expected
// numbers are those of INDEX.md, measured by another reader; assimp and lib3mf are the second opinion on what this one
// reads.
#include <algorithm>
#include <filesystem>
#include <set>

#include <Model/COM/NMR_DLLInterfaces.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture.h"
#include "io/pictures/texture.h"
#include "optics/colour/colour.h"
#include "tests/outcomes.h"
#include "tests/places.h"

#ifdef __SANITIZE_ADDRESS__
// lib3mf, the witness, does not close all entries of a package that it opens.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libzip.so\n"; }
#endif

using namespace voxtone;
using namespace voxtone::io;
namespace fs = std::filesystem;

namespace {

const fs::path models = fs::path(test::source_dir()) / ".." / "shared" / "models";

bool here() {
    if (fs::exists(models / "INDEX.md")) return true;
    test::skip("the model corpus is not beside the tree");
    return false;
}

struct Expected {
    const char* file;
    std::size_t triangles;
    bool colour;
    std::size_t textures;  // pictures in use
    double mm_per_unit;
    double extent[3];  // in file units, by size; 0: not in INDEX.md as the print lies
};

// pyramids: INDEX.md counts its objects once (3172); its nine build items hold one of 104 triangles twice more.
const Expected expected[] = {
    {"spot/spot.obj", 5856, true, 1, 0, {0.9431, 1.69, 1.718}},
    {"ycb_banana/textured_simple_reoriented.obj", 15728, true, 1, 0, {0.03755, 0.07888, 0.1958}},
    {"spider/spider.obj", 1368, true, 4, 0, {79.74, 150.6, 193.4}},
    {"exploding_barrel/ExplodingBarrel.glb", 8150, true, 1, 1000, {48.35, 48.35, 72.11}},
    {"kaykit_mage/Mage.glb", 5683, true, 1, 1000, {2.271, 2.426, 2.716}},
    {"fox/Fox.gltf", 576, true, 1, 1000, {25.19, 79.03, 154.7}},
    {"multipletextures_3mf/multipletextures.3mf", 96692, true, 2, 1, {99.64, 140.1, 150.0}},
    {"sphere_logo_3mf/sphere_logo.3mf", 3032, true, 1, 1, {40, 40, 40}},
    {"multiprop_opaque_3mf/multiprop-opaque.3mf", 12, true, 1, 10, {10, 10, 10}},
    {"pyramids_3mf/pyramids.3mf", 0, true, 0, 1, {0, 0, 0}},
    {"ankylosaurus_ply/ankylosaurus_mesh.ply", 69636, true, 0, 0, {0.3427, 0.604, 1.01}},
    {"sword/sword.obj", 44582, false, 0, 0, {0.0343, 0.2339, 0.9156}},
    {"plane_holes/plane_holes.obj", 16747, false, 0, 0, {4.367, 13.29, 14.69}},
    {"offset1/Offset1.obj", 4418, false, 0, 0, {716.3, 1384, 3967}},
    {"openscad_nonmanifold/openscad-nonmanifold-crash.obj", 1442, false, 0, 0, {2, 13, 18}},
    {"max_export_stl/3DSMaxExport.STL", 2000, false, 0, 0, {48.34, 52.64, 57.03}},
    {"hourglass/hourglass_ico.obj", 40, false, 0, 0, {1.701, 1.789, 4}},
    {"thingi_68435/68435.stl", 182, false, 0, 0, {13.2, 42.32, 89.41}},
    {"thingi_73338/73338.stl", 220, false, 0, 0, {34.23, 47.12, 57.99}},
    {"thingi_68251/68251.stl", 164, false, 0, 0, {7.807, 23.23, 47.35}},
    {"thingi_68256/68256.stl", 80, false, 0, 0, {20.4, 38.57, 77.48}},
    {"thingi_61460/61460.stl", 112, false, 0, 0, {42.44, 51.97, 51.98}},
    {"thingi_65778/65778.stl", 480, false, 0, 0, {6, 40, 83}},
};

Eigen::AlignedBox<double, 3> box_of(const TexturedMesh& mesh) {
    Eigen::AlignedBox<double, 3> box;
    for (const auto& p : mesh.positions) box.extend(p);
    return box;
}

std::string lost(const ModelFile& file) {
    std::string all;
    for (const std::string& warning : file.warnings)
        if (warning.find("LOST") != std::string::npos) all += warning + "\n";
    return all;
}

}  // namespace

TEST_CASE("real models are read whole") {
    if (!here()) return;
    std::set<std::string> seen{"box_infinites"};
    for (const Expected& want : expected) {
        INFO(want.file);
        const ModelFile file = read_model(models / want.file);
        seen.insert(fs::path(want.file).begin()->string());
        if (want.triangles) CHECK(file.mesh.triangles.size() == want.triangles);
        CHECK(file.has_colour == want.colour);
        CHECK(file.mm_per_file_unit == want.mm_per_unit);
        std::set<const Texture*> textures;
        for (const std::uint32_t m : file.mesh.material_of_triangle)
            if (file.mesh.materials[m].texture) textures.insert(file.mesh.materials[m].texture.get());
        CHECK(textures.size() == want.textures);
        Eigen::Vector3d extent = box_of(file.mesh).sizes();
        std::sort(extent.begin(), extent.end());
        for (int i = 0; i < 3; ++i)
            if (want.extent[i] > 0) CHECK(extent[i] == Approx(want.extent[i]).epsilon(6e-4));  // four digits there
        CHECK(lost(file).empty());
        CHECK(file.lost_colour.empty());
    }
    for (const auto& entry : fs::directory_iterator(models)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory()) continue;
        bool has_model = false;
        for (const auto& file : fs::directory_iterator(entry)) {
            has_model |= is_model_name(file.path());
            if (name.starts_with("img_") && (file.path().extension() == ".png" || file.path().extension() == ".jpg")) {
                const Picture picture = read_picture(file.path());
                CHECK(picture.width_px > 0);
                CHECK(picture.warnings.empty());
            }
        }
        INFO(name);
        if (has_model) CHECK(seen.contains(name));
    }
    CHECK_THROWS_WITH(read_model(models / "box_infinites/BoxWithInfinites.glb"),
                      Catch::Contains("24 of the 24 vertices") && Catch::Contains("infinite"));
}

TEST_CASE("assimp sees the same glTF models") {
    if (!here()) return;
    for (const char* name : {"exploding_barrel/ExplodingBarrel.glb", "kaykit_mage/Mage.glb", "fox/Fox.gltf"}) {
        INFO(name);
        const ModelFile file = read_model(models / name);
        Assimp::Importer importer;
        const aiScene* scene = importer.ReadFile((models / name).string(), aiProcess_Triangulate);
        REQUIRE(scene);
        std::vector<std::array<double, 5>> theirs, mine;  // x, y, z, u, v of every corner
        const std::function<void(const aiNode&, aiMatrix4x4)> walk = [&](const aiNode& node,
                                                                         const aiMatrix4x4& parent) {
            const aiMatrix4x4 transform = parent * node.mTransformation;
            for (unsigned m = 0; m < node.mNumMeshes; ++m) {
                const aiMesh& mesh = *scene->mMeshes[node.mMeshes[m]];
                for (unsigned f = 0; f < mesh.mNumFaces; ++f)
                    for (unsigned c = 0; c < 3; ++c) {
                        const unsigned i = mesh.mFaces[f].mIndices[c];
                        const aiVector3D p = transform * mesh.mVertices[i], uv = mesh.mTextureCoords[0][i];
                        theirs.push_back({p.x, -p.z, p.y, uv.x, uv.y});
                    }
            }
            for (unsigned c = 0; c < node.mNumChildren; ++c) walk(*node.mChildren[c], transform);
        };
        walk(*scene->mRootNode, {});
        for (std::size_t t = 0; t < file.mesh.triangles.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                const Eigen::Vector3d& p = file.mesh.positions[file.mesh.triangles[t][c]];
                mine.push_back({p.x(), p.y(), p.z(), file.mesh.corner_uv[t][c].x(), file.mesh.corner_uv[t][c].y()});
            }
        REQUIRE(mine.size() == theirs.size());
        // Rounding differs, so that sorted lists could interleave; the moments of the corners do not care for their
        // order.
        for (std::size_t k = 0; k < 5; ++k)
            for (std::size_t l = k; l < 5; ++l) {
                double a = 0, b = 0, scale = 0;
                for (std::size_t i = 0; i < mine.size(); ++i) {
                    a += mine[i][k] * mine[i][l];
                    b += theirs[i][k] * theirs[i][l];
                    scale += std::abs(mine[i][k] * mine[i][l]);
                }
                CHECK(std::abs(a - b) < 1e-5 * scale);
            }
    }
}

TEST_CASE("lib3mf sees the same 3MF models") {
    if (!here()) return;
    for (const char* name : {"multipletextures_3mf/multipletextures.3mf", "sphere_logo_3mf/sphere_logo.3mf"}) {
        INFO(name);
        const ModelFile file = read_model(models / name);
        NMR::PLib3MFModel* model = nullptr;
        NMR::PLib3MFModelReader* reader = nullptr;
        NMR::PLib3MFModelResourceIterator* objects = nullptr;
        NMR::PLib3MFModelResource* object = nullptr;
        NMR::PLib3MFPropertyHandler* properties = nullptr;
        REQUIRE(NMR::lib3mf_createmodel(&model) == 0);
        REQUIRE(NMR::lib3mf_model_queryreader(model, "3mf", &reader) == 0);
        REQUIRE(NMR::lib3mf_reader_readfromfileutf8(reader, (models / name).string().c_str()) == 0);
        REQUIRE(NMR::lib3mf_model_getmeshobjects(model, &objects) == 0);
        BOOL more = 0;
        REQUIRE(NMR::lib3mf_resourceiterator_movenext(objects, &more) == 0);
        REQUIRE(more);
        REQUIRE(NMR::lib3mf_resourceiterator_getcurrent(objects, &object) == 0);
        DWORD triangles = 0;
        NMR::lib3mf_meshobject_gettrianglecount(object, &triangles);
        REQUIRE(triangles == file.mesh.triangles.size());
        REQUIRE(NMR::lib3mf_meshobject_createpropertyhandler(object, &properties) == 0);
        std::size_t textured = 0, coloured = 0, wrong = 0;
        for (DWORD t = 0; t < triangles; ++t) {
            NMR::MODELMESHTEXTURE2D texture{};
            NMR::lib3mf_propertyhandler_gettexture(properties, t, &texture);
            NMR::MODELMESH_TRIANGLECOLOR_SRGB colour{};
            NMR::lib3mf_propertyhandler_getcolor(properties, t, &colour);
            const bool has_texture = bool(file.mesh.materials[file.mesh.material_of_triangle[t]].texture);
            wrong += has_texture != (texture.m_nTextureID != 0);
            for (std::size_t c = 0; c < 3; ++c) {
                if (has_texture) {
                    wrong += std::abs(file.mesh.corner_uv[t][c].x() - texture.m_fU[c]) > 1e-6f ||
                             std::abs(file.mesh.corner_uv[t][c].y() - texture.m_fV[c]) > 1e-6f;
                } else if (colour.m_Colors[c].m_Alpha) {
                    const float mine = file.mesh.corner_rgb.empty() ? 1 : file.mesh.corner_rgb[t][c].x();
                    wrong += std::abs(mine - optics::srgb_decode(colour.m_Colors[c].m_Red / 255.0)) > 1e-5;
                }
            }
            textured += has_texture;
            coloured += colour.m_Colors[0].m_Alpha != 0;
        }
        CHECK(wrong == 0);
        CHECK(textured > 0);
        CHECK(textured + coloured >= triangles);
        for (NMR::PLib3MFBase* handle :
             {static_cast<NMR::PLib3MFBase*>(properties), static_cast<NMR::PLib3MFBase*>(object),
              static_cast<NMR::PLib3MFBase*>(objects), static_cast<NMR::PLib3MFBase*>(reader),
              static_cast<NMR::PLib3MFBase*>(model)})
            NMR::lib3mf_release(handle);
    }
}
