// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/wrapped_layers.h"

#include <cmath>
#include <map>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/pictures/png_pixels.h"
#include "scattering/print/laminate_fit.h"
#include "scattering/print/layer_surfaces.h"
#include "slicer/layers/layer_maker.h"
#include "slicer/look/upright_cut.h"
#include "slicer/mesh/mesh_repair.h"
#include "slicer/printer/placement.h"
#include "tests/slicer/layers/made_voxels.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

constexpr io::Material white = 1, black = 2, base = 3;

VisibleSurface all_of(const SolidMesh& mesh) {
    VisibleSurface s;
    s.positions_mm = mesh.positions_mm;
    s.triangles = mesh.triangles;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        s.source_triangle.push_back(t);
        s.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    return s;
}

io::TexturedMesh textured(const SolidMesh& mesh) {
    io::TexturedMesh t;
    t.positions = mesh.positions_mm;
    t.triangles = mesh.triangles;
    return t;
}

using Laminate = std::vector<scattering::LaminateLayer>;

/// A body with laminates wrapped around it, placed by box, on a map of pixels of 1 x 1 mm in one row.
struct Wrapped {
    Wrapped(const SolidMesh& mesh, const Vector3d& pitch, const std::vector<Laminate>& laminates, bool top_only = false)
        : solid_mesh(mesh),
          surface(all_of(mesh)),
          grid(grid_about(mesh, pitch)),
          aligned(scattering::align_laminates(laminates)) {
        std::vector<std::uint16_t> pixels;
        for (std::size_t s = 0; s < laminates.size(); ++s) pixels.push_back(static_cast<std::uint16_t>(s));
        fields.emplace(scattering::LaminateMap{static_cast<std::uint32_t>(laminates.size()), 1,
                                               double(laminates.size()), 1, pixels, scattering::MapEdge::mirror, 0},
                       aligned);
        placement.emplace(MapPlacement::by_box(textured(mesh)));
        if (top_only) keep_top();
        screen.emplace(std::array{pitch.x(), pitch.y(), pitch.z()});
        wrapped.emplace(surface, grid, *fields, *placement, *screen, std::vector<io::Material>{white, black}, base);
        solid.emplace(mesh, grid);
        measured.emplace(surface);
        shell.emplace(*measured, grid, wrapped->shell_mm());
        voxels = made({*solid, nullptr, surface, *shell, base, &*wrapped});
    }
    [[nodiscard]] std::vector<io::Material> made(const LayerSources& sources) const {
        return test::made_voxels(sources).materials;
    }
    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return (std::size_t(k) * std::size_t(grid.size[1]) + std::size_t(j)) * std::size_t(grid.size[0]) +
               std::size_t(i);
    }
    [[nodiscard]] io::Material at(int i, int j, int k) const { return voxels[index(i, j, k)]; }
    [[nodiscard]] double volume(io::Material m) const {
        return double(std::count(voxels.begin(), voxels.end(), m)) * grid.voxel_volume_mm3();
    }

    SolidMesh solid_mesh;
    VisibleSurface surface;
    VoxelGrid grid;
    scattering::AlignedLaminates aligned;
    std::optional<scattering::LayerFields> fields;
    std::optional<MapPlacement> placement;
    std::optional<halftone::BlueNoiseScreen> screen;
    std::optional<WrappedLayers> wrapped;
    std::optional<Solid> solid;
    std::optional<SurfaceIndex> measured;
    std::optional<SurfaceShell> shell;
    std::vector<io::Material> voxels;

private:
    static VoxelGrid grid_about(const SolidMesh& mesh, const Vector3d& pitch) {
        Vector3d low = mesh.positions_mm[0], high = low;
        for (const Vector3d& p : mesh.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
        return grid_around(low, high, pitch);
    }
    void keep_top() {
        VisibleSurface top;
        top.positions_mm = surface.positions_mm;
        double z = -1e9;
        for (const Vector3d& p : surface.positions_mm) z = std::max(z, p.z());
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            const auto& triangle = surface.triangles[t];
            if (!std::all_of(triangle.begin(), triangle.end(),
                             [&](std::uint32_t c) { return surface.positions_mm[c].z() > z - 1e-9; }))
                continue;
            top.triangles.push_back(triangle);
            top.source_triangle.push_back(surface.source_triangle[t]);
            top.source_uv.push_back(surface.source_uv[t]);
        }
        surface = top;
    }
};

