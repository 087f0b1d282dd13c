// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/touching_walls.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/mesh/winding_number.h"
#include "slicer/surface/surface_piece.h"

namespace voxtone::slicer {

namespace {

/// Pieces up to this size are taken for covered, or not, where their corners and their centre agree.
constexpr double trusted_mm = 1;

class Covered {
public:
    Covered(std::span<const BodyOfSurface> bodies, std::uint32_t source, double gap_mm, double piece_mm)
        : bodies_(bodies), source_(source), gap_mm_(gap_mm), piece_mm_(piece_mm) {}

    Sight operator()(const Piece& piece) const {
        const Eigen::Vector3d across = (piece.corner[1] - piece.corner[0]).cross(piece.corner[2] - piece.corner[0]);
        if (!(across.norm() > 0) || !near_another(piece)) return Sight::visible;
        const Eigen::Vector3d step = gap_mm_ * across.normalized(), centre = piece.centre();
        const double longest = piece.longest();
        const bool here = covered_at(centre + step);
        if (longest <= piece_mm_) return here ? Sight::hidden : Sight::visible;
        if (longest > trusted_mm) return Sight::mixed;
        for (const Eigen::Vector3d& corner : piece.corner)
            if (covered_at(0.98 * corner + 0.02 * centre + step) != here) return Sight::mixed;
        return here ? Sight::hidden : Sight::visible;
    }

private:
    [[nodiscard]] bool is_own(const BodyOfSurface& body) const {
        return source_ >= body.first_source && source_ < body.end_source;
    }
    [[nodiscard]] bool near_another(const Piece& piece) const {
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d& corner : piece.corner) box.extend(corner);
        const Eigen::Vector3d around = Eigen::Vector3d::Constant(gap_mm_);
        std::vector<std::uint32_t> found;
        for (const BodyOfSurface& body : bodies_)
            if (!is_own(body)) body.solid->overlapping(box.min() - around, box.max() + around, found);
        return !found.empty();
    }
    [[nodiscard]] bool covered_at(const Eigen::Vector3d& p) const {
        return std::ranges::any_of(
            bodies_, [&](const BodyOfSurface& body) { return !is_own(body) && winding_number(*body.solid, p) != 0; });
    }

    std::span<const BodyOfSurface> bodies_;
    std::uint32_t source_;
    double gap_mm_, piece_mm_;
};

}  // namespace

void drop_touching_walls(VisibleSurface& surface, std::span<const BodyOfSurface> bodies, double gap_mm,
                         double piece_mm) {
    const std::size_t count = surface.triangles.size();
    struct Left {
        Sight as_a_whole = Sight::visible;
        std::vector<Piece> pieces;
    };
    std::vector<Left> left(count);
    parallel_for(0, count, 64, [&](std::size_t t) {
        const auto& [a, b, c] = surface.triangles[t];
        const auto& at = surface.positions_mm;
        const Covered covered(bodies, surface.source_triangle[t], gap_mm, piece_mm);
        left[t].as_a_whole = add_visible(Piece{{at[a], at[b], at[c]}, surface.source_uv[t], surface.source_triangle[t]},
                                         covered, left[t].pieces);
    });
    VisibleSurface kept;
    kept.positions_mm = std::move(surface.positions_mm);
    const auto add = [&](const std::array<std::uint32_t, 3>& triangle, const Piece& piece) {
        kept.triangles.push_back(triangle);
        kept.source_uv.push_back(piece.uv);
        kept.source_triangle.push_back(piece.source);
    };
    for (std::size_t t = 0; t < count; ++t) {
        if (left[t].as_a_whole == Sight::visible) {
            add(surface.triangles[t], left[t].pieces[0]);
            continue;
        }
        for (const Piece& piece : left[t].pieces) {
            const auto first = static_cast<std::uint32_t>(kept.positions_mm.size());
            kept.positions_mm.insert(kept.positions_mm.end(), piece.corner.begin(), piece.corner.end());
            add({first, first + 1, first + 2}, piece);
        }
    }
    surface = std::move(kept);
}

}  // namespace voxtone::slicer
