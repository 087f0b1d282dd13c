// SPDX-License-Identifier: GPL-3.0-or-later
//
// Monte Carlo on curved bodies: how much it matters whether light leaves at the faces of the voxels or at the mesh, and
// what the mesh costs. Usage: boundary_benchmark [PATHS per cell and channel]. Voxels 42.3 x 84.7 x 27 um, viewing
// cells of 0.085 mm, Vero Opaque. Per body: paths per second with either boundary; the appearance of the whole body,
// relative to the same body all of white resin; CIEDE2000 between the two; and the rms difference of single cells in
// linear RGB, the noise taken out (the product of two independent halves). Then bodies that are not convex: what it
// matters that light that leaves one part of them and meets another is followed, and how near the fast predictor comes
// to it that gathers such light cell by cell (parts_in_sight.h). `boundary_benchmark PATHS outside`: those alone.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/random.h"
#include "optics/colour/colour.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "slicer/mesh/mesh_boundary.h"
#include "slicer/options/model_choice.h"
#include "slicer/predict/parts_in_sight.h"
#include "slicer/solid/solid.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr Material white = 5;

SolidMesh sphere(double radius, int n) {
    SolidMesh m;
    m.positions_mm.emplace_back(0, 0, -radius);
    for (int u = 1; u < n; ++u)
        for (int v = 0; v < 2 * n; ++v) {
            const double a = std::numbers::pi * u / n, b = std::numbers::pi * v / n;
            m.positions_mm.emplace_back(radius * std::sin(a) * std::cos(b), radius * std::sin(a) * std::sin(b),
                                        -radius * std::cos(a));
        }
    m.positions_mm.emplace_back(0, 0, radius);
    const auto top = static_cast<std::uint32_t>(m.positions_mm.size() - 1);
    const auto at = [&](int u, int v) { return static_cast<std::uint32_t>(1 + (u - 1) * 2 * n + v % (2 * n)); };
    for (int v = 0; v < 2 * n; ++v) {
        m.triangles.push_back({0, at(1, v + 1), at(1, v)});
        for (int u = 1; u + 1 < n; ++u) {
            m.triangles.push_back({at(u, v), at(u, v + 1), at(u + 1, v + 1)});
            m.triangles.push_back({at(u, v), at(u + 1, v + 1), at(u + 1, v)});
        }
        m.triangles.push_back({at(n - 1, v), at(n - 1, v + 1), top});
    }
    return m;
}

/// A round cup with walls and a bottom as thick as `wall`, all sizes mm.
SolidMesh cup(double outer, double height, double wall, int n) {
    // Rings from the middle of the bottom outside, around the wall, to the middle of the bottom inside.
    const std::vector<std::pair<double, double>> profile{
        {outer, 0}, {outer, height}, {outer - wall, height}, {outer - wall, wall}};
    SolidMesh m;
    m.positions_mm.emplace_back(0, 0, 0);
    for (const auto& [r, z] : profile)
        for (int v = 0; v < n; ++v) {
            const double b = 2 * std::numbers::pi * v / n;
            m.positions_mm.emplace_back(r * std::cos(b), r * std::sin(b), z);
        }
    m.positions_mm.emplace_back(0, 0, wall);
    const auto last = static_cast<std::uint32_t>(m.positions_mm.size() - 1);
    const auto at = [&](std::size_t ring, int v) {
        return static_cast<std::uint32_t>(1 + ring * static_cast<std::size_t>(n) + static_cast<std::size_t>(v % n));
    };
    for (int v = 0; v < n; ++v) {
        m.triangles.push_back({0, at(0, v + 1), at(0, v)});
        for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
            m.triangles.push_back({at(ring, v), at(ring, v + 1), at(ring + 1, v + 1)});
            m.triangles.push_back({at(ring, v), at(ring + 1, v + 1), at(ring + 1, v)});
        }
        m.triangles.push_back({at(profile.size() - 1, v), at(profile.size() - 1, v + 1), last});
    }
    return m;
}

