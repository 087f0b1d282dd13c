// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/visible_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/warning.h"
#include "slicer/mesh/disjoint_sets.h"
#include "slicer/mesh/exact_predicates.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_crossings.h"
#include "slicer/mesh/step_share.h"
#include "slicer/mesh/winding_number.h"
#include "slicer/surface/surface_piece.h"

namespace voxtone::slicer {

using Eigen::Vector2f;
using Eigen::Vector3d;

namespace {

constexpr double just_off_mm = 1e-5;  // how far beside the surface its sides are looked at
constexpr int most_doublings = 8;     // of the pieces' size, where a finer cut takes too much work

// Where corners of `mine` are in `source`: (u, v) of each.
std::array<Vector2f, 3> corner_uv(const Triangle& mine, const Triangle& source,
                                  const std::vector<Vector3d>& my_positions,
                                  const std::vector<Vector3d>& source_positions) {
    const Vector2f at[3] = {{0, 0}, {1, 0}, {0, 1}};
    std::array<Vector2f, 3> uv;
    for (int c = 0; c < 3; ++c) {
        // By number, or by place after welding.
        int best = 0;
        double best2 = std::numeric_limits<double>::infinity();
        for (int s = 0; s < 3; ++s) {
            const double d2 =
                mine[c] == source[s] ? -1 : (my_positions[mine[c]] - source_positions[source[s]]).squaredNorm();
            if (d2 < best2) best2 = d2, best = s;
        }
        uv[c] = at[best];
    }
    return uv;
}

[[noreturn]] void refuse_heap(std::size_t triangles) {
    throw InputError(
        fmt::format("the model's {} triangles lie on or across one another, or are so long and thin, that it cannot be "
                    "worked out in bounded time what is seen of them; unite its parts (boolean union), remove doubled "
                    "faces and remesh long thin ones in a mesh editor",
                    triangles));
}

// The surface while it is put together.
class VisibleParts {
public:
    VisibleParts(const std::vector<Vector3d>& positions_mm, const std::vector<Triangle>& source_triangles,
                 const RepairedMesh& repaired, const VisibleSurfaceOptions& options, Progress* progress);

    /// The solid's triangles of the textured mesh, and those that fill holes; those of sheets first.
    void show_solid();
    /// The triangles of the textured mesh that wraps stand for.
    void show_wrapped();

    VisibleSurface surface;
    VisibleSurfaceReport report;

private:
    static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

    [[nodiscard]] std::array<Vector3d, 3> places(const Triangle& t) const {
        return {solid_.positions_mm[t[0]], solid_.positions_mm[t[1]], solid_.positions_mm[t[2]]};
    }
    [[nodiscard]] Vector3d normal(std::uint32_t t) const;
    [[nodiscard]] bool hidden_at(const Vector3d& p, const Vector3d& normal, WorkBudget& work) const;

    [[nodiscard]] std::uint64_t most_steps() const {
        return options_.most_steps ? options_.most_steps : WorkBudget::for_triangles(solid_.triangles.size());
    }
    void judge_regions(WorkBudget& work);
    void order_by_place();
    void find_sources_at_corners();

    // A triangle that others cross, cut up.
    struct Cut {
        Sight as_a_whole = Sight::visible;
        std::vector<Piece> visible;
    };
    [[nodiscard]] std::vector<std::uint32_t> crossed_triangles() const;
    void cut_crossed();
    [[nodiscard]] Cut cut(std::uint32_t t, double piece_mm, WorkBudget& work) const;
    [[nodiscard]] Sight look_at_crossed(std::uint32_t t, const Vector3d& normal, const Piece& piece, double piece_mm,
                                        WorkBudget& work) const;
    template <class TryWith>
    void try_with_coarser_pieces(TryWith&& try_with);

    [[nodiscard]] bool is_source(std::uint32_t t) const { return solid_.source_triangle[t] >= 0; }
    [[nodiscard]] bool is_fill(std::uint32_t t) const {
        return !is_source(t) && source_at_corner_[solid_.triangles[t][0]] != nobody;
    }
    [[nodiscard]] Piece whole_piece(std::uint32_t t) const;
    Sight find_visible_pieces(std::uint32_t t);
    void count(Sight as_a_whole);

