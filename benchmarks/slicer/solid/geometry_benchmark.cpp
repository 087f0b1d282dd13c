// SPDX-License-Identifier: GPL-3.0-or-later
//
// Speed of the geometry: repair, visible surface, solid with thin features and surface shell of a model on the voxel
// grid of a colour printer (600 x 300 dpi, layers of 27 um). Usage: geometry_benchmark [MODEL [SIZE_MM [DEPTH_MM]]];
// SIZE_MM 0: as the file has it, in mm. Without arguments the cow at 60 mm. Prints voxels, shell voxels, and time per
// phase on one thread and on all; core-seconds are CPU time, so that other work on the machine counts little.
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "io/models/model_reader.h"
#include "slicer/mesh/mesh_repair.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/thin_features.h"
#include "slicer/surface/surface_shell.h"
#include "slicer/surface/visible_surface.h"
#include "tests/places.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Of this thread, so that other work on the machine counts little.
double cpu_seconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string path = argc > 1 ? argv[1] : test::source_dir() + "/examples/models/spot/spot.obj";
    const double size_mm = argc > 2 ? std::atof(argv[2]) : 60, depth_mm = argc > 3 ? std::atof(argv[3]) : 1;
    io::TexturedMesh mesh = io::read_model(path).mesh;
    Vector3d low = mesh.positions.at(0), high = low;
    for (const Vector3d& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double scale = size_mm > 0 ? size_mm / (high - low).maxCoeff() : 1;
    for (Vector3d& p : mesh.positions) p = (p - low) * scale;

    double start = seconds();
    const auto lap = [&start] { return seconds() - std::exchange(start, seconds()); };
    RepairOptions options;
    const RepairedMesh repaired = repair_mesh(mesh, options);
    const double repair_s = lap();
    const SurfaceIndex surface(find_visible_surface(mesh.positions, mesh.triangles, repaired));
    const double visible_s = lap();
    VoxelGrid grid;
    grid.pitch_mm = {25.4 / 600, 25.4 / 300, 0.027};
    for (int a = 0; a < 3; ++a) grid.size[a] = int(std::ceil((high - low)[a] * scale / grid.pitch_mm[a]));
    const Solid solid(*repaired.solid, grid);
    const double solid_s = lap();
    const ThinFeatures thin(repaired.solid, solid);
    const double thin_s = lap();
    const SurfaceShell shell(surface, grid, depth_mm);
    const double shell_s = lap();
    std::printf("%s: %zu triangles, %zu visible, %d x %d x %d = %.3g voxels, blocks of %d x %d x %d\n", path.c_str(),
                mesh.triangles.size(), surface->triangles.size(), grid.size[0], grid.size[1], grid.size[2],
                double(grid.voxels()), shell.block_size()[0], shell.block_size()[1], shell.block_size()[2]);
    std::printf("set-up: repair %.3f s, visible surface %.3f s, solid %.3f s, thin features %.3f s, shell %.3f s\n",
                repair_s, visible_s, solid_s, thin_s, shell_s);

    const std::size_t cores = thread_count();
    for (const std::size_t threads : {std::size_t{1}, cores}) {
        const ThreadLimit limit(threads);
        std::atomic<std::uint64_t> body{0}, added{0}, in_shell{0}, solid_ns{0}, thin_ns{0}, shell_ns{0}, blocks{0};
        start = seconds();
        parallel_for(0, std::size_t(shell.block_layers()), 1, [&](std::size_t bk) {
            const double t0 = cpu_seconds();
            SpanSlab slab;
            const int k = int(bk) * shell.block_size()[2], k_end = std::min(k + shell.block_size()[2], grid.size[2]);
            solid.slab(k, k_end, slab);
            const double t1 = cpu_seconds();
            added += thin.slab(k, k_end, slab);
            const double t2 = cpu_seconds();
            std::uint64_t voxels = 0, shell_voxels = 0, visited = 0;
            for (int l = k; l < k_end; ++l) voxels += slab.voxels_of_layer(l);
            for (int bj = 0; bj < shell.block_rows(); ++bj)
                shell.for_each_block(bj, int(bk), slab, [&](const ShellBlock& b) {
                    ++visited;
                    for (int r = 0; r < b.size[1] * b.size[2]; ++r)
                        shell_voxels += std::uint64_t(__builtin_popcount(b.shell[r]));
                });
            const double t3 = cpu_seconds();
            body += voxels;
            in_shell += shell_voxels;
            blocks += visited;
            solid_ns += std::uint64_t((t1 - t0) * 1e9);
            thin_ns += std::uint64_t((t2 - t1) * 1e9);
            shell_ns += std::uint64_t((t3 - t2) * 1e9);
        });
        const double wall = seconds() - start;
        std::printf(
            "%zu threads: %.3f s; body %.4g (%.4g added), shell %.4g voxels in %.4g blocks; solid %.3f core-s, with "
            "thin features "
            "%.3f core-s, shell %.3f core-s = %.1f ns per shell voxel, %.2f us per block\n",
            threads, wall, double(body), double(added), double(in_shell), double(blocks), double(solid_ns) * 1e-9,
            double(thin_ns) * 1e-9, double(shell_ns) * 1e-9, double(shell_ns) / double(in_shell),
            double(shell_ns) * 1e-3 / double(blocks));
        if (cores == 1) break;
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf("peak memory %.0f MB\n", double(usage.ru_maxrss) / 1024);
}
