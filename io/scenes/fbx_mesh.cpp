// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scenes/fbx_mesh.h"

#include <string_view>

#include <fmt/format.h>

#include "base/printable.h"

namespace voxtone::io {

namespace {

std::string_view text_in(const FbxNode& node, std::string_view child) {
    const FbxNode* const found = node.child(child);
    return found ? found->text(0) : std::string_view();
}

/// Layers whose mapping is not known (edges, none) are none.
std::optional<FbxLayer> layer_of(FbxTree& tree, const FbxNode& node, std::size_t width, const char* values,
                                 const char* index) {
    FbxLayer layer;
    layer.name = text_in(node, "Name");
    layer.width = width;
    const std::string_view mapping = text_in(node, "MappingInformationType");
    if (mapping == "ByPolygonVertex")
        layer.mapping = FbxLayer::Mapping::corner;
    else if (mapping == "ByVertex" || mapping == "ByVertice")
        layer.mapping = FbxLayer::Mapping::vertex;
    else if (mapping == "ByPolygon")
        layer.mapping = FbxLayer::Mapping::polygon;
    else if (mapping != "AllSame")
        return std::nullopt;
    layer.values = tree.reals(node.child(values));
    const std::string_view reference = text_in(node, "ReferenceInformationType");
    layer.indexed = index && (reference == "IndexToDirect" || reference == "Index") && node.child(index);
    if (layer.indexed) layer.index = tree.integers(node.child(index));
    return layer;
}

}  // namespace

std::optional<std::size_t> FbxLayer::at(const FbxCorner& corner) const {
    std::size_t place = mapping == Mapping::corner    ? corner.number
                        : mapping == Mapping::vertex  ? corner.vertex
                        : mapping == Mapping::polygon ? corner.polygon
                                                      : 0;
    if (indexed) {
        if (place >= index.size() || index[place] < 0) return std::nullopt;
        place = static_cast<std::size_t>(index[place]);
    }
    if (place >= values.size() / width) return std::nullopt;
    return place * width;
}

FbxMesh fbx_mesh(FbxTree& tree, const FbxNode& geometry) {
    FbxMesh mesh;
    const std::vector<double> places = tree.reals(geometry.child("Vertices"));
    for (std::size_t i = 0; i + 2 < places.size(); i += 3)
        mesh.vertices.emplace_back(places[i], places[i + 1], places[i + 2]);
    FbxPolygon polygon;
    for (const std::int64_t given : tree.integers(geometry.child("PolygonVertexIndex"))) {
        const std::int64_t vertex = given < 0 ? ~given : given;  // the last of a polygon is complemented
        if (static_cast<std::uint64_t>(vertex) >= mesh.vertices.size())
            tree.fail(fmt::format("a polygon of '{}' uses vertex {}, but there are only {}",
                                  printable(geometry.text(1)), vertex, mesh.vertices.size()));
        mesh.vertex_of_corner.push_back(static_cast<std::uint32_t>(vertex));
        ++polygon.corners;
        if (given >= 0) continue;
        if (polygon.corners < 3)
            ++mesh.thin;
        else
            mesh.polygons.push_back(polygon);
        polygon = {polygon.number + 1, mesh.vertex_of_corner.size(), 0};
    }
    if (polygon.corners) tree.fail(fmt::format("the last polygon of '{}' has no end", printable(geometry.text(1))));
    for (const FbxNode& child : geometry.children) {
        if (child.name == "LayerElementUV")
            if (auto layer = layer_of(tree, child, 2, "UV", "UVIndex")) mesh.uv.push_back(std::move(*layer));
        if (child.name == "LayerElementColor")
            if (auto layer = layer_of(tree, child, 4, "Colors", "ColorIndex"))
                mesh.colours.push_back(std::move(*layer));
        // "IndexToDirect" there, too, and the numbers are those of materials
        if (child.name == "LayerElementMaterial" && !mesh.materials)
            mesh.materials = layer_of(tree, child, 1, "Materials", nullptr);
    }
    return mesh;
}

}  // namespace voxtone::io
