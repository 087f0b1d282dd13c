// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/composed_surface.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// One triangle in a box of 2 x 1 x 4 mm, its corners' codes from `first`.
io::ViewerSurface triangle(std::uint8_t first, const std::vector<std::string>& looks) {
    io::ViewerSurface s;
    s.low_mm = {0, 0, 0}, s.high_mm = {2, 1, 4};
    s.positions = {0, 0, 0, 65535, 0, 0, 0, 65535, 65535};
    s.triangles = {0, 1, 2};
    for (std::size_t l = 0; l < looks.size(); ++l) {
        io::ViewerLook look{looks[l], "caption of " + looks[l], {}};
        for (int n = 0; n < 9; ++n) look.rgb.push_back(std::uint8_t(first + 20 * int(l) + n));
        s.looks.push_back(look);
    }
    s.seen = {1, 2, 3};
    s.place_mm = 0.1;
    return s;
}

/// Where a vertex of a body lies.
Eigen::Vector3d place(const io::ViewerSurface& s, std::size_t v) {
    Eigen::Vector3d p;
    for (std::size_t a = 0; a < 3; ++a)
        p[Eigen::Index(a)] = s.low_mm[a] + s.positions[3 * v + a] / 65535.0 * (s.high_mm[a] - s.low_mm[a]);
    return p;
}

}  // namespace

TEST_CASE("Surfaces stand at all their places, with their colours and differences", "[look]") {
    const io::ViewerSurface a = triangle(10, {"target", "open loop", "print"}), b = triangle(100, {"target", "print"});
    const std::array placed{PlacedSurface{&a, {{10, 20, 0}, {30, 0, 5}}}, PlacedSurface{&b, {{0, 0, 0}}}};
    const io::ViewerSurface whole = compose_surfaces(placed);
    REQUIRE(whole.positions.size() == 27);
    CHECK(whole.triangles == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8});
    const std::vector<Eigen::Vector3d> wanted{{10, 20, 0}, {12, 20, 0}, {10, 21, 4}, {30, 0, 5}, {32, 0, 5},
                                              {30, 1, 9},  {0, 0, 0},   {2, 0, 0},   {0, 1, 4}};
    for (std::size_t v = 0; v < wanted.size(); ++v) CHECK((place(whole, v) - wanted[v]).norm() < 1e-3);
    // What one of them lacks none shows.
    REQUIRE(whole.looks.size() == 2);
    CHECK(whole.looks[0].name == "target");
    CHECK(whole.looks[1].name == "print");
    CHECK(whole.looks[1].rgb[0] == 50);
    CHECK(whole.looks[1].rgb[9] == 50);
    CHECK(whole.looks[1].rgb[18] == 120);
    CHECK(whole.seen == io::ViewerDifferences{1, 2, 3, 1, 2, 3, 1, 2, 3});
    CHECK(whole.single.empty());
}

TEST_CASE("What is clear comes last, wherever it stands", "[look]") {
    io::ViewerSurface clear = triangle(10, {"print"});
    clear.expected = "colours in reach";
    const io::ViewerSurface body = triangle(100, {"print"});
    clear.clear = 3;
    const std::array placed{PlacedSurface{&clear, {{0, 0, 0}, {9, 0, 0}}}, PlacedSurface{&body, {{1, 1, 1}}}};
    const io::ViewerSurface whole = compose_surfaces(placed);
    CHECK(whole.triangles == std::vector<std::uint32_t>{6, 7, 8, 0, 1, 2, 3, 4, 5});
    CHECK(whole.clear == 6);
    CHECK(whole.expected == "colours in reach");  // what is compared stays what it was
    // Fixed pictures show all of what hides nothing, and some of what would.
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    (void)coloured_surface(whole, whole.looks[0], positions, triangles);
    CHECK(triangles == std::vector<std::array<std::uint32_t, 3>>{{6, 7, 8}, {0, 1, 2}});
}

TEST_CASE("A picture that is cut to shape is a slab of its shape", "[look]") {
    io::ViewerSurface picture;
    picture.size_px = {4, 4};
    picture.low_mm = {0, 0, 2}, picture.high_mm = {4, 4, 2};
    picture.covered.assign(16, 1);
    picture.covered[15] = 0;  // the lower right
    picture.looks.push_back({"print", "", std::vector<std::uint8_t>(48, 7)});
    const std::array placed{PlacedSurface{&picture, {{0, 0, 0}}}};
    const io::ViewerSurface whole = compose_surfaces(placed);
    // 15 middles, a grey rim and a bottom; 9 squares of 2 triangles less the half that the missing corner takes, twice,
    // and walls along their rim.
    CHECK(whole.positions.size() == 3 * 45);
    CHECK(whole.triangles.size() % 3 == 0);
    const std::size_t face = 17, rim = 12;
    CHECK(whole.triangles.size() == 3 * (2 * face + 2 * (rim - 1)));
    double volume = 0;
    for (std::size_t t = 0; t < whole.triangles.size(); t += 3)
        volume += place(whole, whole.triangles[t])
                      .dot(place(whole, whole.triangles[t + 1]).cross(place(whole, whole.triangles[t + 2]))) /
                  6;
    CHECK(volume == Approx(2 * 8.5).epsilon(1e-3));
}

TEST_CASE("A picture is a slab with its colours on top and a side all round", "[look]") {
    io::ViewerSurface picture;
    picture.size_px = {3, 2};
    picture.low_mm = {0, 0, 0}, picture.high_mm = {3, 2, 1.5};
    picture.covered.assign(6, 1);
    picture.looks = {{"target", "", {}}};
    for (int n = 0; n < 18; ++n) picture.looks[0].rgb.push_back(std::uint8_t(n));
    const std::array placed{PlacedSurface{&picture, {{5, 0, 0}}}};
    const io::ViewerSurface slab = compose_surfaces(placed);
    REQUIRE(slab.positions.size() / 3 == 6 + 8);
    CHECK((place(slab, 0) - Eigen::Vector3d(5.5, 1.5, 1.5)).norm() < 1e-3);  // the first row is the far one
    CHECK((place(slab, 4) - Eigen::Vector3d(6.5, 0.5, 1.5)).norm() < 1e-3);
    CHECK(slab.looks[0].rgb[3 * 4] == 12);
    CHECK(slab.triangles.size() / 3 == 4 + 10);
    for (std::size_t t = 0; t < slab.triangles.size(); t += 3) {
        const Eigen::Vector3d p = place(slab, slab.triangles[t]), q = place(slab, slab.triangles[t + 1]),
                              r = place(slab, slab.triangles[t + 2]);
        const Eigen::Vector3d normal = (q - p).cross(r - p), middle(6.5, 1, 0.75);
        CHECK(normal.dot((p + q + r) / 3 - middle) > 0);  // outward
    }
}

TEST_CASE("A surface to be drawn has the colours of its corners and what lies between", "[look]") {
    const io::ViewerSurface body = triangle(0, {"target"});
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const ColouredSurface drawn = coloured_surface(body, body.looks[0], positions, triangles);
    REQUIRE(drawn.triangles.size() == 1);
    CHECK((drawn.positions_mm[2] - Eigen::Vector3d(0, 1, 4)).norm() < 1e-3);
    CHECK(drawn.colour(0, 0, 0).x() == Approx(0));
    CHECK(drawn.colour(0, 1, 0).x() == Approx(3 / 255.0 / 12.92).epsilon(1e-3));
    CHECK(drawn.colour(0, 0.5f, 0.5f).y() == Approx(0.5 * (4 + 7) / 255.0 / 12.92).epsilon(1e-3));
}
