// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/glb_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/error.h"
#include "base/printable.h"
#include "optics/numerics/portable_math.h"

namespace voxtone::io {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

constexpr std::size_t position_bytes = 3 * sizeof(float);
constexpr std::size_t colour_bytes = 4 * sizeof(std::uint16_t);  // RGBA, so that each begins at a multiple of 4
constexpr std::size_t triangle_bytes = 3 * sizeof(std::uint32_t);

Eigen::Vector3f to_gltf(const Eigen::Vector3f& mm) { return {mm.x() / 1000, mm.z() / 1000, -mm.y() / 1000}; }

std::string vector_text(const Eigen::Vector3f& v) { return fmt::format("[{},{},{}]", v.x(), v.y(), v.z()); }

template <class Value>
void append(std::vector<std::uint8_t>& bytes, const Value& value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof(Value));
    std::memcpy(bytes.data() + at, &value, sizeof(Value));
}

/// Of each vertex, weighted by the angles of its triangles (G. Thuermer, C. Wuethrich 1998); straight up where there
/// are none.
std::vector<Eigen::Vector3f> normals_of(const ColouredMesh& mesh) {
    std::vector<Eigen::Vector3f> normals(mesh.positions_mm.size(), Eigen::Vector3f::Zero());
    for (const auto& t : mesh.triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            const Eigen::Vector3f& p = mesh.positions_mm[t[c]];
            const Eigen::Vector3f a = mesh.positions_mm[t[(c + 1) % 3]] - p, b = mesh.positions_mm[t[(c + 2) % 3]] - p;
            const Eigen::Vector3f cross = a.cross(b);
            const float sine = cross.norm();
            if (sine > 0) normals[t[c]] += cross * (portable::atan2(sine, a.dot(b)) / sine);
        }
    for (Eigen::Vector3f& n : normals) {
        const float length = n.norm();
        n = length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f::UnitZ();
    }
    return normals;
}

std::string unlit_material() {
    return R"({"name":"vertex colours","doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1],)"
           R"("metallicFactor":0,"roughnessFactor":1},"extensions":{"KHR_materials_unlit":{}}})";
}

std::string lit_material(const LitMaterial& lit) {
    VOXTONE_EXPECT(lit.roughness >= 0 && lit.roughness <= 1 && lit.eta >= 1 && lit.thickness_mm > 0);
    constexpr double mm = 1e-3;
    return fmt::format(
        R"({{"name":"print","pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,1],"metallicFactor":0,"roughnessFactor":{:.4g}}},)"
        R"("extensions":{{"KHR_materials_ior":{{"ior":{:.6g}}},"KHR_materials_transmission":{{"transmissionFactor":0}},)"
        R"("KHR_materials_volume":{{"thicknessFactor":{:.6g},"attenuationDistance":{:g},"attenuationColor":[{:.6g},{:.6g},{:.6g}]}}}}}})",
        lit.roughness, lit.eta, lit.thickness_mm * mm, mm, lit.transmitted_by_mm[0], lit.transmitted_by_mm[1],
        lit.transmitted_by_mm[2]);
}