    [[nodiscard]] std::vector<bool> sheets() const;
    void lay_labels(const std::vector<bool>& of_sheet);
    template <class Which>
    void show_solid(const Which& which);
    void show_source(std::uint32_t t);
    void show_fill(std::uint32_t t);
    void show_in_corner_colours(const Piece& piece, const Triangle& corners);
    [[nodiscard]] Vector2f source_uv_at(std::uint32_t corner) const;

    void add(const Triangle& t, const std::array<Vector2f, 3>& uv, std::uint32_t source);
    void add(const Piece& piece);

    const std::vector<Vector3d>& source_positions_mm_;
    const std::vector<Triangle>& source_triangles_;
    const RepairedMesh& repaired_;
    const SolidMesh& solid_;
    const TriangleTree& tree_;
    VisibleSurfaceOptions options_;
    Progress* progress_;
    std::vector<std::vector<std::uint32_t>> crossings_;  // per triangle of the solid, by what it is crossed
    std::vector<Sight> sight_;                           // per triangle that nothing crosses
    std::unordered_map<std::uint32_t, Cut> cuts_;        // of the others
    std::vector<std::uint32_t> order_;                   // triangles of the solid, by where they lie
    std::vector<Triangle> corners_;                      // of each, from the one that lies first on
    std::vector<std::uint32_t> source_at_corner_;        // per corner a triangle there that has a source, or nobody
    std::vector<Triangle> wrap_;                         // without a source at any corner
    std::vector<Piece> pieces_;                          // visible ones of the triangle under work
};

VisibleParts::VisibleParts(const std::vector<Vector3d>& positions_mm, const std::vector<Triangle>& source_triangles,
                           const RepairedMesh& repaired, const VisibleSurfaceOptions& options, Progress* progress)
    : source_positions_mm_(positions_mm),
      source_triangles_(source_triangles),
      repaired_(repaired),
      solid_(*repaired.solid),
      tree_(repaired.solid.tree()),
      options_(options),
      progress_(progress),
      crossings_(solid_.triangles.size()),
      sight_(solid_.triangles.size(), Sight::visible) {
    surface.positions_mm = solid_.positions_mm;
    const MeshDiagnosis& mesh = repaired.report.after;
    const bool plain = mesh.shells == 1 && mesh.crossing_pairs == 0 && mesh.nonmanifold_edges == 0;
    order_by_place();
    find_sources_at_corners();
    if (plain) return;
    WorkBudget work(most_steps(), progress_);
    try {
        judge_regions(work);
    } catch (const WorkExceeded&) {
        refuse_heap(solid_.triangles.size());
    }
    cut_crossed();
}

Vector3d VisibleParts::normal(std::uint32_t t) const {
    const auto [a, b, c] = places(solid_.triangles[t]);
    const Vector3d n = (b - a).cross(c - a);
    return n.norm() > 0 ? n.normalized() : Vector3d::UnitX();
}

bool VisibleParts::hidden_at(const Vector3d& p, const Vector3d& normal, WorkBudget& work) const {
    return winding_number(tree_, p + just_off_mm * normal, &work) != 0 &&
           winding_number(tree_, p - just_off_mm * normal, &work) != 0;
}

// A region: neighbours through plain edges, as long as no other triangle crosses them. It is hidden or visible as one,
// and judged at its largest triangle.
void VisibleParts::judge_regions(WorkBudget& work) {
    StepShare bar(progress_, tree_.triangles().size(), tree_.triangles().size());
    crossings_ = find_crossings(tree_, work, &bar);
    const auto count = static_cast<std::uint32_t>(solid_.triangles.size());
    DisjointSets regions(count);
    for_each_edge(edge_uses(solid_.triangles), [&](std::span<const EdgeUse> edge) {
        if (edge.size() == 2 && crossings_[edge[0].triangle].empty() && crossings_[edge[1].triangle].empty())
            regions.unite(edge[0].triangle, edge[1].triangle);
    });
    std::vector<std::uint32_t> largest(count);
    std::iota(largest.begin(), largest.end(), 0u);
    std::vector<double> areas(count);
    std::vector<std::uint32_t> root_of(count), roots;
    for (std::uint32_t t = 0; t < count; ++t) {
        root_of[t] = regions.root(t);
        if (root_of[t] == t && crossings_[t].empty()) roots.push_back(t);
        areas[t] = area(solid_.positions_mm, solid_.triangles[t]);
        std::uint32_t& best = largest[root_of[t]];
        if (areas[t] > areas[best]) best = t;
    }
    StepShare share(progress_, count / 2, roots.size());
    parallel_for(0, roots.size(), 4, [&](std::size_t r) {
        const std::uint32_t judge = largest[roots[r]];
        const auto [a, b, c] = places(solid_.triangles[judge]);
        sight_[roots[r]] = hidden_at((a + b + c) / 3, normal(judge), work) ? Sight::hidden : Sight::visible;
        share.advance();
    });
    for (std::uint32_t t = 0; t < count; ++t)
        if (crossings_[t].empty()) sight_[t] = sight_[root_of[t]];
}

std::vector<std::uint32_t> VisibleParts::crossed_triangles() const {
    std::vector<std::uint32_t> crossed;
    for (std::uint32_t t = 0; t < crossings_.size(); ++t)
        if (!crossings_[t].empty() && (is_source(t) || is_fill(t))) crossed.push_back(t);
    return crossed;
}

// Calls try_with(size of pieces, work) with pieces twice as large while the work exceeds its bounds.
template <class TryWith>
void VisibleParts::try_with_coarser_pieces(TryWith&& try_with) {
    double piece_mm = options_.piece_mm;
    for (int doublings = 0; doublings <= most_doublings; ++doublings, piece_mm *= 2) {
        WorkBudget work(most_steps(), progress_);
        try {
            try_with(piece_mm, work);
            if (doublings > 0 && progress_)
                progress_->warn(named_warning(
                    "rough-edges",
                    fmt::format("The model's parts lie in one another so often that the edges of what is seen of them "
                                "are {:.2g} mm rough. Unite them in a mesh editor if that shows.",
                                piece_mm)));
            return;
        } catch (const WorkExceeded&) {
        }
    }
    refuse_heap(solid_.triangles.size());
}

void VisibleParts::cut_crossed() {
    const std::vector<std::uint32_t> crossed = crossed_triangles();
    std::vector<Cut> cuts(crossed.size());
    StepShare share(progress_, solid_.triangles.size() - solid_.triangles.size() / 2, crossed.size());
    try_with_coarser_pieces([&](double piece_mm, WorkBudget& work) {
        parallel_for(0, crossed.size(), 4, [&](std::size_t n) {
            cuts[n] = cut(crossed[n], piece_mm, work);
            share.advance();
        });
    });
    cuts_.reserve(crossed.size());
    for (std::size_t n = 0; n < crossed.size(); ++n) cuts_.emplace(crossed[n], std::move(cuts[n]));
}

VisibleParts::Cut VisibleParts::cut(std::uint32_t t, double piece_mm, WorkBudget& work) const {
    Cut result;
    const Vector3d n = normal(t);
    result.as_a_whole = add_visible(
        whole_piece(t), [&](const Piece& piece) { return look_at_crossed(t, n, piece, piece_mm, work); },
        result.visible);
    return result;
}

// So that of triangles that are equally near to a place the same one is taken however the file is ordered.
void VisibleParts::order_by_place() {
    const auto& places = solid_.positions_mm;
    std::vector<std::uint32_t> vertices(places.size()), rank(places.size());
    std::iota(vertices.begin(), vertices.end(), 0u);
    const auto lies_before = [&](std::uint32_t a, std::uint32_t b) {
        return std::lexicographical_compare(places[a].begin(), places[a].end(), places[b].begin(), places[b].end());
    };
    std::sort(vertices.begin(), vertices.end(), lies_before);
    for (std::size_t n = 1; n < vertices.size(); ++n)
        rank[vertices[n]] = rank[vertices[n - 1]] + (lies_before(vertices[n - 1], vertices[n]) ? 1 : 0);
    corners_ = solid_.triangles;
    std::vector<Triangle> ranks;
    ranks.reserve(corners_.size());
    for (Triangle& t : corners_) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end(), lies_before), t.end());
        Triangle& of_t = ranks.emplace_back(Triangle{rank[t[0]], rank[t[1]], rank[t[2]]});
        std::sort(of_t.begin(), of_t.end());
    }
    order_.resize(corners_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return ranks[a] != ranks[b] ? ranks[a] < ranks[b] : a < b; });
}

