// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/cavities.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/mesh/box.h"
#include "slicer/mesh/hole_filling.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/solid/enclosed_space.h"

namespace voxtone::slicer {

using Eigen::Vector3d;
using Label = EnclosedSpace::Label;

namespace {

// Ways in: narrower than a quarter of a millimetre is none, or than two voxels. To fill everything, up to some 3.5 mm,
// what drain holes have.
constexpr double finest_cell_mm = 0.25, fill_cell_mm = 0.5, filled_opening_mm = 3.5;
constexpr double finest_plug_mm = 0.05;  // of a plug's cells: 20 mm of room come to the 2^26 cells there may be
constexpr std::size_t most_wall_samples = 4096;

EnclosureOptions enclosure(const CavityOptions& options) {
    EnclosureOptions enclosing;
    enclosing.cell_mm =
        std::max(options.mode == CavityMode::fill ? fill_cell_mm : finest_cell_mm, 2 * options.pitch_mm);
    if (options.mode == CavityMode::fill)
        enclosing.closing = std::max(1, int(std::ceil((filled_opening_mm / enclosing.cell_mm - 1) / 2)));
    return enclosing;
}

// Whether a triangle stands between two points, as doubles tell: what an edge hides or not decides no triangle alone.
bool stands_between(const Vector3d& p, const Vector3d& q, const std::array<Vector3d, 3>& corner) {
    const Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double above = normal.dot(p - corner[0]), below = normal.dot(q - corner[0]);
    if ((above > 0) == (below > 0)) return false;
    const Vector3d at = p + (q - p) * (above / (above - below));
    for (std::size_t c = 0; c < 3; ++c)
        if (normal.dot((corner[(c + 1) % 3] - corner[c]).cross(at - corner[c])) < 0) return false;
    return true;
}

// What is seen from each triangle's outer side: outside or a void; wall where nothing is.
class Outlook {
public:
    /// Keeps references to both.
    Outlook(const SolidIndex& solid, const EnclosedSpace& space) : solid_(*solid), tree_(solid.tree()), space_(space) {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z)
                    if (x != 0 || y != 0 || z != 0) around_.push_back(Vector3d(x, y, z).normalized());
    }

    [[nodiscard]] std::vector<Label> of_all(const Progress* progress) const {
        std::vector<Label> seen(solid_.triangles.size());
        parallel_for(
            0, seen.size(), 64, [&](std::size_t t) { seen[t] = from(std::uint32_t(t)); }, progress);
        spread(seen);
        return seen;
    }

private:
    [[nodiscard]] Label from(std::uint32_t t) const {
        const auto [a, b, c] = tree_.corners(t);
        const Vector3d normal = (b - a).cross(c - a);
        if (!(normal.norm() > 0)) return EnclosedSpace::wall;
        const Vector3d up = normal.normalized(), at = (a + b + c) / 3;
        if (const Label label = along(t, at, up); label != EnclosedSpace::wall) return label;
        for (const Vector3d& way : around_)
            if (way.dot(up) > 0.2)
                if (const Label label = along(t, at, way); label != EnclosedSpace::wall) return label;
        return EnclosedSpace::wall;
    }
    /// The first free cell on the way, where nothing stands before it.
    [[nodiscard]] Label along(std::uint32_t t, const Vector3d& at, const Vector3d& way) const {
        for (int half_cells = 1; half_cells <= 6; ++half_cells) {
            const Vector3d to = at + 0.5 * half_cells * space_.cell_mm() * way;
            const Label label = space_.at(to);
            if (label == EnclosedSpace::wall || label == EnclosedSpace::pocket) continue;
            return is_clear(t, at, to) ? label : EnclosedSpace::wall;
        }
        return EnclosedSpace::wall;
    }
    [[nodiscard]] bool is_clear(std::uint32_t t, const Vector3d& from, const Vector3d& to) const {
        std::vector<std::uint32_t> near;
        tree_.overlapping(from.cwiseMin(to), from.cwiseMax(to), near);
        return std::ranges::none_of(
            near, [&](std::uint32_t other) { return other != t && stands_between(from, to, tree_.corners(other)); });
    }
    /// What sees nothing takes after its neighbours.
    void spread(std::vector<Label>& seen) const {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
        for_each_edge(edge_uses(solid_.triangles), [&](std::span<const EdgeUse> edge) {
            for (std::size_t n = 1; n < edge.size(); ++n) {
                links.emplace_back(edge[n - 1].triangle, edge[n].triangle);
                links.emplace_back(edge[n].triangle, edge[n - 1].triangle);
            }
        });
        std::ranges::sort(links);
        std::vector<std::uint32_t> queue;
        for (std::uint32_t t = 0; t < seen.size(); ++t)
            if (seen[t] != EnclosedSpace::wall) queue.push_back(t);
        for (std::size_t n = 0; n < queue.size(); ++n) {
            auto link = std::ranges::lower_bound(links, std::pair(queue[n], std::uint32_t{0}));
            for (; link != links.end() && link->first == queue[n]; ++link) {
                if (seen[link->second] != EnclosedSpace::wall) continue;
                seen[link->second] = seen[queue[n]];
                queue.push_back(link->second);
            }
        }
    }

