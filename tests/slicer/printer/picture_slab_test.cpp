// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/picture_slab.h"

#include <cmath>
#include <functional>
#include <map>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/printer/picture_outline.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Contains;

namespace {

using Alpha = std::function<int(int x, int y)>;

/// Green, with alpha; what is transparent is black below.
io::DecodedImage image_of(std::uint32_t width, std::uint32_t height, const Alpha& alpha) {
    io::DecodedImage image;
    image.texels.width_px = width, image.texels.height_px = height;
    for (int y = 0; y < int(height); ++y)
        for (int x = 0; x < int(width); ++x) {
            const auto a = std::uint8_t(alpha(x, y));
            image.texels.srgb8.insert(image.texels.srgb8.end(), {0, std::uint8_t(a ? 200 : 0), 0, a});
            image.has_alpha = image.has_alpha || a < 255;
        }
    return image;
}

std::vector<Outline> outlines_of(std::uint32_t width, std::uint32_t height, const Alpha& alpha,
                                 std::uint32_t step = 1) {
    std::vector<std::uint16_t> values;
    for (int y = 0; y < int(height); ++y)
        for (int x = 0; x < int(width); ++x) values.push_back(std::uint16_t(alpha(x, y) * 257));
    return picture_outlines(values, width, height, step);
}

double area_of(const std::vector<Outline>& outlines) {
    std::vector<Eigen::Vector2d> corners;
    for (const Outline& outline : outlines) corners.insert(corners.end(), outline.begin(), outline.end());
    double area = 0;
    for (const auto& [a, b, c] : outline_triangles(outlines)) {
        const Eigen::Vector2d u = corners[b] - corners[a], v = corners[c] - corners[a];
        CHECK(u.x() * v.y() > u.y() * v.x());
        area += (u.x() * v.y() - u.y() * v.x()) / 2;
    }
    return area;
}

/// A ring around a hole, and a dot beside it.
int ring(int x, int y) {
    const double r = std::hypot(x - 19.5, y - 19.5);
    return (r < 18 && r > 8) || std::hypot(x - 50, y - 20) < 6 ? 255 : 0;
}

}  // namespace

TEST_CASE("Outlines of pictures enclose what is opaque, holes stay holes, and edges lie where alpha is a half") {
    const auto all = outlines_of(7, 5, [](int, int) { return 255; });
    REQUIRE(all.size() == 1);
    CHECK(all[0].size() == 8);  // its corners are cut by half a pixel each way
    CHECK(area_of(all) == Approx(35 - 4 * 0.125));
    CHECK(outlines_of(60, 40, ring).size() == 3);
    double opaque = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x) opaque += ring(x, y) / 255;
    CHECK(area_of(outlines_of(60, 40, ring)) == Approx(opaque).epsilon(0.02));
    // Means of 4 x 4 pixels know as much, but for the edges.
    CHECK(area_of(outlines_of(60, 40, ring, 4)) == Approx(opaque).epsilon(0.05));
    // 0, 51, 102 | 153 ...: a half lies between the third and the fourth.
    const auto soft = outlines_of(6, 3, [](int x, int) { return 51 * x; });
    REQUIRE(soft.size() == 1);
    double left = 100;
    for (const Eigen::Vector2d& p : soft[0]) left = std::min(left, p.x());
    CHECK(left == Approx(3.0).margin(1e-3));
    CHECK(outlines_of(4, 4, [](int, int) { return 127; }).empty());
    // An island in a lake on an island.
    const auto nested = outlines_of(15, 15, [](int x, int y) {
        const int d = std::max(std::abs(x - 7), std::abs(y - 7));
        return d < 2 || (d > 3 && d < 7) ? 255 : 0;
    });
    CHECK(nested.size() == 3);
    CHECK(area_of(nested) == Approx(13 * 13 - 7 * 7 + 3 * 3).margin(1.5));
}