void VisibleParts::find_sources_at_corners() {
    source_at_corner_.assign(solid_.positions_mm.size(), nobody);
    for (const std::uint32_t t : order_) {
        if (solid_.source_triangle[t] < 0) continue;
        for (const std::uint32_t v : solid_.triangles[t])
            if (source_at_corner_[v] == nobody) source_at_corner_[v] = t;
    }
}

// Shells that enclose nothing, or nothing but what filling their holes made of them: a label that lies on a body.
std::vector<bool> VisibleParts::sheets() const {
    std::vector<bool> of_sheet(solid_.triangles.size(), false);
    if (repaired_.report.after.shells < 2) return of_sheet;
    struct Extent {
        double own = 0, fill = 0, volume = 0;
    };
    const Shells shells = find_shells(solid_.triangles);
    std::vector<Extent> extents(shells.count);
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
        Extent& extent = extents[shells.of_triangle[t]];
        (is_fill(t) ? extent.fill : extent.own) += area(solid_.positions_mm, solid_.triangles[t]);
        extent.volume += signed_volume(solid_.positions_mm, solid_.triangles[t]);
    }
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
        const auto& [own, fill, volume] = extents[shells.of_triangle[t]];
        of_sheet[t] = fill > 0.7 * own || std::abs(volume) < 1e-6 * std::pow(own + fill, 1.5);
    }
    return of_sheet;
}

