// SPDX-License-Identifier: GPL-3.0-or-later
#include "compressed_samples.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <draco/compression/encode.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include "model_samples.h"

namespace voxtone::test {

namespace {

std::string comma(int count) { return count > 0 ? "," : ""; }

/// Attributes by names and accessors.
std::string primitive(const std::string& attributes, int indices, const std::string& more = "") {
    return fmt::format(R"({{"attributes":{{{}}},"indices":{}{}}})", attributes, indices, more);
}

template <class Value>
std::uint32_t add(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data_type, int components,
                  bool normalised, const std::vector<Value>& values) {
    const auto stride = static_cast<std::int64_t>(sizeof(Value)) * components;
    const auto points = static_cast<std::uint32_t>(values.size()) / static_cast<std::uint32_t>(components);
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, static_cast<std::uint8_t>(components), data_type, normalised, stride, 0);
    const int id = mesh.AddAttribute(attribute, true, points);
    for (std::uint32_t p = 0; p < points; ++p)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p),
                                              values.data() + std::size_t{p} * std::size_t(components));
    return mesh.attribute(id)->unique_id();
}

}  // namespace

BallMesh ball(int bands, int from, int to) {
    BallMesh mesh;
    const int columns = 2 * bands;
    for (int row = from; row <= to; ++row)
        for (int column = 0; column <= columns; ++column) {
            const double theta = std::numbers::pi * row / bands,
                         phi = 2 * std::numbers::pi * (column % columns) / columns;
            const double ring = row == 0 || row == bands ? 0 : std::sin(theta);
            for (const double x : {ring * std::cos(phi), std::cos(theta), ring * std::sin(phi)})
                mesh.xyz.push_back(static_cast<float>(x));
            mesh.uv.push_back(static_cast<float>(column) / static_cast<float>(columns));
            mesh.uv.push_back(static_cast<float>(row) / static_cast<float>(bands));
            for (const int code : {255 * row / bands, 255 * (column % columns) / columns, 40, 255})
                mesh.rgba.push_back(static_cast<std::uint8_t>(code));
        }
    const auto at = [&](int row, int column) {
        return static_cast<std::uint32_t>((row - from) * (columns + 1) + column);
    };
    for (int row = from; row < to; ++row)
        for (int column = 0; column < columns; ++column) {
            const std::uint32_t a = at(row, column), b = at(row, column + 1), c = at(row + 1, column),
                                d = at(row + 1, column + 1);
            if (row > 0) mesh.corners.insert(mesh.corners.end(), {a, b, d});
            if (row < bands - 1) mesh.corners.insert(mesh.corners.end(), {a, d, c});
        }
    return mesh;
}

int GltfBuilder::view(const std::string& bytes, const std::string& more) {
    while (binary.size() % 4) binary += '\0';
    views += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", comma(view_count), binary.size(),
                         bytes.size(), more);
    binary += bytes;
    return view_count++;
}

int GltfBuilder::accessor(int view, int component_type, std::size_t count, const std::string& type,
                          const std::string& more) {
    const std::string of = view < 0 ? "" : fmt::format(R"("bufferView":{},)", view);
    accessors += fmt::format(R"({}{{{}"componentType":{},"count":{},"type":"{}"{}}})", comma(accessor_count), of,
                             component_type, count, type, more);
    return accessor_count++;
}

std::string GltfBuilder::file(const std::string& rest) const {
    return glb(
        fmt::format(
            R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}{}],"bufferViews":[{}],"accessors":[{}],{}}})",
            binary.size(), more_buffers, views, accessors, rest),
        binary);
}

std::string scene_of(const std::string& primitives) {
    return fmt::format(R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}])", primitives);
}

std::string plain_glb(const std::vector<BallMesh>& pieces) {
    GltfBuilder b;
    std::string primitives;
    for (const BallMesh& mesh : pieces) {
        const int p = b.data(raw(mesh.xyz), 5126, mesh.vertices(), "VEC3");
        const int uv = b.data(raw(mesh.uv), 5126, mesh.vertices(), "VEC2");
        const int rgba = b.data(raw(mesh.rgba), 5121, mesh.vertices(), "VEC4", R"(,"normalized":true)");
        const int corners = b.data(raw(mesh.corners), 5125, mesh.corners.size(), "SCALAR");
        primitives += (primitives.empty() ? "" : ",") +
                      primitive(fmt::format(R"("POSITION":{},"TEXCOORD_0":{},"COLOR_0":{})", p, uv, rgba), corners,
                                R"(,"material":0)");
    }
    return b.file(
        scene_of(primitives) +
        R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
        R"("images":[{"uri":"t.png"}])");
}

