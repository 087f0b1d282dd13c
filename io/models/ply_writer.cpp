// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/ply_writer.h"

#include <algorithm>
#include <bit>
#include <string>

#include <fmt/core.h>

#include "base/contracts.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");
constexpr std::size_t face_bytes = 1 + 3 * sizeof(std::uint32_t);

}  // namespace

std::vector<std::uint8_t> ply_bytes(const ColouredMesh& mesh, const VertexNumbers& numbers) {
    VOXTONE_EXPECT(mesh.positions_mm.size() == mesh.rgb.size());
    VOXTONE_EXPECT(numbers.values.size() == numbers.names.size() * mesh.positions_mm.size());
    const std::size_t vertex_bytes = 3 * sizeof(float) + 3 + numbers.names.size() * sizeof(float);
    std::string properties;
    for (const std::string& name : numbers.names) properties += "property float " + name + "\n";
    const std::string header = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment made by voxtone; millimetres, z up; sRGB\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n{}"
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.positions_mm.size(), properties, mesh.triangles.size());
    std::vector<std::uint8_t> bytes(header.size() + vertex_bytes * mesh.positions_mm.size() +
                                    face_bytes * mesh.triangles.size());
    std::uint8_t* to = bytes.data();
    const auto put = [&to](const void* from, std::size_t size) {
        to = std::copy_n(static_cast<const std::uint8_t*>(from), size, to);  // no numbers: nothing, from nowhere
    };
    put(header.data(), header.size());
    for (std::size_t i = 0; i < mesh.positions_mm.size(); ++i) {
        put(mesh.positions_mm[i].data(), 3 * sizeof(float));
        for (int c = 0; c < 3; ++c) *to++ = linear_to_srgb8(mesh.rgb[i][c]);
        put(numbers.values.data() + i * numbers.names.size(), numbers.names.size() * sizeof(float));
    }
    for (const auto& triangle : mesh.triangles) {
        *to++ = 3;
        put(triangle.data(), 3 * sizeof(std::uint32_t));
    }
    return bytes;
}

}  // namespace voxtone::io
