// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/gcvf_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/warning.h"
#include "io/files/zip_writer.h"
#include "io/layers/gcvf_config.h"

namespace voxtone::io {
namespace {

using Point = std::array<float, 3>;

void put_little_endian(std::vector<std::uint8_t>& out, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}
void put_float(std::vector<std::uint8_t>& out, float value) {
    put_little_endian(out, std::bit_cast<std::uint32_t>(value));
}

/// From the model's frame into that of the bitmaps: x along columns, y negative along rows, z along layers; all mm.
Point to_bitmap(const StackDescription& stack, const Point& p) {
    // Sizes before the orientation.
    double w = stack.size_mm[0], h = stack.size_mm[1];
    if (stack.orientation.swap_xy) std::swap(w, h);
    double u = p[0] - stack.origin_mm[0], v = stack.origin_mm[1] + h - p[1];
    if (stack.orientation.swap_xy) {
        std::swap(u, v);
        std::swap(w, h);
    }
    if (stack.orientation.flip_x) u = w - u;
    if (stack.orientation.flip_y) v = h - v;
    return {static_cast<float>(u), static_cast<float>(-v), static_cast<float>(p[2] - stack.origin_mm[2])};
}

constexpr std::array<std::array<std::uint32_t, 3>, 12> box_triangles = {{{0, 2, 1},
                                                                         {1, 2, 3},
                                                                         {4, 5, 6},
                                                                         {5, 7, 6},
                                                                         {0, 1, 4},
                                                                         {1, 5, 4},
                                                                         {2, 6, 3},
                                                                         {3, 6, 7},
                                                                         {0, 4, 2},
                                                                         {2, 4, 6},
                                                                         {1, 3, 5},
                                                                         {3, 7, 5}}};

}  // namespace

GcvfPreview gcvf_preview(const StackDescription& stack, const PreviewMesh& mesh) {
    std::vector<Point> vertices;
    std::span<const std::array<std::uint32_t, 3>> triangles = mesh.triangles;
    bool mirrored = false;
    if (mesh.triangles.empty()) {
        for (int corner = 0; corner < 8; ++corner)
            vertices.push_back({static_cast<float>(corner & 1 ? stack.size_mm[0] : 0),
                                static_cast<float>(corner & 2 ? 0 : -stack.size_mm[1]),
                                static_cast<float>(corner & 4 ? stack.size_mm[2] : 0)});
        triangles = box_triangles;
    } else {
        for (const auto& p : mesh.vertices_mm) vertices.push_back(to_bitmap(stack, p));
        mirrored = (stack.orientation.flip_x != stack.orientation.flip_y) != stack.orientation.swap_xy;
    }
    GcvfPreview preview;
    constexpr std::string_view title = "voxtone preview, mm, y negative";
    preview.stl.assign(80, 0);
    std::copy(title.begin(), title.end(), preview.stl.begin());
    put_little_endian(preview.stl, static_cast<std::uint32_t>(triangles.size()));
    std::array<float, 3> least{}, greatest{};
    bool first = true;
    for (auto triangle : triangles) {
        if (mirrored) std::swap(triangle[1], triangle[2]);
        std::array<Point, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            VOXTONE_EXPECT(triangle[c] < vertices.size());
            corners[c] = vertices[triangle[c]];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                least[axis] = first ? corners[c][axis] : std::min(least[axis], corners[c][axis]);
                greatest[axis] = first ? corners[c][axis] : std::max(greatest[axis], corners[c][axis]);
            }
            first = false;
        }
        Point a, b, n;
        for (std::size_t i = 0; i < 3; ++i) {
            a[i] = corners[1][i] - corners[0][i];
            b[i] = corners[2][i] - corners[0][i];
        }
        for (std::size_t i = 0; i < 3; ++i) n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
        const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (const float value : n) put_float(preview.stl, length > 0 ? value / length : 0.f);
        for (const auto& corner : corners)
            for (const float value : corner) put_float(preview.stl, value);
        preview.stl.push_back(0);
        preview.stl.push_back(0);
    }
    const std::array<double, 3> pitch_mm = {stack.pitch_um[0] * 1e-3, stack.pitch_um[1] * 1e-3,
                                            stack.pitch_um[2] * 1e-3};
    // y negative in mm becomes rows downward: the greatest y is the first row.
    put_float(preview.box, static_cast<float>(least[0] / pitch_mm[0]));
    put_float(preview.box, static_cast<float>(-greatest[1] / pitch_mm[1]));
    put_float(preview.box, static_cast<float>(least[2] / pitch_mm[2]));
    put_float(preview.box, static_cast<float>(greatest[0] / pitch_mm[0]));
    put_float(preview.box, static_cast<float>(-least[1] / pitch_mm[1]));
    put_float(preview.box, static_cast<float>(greatest[2] / pitch_mm[2]));
    return preview;
}

void write_gcvf(const std::filesystem::path& file, const StackDescription& stack, const std::filesystem::path& folder,
                const TopmostLayers& topmost, const GcvfPreview& preview, Progress* progress) {
    const std::string config = gcvf_config_text(gcvf_config(stack));
    const std::vector<std::uint8_t> zbuffer = topmost.png();

    const auto bytes_of = [](const std::string& text) {
        return std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    };
    std::vector<ZipEntry> entries{{.name = "ConfigFile.xml", .bytes = bytes_of(config), .deflate = true}};
    for (std::uint32_t k = 0; k < stack.layers; ++k)
        entries.push_back({.name = fmt::format("layer_{}.png", k), .file = folder / stack.layer_path(k)});
    entries.push_back({.name = "Mesh.stl", .bytes = preview.stl, .deflate = true});
    entries.push_back({.name = "MeshBbx.ktn", .bytes = preview.box, .deflate = true});
    entries.push_back({.name = "Zbuffer.png", .bytes = zbuffer});
    write_zip(file, entries, progress);
    if (const std::string note = gcvf_size_note(std::filesystem::file_size(file), entries.size());
        progress && !note.empty())
        progress->warn(named_warning("gcvf-zip64", fmt::format("{}: {}", file.filename().string(), note)));
}

}  // namespace voxtone::io