DracoStream draco_stream(const BallMesh& ball, const DracoHow& how) {
    draco::Mesh mesh;
    mesh.set_num_points(static_cast<std::uint32_t>(ball.vertices()));
    DracoStream stream;
    using Type = draco::GeometryAttribute::Type;
    stream.position = add(mesh, Type::POSITION, draco::DT_FLOAT32, 3, false, ball.xyz);
    stream.uv = add(mesh, Type::TEX_COORD, draco::DT_FLOAT32, 2, false, ball.uv);
    stream.colour = add(mesh, Type::COLOR, draco::DT_UINT8, 4, true, ball.rgba);
    for (std::size_t i = 0; i < ball.corners.size(); i += 3)
        mesh.AddFace({draco::PointIndex(ball.corners[i]), draco::PointIndex(ball.corners[i + 1]),
                      draco::PointIndex(ball.corners[i + 2])});
    mesh.DeduplicateAttributeValues();
    mesh.DeduplicatePointIds();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(how.sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
    if (how.position_bits > 0) encoder.SetAttributeQuantization(Type::POSITION, how.position_bits);
    encoder.SetAttributeQuantization(Type::TEX_COORD, 12);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) throw std::runtime_error("Draco does not encode");
    stream.bytes.assign(buffer.data(), buffer.size());
    return stream;
}

std::string draco_glb(const std::vector<BallMesh>& pieces, const DracoHow& how) {
    GltfBuilder b;
    std::string primitives;
    for (const BallMesh& mesh : pieces) {
        const DracoStream stream = draco_stream(mesh, how);
        const int view = b.view(stream.bytes);
        const int p = b.accessor(-1, 5126, mesh.vertices(), "VEC3"), uv = b.accessor(-1, 5126, mesh.vertices(), "VEC2");
        const int rgba = b.accessor(-1, 5121, mesh.vertices(), "VEC4", R"(,"normalized":true)");
        const int corners = b.accessor(-1, 5125, mesh.corners.size(), "SCALAR");
        primitives +=
            (primitives.empty() ? "" : ",") +
            primitive(fmt::format(R"("POSITION":{},"TEXCOORD_0":{},"COLOR_0":{})", p, uv, rgba), corners,
                      fmt::format(R"(,"material":0,"extensions":{{"KHR_draco_mesh_compression":{{"bufferView":{},)"
                                  R"("attributes":{{"POSITION":{},"TEXCOORD_0":{},"COLOR_0":{}}}}}}})",
                                  view, stream.position, stream.uv, stream.colour));
    }
    return b.file(
        scene_of(primitives) +
        R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
        R"("images":[{"uri":"t.png"}],"extensionsRequired":["KHR_draco_mesh_compression"])");
}

std::string meshopt_vertices(const std::string& bytes, std::size_t stride) {
    const std::size_t count = bytes.size() / stride;
    std::string stream(meshopt_encodeVertexBufferBound(count, stride), '\0');
    stream.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(stream.data()), stream.size(),
                                             bytes.data(), count, stride));
    return stream;
}

std::string meshopt_triangles(const std::vector<std::uint32_t>& corners, std::size_t vertices) {
    std::string stream(meshopt_encodeIndexBufferBound(corners.size(), vertices), '\0');
    stream.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(stream.data()), stream.size(),
                                            corners.data(), corners.size()));
    return stream;
}

std::string meshopt_sequence(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
    std::string stream(meshopt_encodeIndexSequenceBound(indices.size(), vertices), '\0');
    stream.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(stream.data()), stream.size(),
                                              indices.data(), indices.size()));
    return stream;
}

int meshopt_view(GltfBuilder& b, const std::string& stream, std::size_t count, std::size_t stride,
                 const std::string& mode, const std::string& filter, const std::string& extension) {
    while (b.binary.size() % 4) b.binary += '\0';
    const std::string of = mode == "ATTRIBUTES" ? fmt::format(R"("byteStride":{},)", stride) : "";
    b.views += fmt::format(
        R"({}{{"buffer":1,"byteOffset":0,"byteLength":{},{}"extensions":{{"{}":{{"buffer":0,"byteOffset":{},)"
        R"("byteLength":{},"byteStride":{},"count":{},"mode":"{}","filter":"{}"}}}}}})",
        comma(b.view_count), count * stride, of, extension, b.binary.size(), stream.size(), stride, count, mode,
        filter);
    b.more_buffers = fmt::format(R"(,{{"byteLength":1000000,"extensions":{{"{}":{{"fallback":true}}}}}})", extension);
    b.binary += stream;
    return b.view_count++;
}

std::string meshopt_glb(const BallMesh& mesh, const std::string& extension) {
    GltfBuilder b;
    const std::size_t n = mesh.vertices();
    const auto vertices = [&](const std::string& bytes, std::size_t stride) {
        return meshopt_view(b, meshopt_vertices(bytes, stride), n, stride, "ATTRIBUTES", "NONE", extension);
    };
    const int p = b.accessor(vertices(raw(mesh.xyz), 12), 5126, n, "VEC3");
    const int uv = b.accessor(vertices(raw(mesh.uv), 8), 5126, n, "VEC2");
    const int rgba = b.accessor(vertices(raw(mesh.rgba), 4), 5121, n, "VEC4", R"(,"normalized":true)");
    const int corners = b.accessor(
        meshopt_view(b, meshopt_triangles(mesh.corners, n), mesh.corners.size(), 2, "TRIANGLES", "NONE", extension),
        5123, mesh.corners.size(), "SCALAR");
    return b.file(
        scene_of(primitive(fmt::format(R"("POSITION":{},"TEXCOORD_0":{},"COLOR_0":{})", p, uv, rgba), corners,
                           R"(,"material":0)")) +
        R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
        R"("images":[{"uri":"t.png"}],"extensionsRequired":[")" +
        extension + R"("])");
}

}  // namespace voxtone::test
