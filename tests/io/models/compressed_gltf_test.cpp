// SPDX-License-Identifier: GPL-3.0-or-later
//
// glTF that is compressed with Draco or meshoptimizer, held against the same without compression.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "compressed_samples.h"
#include "io/codecs/draco_mesh.h"
#include "io/codecs/meshopt_stream.h"
#include "tests/io/models/model_test.h"

namespace {

ModelFile read_glb(const std::string& bytes, const Files& others = {}, const ReadOptions& options = {}) {
    return read_alone({{"a.glb", bytes}, {"t.png", four_colours()}}, others, options);
}

std::string refusal_of(const std::string& bytes, const Files& others = {}, const ReadOptions& options = {}) {
    return refusal_by([&] { return read_glb(bytes, others, options); });
}

/// Edges that one triangle has and no other the other way round.
std::size_t open_edges(const TexturedMesh& mesh) {
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& t : mesh.triangles)
        for (std::size_t c = 0; c < 3; ++c) edges.emplace(t[c], t[(c + 1) % 3]);
    return static_cast<std::size_t>(std::ranges::count_if(edges, [&](const auto& e) {
        return !edges.contains({e.second, e.first});
    }));
}

/// A corner: where it is, what is laid on it, its colour.
using Corner = std::tuple<std::array<double, 3>, std::array<float, 2>, std::array<float, 3>>;

Corner corner_of(const TexturedMesh& mesh, std::size_t t, std::size_t c) {
    const Vector3d& p = mesh.positions[mesh.triangles[t][c]];
    const Vector2f& uv = mesh.corner_uv[t][c];
    const Vector3f& rgb = mesh.corner_rgb[t][c];
    return {{p.x(), p.y(), p.z()}, {uv.x(), uv.y()}, {rgb.x(), rgb.y(), rgb.z()}};
}

/// The least corner first, for encoders turn triangles.
std::vector<std::array<Corner, 3>> turned(const TexturedMesh& mesh) {
    std::vector<std::array<Corner, 3>> all;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<Corner, 3> corners{corner_of(mesh, t, 0), corner_of(mesh, t, 1), corner_of(mesh, t, 2)};
        std::ranges::rotate(corners, std::ranges::min_element(corners));
        all.push_back(corners);
    }
    std::ranges::sort(all);
    return all;
}

/// The vertex of `mesh` that lies nearest.
std::uint32_t nearest(const TexturedMesh& mesh, const Vector3d& place) {
    std::uint32_t best = 0;
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
        if ((mesh.positions[v] - place).norm() < (mesh.positions[best] - place).norm()) best = v;
    return best;
}

/// Largest distances of places and texture coordinates of triangles from those of the twin; colours are the same.
struct TwinError {
    double place = 0;
    float uv = 0;
    bool same_colours = true, same_triangles = true;
};

TwinError error_against(const TexturedMesh& twin, const TexturedMesh& mesh) {
    std::map<std::array<std::uint32_t, 3>, std::pair<std::size_t, std::size_t>> known;  // triangle, its first corner
    for (std::size_t t = 0; t < twin.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            known[{twin.triangles[t][c], twin.triangles[t][(c + 1) % 3], twin.triangles[t][(c + 2) % 3]}] = {t, c};
    TwinError error{.same_triangles = twin.triangles.size() == mesh.triangles.size()};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<std::uint32_t, 3> at{};
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3d& place = mesh.positions[mesh.triangles[t][c]];
            at[c] = nearest(twin, place);
            error.place = std::max(error.place, (twin.positions[at[c]] - place).cwiseAbs().maxCoeff());
        }
        const auto found = known.find(at);
        error.same_triangles &= found != known.end();
        if (found == known.end()) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [other, first] = found->second;
            const std::size_t o = (first + c) % 3;
            error.uv = std::max(error.uv, (twin.corner_uv[other][o] - mesh.corner_uv[t][c]).cwiseAbs().maxCoeff());
            error.same_colours &= twin.corner_rgb[other][o] == mesh.corner_rgb[t][c];
        }
    }
    return error;
}

