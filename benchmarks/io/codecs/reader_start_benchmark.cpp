// SPDX-License-Identifier: GPL-3.0-or-later
//
// What it costs to read the smallest textured model there is: the start of the programs that read, before any pixel
// counts. One line a kind of texture: wall and processor time (medians) and the largest memory of a program that was
// started.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <tiffio.h>

#include "io/files/whole_file.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture_writer.h"

namespace {

namespace fs = std::filesystem;
using namespace voxtone;

constexpr int runs = 31;

struct Cost {
    double wall_ms = 0, processor_ms = 0;
    long peak_kib = 0;
};

double seconds(const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); }

/// Of what a process of its own starts: the largest of its children counts.
Cost cost_of(const fs::path& model) {
    int ends[2];
    if (pipe(ends) != 0) return {};
    const pid_t child = fork();
    if (child == 0) {
        const auto start = std::chrono::steady_clock::now();
        (void)io::read_model(model);
        const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
        rusage children{};
        getrusage(RUSAGE_CHILDREN, &children);
        const Cost cost{wall.count(), 1e3 * (seconds(children.ru_utime) + seconds(children.ru_stime)),
                        children.ru_maxrss};
        _exit(write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
    }
    Cost cost;
    if (read(ends[0], &cost, sizeof cost) != sizeof cost) std::fputs("a run failed\n", stderr);
    close(ends[0]);
    close(ends[1]);
    waitpid(child, nullptr, 0);
    return cost;
}

void print_costs(const char* kind, const fs::path& model) {
    std::vector<double> walls, processors, peaks;
    for (int i = 0; i < runs; ++i) {
        const Cost cost = cost_of(model);
        walls.push_back(cost.wall_ms);
        processors.push_back(cost.processor_ms);
        peaks.push_back(double(cost.peak_kib) / 1024);
    }
    const auto median = [](std::vector<double>& values) {
        std::nth_element(values.begin(), values.begin() + runs / 2, values.end());
        return values[runs / 2];
    };
    std::printf("%-6s %8.1f ms %8.1f ms of the processor %8.1f MiB\n", kind, median(walls), median(processors),
                median(peaks));
}

void write_tiff(const fs::path& path) {
    TIFF* const file = TIFFOpen(path.c_str(), "w");
    for (const auto& [tag, value] : {std::pair{TIFFTAG_IMAGEWIDTH, 1},
                                     {TIFFTAG_IMAGELENGTH, 1},
                                     {TIFFTAG_SAMPLESPERPIXEL, 3},
                                     {TIFFTAG_BITSPERSAMPLE, 8},
                                     {TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB},
                                     {TIFFTAG_PLANARCONFIG, 1}})
        TIFFSetField(file, static_cast<std::uint32_t>(tag), value);
    std::uint8_t pixel[] = {200, 40, 40};
    TIFFWriteScanline(file, pixel, 0);
    TIFFClose(file);
}

fs::path write_model(const fs::path& folder, const std::string& picture) {
    const std::string name = "model-" + picture;
    std::ofstream(folder / (name + ".mtl")) << "newmtl m\nmap_Kd " << picture << "\n";
    std::ofstream(folder / (name + ".obj")) << "mtllib " << name
                                            << ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                               "usemtl m\nf 1/1 2/2 3/3\n";
    return folder / (name + ".obj");
}

}  // namespace

int main() {
    const fs::path folder = fs::temp_directory_path() / ("voxtone-reader-start-" + std::to_string(getpid()));
    fs::create_directory(folder);
    std::ofstream(folder / "plain.stl") << "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                           "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    io::write_whole_file(folder / "a.png", io::png_bytes(io::Picture8{1, 1, 3, {200, 40, 40}}));
    write_tiff(folder / "a.tif");
    print_costs("none", folder / "plain.stl");
    print_costs("PNG", write_model(folder, "a.png"));
    print_costs("TIFF", write_model(folder, "a.tif"));
    fs::remove_all(folder);
}
