// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files of points, of lines, of what is hidden: what there is in place of faces is told, not that there are none alone.
#include <string>
#include "tests/io/models/model_test.h"

namespace {

std::string refusal(const std::string& name, const std::string& bytes) {
    return refusal_by([&] { return read_alone({{name, bytes}}); });
}

/// A glTF of one node with a primitive of this mode over three points.
std::string gltf_of(int mode, const std::string& node = "", const std::string& primitive = "",
                    const std::string& root = "", const std::string& attributes = "") {
    const std::string head =
        "{" + root +
        R"("asset": {"version": "2.0"}, "buffers": [{"byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],)"
        R"("accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],)"
        R"("scenes": [{"nodes": [0]}], "extensionsUsed": ["KHR_node_visibility"],)";
    return glb(head + R"("nodes": [{"mesh": 0)" + node +
                   R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0)" + attributes + R"(}, "mode": )" +
                   std::to_string(mode) + primitive + "}]}]}",
               raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
}

}  // namespace

TEST_CASE("A file without faces says what it has instead") {
    for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"},
                                      {"b.obj", "v 0 0 0\nv 1 0 0\n"},
                                      {"a.ply",
                                       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                                       "property float z\nend_header\n0 0 0\n"},
                                      {"points.glb", gltf_of(0)},
                                      {"lines.glb", gltf_of(1)}}) {
        INFO(name);
        CHECK_THAT(refusal(name, bytes), Contains(name + " holds no faces to print, only points or lines"));
    }
    CHECK_THAT(refusal("hidden.glb", gltf_of(4, R"(, "extensions": {"KHR_node_visibility": {"visible": false}})")),
               Contains("only hidden nodes"));
    const auto splats = Contains("only Gaussian splats, which have no surface: export a mesh");
    for (const std::string properties :
         {"property float f_dc_0\nproperty float opacity\nproperty float scale_0\nproperty float rot_0\n",
          "property float scale_0\nproperty float rot_0\nproperty uchar red\nproperty uchar green\n"}) {
        const std::string header =
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            "property float z\n" +
            properties + "end_header\n0 0 0 1 1 1 1\n";
        CHECK_THAT(refusal("splat.ply", header), splats);
    }
    CHECK_THAT(refusal("splat.glb", gltf_of(0, "", R"(, "extensions": {"KHR_gaussian_splatting": {}})")), splats);
    CHECK_THAT(refusal("need.glb", gltf_of(0, "", R"(, "extensions": {"KHR_gaussian_splatting": {}})",
                                           R"("extensionsRequired": ["KHR_gaussian_splatting"],)")),
               splats);
    // By the names of their attributes alone, as drafts had them.
    CHECK_THAT(refusal("draft.glb", gltf_of(0, "", "", "", R"(, "_ROTATION": 0, "_SCALE": 0)")), splats);
    CHECK_THAT(refusal("turned.glb", gltf_of(0, "", "", "", R"(, "_ROTATION": 0)")), Contains("only points or lines"));
    CHECK_THAT(refusal("a.stl", "solid a\nendsolid a\n"), Contains("without any facet"));
    CHECK_THAT(refusal("c.obj", "o empty\n"), Contains("holds no faces"));
}
