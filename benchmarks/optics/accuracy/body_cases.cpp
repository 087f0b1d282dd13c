// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_cases.h"

#include <cmath>
#include <numbers>

#include "halftone_skin.h"
#include "voxtone/slicer/mesh_boundary.h"

namespace voxtone::accuracy {
namespace {

using namespace optics;
using halftone::CumulativeMixture;

constexpr double skin_mm = 0.3;

Point centre_of(int x, int y, int z) { return {(x + 0.5) * j750_mm[0], (y + 0.5) * j750_mm[1], (z + 0.5) * j750_mm[2]}; }

std::array<int, 3> voxels_of(const Point& box_mm) {
    std::array<int, 3> size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<int>(std::ceil(box_mm[a] / j750_mm[a]));
    return size;
}

SuiteCase body(std::string name, std::string shown, std::string boundary) {
    SuiteCase c;
    c.name = std::move(name);
    c.shown = std::move(shown);
    c.boundary = std::move(boundary);
    c.resins = suite_resins();
    c.backing = Backing::none;
    c.sides = Sides::open;
    c.part = SurfacePart::all;
    c.noise = 0.5;
    return c;
}

std::vector<CumulativeMixture> colours(const HalftoneSkin& skin) {
    std::vector<CumulativeMixture> all;
    for (const auto& rgb : {std::array{205, 60, 50}, {70, 170, 190}, {235, 210, 75}, {240, 240, 235}, {55, 80, 160}, {215, 110, 150},
                            {75, 150, 85}, {90, 90, 90}})
        all.push_back(skin.of_code(rgb[0], rgb[1], rgb[2]));
    return all;
}

SuiteCase textured_sphere(const HalftoneSkin& skin) {
    constexpr double radius = 1.2;
    const Point centre{1.31, 1.33, 1.30};
    SuiteCase c = body("sphere", "a sphere of 2.4 mm with fields of eight colours", "the sphere");
    c.white_is_one = true;
    c.true_boundary = std::make_shared<Sphere>(centre, radius);
    const std::vector<CumulativeMixture> field = colours(skin);
    c.volume = make_resin_volume(voxels_of({2.62, 2.66, 2.60}), j750_mm, [&](int x, int y, int z) {
        const Point p = centre_of(x, y, z);
        const double dx = p[0] - centre[0], dy = p[1] - centre[1], dz = p[2] - centre[2], r = std::hypot(dx, dy, dz);
        if (r > radius) return air;
        if (r < radius - skin_mm) return resin::W;
        // Six fields around, four from pole to pole.
        const int around = static_cast<int>(std::floor((std::atan2(dy, dx) / std::numbers::pi + 1) * 3)) % 6;
        const int up = std::min(3, static_cast<int>(4 * std::acos(dz / r) / std::numbers::pi));
        return skin.at(field[static_cast<std::size_t>((around + 3 * up) % 8)], x, y, z);
    });
    return c;
}

/// Corners (x, z) of a comb with three leaning, tapered fins, counter-clockwise; the first of a fin is at its right foot.
constexpr std::array<std::array<double, 2>, 14> comb{{{0.05, 0.05}, {3.25, 0.05}, {3.25, 0.90},              //
                                                      {3.00, 0.90}, {3.25, 2.30}, {2.65, 2.30}, {2.20, 0.90},  // 0.8 to 0.6 mm
                                                      {1.80, 0.90}, {1.60, 2.30}, {1.25, 2.30}, {1.30, 0.90},  // 0.5 to 0.35 mm
                                                      {0.60, 0.90}, {0.45, 2.30}, {0.20, 2.30}}};              // 0.3 to 0.25 mm
constexpr std::array<double, 2> last_foot{0.30, 0.90}, left_shoulder{0.05, 0.90};
constexpr double comb_from = 0.05, comb_to = 1.55;  // y

std::vector<std::array<double, 2>> comb_outline() {
    std::vector<std::array<double, 2>> outline(comb.begin(), comb.end());
    outline.push_back(last_foot);
    outline.push_back(left_shoulder);
    return outline;
}

bool inside(const std::vector<std::array<double, 2>>& outline, double x, double z) {
    bool in = false;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++)
        if ((outline[i][1] > z) != (outline[j][1] > z) &&
            x < (outline[j][0] - outline[i][0]) * (z - outline[i][1]) / (outline[j][1] - outline[i][1]) + outline[i][0])
            in = !in;
    return in;
}

/// The comb as a closed mesh, outward: sides of two triangles each; ends of the block and three fins.
std::shared_ptr<const BodyBoundary> comb_mesh(const std::vector<std::array<double, 2>>& outline) {
    const auto n = static_cast<std::uint32_t>(outline.size());
    std::vector<Eigen::Vector3d> positions;
    for (const double y : {comb_from, comb_to})
        for (const auto& p : outline) positions.emplace_back(p[0], y, p[1]);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        triangles.push_back({i, i + n, j});
        triangles.push_back({j, i + n, j + n});
    }
    const auto end = [&](std::initializer_list<std::uint32_t> polygon) {
        const std::vector<std::uint32_t> p(polygon);
        for (std::size_t k = 1; k + 1 < p.size(); ++k) {
            triangles.push_back({p[0], p[k], p[k + 1]});              // at comb_from, outward is -y
            triangles.push_back({p[0] + n, p[k + 1] + n, p[k] + n});
        }
    };
    end({3, 4, 5, 6});
    end({7, 8, 9, 10});
    end({11, 12, 13, 14});
    end({0, 1, 2, 3, 6, 7, 10, 11, 14, 15});
    return std::make_shared<slicer::MeshBoundary>(positions, triangles, Eigen::Vector3d::Zero());
}

SuiteCase fins(const HalftoneSkin& skin) {
    SuiteCase c = body("fins", "a block with three leaning fins, 0.8, 0.5 and 0.3 mm thick", "the mesh");
    const auto outline = comb_outline();
    c.true_boundary = comb_mesh(outline);
    const std::vector<CumulativeMixture> field = colours(skin);
    c.volume = make_resin_volume(voxels_of({3.30, 1.60, 2.35}), j750_mm, [&](int x, int y, int z) {
        const Point p = centre_of(x, y, z);
        if (p[1] < comb_from || p[1] > comb_to || !inside(outline, p[0], p[2])) return air;
        BoundaryNormals normals;
        const Point at = c.true_boundary->nearest(p, normals);
        if (std::hypot(at[0] - p[0], at[1] - p[1], at[2] - p[2]) > skin_mm) return resin::W;
        // One colour for what looks left, another for what looks right, and bands along y.
        const std::size_t side = normals.geometric[0] > 0.1 ? 0 : normals.geometric[0] < -0.1 ? 2 : 4;
        return skin.at(field[side + (at[1] > 0.8 ? 1 : 0)], x, y, z);
    });
    return c;
}

}  // namespace

std::vector<SuiteCase> body_cases() {
    const HalftoneSkin skin(suite_resins(), {"C", "M", "Y", "K", "W"}, skin_mm, 3);
    std::vector<SuiteCase> cases;
    cases.push_back(textured_sphere(skin));
    cases.push_back(fins(skin));
    return cases;
}

}  // namespace voxtone::accuracy