// Of a printer whose screen is built in.
const Vector3d pitch(25.4 / 600, 25.4 / 300, 0.027);

/// Voxels of a material in a column, from the top.
int count(const Wrapped& w, int i, int j, io::Material m) {
    int n = 0;
    for (int k = 0; k < w.grid.size[2]; ++k) n += w.at(i, j, k) == m;
    return n;
}

JobBody body_of(const Wrapped& w) {
    JobBody body;
    body.solid = SolidIndex(w.solid_mesh);
    body.surface = SurfaceIndex(w.surface);
    body.grid = w.grid;
    return body;
}

std::vector<LayerSurface> surfaces_of(const Wrapped& w, double cell_mm) {
    Progress progress;
    return layer_surfaces(body_of(w), *w.wrapped, cell_mm, progress);
}

MeshDiagnosis diagnosis_of(const LayerSurface& surface) {
    std::vector<Vector3d> positions;
    for (const Eigen::Vector3f& p : surface.positions_mm) positions.push_back(p.cast<double>());
    return diagnose(positions, surface.triangles);
}

}  // namespace

TEST_CASE("A body of core alone has the voxels of the body with its shell") {
    const Wrapped w(shapes::sphere(1.5, 40), pitch, {{{0, 0.1}, {1, 0.2}}});
    LayerSources sources{*w.solid, nullptr, w.surface, *w.shell, base, &*w.wrapped};
    sources.core_only = true;
    const std::vector<io::Material> core = w.made(sources);
    REQUIRE(std::count(w.voxels.begin(), w.voxels.end(), black) > 0);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < core.size(); ++i)
        wrong += core[i] != (w.voxels[i] == io::background ? io::background : base);
    CHECK(wrong == 0);
}

TEST_CASE(
    "Columns of a flat slab have their laminate's layers in order, each border within a voxel, thicknesses exact on "
    "average") {
    // The third layer is thinner than a voxel.
    const Vector3d size = pitch.cwiseProduct(Vector3d(128, 64, 60));
    const Wrapped w(shapes::box({0, 0, 0}, size), pitch, {{{0, 0.1}, {1, 0.25}, {0, 0.011}, {1, 0.4}}}, true);
    REQUIRE(w.grid.size[2] == 60);
    const std::array<double, 4> bottom{0.1, 0.35, 0.361, 0.761};
    const std::array<io::Material, 4> material{white, black, white, black};
    double first = 0, third = 0;
    for (int j = 0; j < w.grid.size[1]; ++j)
        for (int i = 0; i < w.grid.size[0]; ++i)
            for (int n = 0; n < 60; ++n) {
                const io::Material m = w.at(i, j, 59 - n);
                const double low = n * pitch.z(), high = low + pitch.z();
                // The material must be that of some depth within the voxel.
                bool within = m == base && high > bottom[3];
                for (std::size_t l = 0; l < 4; ++l)
                    within = within || (m == material[l] && high > (l ? bottom[l - 1] : 0) && low < bottom[l]);
                if (!within) CHECK(within);
                first += m == white && low < 0.2;
                third += m == white && low > 0.3;
            }
    const double columns = double(w.grid.size[0]) * w.grid.size[1];
    CHECK(pitch.z() * first / columns == Approx(0.1).epsilon(0.005));
    CHECK(pitch.z() * third / columns == Approx(0.011).epsilon(0.02));
    CHECK(w.volume(black) == Approx(0.65 * size.x() * size.y()).epsilon(0.005));
    CHECK(w.volume(base) == Approx((size.z() - 0.761) * size.x() * size.y()).epsilon(0.005));
}

TEST_CASE("Layers of a sphere lie at their radii and have their volumes", "[slow]") {
    const double R = 2.4;
    const Wrapped w(shapes::sphere(R, 80), pitch, {{{0, 0.3}, {1, 0.5}}});
    const double reach = 0.5 * pitch.norm() + 0.01;  // half a voxel, and the chords of the mesh
    for (int k = 0; k < w.grid.size[2]; ++k)
        for (int j = 0; j < w.grid.size[1]; ++j)
            for (int i = 0; i < w.grid.size[0]; ++i) {
                const double depth = R - w.grid.centre(i, j, k).norm();
                const io::Material m = w.at(i, j, k);
                if (m == io::background) continue;
                const bool good = m == white   ? depth < 0.3 + reach
                                  : m == black ? depth > 0.3 - reach && depth < 0.8 + reach
                                               : depth > 0.8 - reach;
                if (!good) CHECK(good);
            }
    const auto ball = [](double r) { return 4 * 3.14159265358979 / 3 * r * r * r; };
    CHECK(w.volume(black) == Approx(ball(R - 0.3) - ball(R - 0.8)).epsilon(0.005));
    CHECK(w.volume(white) == Approx(ball(R) - ball(R - 0.3)).epsilon(0.01));
    CHECK(w.volume(base) == Approx(ball(R - 0.8)).epsilon(0.005));
}

