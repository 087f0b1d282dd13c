// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/surface_smoothing.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace voxtone::optics;

namespace {

Surface plate(int nx, int ny, float edge) {
    Surface surface;
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
            SurfaceCell cell;
            cell.centre_mm = {(static_cast<float>(x) + 0.5F) * edge, (static_cast<float>(y) + 0.5F) * edge, 1};
            cell.normal = {0, 0, 1};
            cell.area_mm2 = edge * edge;
            surface.cells.push_back(cell);
        }
    return surface;
}

}  // namespace

TEST_CASE("Points of a surface are its cells, and their edge is that of most of it") {
    Surface surface = plate(10, 10, 0.2F);
    const std::vector<SurfacePoint> points = surface_points(surface);
    REQUIRE(points.size() == 100);
    CHECK(points[13].at == surface.cells[13].centre_mm);
    CHECK(points[13].area == Approx(0.04));
    CHECK(typical_edge_mm(points) == Approx(0.2));
    surface.cells[0].area_mm2 = 0;
    CHECK(surface_points(surface)[0].area > 0);
    CHECK(typical_edge_mm(surface_points(surface)) == Approx(0.2));
}

TEST_CASE(
    "Smoothing a surface keeps constants and damps waves as a Gaussian does, narrow or wide, in one step or two") {
    const Surface surface = plate(120, 60, 0.1F);
    const std::vector<SurfacePoint> points = surface_points(surface);
    constexpr double spread = 0.5;
    for (const auto& [from, to] : {std::pair{0.0, 0.25}, {0.0, spread}, {0.25, spread}, {0.0, 1.0}}) {
        const SurfaceSmoothing smoothing(points, to, from, 0.1);
        std::vector<float> in, out(3 * points.size());
        constexpr double wave = 2 * std::numbers::pi / 3;
        for (const SurfacePoint& p : points) {
            in.push_back(0.7F);
            in.push_back(static_cast<float>(std::cos(wave * static_cast<double>(p.at[0]))));
            in.push_back(0);
        }
        smoothing.apply(in, out, 3);
        double amplitude = 0, squares = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            CHECK(out[3 * i] == Approx(0.7F).epsilon(1e-6));
            CHECK(out[3 * i + 2] == 0);
            // Two periods in the middle: borders bend the wave.
            if (points[i].at[0] < 3 || points[i].at[0] > 9) continue;
            amplitude += static_cast<double>(out[3 * i + 1]) * in[3 * i + 1];
            squares += static_cast<double>(in[3 * i + 1]) * in[3 * i + 1];
        }
        INFO(from << " to " << to);
        CHECK(amplitude / squares == Approx(std::exp(-wave * wave * (to * to - from * from) / 4)).margin(0.01));
    }
}