/// A stream's head with these numbers of faces and points, of seven bits a byte.
std::string draco_head(bool sequential, std::uint64_t faces, std::uint64_t points) {
    std::string stream("DRACO\2\2\1", 8);
    stream += sequential ? '\0' : '\1';
    stream += std::string(2, '\0');
    if (!sequential) stream += '\0';
    for (std::uint64_t number : {sequential ? faces : points, sequential ? points : faces}) {
        for (; number > 127; number >>= 7) stream += static_cast<char>(128 | (number & 127));
        stream += static_cast<char>(number);
    }
    return stream + std::string(40, '\0');
}

std::string draco_refusal(const std::string& stream, std::vector<DracoAttribute> attributes = {{0, 5126}}) {
    return refusal_by(
        [&] { return decode_draco(std::as_bytes(std::span(stream)), attributes, std::uint64_t{1} << 31); });
}

MeshoptStream stream_of(const std::string& bytes, std::int64_t count, std::int64_t stride, const std::string& mode,
                        const std::string& filter = "NONE") {
    return {std::as_bytes(std::span(bytes)), count, stride, mode, filter};
}

std::string meshopt_refusal(const MeshoptStream& stream, std::uint64_t most_bytes = 1 << 20) {
    try {
        return decode_meshopt(stream, most_bytes).newer;
    } catch (const InputError& error) {
        return error.what();
    }
}

}  // namespace

TEST_CASE("Draco gives the twin within a quantum, closed, with its texture coordinates and colours", "[draco]") {
    const ModelFile twin = read_glb(plain_glb({ball()}));
    REQUIRE(open_edges(twin.mesh) == 0);
    for (const bool sequential : {false, true})
        for (const int bits : {8, 11, 14, 0}) {
            INFO("sequential " << sequential << ", " << bits << " bits");
            const ModelFile file = read_glb(draco_glb({ball()}, {bits, sequential}));
            CHECK(file.warnings.empty());
            CHECK(open_edges(file.mesh) == 0);
            REQUIRE(file.mesh.corner_uv.size() == file.mesh.triangles.size());
            const TwinError error = error_against(twin.mesh, file.mesh);
            CHECK(error.same_triangles);
            CHECK(error.same_colours);
            CHECK(error.uv <= 1.0f / 4095);
            CHECK(error.place <= (bits > 0 ? 2.0 / ((1 << bits) - 1) : 0.0));
            CHECK(file.mesh.materials[file.mesh.material_of_triangle[0]].texture);
        }
}

TEST_CASE("Pieces that were rounded on grids of their own hang together again", "[draco]") {
    // Three slices of the ball: of other extents, so of other quanta.
    const std::vector<BallMesh> pieces{ball(12, 0, 5), ball(12, 5, 6), ball(12, 6, 12)};
    const ModelFile twin = read_glb(plain_glb(pieces));
    REQUIRE(open_edges(twin.mesh) == 0);
    for (const int bits : {7, 9, 11, 14}) {
        INFO(bits << " bits");
        const ModelFile file = read_glb(draco_glb(pieces, {bits, false}));
        CHECK(open_edges(file.mesh) == 0);
        const TwinError error = error_against(twin.mesh, file.mesh);
        CHECK(error.same_triangles);
        CHECK(error.place <= 2.0 / ((1 << bits) - 1));
    }
}

TEST_CASE("Where the values are there without Draco, these are taken", "[draco]") {
    GltfBuilder b;
    const BallMesh mesh = ball();
    const int junk = b.view("no stream"), p = b.data(raw(mesh.xyz), 5126, mesh.vertices(), "VEC3"),
              corners = b.data(raw(mesh.corners), 5125, mesh.corners.size(), "SCALAR");
    const auto file = [&](int indices) {
        return b.file(scene_of(
            fmt::format(R"({{"attributes":{{"POSITION":{}}},"indices":{},"extensions":)"
                        R"({{"KHR_draco_mesh_compression":{{"bufferView":{},"attributes":{{"POSITION":0}}}}}}}})",
                        p, indices, junk)));
    };
    CHECK(read_glb(file(corners)).mesh.triangles.size() == mesh.corners.size() / 3);
    const int lacking = b.accessor(-1, 5125, mesh.corners.size(), "SCALAR");
    CHECK_THAT(refusal_of(file(lacking)),
               Contains("primitive 0 of mesh 0 of a.glb") && Contains("without mesh compression"));
}

