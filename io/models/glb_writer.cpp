// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/models/glb_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/core.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/printable.h"

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

std::string document(const ColouredMesh& mesh, std::string_view name) {
    Eigen::Vector3f low = to_gltf(mesh.positions_mm.front()), high = low;
    for (const Eigen::Vector3f& position : mesh.positions_mm) {
        low = low.cwiseMin(to_gltf(position));
        high = high.cwiseMax(to_gltf(position));
    }
    const std::size_t vertices = mesh.positions_mm.size(), indices = 3 * mesh.triangles.size();
    const std::size_t colours_at = vertices * position_bytes, indices_at = colours_at + vertices * colour_bytes;
    const std::size_t size = indices_at + indices * sizeof(std::uint32_t);
    // 34962 and 34963: array and element-array buffers; 5126, 5123, 5125: float, 16-bit, 32-bit.
    return fmt::format(
        R"({{"asset":{{"version":"2.0","generator":"voxtone"}},"extensionsUsed":["KHR_materials_unlit"],)"
        R"("scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"name":{0}}}],)"
        R"("meshes":[{{"name":{0},"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":1}},"indices":2,"material":0}}]}}],)"
        R"("materials":[{{"name":"vertex colours","doubleSided":true,"pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,1],)"
        R"("metallicFactor":0,"roughnessFactor":1}},"extensions":{{"KHR_materials_unlit":{{}}}}}}],)"
        R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{1},"type":"VEC3","min":{2},"max":{3}}},)"
        R"({{"bufferView":1,"componentType":5123,"normalized":true,"count":{1},"type":"VEC4"}},)"
        R"({{"bufferView":2,"componentType":5125,"count":{4},"type":"SCALAR"}}],)"
        R"("bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{5},"target":34962}},)"
        R"({{"buffer":0,"byteOffset":{5},"byteLength":{6},"target":34962}},)"
        R"({{"buffer":0,"byteOffset":{7},"byteLength":{8},"target":34963}}],"buffers":[{{"byteLength":{9}}}]}})",
        json_quoted(name), vertices, vector_text(low), vector_text(high), indices, colours_at, indices_at - colours_at,
        indices_at, size - indices_at, size);
}

}  // namespace

std::vector<std::uint8_t> glb_bytes(const ColouredMesh& mesh, std::string_view name) {
    VOXTONE_EXPECT(!mesh.triangles.empty() && mesh.positions_mm.size() == mesh.rgb.size());
    std::string json = document(mesh, name);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::size_t binary =
        mesh.positions_mm.size() * (position_bytes + colour_bytes) + mesh.triangles.size() * triangle_bytes;
    const std::size_t size = 12 + 8 + json.size() + 8 + binary;
    if (size > std::numeric_limits<std::uint32_t>::max())
        throw InputError("the preview model would be larger than the 4 GiB that GLB can hold; ask for fewer vertices");

    std::vector<std::uint8_t> bytes;
    bytes.reserve(size);
    const auto append_u32 = [&](std::size_t value) { append(bytes, static_cast<std::uint32_t>(value)); };
    append_u32(0x46546C67);  // "glTF"
    append_u32(2);
    append_u32(size);
    append_u32(json.size());
    append_u32(0x4E4F534A);  // "JSON"
    bytes.insert(bytes.end(), json.begin(), json.end());
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
    VOXTONE_ENSURE(bytes.size() == size);
    return bytes;
}

}  // namespace voxtone::io