TEST_CASE("Layers keep their thickness on a slanted side") {
    SolidMesh mesh = shapes::box({0, 0, 0}, {6, 6, 1.5});
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(0.5, Vector3d::UnitX()) * Eigen::AngleAxisd(0.3, Vector3d::UnitY())).toRotationMatrix();
    for (Vector3d& p : mesh.positions_mm) p = turn * p;
    const Wrapped w(mesh, pitch, {{{0, 0.11}, {1, 0.17}}});
    const double a = 6 * 6 * 1.5, b = 5.78 * 5.78 * 1.28,
                 c = 5.44 * 5.44 * 0.94;  // boxes, each that much smaller on every side
    CHECK(w.volume(white) == Approx(a - b).epsilon(0.01));
    CHECK(w.volume(black) == Approx(b - c).epsilon(0.01));
    CHECK(w.volume(base) == Approx(c).epsilon(0.01));
}

TEST_CASE("Layers from both sides of a thin wall meet in its middle") {
    const Wrapped w(shapes::box({0, 0, 0}, {20 * pitch.x(), 8, 8}), pitch, {{{0, 5 * pitch.x()}, {1, 1}}});
    const int j = w.grid.size[1] / 2, k = w.grid.size[2] / 2;
    double from_left = 0, from_right = 0;
    int blacks = 0;
    for (int jj = j - 10; jj < j + 10; ++jj)
        for (int kk = k - 10; kk < k + 10; ++kk)
            for (int i = 0; i < 20; ++i) {
                const io::Material m = w.at(i, jj, kk);
                CHECK(m != base);
                if (i < 10)
                    from_left += m == white;
                else
                    from_right += m == white;
                blacks += m == black;
            }
    CHECK(from_left == Approx(5 * 400).epsilon(0.01));
    CHECK(from_right == Approx(5 * 400).epsilon(0.01));
    CHECK(blacks == Approx(10 * 400).epsilon(0.01));
}

TEST_CASE("From one cluster to the next printed layers run out without steps") {
    // White 0.9 and black 0.9 over 1 mm: the slope at the worst is 0.9 mm per mm, 0.038 mm a column.
    const Wrapped w(shapes::box({0, 0, 0}, {2, 4, 60 * pitch.z()}), pitch, {{{0, 0.9}}, {{1, 0.9}}}, true);
    double last = -1;
    for (int i = 0; i < w.grid.size[0]; ++i) {
        double mean = 0;
        for (int j = 0; j < w.grid.size[1]; ++j) mean += pitch.z() * count(w, i, j, white) / w.grid.size[1];
        const double x = w.grid.centre(i, 0, 0).x();
        CHECK(mean == Approx(0.9 * std::clamp(1.5 - x, 0.0, 1.0)).margin(0.01));
        if (last >= 0) CHECK(std::abs(mean - last) < 0.05);
        last = mean;
    }
}

TEST_CASE("A body whose map has no layers is of the base alone") {
    const Wrapped w(shapes::box({0, 0, 0}, {1, 1, 1}), pitch, {{}});
    CHECK(w.volume(base) == Approx(w.grid.voxels() * w.grid.voxel_volume_mm3()).epsilon(0.1));
    CHECK(w.volume(white) == 0);
}

