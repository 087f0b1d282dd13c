// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_cases.h"

#include <cmath>
#include <numbers>

#include "extruded_polygon.h"
#include "halftone_skin.h"

namespace voxtone::accuracy {
namespace {

using namespace optics;
using halftone::CumulativeMixture;

constexpr double skin_mm = 0.3;

Point centre_of(int x, int y, int z) {
    return {(x + 0.5) * j750_mm[0], (y + 0.5) * j750_mm[1], (z + 0.5) * j750_mm[2]};
}

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
    for (const auto& rgb : {std::array{205, 60, 50},
                            {70, 170, 190},
                            {235, 210, 75},
                            {240, 240, 235},
                            {55, 80, 160},
                            {215, 110, 150},
                            {75, 150, 85},
                            {90, 90, 90}})
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

/// A block with three leaning, tapered fins: corners (x, z), counter-clockwise, each fin from its right foot to its
/// left. Flat sides that look along an axis lie on borders of voxels, as `slice` lays a body's lower sides; those that
/// lean do not.
constexpr double left = 1 * j750_mm[0], right = 77 * j750_mm[0], bottom = 2 * j750_mm[2], shoulder = 33 * j750_mm[2],
                 top = 85 * j750_mm[2];
const std::vector<std::array<double, 2>> comb{
    {left, bottom},   {right, bottom}, {right, shoulder}, {3.00, shoulder},
    {3.25, top},      {2.65, top},     {2.20, shoulder},                     // 0.8 to 0.6 mm
    {1.80, shoulder}, {1.60, top},     {1.25, top},       {1.30, shoulder},  // 0.5 to 0.35 mm
    {0.60, shoulder}, {0.45, top},     {0.20, top},       {0.30, shoulder},  // 0.3 to 0.25 mm
    {left, shoulder}};
constexpr double front = 1 * j750_mm[1], back = 13 * j750_mm[1];

SuiteCase fins(const HalftoneSkin& skin) {
    SuiteCase c = body("fins", "a block with three leaning fins, 0.8, 0.5 and 0.3 mm thick", "the body's flat sides");
    const auto shape = std::make_shared<ExtrudedPolygon>(comb, front, back);
    c.true_boundary = shape;
    const std::vector<CumulativeMixture> field = colours(skin);
    c.volume = make_resin_volume(voxels_of({right + 0.07, back + 0.05, top + 0.05}), j750_mm, [&](int x, int y, int z) {
        const Point p = centre_of(x, y, z);
        if (!shape->inside(p)) return air;
        BoundaryNormals normals;
        const Point at = shape->nearest(p, normals);
        if (std::hypot(at[0] - p[0], at[1] - p[1], at[2] - p[2]) > skin_mm) return resin::W;
        // One colour for what looks left, another for what looks right, and bands along y.
        const std::size_t side = normals.geometric[0] > 0.1 ? 0 : normals.geometric[0] < -0.1 ? 2 : 4;
        return skin.at(field[side + (at[1] > (front + back) / 2 ? 1 : 0)], x, y, z);
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