void VisibleParts::show_solid() {
    const std::vector<bool> of_sheet = sheets();
    show_solid([&](std::uint32_t t) { return of_sheet[t]; });
    lay_labels(of_sheet);
    show_solid([&](std::uint32_t t) { return !of_sheet[t]; });
}

// Of the surface so far, which is that of sheets.
void VisibleParts::lay_labels(const std::vector<bool>& of_sheet) {
    if (surface.triangles.empty() || !(options_.label_mm > 0)) return;
    std::vector<Triangle> bodies;
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t)
        if (!of_sheet[t]) bodies.push_back(solid_.triangles[t]);
    if (bodies.empty()) return;
    const TriangleTree tree(solid_.positions_mm, bodies);
    for (const Triangle& t : surface.triangles)
        for (const std::uint32_t corner : t) {
            Vector3d& place = surface.positions_mm[corner];
            const TriangleTree::Nearest body = tree.nearest(place, TriangleTree::none, options_.label_mm);
            if (body.triangle != TriangleTree::none) place = body.point;
        }
}

template <class Which>
void VisibleParts::show_solid(const Which& which) {
    for (std::size_t n = 0; n < order_.size(); ++n) {
        const std::uint32_t t = order_[n];
        const Triangle& corners = corners_[t];
        if (progress_ && n % 4096 == 0) progress_->check_cancelled();
        if (!which(t)) continue;
        if (is_source(t))
            show_source(t);
        else if (is_fill(t))
            show_fill(t);
        else
            wrap_.push_back(corners);
    }
}