TEST_CASE("Closed surfaces of the layers of a sphere have their volumes, each edge two triangles", "[slow]") {
    const double R = 2.4;
    const Wrapped w(shapes::sphere(R, 80), pitch, {{{0, 0.3}, {1, 0.5}}});
    const std::vector<LayerSurface> surfaces = surfaces_of(w, 0.1);
    REQUIRE(surfaces.size() == 3);
    for (const LayerSurface& surface : surfaces) {
        const MeshDiagnosis d = diagnosis_of(surface);
        CHECK(d.boundary_edges == 0);
        CHECK(d.nonmanifold_edges == 0);
        CHECK(d.inconsistent_edges == 0);
        CHECK(d.volume_mm3 == Approx(surface.volume_mm3).epsilon(1e-6));
        CHECK(surface.volume_mm3 == Approx(w.volume(surface.material)).epsilon(0.02));
    }
    CHECK(diagnosis_of(surfaces[0]).shells == 2);  // outside and inside
    CHECK(diagnosis_of(surfaces[2]).shells == 1);
}

TEST_CASE("Closed surfaces leave nothing where a layer has thickness zero, and are closed where layers run out") {
    // White on the left, black on the right, the base below; the map has one pixel a millimetre, so both run out from 1
    // to 3 mm.
    const Vector3d size = pitch.cwiseProduct(Vector3d(94, 36, 60));
    const Wrapped w(shapes::box({0, 0, 0}, size), pitch, {{{0, 0.8}}, {{0, 0.8}}, {{1, 0.8}}, {{1, 0.8}}}, true);
    const double cell = 0.08, edges = 4 * size.sum();
    for (const LayerSurface& surface : surfaces_of(w, cell)) {
        const MeshDiagnosis d = diagnosis_of(surface);
        CHECK(d.open_edges == 0);
        CHECK(std::abs(surface.volume_mm3 - w.volume(surface.material)) < edges * cell * cell);  // edges are blunted
        float low = 9, high = -9;
        for (const Eigen::Vector3f& p : surface.positions_mm) low = std::min(low, p.x()), high = std::max(high, p.x());
        if (surface.material == white) CHECK(high < 2.55);
        if (surface.material == black) CHECK(low > 1.45);
    }
    Progress progress;
    const Wrapped empty(shapes::box({0, 0, 0}, {1, 1, 1}), pitch, {{}});
    CHECK(surfaces_of(empty, 0.1).size() == 1);  // of the base
    CHECK_THROWS_AS(surfaces_of(empty, 0.001), InputError);
}

TEST_CASE("The share of the surface without room for its laminate is that of its edges, and of thin walls", "[slow]") {
    const auto fit_of = [](const SolidMesh& mesh, const std::vector<Laminate>& laminates) {
        const Wrapped w(mesh, pitch, laminates);
        const JobBody body = body_of(w);
        return laminate_fit(body.surface, body.grid,
                            body.is_picture ? std::optional(body.placement.extent_mm.z()) : std::nullopt, *w.wrapped,
                            Progress());
    };
    const std::vector<Laminate> deep{{{0, 0.5}, {1, 0.5}}};
    CHECK(fit_of(shapes::sphere(3, 40), deep).thin_share == 0);
    // On a cube of 10 mm all that is nearer than 1 mm to an edge, less the slack of one voxel.
    const double edge = 1 - pitch.maxCoeff();
    CHECK(fit_of(shapes::box({0, 0, 0}, {10, 10, 10}), deep).thin_share ==
          Approx(1 - std::pow(10 - 2 * edge, 2) / 100).margin(0.015));
    const LaminateFit wall = fit_of(shapes::box({0, 0, 0}, {0.8, 30, 30}), deep);
    CHECK(wall.thin_share == Approx(1).margin(0.01));
    CHECK(wall.missing_mean == Approx(0.6 - 0.5 * pitch.maxCoeff()).margin(0.03));  // 0.4 of 1 mm are there
    CHECK(fit_of(shapes::box({0, 0, 0}, {1, 1, 1}), {{}}).thin_share == 0);
}