TEST_CASE("A Draco stream that is cut at any byte is refused in a sentence, or is whole", "[draco]") {
    for (const bool sequential : {false, true}) {
        const DracoStream whole = draco_stream(ball(4), {11, sequential});
        const std::vector<DracoAttribute> attributes{{whole.position, 5126}, {whole.uv, 5126}, {whole.colour, 5121}};
        REQUIRE(draco_refusal(whole.bytes, attributes) == "no error");
        std::size_t read = 0;
        for (std::size_t length = 0; length < whole.bytes.size(); ++length) {
            INFO(length);
            const std::string why = draco_refusal(whole.bytes.substr(0, length), attributes);
            read += why == "no error";
            CHECK_THAT(why, Contains("damaged or cut short") || Contains("no error"));
        }
        CHECK(read <= 4);  // what its end is padded with
    }
}

TEST_CASE("A Draco stream that declares more than may be unpacked is refused before it is decoded", "[draco]") {
    for (const bool sequential : {false, true}) {
        CHECK_THAT(draco_refusal(draco_head(sequential, 1, 4'000'000'000)),
                   Contains("4000000000 points") && Contains("2147483648 bytes"));
        CHECK_THAT(draco_refusal(draco_head(sequential, 1'400'000'000, 3)), Contains("1400000000 triangles"));
        CHECK_THAT(draco_refusal(draco_head(sequential, 1'000'000, 3)), Contains("damaged"));
    }
    ReadOptions small;
    small.max_unpacked_bytes = 1000;
    CHECK_THAT(refusal_of(draco_glb({ball()}), {}, small), Contains("1000 bytes") && Contains("a.glb"));
}

TEST_CASE("What a Draco stream has not is named", "[draco]") {
    const DracoStream stream = draco_stream(ball(4));
    CHECK_THAT(draco_refusal(stream.bytes, {{77, 5126}}), Contains("no attribute 77"));
    CHECK_THAT(draco_refusal("DRACO\2\2\0\0\0\0 and so on"), Contains("damaged"));
    CHECK_THAT(draco_refusal("no Draco at all"), Contains("damaged"));
    CHECK_THAT(draco_refusal(""), Contains("damaged"));
    std::string newer = stream.bytes;
    newer[5] = 9;
    CHECK_THAT(draco_refusal(newer), Contains("version"));
}

TEST_CASE("meshopt gives the bits of the twin", "[meshopt]") {
    const ModelFile twin = read_glb(plain_glb({ball()}));
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        const ModelFile file = read_glb(meshopt_glb(ball(), extension));
        CHECK(file.warnings.empty());
        CHECK(open_edges(file.mesh) == 0);
        CHECK(turned(file.mesh) == turned(twin.mesh));
    }
}

TEST_CASE("meshopt streams of every mode are what was encoded", "[meshopt]") {
    const BallMesh mesh = ball();
    const auto sorted = [](std::vector<std::array<std::uint32_t, 3>> triangles) {
        for (auto& t : triangles) std::ranges::rotate(t, std::ranges::min_element(t));
        std::ranges::sort(triangles);
        return triangles;
    };
    const auto indices_of = [](const MeshoptResult& result, std::size_t stride) {
        std::vector<std::uint32_t> indices(result.bytes.size() / stride);
        for (std::size_t i = 0; i < indices.size(); ++i)
            std::memcpy(&indices[i], result.bytes.data() + i * stride, stride);
        return indices;
    };
    const auto triangles_of = [&](const std::vector<std::uint32_t>& indices) {
        std::vector<std::array<std::uint32_t, 3>> triangles;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
            triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
        return sorted(triangles);
    };
    const auto count = static_cast<std::int64_t>(mesh.corners.size());
    const std::string triangles = meshopt_triangles(mesh.corners, mesh.vertices()),
                      sequence = meshopt_sequence(mesh.corners, mesh.vertices());
    for (const std::int64_t stride : {2, 4}) {
        const auto wide = static_cast<std::size_t>(stride);
        CHECK(triangles_of(indices_of(decode_meshopt(stream_of(triangles, count, stride, "TRIANGLES"), 1 << 20),
                                      wide)) == triangles_of(mesh.corners));
        CHECK(indices_of(decode_meshopt(stream_of(sequence, count, stride, "INDICES"), 1 << 20), wide) == mesh.corners);
    }
    for (const std::size_t stride : {4u, 8u, 12u, 16u, 64u, 256u}) {
        std::string bytes(stride * 300, '\0');
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i % 251);
        const MeshoptResult result = decode_meshopt(
            stream_of(meshopt_vertices(bytes, stride), 300, static_cast<std::int64_t>(stride), "ATTRIBUTES"), 1 << 20);
        CHECK(std::memcmp(result.bytes.data(), bytes.data(), bytes.size()) == 0);
        CHECK(result.bytes.size() == bytes.size());
    }
}

TEST_CASE("meshopt filters give what their encoder rounded to", "[meshopt]") {
    constexpr std::size_t n = 37;
    SECTION("octahedral: unit vectors of 8 and 16 bits, the fourth component as it was") {
        std::vector<float> vectors;
        for (std::size_t i = 0; i < n; ++i) {
            const Vector3f v = Vector3f(float(i) - 18, float(i * 7 % 11) - 5, float(i * 5 % 13) - 6.5f).normalized();
            vectors.insert(vectors.end(), {v.x(), v.y(), v.z(), 1});
        }
        for (const std::size_t stride : {4u, 8u}) {
            std::string bytes(n * stride, '\0');
            meshopt_encodeFilterOct(bytes.data(), n, stride, stride == 4 ? 8 : 16, vectors.data());
            const MeshoptResult result =
                decode_meshopt(stream_of(meshopt_vertices(bytes, stride), n, static_cast<std::int64_t>(stride),
                                         "ATTRIBUTES", "OCTAHEDRAL"),
                               1 << 20);
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t c = 0; c < 3; ++c) {
                    std::int16_t value = 0;
                    std::memcpy(&value, result.bytes.data() + i * stride + c * stride / 4, stride / 4);
                    const float share =
                        stride == 4 ? float(static_cast<std::int8_t>(value)) / 127 : float(value) / 32767;
                    CHECK(share == Approx(vectors[4 * i + c]).margin(stride == 4 ? 0.02 : 0.0002));
                }
        }
    }
    SECTION("quaternions turn the copies of a mesh") {
        const Eigen::Quaternionf turn(Eigen::AngleAxisf(1.2f, Vector3f(1, 2, 3).normalized()));
        const std::vector<float> values{turn.x(), turn.y(), turn.z(), turn.w(), 0, 0, 0, 1};
        std::string bytes(16, '\0');
        meshopt_encodeFilterQuat(bytes.data(), 2, 8, 16, values.data());
        GltfBuilder b;
        const int p = b.data(raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}), 5126, 3, "VEC3");
        const int q = b.accessor(meshopt_view(b, meshopt_vertices(bytes, 8), 2, 8, "ATTRIBUTES", "QUATERNION"), 5122, 2,
                                 "VEC4", R"(,"normalized":true)");
        const ModelFile file = read_glb(b.file(fmt::format(
            R"("nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"ROTATION":{}}}}}}}}}],)"
            R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}}])",
            q, p)));
        REQUIRE(file.mesh.triangles.size() == 2);
        const Vector3f x = turn * Vector3f::UnitX();
        CHECK((file.mesh.positions[file.mesh.triangles[0][1]] - Vector3d(x.x(), -x.z(), x.y())).norm() < 1e-3);
    }
    SECTION("exponential: 24 bits of mantissa and 8 of exponent, a component each") {
        std::vector<float> values;
        for (std::size_t i = 0; i < 3 * n; ++i) values.push_back((float(i) - 50.25f) * (i % 2 ? 1e-3f : 40));
        std::string bytes(n * 12, '\0');
#if MESHOPTIMIZER_VERSION >= 190  // Debian 13's can do otherwise, too
        meshopt_encodeFilterExp(bytes.data(), n, 12, 20, values.data(), meshopt_EncodeExpSharedVector);
#else
        meshopt_encodeFilterExp(bytes.data(), n, 12, 20, values.data());
#endif
        const MeshoptResult result =
            decode_meshopt(stream_of(meshopt_vertices(bytes, 12), n, 12, "ATTRIBUTES", "EXPONENTIAL"), 1 << 20);
        for (std::size_t i = 0; i < 3 * n; ++i) {
            std::int32_t code = 0;
            float value = 0;
            std::memcpy(&code, bytes.data() + 4 * i, 4);
            std::memcpy(&value, result.bytes.data() + 4 * i, 4);
            const std::int32_t mantissa = static_cast<std::int32_t>(static_cast<std::uint32_t>(code) << 8) >> 8;
            CHECK(value == std::ldexp(static_cast<float>(mantissa), code >> 24));
            CHECK(value == Approx(values[i]).margin(0.01));
        }
    }
}

