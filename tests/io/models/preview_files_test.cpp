// SPDX-License-Identifier: GPL-3.0-or-later
//
// GLB and PLY are read back by assimp, whose code shares nothing with the writers.
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "base/contracts.h"
#include "io/models/glb_writer.h"
#include "io/models/ply_writer.h"
#include "io/pictures/srgb_code.h"

using namespace voxtone;
using namespace voxtone::io;

namespace {

/// No two of its axes, directions or colours can be confused: 30 mm along x, 20 along y, 10 along z.
ColouredMesh marker() {
    return {{{0, 0, 0}, {30, 0, 0}, {0, 20, 0}, {0, 0, 10}},
            {{1, 1, 1}, {1, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.1f}},
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

const aiMesh* read(Assimp::Importer& importer, const std::vector<std::uint8_t>& bytes, const char* format) {
    const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format);
    INFO(importer.GetErrorString());
    REQUIRE(scene);
    REQUIRE(scene->mNumMeshes == 1);
    return scene->mMeshes[0];  // no reference: g++ 14 takes it for one to the bytes
}

/// Where assimp has put the marker's vertex i: by its place, since 5.4 numbers them as faces name them. In metres, y
/// up: our x stays, our z becomes y, our y becomes -z.
unsigned vertex_of(const aiMesh& mesh, std::size_t i) {
    const std::array<aiVector3D, 4> places{{{0, 0, 0}, {0.03f, 0, 0}, {0, 0, -0.02f}, {0, 0.01f, 0}}};
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
        if ((mesh.mVertices[v] - places[i]).Length() < 1e-8f) return v;
    FAIL("no vertex where " << i << " is");
    return 0;
}

/// Six times the volume, positive when faces are turned outward.
double signed_volume(const aiMesh& mesh) {
    double volume = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiVector3D a = mesh.mVertices[mesh.mFaces[f].mIndices[0]], b = mesh.mVertices[mesh.mFaces[f].mIndices[1]],
                         c = mesh.mVertices[mesh.mFaces[f].mIndices[2]];
        volume += a * (b ^ c);
    }
    return volume;
}

}  // namespace

TEST_CASE("GLB keeps axes, size, orientation and colours") {
    Assimp::Importer importer;
    const aiMesh& mesh = *read(importer, glb_bytes(marker(), "a \"name\"\n\xFF"), "glb");
    REQUIRE(mesh.mNumVertices == 4);
    REQUIRE(mesh.mNumFaces == 4);
    REQUIRE(mesh.HasVertexColors(0));
    for (std::size_t i = 0; i < 4; ++i) {
        const unsigned v = vertex_of(mesh, i);
        for (int c = 0; c < 3; ++c)
            CHECK(std::abs(mesh.mColors[0][v][unsigned(c)] - marker().rgb[i][c]) <= 0.5f / 65535 + 1e-7f);
        CHECK(mesh.mColors[0][v].a == 1.0f);
    }
    CHECK(signed_volume(mesh) == Approx(6e-6));  // 30 * 20 * 10 mm^3, in m^3
}

TEST_CASE("GLB says that it is unlit, and its parts are where it says") {
    const std::vector<std::uint8_t> bytes = glb_bytes(marker(), "marker");
    const std::string text(bytes.begin(), bytes.end());
    CHECK(text.find(R"("extensions":{"KHR_materials_unlit":{}})") != text.npos);
    CHECK(text.find(R"("max":[0.03,0.01,)") != text.npos);
    CHECK(bytes.size() % 4 == 0);
    CHECK(glb_bytes(marker(), "marker") == bytes);
    CHECK_THROWS_AS(glb_bytes({}, "nothing"), ContractViolation);
}

TEST_CASE("a lit GLB keeps colours, has outward normals, and tells its material") {
    Assimp::Importer importer;
    const LitMaterial lit{0.1, 1.5, 2.5, {0.9, 0.8, 0.7}};
    const std::vector<std::uint8_t> bytes = glb_bytes(marker(), "print", lit);
    const aiMesh& mesh = *read(importer, bytes, "glb");
    REQUIRE(mesh.HasNormals());
    aiVector3D middle;
    for (unsigned v = 0; v < 4; ++v) middle += mesh.mVertices[v] * 0.25f;
    for (std::size_t i = 0; i < 4; ++i) {
        const unsigned v = vertex_of(mesh, i);
        CHECK(mesh.mNormals[v].Length() == Approx(1));
        CHECK(mesh.mNormals[v] * (mesh.mVertices[v] - middle) > 0);
        for (int c = 0; c < 3; ++c)
            CHECK(std::abs(mesh.mColors[0][v][unsigned(c)] - marker().rgb[i][c]) <= 0.5f / 65535 + 1e-7f);
    }
    const std::string text(bytes.begin(), bytes.end());
    CHECK(text.find("unlit") == text.npos);
    CHECK(text.find(R"("roughnessFactor":0.1)") != text.npos);
    CHECK(text.find(R"("thicknessFactor":0.0025,"attenuationDistance":0.001,"attenuationColor":[0.9,0.8,0.7])") !=
          text.npos);
}

TEST_CASE("PLY keeps axes, millimetres and sRGB codes") {
    Assimp::Importer importer;
    const aiMesh& mesh = *read(importer, ply_bytes(marker()), "ply");
    REQUIRE(mesh.mNumVertices == 4);
    REQUIRE(mesh.mNumFaces == 4);
    for (unsigned v = 0; v < 4; ++v)
        for (int c = 0; c < 3; ++c) {
            CHECK(mesh.mVertices[v][unsigned(c)] == marker().positions_mm[v][c]);
            CHECK(std::lround(mesh.mColors[0][v][unsigned(c)] * 255) == linear_to_srgb8(marker().rgb[v][c]));
        }
    CHECK(signed_volume(mesh) == Approx(6000));
}
