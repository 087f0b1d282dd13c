// SPDX-License-Identifier: GPL-3.0-or-later
//
// A coloured ball as glTF, plain and compressed by the libraries' own encoders.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace voxtone::test {

/// Vertices as glTF has them: two of one place where texture coordinates differ.
struct BallMesh {
    std::vector<float> xyz, uv;
    std::vector<std::uint8_t> rgba;
    std::vector<std::uint32_t> corners;

    [[nodiscard]] std::size_t vertices() const { return xyz.size() / 3; }
};

/// Of radius 1, closed, y up, cut along a meridian by its texture coordinates. `from` and `to`: latitudes, of `bands`.
[[nodiscard]] BallMesh ball(int bands, int from, int to);
[[nodiscard]] inline BallMesh ball(int bands = 8) { return ball(bands, 0, bands); }

/// A glTF file put together: buffer 0 grows as data is added.
class GltfBuilder {
public:
    std::string binary, views, accessors, more_buffers;
    int view_count = 0, accessor_count = 0;

    int view(const std::string& bytes, const std::string& more = "");
    int accessor(int view, int component_type, std::size_t count, const std::string& type,
                 const std::string& more = "");
    /// Packed data with a view and an accessor.
    int data(const std::string& bytes, int component_type, std::size_t count, const std::string& type,
             const std::string& more = "") {
        return accessor(view(bytes), component_type, count, type, more);
    }
    /// `rest`: nodes, meshes, materials.
    [[nodiscard]] std::string file(const std::string& rest) const;
};

/// One node, one mesh of these primitives.
[[nodiscard]] std::string scene_of(const std::string& primitives);

/// Without compression.
[[nodiscard]] std::string plain_glb(const std::vector<BallMesh>& pieces);

struct DracoHow {
    int position_bits = 11;  ///< 0: not rounded
    bool sequential = false;
};
struct DracoStream {
    std::string bytes;
    std::uint32_t position = 0, uv = 1, colour = 2;  ///< unique ids
};
[[nodiscard]] DracoStream draco_stream(const BallMesh& mesh, const DracoHow& how = {});
/// Each piece compressed for itself.
[[nodiscard]] std::string draco_glb(const std::vector<BallMesh>& pieces, const DracoHow& how = {});

[[nodiscard]] std::string meshopt_vertices(const std::string& bytes, std::size_t stride);
[[nodiscard]] std::string meshopt_triangles(const std::vector<std::uint32_t>& corners, std::size_t vertices);
[[nodiscard]] std::string meshopt_sequence(const std::vector<std::uint32_t>& indices, std::size_t vertices);
/// A view of `count` elements that are compressed.
int meshopt_view(GltfBuilder& builder, const std::string& stream, std::size_t count, std::size_t stride,
                 const std::string& mode, const std::string& filter = "NONE",
                 const std::string& extension = "EXT_meshopt_compression");
[[nodiscard]] std::string meshopt_glb(const BallMesh& mesh, const std::string& extension = "EXT_meshopt_compression");

}  // namespace voxtone::test
