// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/parted_sheets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "slicer/mesh/triangle_tree.h"

namespace voxtone::slicer {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Half of a sheet's thickness along its normal.
double half_mm(const Vector3d& normal, const Vector3d& pitch_mm) {
    return normal.cwiseAbs().cwiseProduct(pitch_mm).maxCoeff() / 2;
}

class Sheets {
public:
    Sheets(std::span<const Vector3d> positions, std::span<const Triangle> triangles, const Vector3d& pitch_mm)
        : positions_(positions), triangles_(triangles), pitch_mm_(pitch_mm) {
        weld();
        find_faces();
        leave_those_on_a_body();
    }

    [[nodiscard]] PartedSheets parted() {
        PartedSheets out{{positions_.begin(), positions_.end()}, {triangles_.begin(), triangles_.end()}, {}};
        if (faces_.empty()) return out;
        std::map<std::uint32_t, std::vector<std::uint32_t>> around;  // sheets' faces, by place
        for (const std::uint32_t t : faces_)
            for (const std::uint32_t v : places_[t]) around[v].push_back(t);
        std::map<std::array<double, 3>, std::uint32_t> moved;
        for (const std::uint32_t t : faces_)
            for (std::size_t c = 0; c < 3; ++c) {
                const Vector3d p = moved_corner(t, c, around[places_[t][c]]);
                const auto [found, is_new] =
                    moved.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(out.positions_mm.size()));
                if (is_new) out.positions_mm.push_back(p);
                out.triangles[t][c] = found->second;
            }
        add_rims(out);
        return out;
    }

private:
    /// Corners in one place are one.
    void weld() {
        std::map<std::array<double, 3>, std::uint32_t> place;
        places_.reserve(triangles_.size());
        for (const Triangle& triangle : triangles_) {
            Triangle& at = places_.emplace_back();
            for (std::size_t c = 0; c < 3; ++c) {
                const Vector3d& p = positions_[triangle[c]];
                at[c] =
                    place.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(place.size())).first->second;
            }
        }
    }
    [[nodiscard]] Vector3d cross(std::uint32_t t) const {
        const auto& [a, b, c] = triangles_[t];
        return (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
    }

    /// Two faces alone in one place that look away from each other.
    void find_faces() {
        std::map<Triangle, std::vector<std::uint32_t>> in_place;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            Triangle key = places_[t];
            std::ranges::sort(key);
            in_place[key].push_back(t);
        }
        is_sheet_.assign(triangles_.size(), false);
        for (const auto& [key, both] : in_place)
            if (both.size() == 2 && cross(both[0]).dot(cross(both[1])) < 0)
                is_sheet_[both[0]] = is_sheet_[both[1]] = true;
    }

    void leave_those_on_a_body() {
        std::vector<Triangle> body;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            if (!is_sheet_[t]) body.push_back(triangles_[t]);
        const TriangleTree tree(positions_, body);
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            if (!is_sheet_[t]) continue;
            const auto& [a, b, c] = triangles_[t];
            const Vector3d middle = (positions_[a] + positions_[b] + positions_[c]) / 3;
            const double reach = 4 * half_mm(cross(t).normalized(), pitch_mm_);
            if (!body.empty() && tree.nearest(middle, TriangleTree::none, reach).triangle != TriangleTree::none)
                is_sheet_[t] = false;
            else
                faces_.push_back(t);
        }
    }

    /// Along the mean normal of the sheet's faces there that look the same way, each by its angle.
    [[nodiscard]] Vector3d moved_corner(std::uint32_t t, std::size_t c, const std::vector<std::uint32_t>& there) const {
        const Vector3d own = cross(t);
        Vector3d sum = Vector3d::Zero();
        for (const std::uint32_t other : there) {
            const Vector3d normal = cross(other);
            if (!(normal.dot(own) > 0)) continue;
            const auto at = std::size_t(std::ranges::find(places_[other], places_[t][c]) - places_[other].begin());
            const auto corner = [&](std::size_t k) { return positions_[triangles_[other][(at + k) % 3]]; };
            const Vector3d along = corner(1) - corner(0), across = corner(2) - corner(0);
            sum += normal.normalized() * std::atan2(along.cross(across).norm(), along.dot(across));
        }
        const Vector3d normal = sum.normalized();
        return positions_[triangles_[t][c]] + half_mm(normal, pitch_mm_) * normal;
    }

    /// Where a sheet's two faces meet at an edge that no other face has.
    void add_rims(PartedSheets& out) const {
        std::map<Edge, std::pair<std::uint32_t, int>> uses;  // by the two places: the last triangle, how many
        const auto edge = [&](std::uint32_t t, std::size_t c) { return Edge{places_[t][c], places_[t][(c + 1) % 3]}; };
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                auto& [last, times] = uses[edge(t, c)];
                last = t, ++times;
            }
        for (const std::uint32_t t : faces_)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto [from, to] = edge(t, c);
                const auto back = uses.find({to, from});
                if (uses.at({from, to}).second != 1 || back == uses.end() || back->second.second != 1) continue;
                const std::uint32_t other = back->second.first;
                if (!is_sheet_[other] || from > to) continue;  // once for the two
                Triangle key = places_[t], twin = places_[other];
                std::ranges::sort(key), std::ranges::sort(twin);
                if (key != twin) continue;
                const auto corner_at = [&](std::uint32_t of, std::uint32_t place) {
                    return out.triangles[of][std::size_t(std::ranges::find(places_[of], place) - places_[of].begin())];
                };
                const std::uint32_t a = corner_at(t, from), b = corner_at(t, to), behind_a = corner_at(other, from),
                                    behind_b = corner_at(other, to);
                out.triangles.push_back({b, a, behind_a});
                out.triangles.push_back({b, behind_a, behind_b});
                out.rim_of.insert(out.rim_of.end(), 2, t);
            }
    }

    std::span<const Vector3d> positions_;
    std::span<const Triangle> triangles_;
    const Vector3d pitch_mm_;
    std::vector<Triangle> places_;  ///< per triangle
    std::vector<bool> is_sheet_;
    std::vector<std::uint32_t> faces_;
};

}  // namespace

PartedSheets part_sheets(std::span<const Vector3d> positions_mm, std::span<const Triangle> triangles,
                         const Vector3d& pitch_mm) {
    return Sheets(positions_mm, triangles, pitch_mm).parted();
}

}  // namespace voxtone::slicer