Piece VisibleParts::whole_piece(std::uint32_t t) const {
    const Triangle& corners = corners_[t];
    if (!is_source(t)) return {places(corners), {Vector2f(0, 0), Vector2f(1, 0), Vector2f(0, 1)}, nobody};
    const auto source = std::uint32_t(solid_.source_triangle[t]);
    return {places(corners), corner_uv(corners, source_triangles_[source], solid_.positions_mm, source_positions_mm_),
            source};
}

Sight VisibleParts::look_at_crossed(std::uint32_t t, const Vector3d& normal, const Piece& piece, double piece_mm,
                                    WorkBudget& work) const {
    work.spend(WorkBudget::exact_test + 4 * crossings_[t].size());
    const bool crossed = std::any_of(crossings_[t].begin(), crossings_[t].end(), [&](std::uint32_t other) {
        return triangles_meet(piece.corner, places(solid_.triangles[other]));
    });
    if (crossed && piece.longest() > piece_mm) return Sight::mixed;
    return hidden_at(piece.centre(), normal, work) ? Sight::hidden : Sight::visible;
}

// Fills pieces_, with the whole triangle itself where all of it is visible.
Sight VisibleParts::find_visible_pieces(std::uint32_t t) {
    pieces_.clear();
    Sight as_a_whole = sight_[t];
    if (const auto cut = cuts_.find(t); cut != cuts_.end()) {
        as_a_whole = cut->second.as_a_whole;
        pieces_ = std::move(cut->second.visible);
    } else if (as_a_whole == Sight::visible) {
        pieces_.push_back(whole_piece(t));
    }
    count(as_a_whole);
    return as_a_whole;
}

void VisibleParts::count(Sight as_a_whole) {
    report.hidden += as_a_whole == Sight::hidden;
    report.cut += as_a_whole == Sight::mixed;
}

void VisibleParts::show_source(std::uint32_t t) {
    if (find_visible_pieces(t) == Sight::visible)
        add(corners_[t], pieces_[0].uv, pieces_[0].source);  // on the corners that are there
    else
        for (const Piece& piece : pieces_) add(piece);
}

void VisibleParts::show_fill(std::uint32_t t) {
    ++report.patches;
    find_visible_pieces(t);
    for (const Piece& piece : pieces_) show_in_corner_colours(piece, corners_[t]);
}

// In six parts, each with the colour of the corner of the fill (`corners`, where piece.uv is (0, 0), (1, 0), (0, 1))
// that is nearest to it.
void VisibleParts::show_in_corner_colours(const Piece& piece, const Triangle& corners) {
    const Vector3d middle = piece.centre();
    for (int c = 0; c < 3; ++c)
        for (const int side : {(c + 1) % 3, (c + 2) % 3}) {
            const Vector2f place = 0.5f * piece.uv[c] + 0.5f * (piece.uv[0] + piece.uv[1] + piece.uv[2]) / 3;
            const float rest = 1 - place[0] - place[1];
            const int nearest = rest >= place[0] && rest >= place[1] ? 0 : place[0] >= place[1] ? 1 : 2;
            Piece part{{piece.corner[c], (piece.corner[c] + piece.corner[side]) / 2, middle}, {}, 0};
            part.source = std::uint32_t(solid_.source_triangle[source_at_corner_[corners[nearest]]]);
            part.uv.fill(source_uv_at(corners[nearest]));
            add(part);
        }
}

// Where a corner of the solid lies in the source of the triangle that is known there.
Vector2f VisibleParts::source_uv_at(std::uint32_t corner) const {
    const std::uint32_t t = source_at_corner_[corner];
    const Triangle& mine = solid_.triangles[t];
    const auto uv = corner_uv(mine, source_triangles_[std::uint32_t(solid_.source_triangle[t])], solid_.positions_mm,
                              source_positions_mm_);
    return uv[std::size_t(std::find(mine.begin(), mine.end(), corner) - mine.begin())];
}

// Whether faces that a wrap replaced are seen: near the wrap, where that is seen.
class WrapSight {
public:
    /// Keeps references to all.
    WrapSight(const std::vector<Vector3d>& positions_mm, const std::vector<Triangle>& wrap, double reach_mm,
              const TriangleTree& solid)
        : wrap_(positions_mm, wrap), reach_mm_(reach_mm), solid_(solid) {}