/// Places and triangles of an OBJ file, nothing else, so high; standing up where y was.
SolidMesh obj_body(const std::string& file, double height) {
    SolidMesh m;
    std::ifstream in(file);
    if (!in) throw std::runtime_error(file + ": cannot be read");
    for (std::string line, word; std::getline(in, line);) {
        std::istringstream words(line);
        words >> word;
        if (word == "v") {
            double x = 0, y = 0, z = 0;
            words >> x >> y >> z;
            m.positions_mm.emplace_back(x, -z, y);
        } else if (word == "f") {
            std::array<std::uint32_t, 3> corners{};
            for (std::uint32_t& c : corners) {
                words >> word;
                c = static_cast<std::uint32_t>(std::stoul(word)) - 1;
            }
            m.triangles.push_back(corners);
        }
    }
    double low = 1e300, high = -1e300;
    for (const Vector3d& p : m.positions_mm) {
        low = std::min(low, p[2]);
        high = std::max(high, p[2]);
    }
    for (Vector3d& p : m.positions_mm) p *= height / (high - low);
    return m;
}

SolidMesh plate(const Vector3d& size, const Eigen::AngleAxisd& turn) {
    SolidMesh m;
    for (int c = 0; c < 8; ++c)
        m.positions_mm.push_back(turn * Vector3d(c & 1 ? size[0] : 0, c & 2 ? size[1] : 0, c & 4 ? size[2] : 0));
    m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return m;
}

/// Cyan, magenta and white by chance, by the voxel's address.
Material halftone(int x, int y, int z) {
    const auto bits = philox4x32(
        {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z), 0}, {1, 2});
    return std::array<Material, 4>{1, 2, white, white}[bits[0] % 4];
}

struct Seen {
    std::array<Appearance, 2> half;
    double paths_per_s = 0;
};

Seen see(const MonteCarloOptions& options, const ResinVolume& volume, const ResinSet& set) {
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, cell_voxels(j750, 0.085), SurfacePart::all);
    Seen seen;
    std::uint64_t paths = 0;
    const auto start = std::chrono::steady_clock::now();
    for (std::uint32_t h = 0; h < 2; ++h) {
        MonteCarloOptions half = options;
        half.first_path = h * options.paths;
        MonteCarloSummary summary;
        seen.half[h] = MonteCarlo(half).predict(scene, surface, summary);
        paths += summary.paths;
    }
    seen.paths_per_s =
        static_cast<double>(paths) / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return seen;
}

Vector3d mean_of(const Seen& seen) {
    Vector3d sum = Vector3d::Zero();
    const std::size_t cells = seen.half[0].value.size() / 3;
    for (const Appearance& a : seen.half)
        for (std::size_t i = 0; i < a.value.size(); ++i)
            sum[static_cast<int>(i % 3)] += static_cast<double>(a.value[i]);
    return sum / static_cast<double>(2 * cells);
}

VoxelGrid grid_around(const SolidMesh& mesh) {
    Vector3d low = mesh.positions_mm[0], high = low;
    for (const Vector3d& p : mesh.positions_mm) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    VoxelGrid grid;
    grid.pitch_mm = {j750[0], j750[1], j750[2]};
    grid.origin_mm = low - 0.3 * grid.pitch_mm;
    for (int a = 0; a < 3; ++a)
        grid.size[static_cast<std::size_t>(a)] =
            static_cast<int>(std::ceil((high - grid.origin_mm)[a] / grid.pitch_mm[a]));
    return grid;
}

/// A mesh as voxels of these materials, the same all of white, and the mesh itself around both.
struct Body {
    VoxelGrid grid;
    ResinVolume volume, paper;
    MeshBoundary boundary;
    ResinSet set = vero_opaque();

    Body(const SolidMesh& mesh, const std::function<Material(int, int, int)>& material_of)
        : grid(grid_around(mesh)),
          volume(voxels_of(mesh, grid, material_of)),
          paper(all_of(volume, white)),
          boundary(mesh.positions_mm, mesh.triangles, grid.origin_mm) {}

private:
    static ResinVolume voxels_of(const SolidMesh& mesh, const VoxelGrid& grid,
                                 const std::function<Material(int, int, int)>& material_of) {
        const Solid solid(mesh, grid);
        const auto slab = solid.slab(0, grid.size[2]);
        return make_resin_volume(
            grid.size, j750, [&](int x, int y, int z) { return slab.contains(x, y, z) ? material_of(x, y, z) : air; });
    }
};

