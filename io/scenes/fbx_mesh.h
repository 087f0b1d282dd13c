// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh of an FBX scene as plain values: places, polygons, and layers of what they show, which may lie at corners,
// vertices, polygons or all alike, straight or by an index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/scenes/fbx_tree.h"

namespace voxtone::io {

/// A corner: its number among all, its vertex, its polygon; from 0.
struct FbxCorner {
    std::size_t number = 0, vertex = 0, polygon = 0;
};

struct FbxLayer {
    enum class Mapping : char { corner, vertex, polygon, same };
    std::string name;
    Mapping mapping = Mapping::same;
    bool indexed = false;
    std::vector<double> values;  ///< `width` each
    std::size_t width = 1;
    std::vector<std::int64_t> index;

    /// Where the corner's values begin; nothing where it has none.
    [[nodiscard]] std::optional<std::size_t> at(const FbxCorner& corner) const;
};

/// Some of all corners, three at least.
struct FbxPolygon {
    std::size_t number = 0, first = 0, corners = 0;
};

struct FbxMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::uint32_t> vertex_of_corner;
    std::vector<FbxPolygon> polygons;
    std::vector<FbxLayer> uv, colours;  ///< uv: two a corner; colours: red, green, blue, alpha
    std::optional<FbxLayer> materials;  ///< numbers among those of the model
    std::size_t thin = 0;               ///< polygons of one or two corners, which are left out

    [[nodiscard]] FbxCorner corner(const FbxPolygon& polygon, std::size_t c) const {
        return {polygon.first + c, vertex_of_corner[polygon.first + c], polygon.number};
    }
};

/// Throws InputError as the tree does.
[[nodiscard]] FbxMesh fbx_mesh(FbxTree& tree, const FbxNode& geometry);

}  // namespace voxtone::io