    const SolidMesh& solid_;
    const TriangleTree& tree_;
    const EnclosedSpace& space_;
    std::vector<Vector3d> around_;
};

// Of half of the area of some triangles the distance to the nearest of others is no larger. Weighted by area.
double median_distance(const SolidMesh& solid, std::span<const std::uint32_t> walls, const TriangleTree& others) {
    std::vector<std::pair<double, double>> samples;  // distance, area
    const std::size_t stride = std::max<std::size_t>(1, walls.size() / most_wall_samples);
    double whole = 0;
    for (std::size_t n = 0; n < walls.size(); n += stride) {
        const auto& [a, b, c] = solid.triangles[walls[n]];
        const Vector3d at = (solid.positions_mm[a] + solid.positions_mm[b] + solid.positions_mm[c]) / 3;
        samples.emplace_back(others.nearest(at).distance, area(solid.positions_mm, solid.triangles[walls[n]]));
        whole += samples.back().second;
    }
    std::ranges::sort(samples);
    double below = 0;
    for (const auto& [distance, part] : samples)
        if ((below += part) >= whole / 2) return distance;
    return 0;
}

std::vector<Cavity> describe(const SolidMesh& solid, const EnclosedSpace& space, std::span<const Label> seen) {
    std::vector<std::vector<std::uint32_t>> walls(space.voids().size());
    std::vector<Triangle> outer;
    for (std::uint32_t t = 0; t < seen.size(); ++t)
        if (seen[t] >= EnclosedSpace::first_void)
            walls[seen[t] - EnclosedSpace::first_void].push_back(t);
        else if (seen[t] == EnclosedSpace::outside)
            outer.push_back(solid.triangles[t]);
    const TriangleTree tree(solid.positions_mm, outer);
    const Vector3d corner = bounding_box(solid.positions_mm, solid.triangles).min();
    std::vector<Cavity> cavities;
    for (std::size_t v = 0; v < walls.size(); ++v) {
        Cavity& cavity = cavities.emplace_back();
        const Vector3d& centre = space.voids()[v].centre_mm;
        for (const std::uint32_t t : walls[v]) {  // seen from its middle, so that pinholes hardly count
            const auto& [a, b, c] = solid.triangles[t];
            const auto& p = solid.positions_mm;
            cavity.volume_mm3 -= (p[a] - centre).dot((p[b] - centre).cross(p[c] - centre)) / 6;
        }
        cavity.volume_mm3 = std::max(cavity.volume_mm3, space.voids()[v].cells_mm3);
        cavity.wall_mm = outer.empty() ? 0 : median_distance(solid, walls[v], tree);
        for (int axis = 0; axis < 3; ++axis) cavity.centre_mm[std::size_t(axis)] = centre[axis] - corner[axis];
    }
    return cavities;
}

// Without what is seen from filled voids; rims are closed.
SolidMesh filled(const SolidMesh& solid, std::span<const Label> seen, std::span<const Cavity> cavities,
                 const Progress* progress) {
    SolidMesh left;
    left.positions_mm = solid.positions_mm;
    for (std::size_t t = 0; t < seen.size(); ++t) {
        if (seen[t] >= EnclosedSpace::first_void && cavities[seen[t] - EnclosedSpace::first_void].filled) continue;
        left.triangles.push_back(solid.triangles[t]);
        left.source_triangle.push_back(solid.source_triangle[t]);
    }
    for (const HoleFill& fill : fill_holes(left.positions_mm, left.triangles, progress))
        for (const Triangle& t : fill.triangles) {
            left.triangles.push_back(t);
            left.source_triangle.push_back(-1);
        }
    return left;
}

// Where walls cross one another, triangles that see a void are parts of other walls too: closing their rims gives them
// back. Whether there are such voids.
bool mark_crossed(const SolidMesh& solid, const EnclosureOptions& enclosing, const EnclosedSpace& before,
                  std::span<Cavity> cavities, const Progress* progress) {
    const EnclosedSpace space(solid, enclosing, progress);
    for (std::size_t v = 0; v < cavities.size(); ++v) {
        cavities[v].crossed = cavities[v].filled && space.at(before.voids()[v].inside_mm) != EnclosedSpace::wall;
        cavities[v].filled &= !cavities[v].crossed;
    }
    return std::ranges::any_of(cavities, &Cavity::crossed);
}

// Such voids are filled with a body of their own, which ends within the walls if cells are half as wide as these.
void plug_crossed(const SolidMesh& given, SolidMesh& solid, EnclosureOptions enclosing, const EnclosedSpace& before,
                  std::span<Cavity> cavities, const Progress* progress) {
    double thinnest_mm = enclosing.cell_mm * 2;
    for (const Cavity& cavity : cavities)
        if (cavity.crossed) thinnest_mm = std::min(thinnest_mm, cavity.wall_mm);
    const double finer = enclosing.cell_mm / (thinnest_mm / 2);
    enclosing.cell_mm /= finer;
    enclosing.closing = int(std::ceil(enclosing.closing * finer));
    if (!(enclosing.cell_mm >= finest_plug_mm)) return;
    const EnclosedSpace space(given, enclosing, progress);
    if (space.cell_mm() > 1.01 * enclosing.cell_mm) return;
    for (std::size_t v = 0; v < cavities.size(); ++v) {
        const Label label = space.at(before.voids()[v].inside_mm);
        if (!cavities[v].crossed || label < EnclosedSpace::first_void) continue;
        const SolidMesh plug = space.plug(label);
        const auto shift = static_cast<std::uint32_t>(solid.positions_mm.size());
        solid.positions_mm.insert(solid.positions_mm.end(), plug.positions_mm.begin(), plug.positions_mm.end());
        for (const auto& [a, b, c] : plug.triangles) solid.triangles.push_back({a + shift, b + shift, c + shift});
        solid.source_triangle.resize(solid.triangles.size(), -1);
        cavities[v].crossed = false, cavities[v].filled = true;
    }
}

double volume_of(const std::vector<Cavity>& cavities) {
    double volume = 0;
    for (const Cavity& cavity : cavities) volume += cavity.volume_mm3;
    return volume;
}

std::string listed(const std::vector<Cavity>& cavities, double outer_mm3) {
    const double volume = volume_of(cavities), share = 100 * volume / outer_mm3;
    const auto& at = cavities[0].centre_mm;
    return fmt::format(
        "{} of {}, {} % of what the outer surface encloses, {}at {:.1f}, {:.1f}, {:.1f} mm from the "
        "model's corner, {} {:.3g} mm",
        cavities.size() == 1 ? "A void" : fmt::format("{} voids", cavities.size()),
        volume < 1000 ? fmt::format("{:.3g} mm^3", volume) : fmt::format("{:.3g} ml", volume / 1000),
        share < 10 ? fmt::format("{:.2g}", share) : fmt::format("{:.0f}", share),
        cavities.size() == 1 ? "" : "the largest ", at[0], at[1], at[2],
        cavities.size() == 1 ? "behind a wall of" : "behind walls from",
        std::ranges::min(cavities, {}, &Cavity::wall_mm).wall_mm);
}

}  // namespace