TEST_CASE("A meshopt stream that is cut, or says what cannot be, is refused in a sentence", "[meshopt]") {
    const BallMesh mesh = ball(4);
    const std::string vertices = meshopt_vertices(raw(mesh.xyz), 12),
                      triangles = meshopt_triangles(mesh.corners, mesh.vertices()),
                      sequence = meshopt_sequence(mesh.corners, mesh.vertices());
    const auto n = static_cast<std::int64_t>(mesh.vertices()), corners = static_cast<std::int64_t>(mesh.corners.size());
    for (std::size_t length = 0; length < vertices.size(); ++length)
        CHECK_FALSE(meshopt_refusal(stream_of(vertices.substr(0, length), n, 12, "ATTRIBUTES")).empty());
    for (std::size_t length = 0; length < triangles.size(); ++length)
        CHECK_FALSE(meshopt_refusal(stream_of(triangles.substr(0, length), corners, 2, "TRIANGLES")).empty());
    for (std::size_t length = 0; length < sequence.size(); ++length)
        CHECK_FALSE(meshopt_refusal(stream_of(sequence.substr(0, length), corners, 4, "INDICES")).empty());
    const auto of = [&](std::int64_t count, std::int64_t stride, const char* mode, const char* filter = "NONE") {
        return meshopt_refusal(stream_of(vertices, count, stride, mode, filter));
    };
    CHECK_THAT(of(4'000'000'000, 12, "ATTRIBUTES"), Contains("4000000000 elements"));
    CHECK_THAT(meshopt_refusal(stream_of(vertices, n, 12, "ATTRIBUTES"), 100), Contains("100 bytes"));
    CHECK_THAT(of(-1, 12, "ATTRIBUTES"), Contains("-1 elements"));
    for (const std::int64_t stride : {-4, 0, 3, 10, 260})
        CHECK_THAT(of(n, stride, "ATTRIBUTES"), Contains("not for its mode"));
    CHECK_THAT(of(3, 12, "TRIANGLES"), Contains("not for its mode"));
    CHECK_THAT(of(4, 2, "TRIANGLES"), Contains("4 elements"));
    CHECK_THAT(of(n, 12, "STRIPS"), Contains("STRIPS"));
    CHECK_THAT(of(n, 12, "ATTRIBUTES", "OCTAHEDRAL"), Contains("not for its filter"));
    CHECK_THAT(of(n, 12, "ATTRIBUTES", "QUATERNION"), Contains("not for its filter"));
    CHECK_THAT(meshopt_refusal(stream_of(sequence, corners, 4, "INDICES", "EXPONENTIAL")), Contains("EXPONENTIAL"));
    CHECK_THAT(meshopt_refusal(stream_of(triangles, n, 12, "ATTRIBUTES")), Contains("damaged"));
}

TEST_CASE("What a newer meshoptimizer wrote is refused by name, or taken as it is there besides", "[meshopt]") {
    const std::vector<float> triangle{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const auto file = [&](bool newer, const std::string& filter, const std::string& fallback) {
        std::string stream = meshopt_vertices(raw(triangle), 12);
        if (newer) stream[0] = static_cast<char>(static_cast<unsigned char>(stream[0]) | 0xf);
        GltfBuilder b;
        const int p = b.accessor(meshopt_view(b, stream, 3, 12, "ATTRIBUTES", filter, "KHR_meshopt_compression"), 5126,
                                 3, "VEC3");
        b.more_buffers = fmt::format(
            R"(,{{"byteLength":36,{}"extensions":{{"KHR_meshopt_compression":{{"fallback":true}}}}}})", fallback);
        return b.file(scene_of(fmt::format(R"({{"attributes":{{"POSITION":{}}}}})", p)));
    };
    CHECK(read_glb(file(false, "NONE", "")).mesh.triangles.size() == 1);
    CHECK_THAT(refusal_of(file(true, "NONE", "")), Contains("version 15 of its coding") && Contains("a.glb"));
    CHECK_THAT(refusal_of(file(false, "COLOR", "")), Contains("the filter COLOR"));
    const std::string uri = R"("uri":"plain.bin",)";
    for (const bool newer : {true, false})
        CHECK(read_glb(file(newer, newer ? "NONE" : "COLOR", uri), {{"plain.bin", raw(triangle)}})
                  .mesh.positions.size() == 3);
    // not wanted where the stream is read: it need not be there
    CHECK(read_glb(file(false, "NONE", uri)).mesh.triangles.size() == 1);
    CHECK_THAT(refusal_of(file(true, "NONE", uri)), Contains("plain.bin"));
}

TEST_CASE("Attributes of small integers are what they stand for, normalised or not", "[meshopt]") {
    // KHR_mesh_quantization: positions, and texture coordinates, of all types; rows are padded to four bytes.
    struct Kind {
        int type;
        double largest;
        std::size_t bytes;
    };
    for (const Kind kind : {Kind{5120, 127, 1}, Kind{5121, 255, 1}, Kind{5122, 32767, 2}, Kind{5123, 65535, 2}})
        for (const bool normalised : {false, true})
            for (const bool compressed : {false, true}) {
                INFO(kind.type << " normalised " << normalised << " compressed " << compressed);
                const std::size_t stride = 4 * kind.bytes;
                const auto row = [&](std::string& bytes, std::initializer_list<int> values) {
                    const std::size_t end = bytes.size() + stride;
                    for (const int value : values) bytes.append(reinterpret_cast<const char*>(&value), kind.bytes);
                    bytes.resize(end, '\0');
                };
                std::string places, uv;
                for (const auto& [x, y] : {std::pair{0, 0}, std::pair{100, 3}, std::pair{7, 120}}) {
                    row(places, {x, y, 5});
                    row(uv, {x, y});
                }
                GltfBuilder b;
                const std::string more = normalised ? R"(,"normalized":true)" : "";
                const auto add = [&](const std::string& bytes, const char* type) {
                    const int view = compressed
                                         ? meshopt_view(b, meshopt_vertices(bytes, stride), 3, stride, "ATTRIBUTES")
                                         : b.view(bytes, fmt::format(R"(,"byteStride":{})", stride));
                    return b.accessor(view, kind.type, 3, type, more);
                };
                const int p = add(places, "VEC3"), t = add(uv, "VEC2");
                const ModelFile file = read_glb(b.file(
                    R"("extensionsRequired":["KHR_mesh_quantization"],)" +
                    scene_of(fmt::format(R"({{"attributes":{{"POSITION":{},"TEXCOORD_0":{}}},"material":0}})", p, t)) +
                    R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
                    R"("images":[{"uri":"t.png"}])"));
                const double unit = normalised ? kind.largest : 1;
                REQUIRE(file.mesh.triangles.size() == 1);
                const Vector3d& place = file.mesh.positions[file.mesh.triangles[0][1]];
                CHECK(place.x() == Approx(100 / unit).epsilon(1e-6));
                CHECK(place.y() == Approx(-5 / unit).epsilon(1e-6));
                CHECK(place.z() == Approx(3 / unit).epsilon(1e-6));
                CHECK(file.mesh.corner_uv[0][2].x() == Approx(7 / unit).epsilon(1e-6));
                CHECK(file.mesh.corner_uv[0][2].y() == Approx(1 - 120 / unit).epsilon(1e-5));
            }
}
