// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_targets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "benchmarks/sets.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::loop_benchmark {
namespace {

namespace fs = std::filesystem;

/// Light grey and dark blue-green squares, both in gamut on thick bodies.
void write_checker(const fs::path& file, int columns, int rows) {
    constexpr int px = 12;
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>(columns * px);
    picture.height_px = static_cast<std::uint32_t>(rows * px);
    for (int y = 0; y < rows * px; ++y)
        for (int x = 0; x < columns * px; ++x)
            picture.pixels.push_back((x / px + y / px) % 2 ? Eigen::Vector4f(0.65F, 0.62F, 0.55F, 1)
                                                           : Eigen::Vector4f(0.12F, 0.25F, 0.28F, 1));
    io::write_whole_file(file, io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Ones())));
}

/// An OBJ without texture coordinates with a checker projected along x; its z becomes the longest extent.
fs::path project_checker(const fs::path& source, const fs::path& work, double size_mm) {
    constexpr double square_mm = 1.5;
    std::vector<std::array<double, 3>> vertex;
    std::string faces;
    std::ifstream in(source);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            std::array<double, 3> v{};
            words >> v[0] >> v[1] >> v[2];
            vertex.push_back(v);
        } else if (kind == "f") {
            faces += "f";
            for (std::string corner; words >> corner;) {
                const std::string index = corner.substr(0, corner.find('/'));
                faces += fmt::format(" {0}/{0}", index);
            }
            faces += "\n";
        }
    }
    std::array<double, 3> low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (const auto& v : vertex)
        for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], v[a]), high[a] = std::max(high[a], v[a]);
    const double scale = size_mm / std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    const int columns = std::max(1, static_cast<int>(std::lround((high[1] - low[1]) * scale / square_mm))),
              rows = std::max(1, static_cast<int>(std::lround((high[2] - low[2]) * scale / square_mm)));
    write_checker(work / "checker.png", columns, rows);
    std::string text = "mtllib checker.mtl\nusemtl checker\n";
    for (const auto& v : vertex)
        text += fmt::format("v {} {} {}\nvt {:.6f} {:.6f}\n", v[0], v[1], v[2], (v[1] - low[1]) / (high[1] - low[1]),
                            (v[2] - low[2]) / (high[2] - low[2]));
    io::write_whole_file(work / "sword_checker.obj", text + faces);
    io::write_whole_file(work / "checker.mtl", "newmtl checker\nKd 1 1 1\nmap_Kd checker.png\n");
    return work / "sword_checker.obj";
}

}  // namespace

std::vector<BodyTarget> body_targets(const fs::path& models, const fs::path& work, const std::string& only,
                                     std::vector<std::string>& missing) {
    fs::create_directories(work);
    std::vector<BodyTarget> found;
    for (const benchmarks::SetEntry& entry : benchmarks::bodies()) {
        BodyTarget b{entry.name, models / entry.file, entry.size_mm, entry.held_out};
        if (b.name.find(only) == std::string::npos) continue;
        if (!fs::exists(b.model)) {
            missing.push_back(b.name);
            continue;
        }
        if (b.name == "sword") b.model = project_checker(b.model, work, b.size_mm);
        found.push_back(b);
    }
    return found;
}

}  // namespace voxtone::loop_benchmark