/// Share of the light from outside that no other part of the body takes from a place of its surface.
double open_share(const BodyBoundary& boundary, const SurfaceCell& cell) {
    constexpr int rays = 64;
    BoundaryNormals normals, met;
    const Point at = boundary.nearest({static_cast<double>(cell.centre_mm[0]), static_cast<double>(cell.centre_mm[1]),
                                       static_cast<double>(cell.centre_mm[2])},
                                      normals);
    int open = 0;
    for (int k = 0; k < rays; ++k) {
        const double u = (k + 0.5) / rays, turn = 2 * std::numbers::pi * 0.618034 * k;
        // entering_direction looks inward: the same cosine law, turned around.
        const Point in = entering_direction(
            normals, {std::sqrt(1 - u), std::sqrt(u) * std::cos(turn), std::sqrt(u) * std::sin(turn)});
        double distance = 0;
        open += !boundary.meets(at, {-in[0], -in[1], -in[2]}, distance, met);
    }
    return static_cast<double>(open) / rays;
}

/// Relative colours of each group's mean by the fast predictor: light between parts lost, gathered.
std::array<std::array<Vector3d, 4>, 2> gathered(const Scene& scene, const Surface& surface, const ResinVolume& paper,
                                                const std::vector<std::size_t>& group) {
    const PartsInSight parts(*scene.volume, surface);
    const auto model = make_model(PredictionModel::transport, {.cell_mm = 0.085});
    Scene white_scene = scene;
    white_scene.volume = &paper;
    std::array<std::array<Vector3d, 4>, 2> colour{};
    const Appearance print = model->predict(scene, surface), twin = model->predict(white_scene, surface);
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<float> of_print = print.value, of_twin = twin.value;
        if (k == 1) {
            parts.shade(of_print, 3, scene.resins->eta);
            parts.shade(of_twin, 3, scene.resins->eta);
        }
        std::array<Vector3d, 4> sum{}, white_sum{};
        for (std::size_t g = 0; g < 4; ++g) sum[g] = white_sum[g] = Vector3d::Zero();
        for (std::size_t i = 0; i < of_print.size(); ++i) {
            sum[group[i / 3]][static_cast<int>(i % 3)] += static_cast<double>(of_print[i]);
            white_sum[group[i / 3]][static_cast<int>(i % 3)] += static_cast<double>(of_twin[i]);
        }
        for (std::size_t g = 0; g < 4; ++g) colour[k][g] = sum[g].cwiseQuotient(white_sum[g]);
    }
    return colour;
}

/// A body all white, and of half cyan and magenta voxels: what following light outside changes in the mean of cells
/// that see so much of the sky.
void measure_outside(const char* name, const SolidMesh& mesh, std::uint32_t paths) {
    const Body body(mesh, halftone);
    const ResinVolume &volume = body.volume, &paper = body.paper;
    const MeshBoundary& boundary = body.boundary;
    const ResinSet& set = body.set;
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const Surface surface = find_surface(scene, cell_voxels(j750, 0.085), SurfacePart::all);
    std::vector<std::size_t> group;
    for (const SurfaceCell& cell : surface.cells) {
        const double open = open_share(boundary, cell);
        group.push_back(open < 0.4 ? 0 : open < 0.7 ? 1 : open < 0.95 ? 2 : 3);
    }
    MonteCarloOptions options{.paths = std::max(2u, paths / 2)};
    std::array<std::array<Vector3d, 4>, 2> print{}, twin{};
    const auto add = [&](std::array<Vector3d, 4>& to, const ResinVolume& of) {
        for (Vector3d& sum : to) sum.setZero();
        const Seen seen = see(options, of, set);
        for (std::size_t i = 0; i < 3 * group.size(); ++i)
            for (const Appearance& half : seen.half)
                to[group[i / 3]][static_cast<int>(i % 3)] += static_cast<double>(half.value[i]);
    };
    for (std::size_t k = 0; k < 2; ++k) {
        options.boundary = &boundary;
        options.follow_outside = k == 0;
        options.seed = 3 + k;
        add(print[k], volume);
        add(twin[k], paper);
    }
    const std::array<std::array<Vector3d, 4>, 2> fast = gathered(scene, surface, paper, group);
    constexpr std::array<const char*, 4> names{"below 0.4", "0.4 to 0.7", "0.7 to 0.95", "above 0.95"};
    for (std::size_t g = 0; g < 4; ++g) {
        const auto cells = std::count(group.begin(), group.end(), g);
        if (cells == 0) continue;
        const Vector3d shade = twin[0][g].cwiseQuotient(twin[1][g]), followed = print[0][g].cwiseQuotient(twin[0][g]),
                       lost = print[1][g].cwiseQuotient(twin[1][g]);
        std::printf("%-20s %-12s %5.1f %%   %.3f %.3f %.3f   %.3f %.3f %.3f   %.3f %.3f %.3f   %5.2f\n", name, names[g],
                    100.0 * static_cast<double>(cells) / static_cast<double>(group.size()), shade[0], shade[1],
                    shade[2], lost[0], lost[1], lost[2], followed[0], followed[1], followed[2],
                    ciede2000(lab_from_linear_srgb(lost), lab_from_linear_srgb(followed)));
        for (std::size_t k = 0; k < 2; ++k)
            std::printf("%-20s %-12s %7s   %-17s   %-17s   %.3f %.3f %.3f   %5.2f\n", "",
                        k == 0 ? "fast, lost" : "gathered", "", "", "", fast[k][g][0], fast[k][g][1], fast[k][g][2],
                        ciede2000(lab_from_linear_srgb(fast[k][g]), lab_from_linear_srgb(followed)));
    }
}