std::vector<Cavity> treat_cavities(RepairedMesh& repaired, const CavityOptions& options, Progress* progress) {
    const EnclosureOptions enclosing = enclosure(options);
    const EnclosedSpace space(*repaired.solid, enclosing, progress);
    if (space.voids().empty()) return {};
    const std::vector<Label> seen = Outlook(repaired.solid, space).of_all(progress);
    std::vector<Cavity> cavities = describe(*repaired.solid, space, seen);
    bool any = false;
    for (Cavity& cavity : cavities) {
        cavity.filled = options.mode == CavityMode::fill ||
                        (options.mode == CavityMode::automatic && cavity.wall_mm < options.shell_mm);
        any |= cavity.filled;
    }
    if (!any) return cavities;
    SolidMesh solid = filled(*repaired.solid, seen, cavities, progress);
    if (mark_crossed(solid, enclosing, space, cavities, progress)) {
        solid = filled(*repaired.solid, seen, cavities, progress);
        plug_crossed(*repaired.solid, solid, enclosing, space, cavities, progress);
    }
    repaired.solid = SolidIndex(std::move(solid));
    const bool counted = repaired.report.after.crossing_pairs >= 0;
    repaired.report.after = diagnose(repaired.solid->positions_mm, repaired.solid->triangles,
                                     counted ? &repaired.solid.tree() : nullptr, progress);
    return cavities;
}

std::vector<std::string> cavity_sentences(const std::vector<Cavity>& cavities, const CavityOptions& options,
                                          double body_mm3) {
    std::vector<Cavity> full, kept, crossed;
    for (const Cavity& cavity : cavities) (cavity.filled ? full : cavity.crossed ? crossed : kept).push_back(cavity);
    const double outer_mm3 = body_mm3 + volume_of(kept) + volume_of(crossed);  // what is void is not of the material
    std::vector<std::string> sentences;
    if (!full.empty())
        sentences.push_back(fmt::format(
            "{}{}, {} filled with resin; --cavities keep leaves that to support material.", listed(full, outer_mm3),
            options.mode == CavityMode::automatic
                ? fmt::format(", thinner than the coloured shell of {:.2g} mm", options.shell_mm)
                : "",
            full.size() == 1 ? "was" : "were"));
    if (!kept.empty())
        sentences.push_back(
            fmt::format("{}, {} kept: support material fills {}, and cannot be washed out. To print solid there: "
                        "--cavities fill.",
                        listed(kept, outer_mm3), kept.size() == 1 ? "was" : "were", kept.size() == 1 ? "it" : "them"));
    if (!crossed.empty())
        sentences.push_back(fmt::format(
            "{}, should be filled and {} not: walls cross one another there, and support material fills "
            "{}. Unite them in a mesh editor (boolean union), or --repair wrap.",
            listed(crossed, outer_mm3), crossed.size() == 1 ? "was" : "were", crossed.size() == 1 ? "it" : "them"));
    return sentences;
}

}  // namespace voxtone::slicer
