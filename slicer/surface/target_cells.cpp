// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/target_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "slicer/mesh/triangle_tree.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

/// Samples per cell, about.
constexpr int samples_per_cell = 8;

/// Values of the surface points nearest to places.
class NearestValue {
public:
    NearestValue(const SurfaceIndex& surface, const ValueOfPoint& value)
        : surface_(*surface), tree_(surface.tree()), value_(value) {}

    /// `guess`: the triangle of a place near by; updated.
    [[nodiscard]] Eigen::Vector3f at(const Eigen::Vector3d& place, std::uint32_t& guess) const {
        const TriangleTree::Nearest nearest = tree_.nearest(place, guess);
        guess = nearest.triangle;
        const auto [a, b, c] = tree_.corners(nearest.triangle);
        const Eigen::Vector3f weight = nearest_weights(nearest.point, a, b, c).cast<float>();
        const auto& uv = surface_.source_uv[nearest.triangle];
        const Eigen::Vector2f at = weight[0] * uv[0] + weight[1] * uv[1] + weight[2] * uv[2];
        return value_(surface_.source_triangle[nearest.triangle], at.x(), at.y());
    }

private:
    const VisibleSurface& surface_;
    const TriangleTree& tree_;
    const ValueOfPoint& value_;
};

/// Calls visit(place) for s x s points spread evenly over a face; mm from the volume's corner.
template <class Visit>
void for_each_point(const optics::SurfaceFace& face, const std::array<double, 3>& pitch_mm, int s, Visit visit) {
    const auto facing = static_cast<std::size_t>(face.facing);
    const std::size_t axis = facing / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int j = 0; j < s; ++j)
        for (int i = 0; i < s; ++i) {
            Eigen::Vector3d place(face.voxel[0], face.voxel[1], face.voxel[2]);
            place[static_cast<Eigen::Index>(axis)] += facing % 2 == 1 ? 1.0 : 0.0;
            place[static_cast<Eigen::Index>(u)] += (i + 0.5) / s;
            place[static_cast<Eigen::Index>(v)] += (j + 0.5) / s;
            visit(Eigen::Vector3d(place.x() * pitch_mm[0], place.y() * pitch_mm[1], place.z() * pitch_mm[2]));
        }
}

}  // namespace

std::vector<Eigen::Vector3f> target_of_cells(const optics::Surface& cells, const std::array<double, 3>& pitch_mm,
                                             const Eigen::Vector3d& corner_mm, const SurfaceIndex& surface,
                                             const io::TexturedMesh& mesh, const Progress* progress) {
    const SurfaceColour colour(mesh, sample_spacing_mm(cells, pitch_mm));
    return mean_of_cells(
        cells, pitch_mm, corner_mm, surface,
        [&colour](std::uint32_t triangle, float u, float v) { return colour.at(triangle, u, v); }, progress);
}

double sample_spacing_mm(const optics::Surface& cells, const std::array<double, 3>& pitch_mm) {
    const double cell_mm = std::cbrt(cells.cell_voxels[0] * pitch_mm[0] * cells.cell_voxels[1] * pitch_mm[1] *
                                     cells.cell_voxels[2] * pitch_mm[2]);
    return cell_mm / std::sqrt(samples_per_cell);
}

std::vector<Eigen::Vector3f> mean_of_cells(const optics::Surface& cells, const std::array<double, 3>& pitch_mm,
                                           const Eigen::Vector3d& corner_mm, const SurfaceIndex& surface,
                                           const ValueOfPoint& value, const Progress* progress) {
    VOXTONE_EXPECT(!surface->triangles.empty());
    const NearestValue nearest(surface, value);
    std::vector<Eigen::Vector3f> target(cells.cells.size());
    parallel_ranges(
        0, target.size(), 512,
        [&](std::size_t first, std::size_t last) {
            std::uint32_t guess = TriangleTree::none;
            for (std::size_t c = first; c < last; ++c) {
                if (progress) progress->check_cancelled();
                const optics::SurfaceCell& cell = cells.cells[c];
                // Many faces: some of them, evenly; few: several points on each.
                const std::uint32_t step = std::max(1u, cell.faces / samples_per_cell);
                const int s =
                    std::max(1, static_cast<int>(std::lround(std::sqrt(samples_per_cell / double(cell.faces)))));
                Eigen::Vector3d sum = Eigen::Vector3d::Zero();
                int count = 0;
                for (std::uint32_t f = 0; f < cell.faces; f += step)
                    for_each_point(cells.faces[cell.first_face + f], pitch_mm, s, [&](const Eigen::Vector3d& place) {
                        sum += nearest.at(corner_mm + place, guess).cast<double>();
                        ++count;
                    });
                target[c] = (sum / count).cast<float>();
            }
        },
        progress);
    return target;
}

std::vector<double> colour_differences(const std::vector<Eigen::Vector3f>& target,
                                       const std::vector<Eigen::Vector3f>& predicted) {
    VOXTONE_EXPECT(target.size() == predicted.size());
    std::vector<double> differences(target.size());
    parallel_for(0, target.size(), 1024, [&](std::size_t i) {
        differences[i] = optics::ciede2000(optics::lab_from_linear_srgb(target[i].cast<double>()),
                                           optics::lab_from_linear_srgb(predicted[i].cast<double>()));
    });
    return differences;
}

std::vector<double> histogram_by_area(const optics::Surface& cells, const std::vector<double>& differences,
                                      const std::vector<double>& edges) {
    VOXTONE_EXPECT(!edges.empty() && std::is_sorted(edges.begin(), edges.end()));
    std::vector<double> share(edges.size(), 0.0);
    double area = 0;
    for (std::size_t i = 0; i < differences.size(); ++i) {
        area += cells.cells[i].area_mm2;
        const auto above = std::upper_bound(edges.begin(), edges.end(), differences[i]);
        if (above != edges.begin())
            share[static_cast<std::size_t>(above - edges.begin() - 1)] += cells.cells[i].area_mm2;
    }
    for (double& s : share) s /= area;
    return share;
}

Eigen::Vector3f difference_colour(double de2000) {
    struct Stop {
        double at;
        float srgb[3];
    };
    static constexpr Stop stops[] = {
        {0, {1, 1, 1}}, {2, {1, 0.9f, 0.3f}}, {5, {1, 0.55f, 0}}, {10, {0.8f, 0, 0}}, {20, {0, 0, 0}}};
    const auto linear = [](const Stop& stop, int c) { return static_cast<float>(optics::srgb_decode(stop.srgb[c])); };
    Eigen::Vector3f colour;
    for (std::size_t i = 0; i + 1 < std::size(stops); ++i) {
        if (de2000 > stops[i + 1].at) continue;
        const auto t = static_cast<float>(std::max(0.0, de2000 - stops[i].at) / (stops[i + 1].at - stops[i].at));
        for (int c = 0; c < 3; ++c) colour[c] = (1 - t) * linear(stops[i], c) + t * linear(stops[i + 1], c);
        return colour;
    }
    return Eigen::Vector3f::Zero();
}

}  // namespace voxtone::slicer