void measure(const char* name, const SolidMesh& mesh, std::uint32_t paths,
             const std::function<Material(int, int, int)>& material_of) {
    const Body body(mesh, material_of);
    const ResinVolume &volume = body.volume, &paper = body.paper;
    const MeshBoundary& boundary = body.boundary;
    const ResinSet& set = body.set;

    MonteCarloOptions options{.paths = std::max(2u, paths / 2)};
    const Seen faces = see(options, volume, set), faces_paper = see(options, paper, set);
    options.boundary = &boundary;
    options.seed = 2;
    const Seen smooth = see(options, volume, set), smooth_paper = see(options, paper, set);

    const Vector3d relative_faces = mean_of(faces).cwiseQuotient(mean_of(faces_paper));
    const Vector3d relative_smooth = mean_of(smooth).cwiseQuotient(mean_of(smooth_paper));
    double square = 0;
    for (std::size_t i = 0; i < faces.half[0].value.size(); ++i)
        square += (static_cast<double>(faces.half[0].value[i]) - static_cast<double>(smooth.half[0].value[i])) *
                  (static_cast<double>(faces.half[1].value[i]) - static_cast<double>(smooth.half[1].value[i]));
    square /= static_cast<double>(faces.half[0].value.size());
    const Vector3d a = mean_of(faces_paper), b = mean_of(smooth_paper);
    std::printf(
        "%-28s %9.0f %9.0f   %.3f %.3f %.3f   %.3f %.3f %.3f   %.3f %.3f %.3f   %.3f %.3f %.3f   %5.2f   %.4f\n", name,
        faces.paths_per_s, smooth.paths_per_s, relative_faces[0], relative_faces[1], relative_faces[2],
        relative_smooth[0], relative_smooth[1], relative_smooth[2], a[0], a[1], a[2], b[0], b[1], b[2],
        ciede2000(lab_from_linear_srgb(relative_faces), lab_from_linear_srgb(relative_smooth)),
        std::copysign(std::sqrt(std::abs(square)), square));
}

void measure_boundaries(std::uint32_t paths) {
    std::printf("%-28s %9s %9s   %-17s   %-17s   %-17s   %-17s   %5s   %s\n", "body", "faces/s", "mesh/s",
                "colour, faces", "colour, mesh", "white, faces", "white, mesh", "dE00", "rms of cells");
    const double r = 1.2;
    measure("sphere 2.4 mm, halftone skin", sphere(r, 80), paths, [&](int x, int y, int z) {
        const Vector3d p((x + 0.2) * j750[0] - r, (y + 0.2) * j750[1] - r, (z + 0.2) * j750[2] - r);
        return p.norm() > r - 0.3 ? halftone(x, y, z) : white;
    });
    for (const double angle : {0.0, 0.2, 0.6, 1.1})
        measure(("plate 0.5 mm, " + std::to_string(angle).substr(0, 3) + " rad").c_str(),
                plate({2.5, 2.5, 0.5}, Eigen::AngleAxisd(angle, Vector3d(0.6, 0.8, 0))), paths, halftone);
}

}  // namespace

int main(int argc, char** argv) {
    const auto paths = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 200);
    const bool all = argc < 3 || std::string(argv[2]) != "outside";
    if (all) measure_boundaries(paths);
    std::printf("\n%-20s %-12s %7s   %-17s   %-17s   %-17s   %s\n", "light outside", "sky seen", "cells",
                "white, followed", "colour, lost", "colour, followed", "dE00");
    measure_outside("cup, 4 x 4 x 4 mm", cup(2, 4, 0.8, 96), paths);
    measure_outside("spot, 12 mm", obj_body(test::source_dir() + "/examples/models/spot/spot.obj", 12), paths);
    return 0;
}
