// SPDX-License-Identifier: GPL-3.0-or-later
//
// One box as other people's programs write it (tests/data/models): its size, and the colours of its six sides.
#include <string>
#include <vector>

#include "tests/io/models/model_test.h"
#include "tests/places.h"

namespace {

/// How the box lies: its +x, +y and +z in the model.
struct Lying {
    Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
};
const Lying as_it_was;
/// Written as it was by a program whose files have y up.
const Lying on_its_back{Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY()};

struct Exported {
    const char* name;
    double mm_per_file_unit, scale;  ///< of the box in units of the file
    Lying lying;
    const char* says;
};

/// The colour of the side that faces along `normal`, from the middle of its triangles; black where they differ.
Vector3f colour_of_side(const TexturedMesh& mesh, const Vector3d& normal) {
    std::vector<Vector3f> found;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vector3d across = (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
        if (across.normalized().dot(normal) < 0.999) continue;
        const SurfaceMaterial& material = mesh.materials[mesh.material_of_triangle[t]];
        Vector3f rgb = material.rgb;
        if (!mesh.corner_rgb.empty())
            rgb = rgb.cwiseProduct((mesh.corner_rgb[t][0] + mesh.corner_rgb[t][1] + mesh.corner_rgb[t][2]) / 3);
        if (material.texture) {
            const Eigen::Vector2f uv = (mesh.corner_uv[t][0] + mesh.corner_uv[t][1] + mesh.corner_uv[t][2]) / 3;
            rgb = rgb.cwiseProduct(material.texture->sample(uv.x(), uv.y()));
        }
        found.push_back(rgb);
    }
    return found.size() == 2 && near(found[0], found[1]) ? found[0] : Vector3f::Zero();
}

Vector3f of_codes(double r, double g, double b) { return {linear(r / 255), linear(g / 255), linear(b / 255)}; }

}  // namespace

TEST_CASE("One box by other people's exporters has its size and the colours of its sides") {
    const Eigen::AngleAxisd turn(30 * 3.14159265358979 / 180, Vector3d::UnitZ());  // before y up is turned
    const auto turned = [&](const Vector3d& axis) {
        const Vector3d p = turn * axis;
        return Vector3d(p.x(), -p.z(), p.y());
    };
    const Lying moved{turned(Vector3d::UnitX()), turned(Vector3d::UnitY()), turned(Vector3d::UnitZ())};
    for (const Exported& file :
         {Exported{"blender-embedded.fbx", 10, 100, as_it_was, ""},
          Exported{"blender-colours.fbx", 10, 100, as_it_was, ""},
          Exported{"assimp-texture.fbx", 10, 1, on_its_back, ""}, Exported{"assimp-text.fbx", 10, 1, on_its_back, ""},
          Exported{"vtk-materials.wrl", 0, 1, on_its_back, ""},
          Exported{"vtk-faces.wrl", 0, 1, moved, "[which-colour]"},
          Exported{"vtk-pixels.wrz", 0, 1, on_its_back, ""}}) {
        INFO(file.name);
        const ModelFile model = read_model_here(test_data() + "/models/" + file.name);
        CHECK(model.mm_per_file_unit == file.mm_per_file_unit);
        CHECK(model.mesh.positions.size() == 8);
        REQUIRE(model.mesh.triangles.size() == 12);
        CHECK(model.lost_colour.empty());
        INFO(warnings(model));
        CHECK_THAT(warnings(model), Contains(file.says));
        CHECK(warnings(model).empty() == std::string(file.says).empty());
        const auto extent = [&](const Vector3d& axis) {
            double low = 1e9, high = -1e9;
            for (const Vector3d& p : model.mesh.positions) {
                low = std::min(low, p.dot(axis));
                high = std::max(high, p.dot(axis));
            }
            return (high - low) / file.scale;
        };
        CHECK(extent(file.lying.x) == Approx(15));
        CHECK(extent(file.lying.y) == Approx(10));
        CHECK(extent(file.lying.z) == Approx(6));
        const auto side = [&](const Vector3d& normal) { return colour_of_side(model.mesh, normal); };
        CHECK(near(side(file.lying.x), of_codes(200, 40, 40)));
        CHECK(near(side(-file.lying.x), of_codes(40, 160, 40)));
        CHECK(near(side(file.lying.y), of_codes(40, 60, 200)));
        CHECK(near(side(-file.lying.y), of_codes(230, 210, 40)));
        CHECK(near(side(file.lying.z), of_codes(170, 170, 170)));
        CHECK(near(side(-file.lying.z), of_codes(180, 40, 160)));
    }
}