std::string document(const ColouredMesh& mesh, std::string_view name, const std::optional<LitMaterial>& lit) {
    Eigen::Vector3f low = to_gltf(mesh.positions_mm.front()), high = low;
    for (const Eigen::Vector3f& position : mesh.positions_mm) {
        low = low.cwiseMin(to_gltf(position));
        high = high.cwiseMax(to_gltf(position));
    }
    const std::size_t vertices = mesh.positions_mm.size(), indices = 3 * mesh.triangles.size();
    const std::size_t colours_at = vertices * position_bytes, indices_at = colours_at + vertices * colour_bytes;
    const std::size_t normals_at = indices_at + indices * sizeof(std::uint32_t);
    const std::size_t size = normals_at + (lit ? vertices * position_bytes : 0);
    // 34962 and 34963: array and element-array buffers; 5126, 5123, 5125: float, 16-bit, 32-bit.
    std::string accessors =
        fmt::format(R"({{"bufferView":0,"componentType":5126,"count":{0},"type":"VEC3","min":{1},"max":{2}}},)"
                    R"({{"bufferView":1,"componentType":5123,"normalized":true,"count":{0},"type":"VEC4"}},)"
                    R"({{"bufferView":2,"componentType":5125,"count":{3},"type":"SCALAR"}})",
                    vertices, vector_text(low), vector_text(high), indices);
    std::string views = fmt::format(R"({{"buffer":0,"byteOffset":0,"byteLength":{0},"target":34962}},)"
                                    R"({{"buffer":0,"byteOffset":{0},"byteLength":{1},"target":34962}},)"
                                    R"({{"buffer":0,"byteOffset":{2},"byteLength":{3},"target":34963}})",
                                    colours_at, indices_at - colours_at, indices_at, normals_at - indices_at);
    if (lit) {
        accessors += fmt::format(R"(,{{"bufferView":3,"componentType":5126,"count":{},"type":"VEC3"}})", vertices);
        views += fmt::format(R"(,{{"buffer":0,"byteOffset":{},"byteLength":{},"target":34962}})", normals_at,
                             size - normals_at);
    }
    return fmt::format(
        R"({{"asset":{{"version":"2.0","generator":"voxtone"}},"extensionsUsed":[{1}],)"
        R"("scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"name":{0}}}],)"
        R"("meshes":[{{"name":{0},"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":1{2}}},"indices":2,"material":0}}]}}],)"
        R"("materials":[{3}],"accessors":[{4}],"bufferViews":[{5}],"buffers":[{{"byteLength":{6}}}]}})",
        json_quoted(name),
        lit ? R"("KHR_materials_ior","KHR_materials_transmission","KHR_materials_volume")" : R"("KHR_materials_unlit")",
        lit ? R"(,"NORMAL":3)" : "", lit ? lit_material(*lit) : unlit_material(), accessors, views, size);
}

}  // namespace

std::vector<std::uint8_t> glb_bytes(const ColouredMesh& mesh, std::string_view name,
                                    const std::optional<LitMaterial>& lit) {
    VOXTONE_EXPECT(!mesh.triangles.empty() && mesh.positions_mm.size() == mesh.rgb.size());
    std::string text = document(mesh, name, lit);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t binary = mesh.positions_mm.size() * (position_bytes + colour_bytes + (lit ? position_bytes : 0)) +
                               mesh.triangles.size() * triangle_bytes;
    const std::size_t size = 12 + 8 + text.size() + 8 + binary;
    if (size > std::numeric_limits<std::uint32_t>::max())
        throw InputError("the preview model would be larger than the 4 GiB that GLB can hold; ask for fewer vertices");

    std::vector<std::uint8_t> bytes;
    bytes.reserve(size);
    const auto append_u32 = [&](std::size_t value) { append(bytes, static_cast<std::uint32_t>(value)); };
    append_u32(0x46546C67);  // "glTF"
    append_u32(2);
    append_u32(size);
    append_u32(text.size());
    append_u32(0x4E4F534A);  // "JSON"
    bytes.insert(bytes.end(), text.begin(), text.end());
    append_u32(binary);
    append_u32(0x004E4942);  // "BIN"
    for (const Eigen::Vector3f& position : mesh.positions_mm) {
        const Eigen::Vector3f p = to_gltf(position);
        VOXTONE_EXPECT(p.allFinite());
        for (int axis = 0; axis < 3; ++axis) append(bytes, p[axis]);
    }
    for (const Eigen::Vector3f& rgb : mesh.rgb) {
        for (int c = 0; c < 3; ++c)
            append(bytes, static_cast<std::uint16_t>(std::lround(65535 * std::clamp(rgb[c], 0.0f, 1.0f))));
        append(bytes, std::uint16_t{65535});
    }
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle) append(bytes, corner);
    if (lit)
        for (const Eigen::Vector3f& normal : normals_of(mesh)) {
            const Eigen::Vector3f n = 1000 * to_gltf(normal);
            for (int axis = 0; axis < 3; ++axis) append(bytes, n[axis]);
        }
    VOXTONE_ENSURE(bytes.size() == size);
    return bytes;
}

}  // namespace voxtone::io