TEST_CASE("The map lies upright and readable on each side of a box, and by texture coordinates on the unit square") {
    // The points of a 2 x 3 x 4 box that are at the map's (0.5, 1) seen from outside.
    const SolidMesh mesh = shapes::box({0, 0, 0}, {2, 3, 4});
    const MapPlacement box = MapPlacement::by_box(textured(mesh));
    std::map<std::string, Vector3d> seen{{"+x", {2, 0.5, 1}}, {"-x", {0, 2.5, 1}}, {"+y", {1.5, 3, 1}},
                                         {"-y", {0.5, 0, 1}}, {"+z", {0.5, 1, 4}}, {"-z", {1.5, 1, 0}}};
    for (const auto& [side, point] : seen) {
        INFO(side);
        bool found = false;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            const Vector3d &p = mesh.positions_mm[a], &q = mesh.positions_mm[b], &r = mesh.positions_mm[c];
            Eigen::Matrix<double, 3, 2> edges;
            edges << q - p, r - p;
            const Eigen::Vector2d uv = edges.colPivHouseholderQr().solve(point - p);
            if ((edges * uv - (point - p)).norm() > 1e-9) continue;
            found = true;
            const Eigen::Vector2f on_map = box.at(t, float(uv.x()), float(uv.y()));
            CHECK(on_map.x() == Approx(0.5));
            CHECK(on_map.y() == Approx(1));
        }
        CHECK(found);
    }
    io::TexturedMesh without = textured(mesh);
    CHECK_THROWS_AS(MapPlacement::by_texture(without, 20, 10), InputError);
    without.corner_uv.assign(mesh.triangles.size(),
                             {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(1, 1)});
    const MapPlacement texture = MapPlacement::by_texture(without, 20, 10);
    CHECK(texture.at(3, 0.5f, 0.25f) == Eigen::Vector2f(15, 2.5f));
}

namespace {

/// Rows from the top, RGBA.
std::vector<std::array<std::uint8_t, 4>> pixels_of(const io::ReportPicture& picture) {
    std::vector<std::array<std::uint8_t, 4>> pixels;
    const io::PngHeader header =
        io::read_png(picture.file, "cut", [&](std::uint32_t, std::span<const std::uint8_t> rgba) {
            for (std::size_t x = 0; x < rgba.size(); x += 4)
                pixels.push_back({rgba[x], rgba[x + 1], rgba[x + 2], rgba[x + 3]});
        });
    CHECK(header.width_px == picture.width_px);
    CHECK(header.height_px == picture.height_px);
    return pixels;
}

}  // namespace

TEST_CASE("A cut shows the layers of its row upright, +x to the right, true to scale") {
    // Voxels twice as wide as high; row j = 1 of three, layers 4 to 7. Each voxel of that row is of another material
    // than its neighbours, the other rows are all of the third.
    VoxelGrid grid;
    grid.pitch_mm = {2, 1, 1};
    grid.size = {3, 3, 9};
    constexpr io::Material in_row[4][3] = {{1, 0, 2}, {2, 2, 1}, {0, 1, 0}, {1, 1, 2}};  // from the bottom
    UprightCut cut(grid, 4, 7, 1);
    for (const int k : {6, 4, 7, 5}) {
        io::LayerRuns layer(3, 3);
        for (int row = 0; row < 3; ++row) {
            for (int i = 0; i < 3; ++i) layer.push(1, row == 1 ? in_row[k - 4][i] : io::Material(3));
            layer.end_row();
        }
        cut.add(k, layer);
    }
    const io::ReportPicture picture = cut.picture({{9, 9, 9}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}}, "cut", 12);
    CHECK(picture.px_per_mm == 2);  // 6 mm are the longer side
    REQUIRE(picture.width_px == 12);
    REQUIRE(picture.height_px == 8);
    const auto pixels = pixels_of(picture);
    std::size_t wrong = 0;
    for (std::size_t y = 0; y < 8; ++y)
        for (std::size_t x = 0; x < 12; ++x) {
            const auto& pixel = pixels[y * 12 + x];
            const io::Material material = in_row[3 - y / 2][x / 4];
            if (material == io::background)
                wrong += pixel[3] != 0;
            else
                wrong += pixel != std::array<std::uint8_t, 4>{std::uint8_t(material == 1 ? 255 : 0),
                                                              std::uint8_t(material == 2 ? 255 : 0), 0, 255};
        }
    CHECK(wrong == 0);
}

TEST_CASE("A cut is through the row that it was asked for") {
    VoxelGrid grid;
    grid.size = {1, 3, 1};
    for (int j = 0; j < 3; ++j) {
        io::LayerRuns layer(1, 3);
        for (int row = 0; row < 3; ++row) {  // row 2 is j = 0
            layer.push(1, io::Material(3 - row));
            layer.end_row();
        }
        UprightCut cut(grid, 0, 0, j);
        cut.add(0, layer);
        const auto pixels = pixels_of(cut.picture({{}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, "cut", 1));
        REQUIRE(pixels.size() == 1);
        CHECK(pixels[0][0] == j + 1);
    }
}