    [[nodiscard]] Sight look_at(const Piece& piece, double piece_mm, WorkBudget& work) const {
        if (piece.longest() > 10 * piece_mm) return Sight::mixed;
        const Vector3d centre = piece.centre();
        int hidden = hidden_at(centre, work);
        if (piece.longest() <= piece_mm) return hidden ? Sight::hidden : Sight::visible;
        for (const Vector3d& c : piece.corner) hidden += hidden_at(0.9 * c + 0.1 * centre, work);
        return hidden == 0 ? Sight::visible : hidden == 4 ? Sight::hidden : Sight::mixed;
    }

private:
    [[nodiscard]] bool hidden_at(const Vector3d& p, WorkBudget& work) const {
        work.spend(WorkBudget::exact_test);
        const TriangleTree::Nearest n = wrap_.nearest(p, TriangleTree::none, reach_mm_);
        if (n.triangle == TriangleTree::none) return true;
        const Vector3d out_of_wrap = n.distance > 0 ? Vector3d((n.point - p) / n.distance) : Vector3d::UnitX();
        return winding_number(solid_, n.point + just_off_mm * out_of_wrap, &work) != 0;
    }

    TriangleTree wrap_;
    double reach_mm_;
    const TriangleTree& solid_;
};

void VisibleParts::show_wrapped() {
    if (wrap_.empty()) return;
    const double reach_mm = 4 * repaired_.report.wrap_offset_mm;
    const WrapSight sight(solid_.positions_mm, wrap_, reach_mm, tree_);
    std::vector<Cut> cuts(repaired_.wrapped_triangles.size());
    try_with_coarser_pieces([&](double piece_mm, WorkBudget& work) {
        parallel_for(0, cuts.size(), 4, [&](std::size_t n) {
            const std::uint32_t source = repaired_.wrapped_triangles[n];
            const auto& [a, b, c] = source_triangles_[source];
            const Piece whole{{source_positions_mm_[a], source_positions_mm_[b], source_positions_mm_[c]},
                              {Vector2f(0, 0), Vector2f(1, 0), Vector2f(0, 1)},
                              source};
            cuts[n].visible.clear();
            cuts[n].as_a_whole = add_visible(
                whole, [&](const Piece& piece) { return sight.look_at(piece, piece_mm, work); }, cuts[n].visible);
        });
    });
    for (const Cut& cut : cuts) {
        count(cut.as_a_whole);
        for (const Piece& piece : cut.visible) add(piece);
    }
}

void VisibleParts::add(const Triangle& t, const std::array<Vector2f, 3>& uv, std::uint32_t source) {
    surface.triangles.push_back(t);
    surface.source_uv.push_back(uv);
    surface.source_triangle.push_back(source);
}

void VisibleParts::add(const Piece& piece) {
    const auto first = static_cast<std::uint32_t>(surface.positions_mm.size());
    surface.positions_mm.insert(surface.positions_mm.end(), piece.corner.begin(), piece.corner.end());
    add({first, first + 1, first + 2}, piece.uv, piece.source);
}

}  // namespace

VisibleSurface find_visible_surface(const std::vector<Vector3d>& positions_mm,
                                    const std::vector<Triangle>& source_triangles, const RepairedMesh& repaired,
                                    const VisibleSurfaceOptions& options, VisibleSurfaceReport* report,
                                    Progress* progress) {
    VOXTONE_EXPECT(options.piece_mm > 0 && repaired.solid->source_triangle.size() == repaired.solid->triangles.size());
    VisibleParts parts(positions_mm, source_triangles, repaired, options, progress);
    parts.show_solid();
    parts.show_wrapped();
    if (report) *report = parts.report;
    return std::move(parts.surface);
}

double coloured_area_mm2(const VisibleSurface& surface) {
    double area = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const auto& p = surface.positions_mm;
        area += 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
    }
    return area;
}

}  // namespace voxtone::slicer
