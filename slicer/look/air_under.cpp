// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/air_under.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "slicer/mesh/box.h"
#include "slicer/printer/placement.h"
#include "slicer/solid/solid.h"

namespace voxtone::slicer {

namespace {

class Views {
public:
    explicit Views(const std::array<int, 3>& size) : size_(size) {
        seen_.front = {size[0], size[2], std::vector<char>(std::size_t(size[0]) * std::size_t(size[2]), 0)};
        seen_.turned = {size[1], size[2], std::vector<char>(std::size_t(size[1]) * std::size_t(size[2]), 0)};
    }
    void add(int j, int k, const Span& span) {
        const auto line = std::size_t(size_[2] - 1 - k);
        char* const row = seen_.front.solid.data() + line * std::size_t(size_[0]);
        std::fill(row + span.begin, row + span.end, 1);
        // What lies at the back comes to lie at the left.
        seen_.turned.solid[line * std::size_t(size_[1]) + std::size_t(size_[1] - 1 - j)] = 1;
    }
    [[nodiscard]] AirUnder take(double ml) {
        seen_.ml = ml;
        return std::move(seen_);
    }

private:
    std::array<int, 3> size_;
    AirUnder seen_;
};

}  // namespace

std::vector<std::string> Silhouette::lines(int most_lines) const {
    const int pixels = 2 * most_lines, longest = std::max({width, height, 1});
    const int columns = std::max(1, width * pixels / longest), rows = std::max(1, height * pixels / longest);
    // A pixel is dark where half of its cells are.
    const auto dark = [&](int x, int y) {
        if (y >= rows) return false;
        int solid_cells = 0, cells = 0;
        for (int v = y * height / rows; v < std::max((y + 1) * height / rows, y * height / rows + 1); ++v)
            for (int u = x * width / columns; u < std::max((x + 1) * width / columns, x * width / columns + 1); ++u)
                ++cells, solid_cells += solid[std::size_t(v) * std::size_t(width) + std::size_t(u)];
        return 2 * solid_cells >= cells;
    };
    std::vector<std::string> text;
    for (int y = 0; y < rows; y += 2) {
        std::string& line = text.emplace_back();
        for (int x = 0; x < columns; ++x)
            line += dark(x, y) ? (dark(x, y + 1) ? "█" : "▀") : (dark(x, y + 1) ? "▄" : " ");
    }
    return text;
}

AirUnder look_under(const SolidMesh& mesh) {
    constexpr double voxels_across = 100;
    const Eigen::AlignedBox3d box = bounding_box(mesh.positions_mm, mesh.triangles);
    const double pitch_mm = box.sizes().maxCoeff() / voxels_across;
    const VoxelGrid grid = grid_around(box.min(), box.max(), Eigen::Vector3d::Constant(pitch_mm));
    const SpanSlab slab = Solid(mesh, grid).slab(0, grid.size[2]);
    const auto width = static_cast<std::size_t>(grid.size[0]);
    std::vector<char> covered(width * static_cast<std::size_t>(grid.size[1]), 0);
    Views views(grid.size);
    std::uint64_t under = 0;
    for (int k = grid.size[2] - 1; k >= 0; --k)
        for (int j = 0; j < grid.size[1]; ++j) {
            char* const row = covered.data() + static_cast<std::size_t>(j) * width;
            int i = 0;
            for (const Span& span : slab.row(j, k)) {
                for (; i < span.begin; ++i) under += static_cast<std::uint64_t>(row[i]);
                for (; i < span.end; ++i) row[i] = 1;
                views.add(j, k, span);
            }
            for (; i < grid.size[0]; ++i) under += static_cast<std::uint64_t>(row[i]);
        }
    return views.take(double(under) * grid.voxel_volume_mm3() * 1e-3);
}

}  // namespace voxtone::slicer
