// SPDX-License-Identifier: GPL-3.0-or-later
//
// Speed of the geometry: solid and surface shell of a model on the voxel grid of a colour printer (600 x 300 dpi, layers
// of 27 um). Usage: geometry_benchmark MODEL.obj SIZE_MM [DEPTH_MM]; without arguments the cow at 60 mm.
// Prints voxels, shell voxels, time per phase on one thread and on all.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

#include "voxtone/base/parallel.h"
#include "voxtone/slicer/solid.h"
#include "voxtone/slicer/surface_shell.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

// Positions and fans of faces; that is all the geometry needs.
SolidMesh read_obj(const std::string& path) {
    SolidMesh mesh;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        if (key == "v") {
            Vector3d p;
            words >> p[0] >> p[1] >> p[2];
            mesh.positions_mm.push_back(p);
        } else if (key == "f") {
            std::vector<std::uint32_t> face;
            for (std::string corner; words >> corner;) face.push_back(std::uint32_t(std::atoi(corner.c_str()) - 1));
            for (std::size_t c = 2; c < face.size(); ++c) mesh.triangles.push_back({face[0], face[c - 1], face[c]});
        }
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) mesh.source_triangle.push_back(std::int32_t(t));
    return mesh;
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Of this thread, so that other work on the machine counts little.
double cpu_seconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string path = argc > 1 ? argv[1] : VOXTONE_SOURCE_DIR "/examples/models/spot/spot.obj";
    const double size_mm = argc > 2 ? std::atof(argv[2]) : 60, depth_mm = argc > 3 ? std::atof(argv[3]) : 1;
    SolidMesh mesh = read_obj(path);
    if (mesh.triangles.empty()) return std::fprintf(stderr, "%s: no triangles\n", path.c_str()), 3;
    Vector3d low = mesh.positions_mm[0], high = low;
    for (const Vector3d& p : mesh.positions_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double scale = size_mm / (high - low).maxCoeff();
    for (Vector3d& p : mesh.positions_mm) p = (p - low) * scale;
    VoxelGrid grid;
    grid.pitch_mm = {25.4 / 600, 25.4 / 300, 0.027};
    for (int a = 0; a < 3; ++a) grid.size[a] = int(std::ceil((high - low)[a] * scale / grid.pitch_mm[a]));

    VisibleSurface surface;
    surface.positions_mm = mesh.positions_mm;
    surface.triangles = mesh.triangles;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    double start = seconds();
    const Solid solid(mesh, grid);
    const double solid_build = seconds() - start;
    start = seconds();
    const SurfaceShell shell(surface, grid, depth_mm);
    const double shell_build = seconds() - start;
    std::printf("%zu triangles, %d x %d x %d = %.3g voxels, blocks of %d x %d x %d\n", mesh.triangles.size(), grid.size[0], grid.size[1],
                grid.size[2], double(grid.voxels()), shell.block_size()[0], shell.block_size()[1], shell.block_size()[2]);
    std::printf("set-up: solid %.3f s, tree %.3f s\n", solid_build, shell_build);

    const std::size_t cores = thread_count();
    for (const std::size_t threads : {std::size_t{1}, cores}) {
        const ThreadLimit limit(threads);
        std::atomic<std::uint64_t> body{0}, in_shell{0}, solid_ns{0}, shell_ns{0}, blocks{0};
        start = seconds();
        parallel_for(0, std::size_t(shell.block_layers()), 1, [&](std::size_t bk) {
            const double t0 = cpu_seconds();
            SpanSlab slab;
            const int k = int(bk) * shell.block_size()[2], k_end = std::min(k + shell.block_size()[2], grid.size[2]);
            solid.slab(k, k_end, slab);
            const double t1 = cpu_seconds();
            std::uint64_t voxels = 0, shell_voxels = 0, visited = 0;
            for (int l = k; l < k_end; ++l) voxels += slab.voxels_of_layer(l);
            for (int bj = 0; bj < shell.block_rows(); ++bj)
                shell.for_each_block(bj, int(bk), slab, [&](const ShellBlock& b) {
                    ++visited;
                    for (int r = 0; r < b.size[1] * b.size[2]; ++r) shell_voxels += std::uint64_t(__builtin_popcount(b.shell[r]));
                });
            const double t2 = cpu_seconds();
            body += voxels;
            in_shell += shell_voxels;
            blocks += visited;
            solid_ns += std::uint64_t((t1 - t0) * 1e9);
            shell_ns += std::uint64_t((t2 - t1) * 1e9);
        });
        const double wall = seconds() - start;
        std::printf("%zu threads: %.3f s; body %.4g, shell %.4g voxels in %.4g blocks; solid %.3f core-s, shell %.3f core-s = %.1f ns per shell "
                    "voxel, %.2f us per block\n",
                    threads, wall, double(body), double(in_shell), double(blocks), double(solid_ns) * 1e-9, double(shell_ns) * 1e-9,
                    double(shell_ns) / double(in_shell), double(shell_ns) * 1e-3 / double(blocks));
        if (cores == 1) break;
    }
}