TEST_CASE("A picture cut to shape is a closed body as large as its opaque part, in its own colours to the rim") {
    PictureOptions options;
    options.width_mm = 27, options.thickness_mm = 2;
    const PictureSlab slab = make_picture_slab(io::finish_cut_out(image_of(60, 40, ring), "ring.png"), options);
    const io::TexturedMesh& mesh = slab.model.mesh;
    CHECK(slab.notes == std::vector<std::string>{"the picture is cut to shape: 2 pieces with 1 hole"});
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    Eigen::AlignedBox3d box;
    for (const auto& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
        volume += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]])) / 6;
    }
    for (const auto& [edge, count] : edges) {
        CHECK(count == 1);
        CHECK(edges.count({edge.second, edge.first}) == 1);
    }
    for (const Eigen::Vector3d& p : mesh.positions) box.extend(p);
    // From the ring's left to the dot's right: 2 to 56 px.
    CHECK(box.min().norm() < 1e-9);
    CHECK(box.max().x() == Approx(27));
    CHECK(box.max().z() == 2);
    double opaque = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x) opaque += ring(x, y) / 255;
    const double px_mm = 27.0 / 54;
    CHECK(volume == Approx(2 * opaque * px_mm * px_mm).epsilon(0.03));
    // Green everywhere on the top, seen from above with the picture upright; nothing of the black that is transparent.
    std::size_t top = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (mesh.material_of_triangle[t] != PictureSlab::face_material) continue;
        ++top;
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector3d& p = mesh.positions[mesh.triangles[t][k]];
            const Eigen::Vector2f& uv = mesh.corner_uv[t][k];
            CHECK(p.z() == 2);
            CHECK(double(uv.x()) == Approx((p.x() / px_mm + 2) / 60).margin(0.01));
            CHECK(double(uv.y()) == Approx((p.y() / px_mm + 2) / 40).margin(0.01));
            CHECK(mesh.materials[0].texture->sample(uv.x(), uv.y()).y() == Approx(0.5776).margin(0.01));
        }
    }
    CHECK(top > 50);
}

TEST_CASE("What cannot be cut to shape is refused, and an opaque picture is the slab that it was") {
    CHECK_THROWS_WITH((void)io::finish_cut_out(image_of(4, 3, [](int, int) { return 255; }), "a.png"),
                      Contains("a.png: has no transparent pixels"));
    CHECK_THROWS_WITH((void)io::finish_cut_out(image_of(4, 3, [](int, int) { return 0; }), "a.png"),
                      Contains("a.png: is transparent all over"));
    CHECK_THROWS_WITH((void)io::finish_cut_out(image_of(4, 3, [](int, int) { return 100; }), "a.png"),
                      Contains("transparent all over"));
    PictureOptions options;
    options.width_mm = 6;
    const PictureSlab slab =
        make_picture_slab(io::finish_picture(image_of(3, 2, [](int, int) { return 255; }), "a.png"), options);
    CHECK(slab.notes.empty());
    CHECK(slab.model.mesh.triangles.size() == 12);
    CHECK(slab.model.mesh.positions.back() == Eigen::Vector3d(6, 4, 4));
}

TEST_CASE("A drawing's own size stands, where --dpi has had its say already") {
    io::Picture drawing = io::finish_picture(image_of(600, 300, [](int, int) { return 255; }), "a.svg");
    drawing.dpi_x = drawing.dpi_y = 600;
    PictureOptions options;
    options.thickness_mm = 1;
    options.dpi = 72;
    const auto width_mm = [&] {
        const PictureSlab slab = make_picture_slab(drawing, options);
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d& p : slab.model.mesh.positions) box.extend(p);
        return box.sizes().x();
    };
    CHECK(width_mm() == Approx(600 / 72.0 * 25.4));
    options.dpi = 1;
    CHECK(width_mm() == Approx(600 * 25.4));
    options.dpi = 72;
    drawing.is_drawing = true;
    CHECK(width_mm() == Approx(25.4));
    options.width_mm = 7;
    CHECK(width_mm() == Approx(7));
}

TEST_CASE("The face of a picture's slab shows it, each place its own, and all else is sides") {
    const io::Picture picture = io::finish_picture(image_of(30, 20, [](int, int) { return 255; }), "a.png");
    PictureOptions options;
    options.width_mm = 6;
    options.thickness_mm = 1;
    const io::TexturedMesh mesh = make_picture_slab(picture, options).model.mesh;
    double top_mm = 0, left_mm = 1e9, front_mm = 1e9, face_mm2 = 0;
    for (const Eigen::Vector3d& p : mesh.positions)
        top_mm = std::max(top_mm, p.z()), left_mm = std::min(left_mm, p.x()), front_mm = std::min(front_mm, p.y());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Eigen::Vector3d area =
            0.5 * (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
        const bool is_face = area.normalized().z() > 0.9 && mesh.positions[a].z() == top_mm;
        CHECK((mesh.material_of_triangle[t] == PictureSlab::face_material) == is_face);
        if (!is_face) continue;
        face_mm2 += area.norm();
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector3d& p = mesh.positions[mesh.triangles[t][k]];
            CHECK(mesh.corner_uv[t][k].x() == Approx((p.x() - left_mm) / 6));
            CHECK(mesh.corner_uv[t][k].y() == Approx((p.y() - front_mm) / 4));
        }
    }
    CHECK(face_mm2 == Approx(24));
}
