// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_repair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "slicer/mesh/alpha_wrap.h"
#include "slicer/mesh/box.h"
#include "slicer/mesh/coincident_faces.h"
#include "slicer/mesh/face_sides.h"
#include "slicer/mesh/hole_filling.h"
#include "slicer/mesh/mesh_chain.h"
#include "slicer/mesh/mesh_orientation.h"
#include "slicer/mesh/open_pieces.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

double diagonal_mm(const SolidMesh& mesh) { return bounding_box(mesh.positions_mm, mesh.triangles).diagonal().norm(); }

double area_mm2(const SolidMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) sum += area(mesh.positions_mm, t);
    return sum;
}

std::string share_text(double share) { return share < 0.01 ? "below 1 %" : fmt::format("{:.0f} %", 100 * share); }

SolidMesh as_it_came(const io::TexturedMesh& textured) {
    SolidMesh mesh{textured.positions, textured.triangles, {}};
    mesh.source_triangle.resize(mesh.triangles.size());
    std::iota(mesh.source_triangle.begin(), mesh.source_triangle.end(), 0);
    return mesh;
}

// Joins vertices nearer than `tolerance` to one that came before. Returns how many went.
std::size_t weld(SolidMesh& mesh, std::vector<PiledFace>& piled, double tolerance) {
    const Vector3d low = bounding_box(mesh.positions_mm, mesh.triangles).min();
    struct Cell {
        std::int64_t x, y, z;
        bool operator==(const Cell&) const = default;
    };
    struct Hash {
        std::size_t operator()(const Cell& c) const {
            return std::size_t((std::uint64_t(c.x) * 0x9E3779B97F4A7C15u ^ std::uint64_t(c.y)) * 0xC2B2AE3D27D4EB4Fu ^
                               std::uint64_t(c.z));
        }
    };
    const auto cell = [&](const Vector3d& p) {
        const Vector3d q = ((p - low) / tolerance).array().floor();
        return Cell{std::int64_t(q[0]), std::int64_t(q[1]), std::int64_t(q[2])};
    };
    std::unordered_map<Cell, std::vector<std::uint32_t>, Hash> cells;
    std::vector<std::uint32_t> to(mesh.positions_mm.size());
    std::vector<bool> used(to.size(), false);
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) used[v] = true;
    std::size_t gone = 0;
    for (std::uint32_t v = 0; v < to.size(); ++v) {
        to[v] = v;
        if (!used[v]) continue;
        const Vector3d& p = mesh.positions_mm[v];
        const Cell home = cell(p);
        for (int n = 0; n < 27 && to[v] == v; ++n) {
            const auto near = cells.find({home.x + n % 3 - 1, home.y + n / 3 % 3 - 1, home.z + n / 9 - 1});
            if (near == cells.end()) continue;
            for (const std::uint32_t other : near->second)
                if (to[v] == v && (mesh.positions_mm[other] - p).norm() <= tolerance) to[v] = other;
        }
        if (to[v] == v)
            cells[home].push_back(v);
        else
            ++gone;
    }
    for (auto& t : mesh.triangles)
        for (std::uint32_t& v : t) v = to[v];
    for (PiledFace& face : piled)
        for (std::uint32_t& v : face.corners) v = to[v];
    return gone;
}

void keep_faces(SolidMesh& mesh, const std::vector<bool>& keep) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!keep[t]) continue;
        mesh.triangles[kept] = mesh.triangles[t];
        mesh.source_triangle[kept++] = mesh.source_triangle[t];
    }
    mesh.triangles.resize(kept);
    mesh.source_triangle.resize(kept);
}

// Faces with a corner twice: they add nothing to the chain.
std::size_t drop_collapsed(SolidMesh& mesh) {
    std::vector<bool> keep(mesh.triangles.size());
    for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = !collapsed(mesh.triangles[t]);
    const std::size_t before = mesh.triangles.size();
    keep_faces(mesh, keep);
    return before - mesh.triangles.size();
}

// All but one of the faces on the same three corners.
std::size_t drop_duplicates(SolidMesh& mesh, std::vector<PiledFace>& piled) {
    std::map<Triangle, std::size_t> first;
    std::vector<bool> keep(mesh.triangles.size());
    for (std::size_t t = 0; t < keep.size(); ++t) {
        Triangle corners = mesh.triangles[t];
        std::sort(corners.begin(), corners.end());
        const auto [there, is_new] = first.emplace(corners, t);
        keep[t] = is_new;
        if (is_new) continue;
        for (const std::size_t face : {there->second, t})
            piled.push_back({mesh.triangles[face], mesh.source_triangle[face]});
    }
    const std::size_t before = mesh.triangles.size();
    keep_faces(mesh, keep);
    return before - mesh.triangles.size();
}

// Faces that filling holes would close upon themselves: pieces (joined through edges) whose fill is about as large as
// they are.
std::vector<bool> loose_faces(const SolidMesh& mesh, const std::vector<HoleFill>& fills) {
    std::vector<Triangle> all = mesh.triangles;
    for (const HoleFill& f : fills) all.insert(all.end(), f.triangles.begin(), f.triangles.end());
    const Shells shells = find_shells(all);
    struct Piece {
        double own = 0, fill = 0;
    };
    std::vector<Piece> pieces(shells.count);
    double total = 0;
    for (std::size_t t = 0; t < all.size(); ++t) {
        const double a = area(mesh.positions_mm, all[t]);
        (t < mesh.triangles.size() ? pieces[shells.of_triangle[t]].own : pieces[shells.of_triangle[t]].fill) += a;
        total += t < mesh.triangles.size() ? a : 0;
    }
    const auto is_loose = [](const Piece& p) { return p.fill > 0.7 * p.own; };
    double loose_area = 0;
    std::size_t loose_pieces = 0;
    for (const Piece& p : pieces)
        if (is_loose(p)) loose_area += p.own, ++loose_pieces;
    std::vector<bool> loose(mesh.triangles.size(), false);
    // A few sheets are sheets; many that make up much of the surface are a body in shreds.
    if (loose_pieces < 12 || loose_area < 0.2 * total) return loose;
    for (std::size_t t = 0; t < loose.size(); ++t) loose[t] = is_loose(pieces[shells.of_triangle[t]]);
    return loose;
}

constexpr std::size_t max_points = 20'000;  // of a wrap that is not the first

// Replaces the faces marked by a wrap around them.
void wrap_faces(SolidMesh& mesh, const std::vector<bool>& marked, const RepairOptions& options, RepairedMesh& result,
                const Progress* progress, StepShare& bar) {
    RepairReport& report = result.report;
    std::vector<Triangle> faces;
    std::vector<bool> keep(mesh.triangles.size());
    SolidMesh marked_mesh;
    for (std::size_t t = 0; t < keep.size(); ++t) {
        keep[t] = !marked[t];
        if (keep[t]) continue;
        faces.push_back(mesh.triangles[t]);
        result.wrapped_triangles.push_back(static_cast<std::uint32_t>(mesh.source_triangle[t]));
    }
    marked_mesh.positions_mm = mesh.positions_mm;
    marked_mesh.triangles = faces;
    const double diagonal = diagonal_mm(marked_mesh);
    double faces_area = 0;
    for (const Triangle& t : faces) faces_area += area(mesh.positions_mm, t);
    // The finer the wrap, the closer; but once it slips through the cracks it lines the surface from inside as well and
    // its area doubles. So: finer until that happens or time runs out (a point takes about a quarter of a millisecond).
    // What is lined on both sides from the start consists of sheets, and is wrapped finely.
    const double offset = std::max(options.pitch_mm, diagonal / 2000);
    const double coarsest = diagonal / 25, finest = std::max(2 * offset, diagonal / 150);
    std::optional<Wrap> wrap;
    bool sheets = false;
    for (double alpha = coarsest;; alpha = std::max(alpha / 2, finest)) {
        if (progress) progress->check_cancelled();
        std::optional<Wrap> finer =
            alpha_wrap(mesh.positions_mm, faces, alpha, offset, wrap ? max_points : 10 * max_points, progress, &bar);
        if (!finer) break;
        double wrap_area = 0;
        for (const Triangle& t : finer->triangles) wrap_area += area(finer->positions, t);
        const bool two_sided = wrap_area > 1.6 * faces_area;
        if (!wrap) sheets = two_sided;
        if (wrap && two_sided && !sheets) break;
        wrap = std::move(finer);
        report.wrap_alpha_mm = alpha;
        report.wrap_offset_mm = offset;
        if (alpha <= finest) break;
    }
    if (!wrap)
        throw ResourceError(
            "the model's surface is too large and too torn to be wrapped; repair it in a mesh editor first");
    keep_faces(mesh, keep);
    const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
    mesh.positions_mm.insert(mesh.positions_mm.end(), wrap->positions.begin(), wrap->positions.end());
    for (const Triangle& t : wrap->triangles) {
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        mesh.source_triangle.push_back(-1);
    }
    report.wrapped_faces = faces.size();
    report.messages.push_back(
        fmt::format("{} faces were replaced by a surface wrapped around them: gaps below {:.3g} mm are bridged and the "
                    "body grows by about {:.3g} mm there.",
                    faces.size(), report.wrap_alpha_mm, report.wrap_offset_mm));
}

void fill(SolidMesh& mesh, const std::vector<HoleFill>& fills, RepairReport& report) {
    for (const HoleFill& f : fills)
        for (const Triangle& t : f.triangles) {
            mesh.triangles.push_back(t);
            mesh.source_triangle.push_back(-1);
            report.filled_area_mm2 += area(mesh.positions_mm, t);
        }
    report.filled_holes = fills.size();
    if (fills.empty()) return;
    const double own = area_mm2(mesh) - report.filled_area_mm2;
    report.messages.push_back(fmt::format("{} hole{} closed with {:.3g} mm^2 of new surface, {} of the model's.",
                                          fills.size(), fills.size() == 1 ? " was" : "s were", report.filled_area_mm2,
                                          share_text(report.filled_area_mm2 / own)));
}

[[noreturn]] void refuse_torn(const OpenPiece& piece, std::size_t edges) {
    throw InputError(
        fmt::format("the model is open at {} edges, and closing it would take {} as much surface as it has, through "
                    "places where nothing tells its shape; complete it in a mesh editor, or say what it is: "
                    "--repair fill (a body, its holes closed straight), --sheet-thickness 1mm (a sheet of that "
                    "thickness), --repair wrap (what its faces enclose)",
                    edges, share_text(piece.fill_mm2 / piece.own_mm2)));
}

void say_sheets(std::size_t sheets, double sheet_mm2, double all_mm2, double thickness_mm, RepairReport& report) {
    const bool one = sheets == 1;
    const std::string thickness =
        thickness_mm > 0 ? fmt::format("{:g} mm", thickness_mm)
                         : fmt::format(
                               "one voxel, since {} no thickness (--sheet-thickness 1mm gives one, and a base "
                               "in a mesh editor makes a body of {})",
                               one ? "it has" : "they have", one ? "it" : "them");
    report.messages.push_back(
        fmt::format("{} open sheet{} and enclose{} nothing ({} of the surface): {} printed with a thickness of {}.",
                    sheets, one ? " is no body" : "s are no bodies", one ? "s" : "", share_text(sheet_mm2 / all_mm2),
                    one ? "it is" : "they are", thickness));
}

void say_sheets_of_two_sides(double share, RepairReport& report) {
    report.messages.push_back(
        fmt::format("{} of the surface is sheets with two sides that enclose nothing: they are printed with a "
                    "thickness of one voxel (--sheet-thickness 1mm gives them one).",
                    share_text(share)));
}

// Gives sheets another side in the place of fills that would make lumps of them; `fills` becomes what closes the rest.
// Refuses what is mostly torn.
void settle_sheets(SolidMesh& mesh, std::vector<HoleFill>& fills, const RepairOptions& options, std::size_t open,
                   RepairReport& report, const Progress* progress) {
    if (options.mode == RepairMode::fill) return;
    const double all_mm2 = area_mm2(mesh);
    std::vector<OpenPiece> sheets;
    double sheet_mm2 = 0;
    for (OpenPiece& piece : open_pieces(mesh.positions_mm, mesh.triangles, fills)) {
        // Torn parts of a body (a coat, a sleeve) are closed as they are without a thickness for its sheets: as sheets
        // they would grow through it. A model that is little else is what its user says that it is.
        const bool is_torn = piece.kind == OpenPiece::Kind::torn, is_most = piece.own_mm2 > all_mm2 / 2;
        if (is_torn && is_most && options.sheet_mm <= 0) refuse_torn(piece, open);
        if (piece.kind == OpenPiece::Kind::body || (is_torn && !is_most)) continue;
        sheet_mm2 += piece.own_mm2;
        sheets.push_back(std::move(piece));
    }
    if (sheets.empty()) return;
    std::vector<bool> of_sheet(mesh.triangles.size(), false);
    for (const OpenPiece& sheet : sheets)
        for (const std::uint32_t t : sheet.faces) of_sheet[t] = true;
    std::vector<Triangle> rest;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (!of_sheet[t]) rest.push_back(mesh.triangles[t]);
    fills = fill_holes(mesh.positions_mm, rest, progress);
    for (const OpenPiece& sheet : sheets) add_other_side(mesh, sheet, options.sheet_mm);
    say_sheets(sheets.size(), sheet_mm2, all_mm2, options.sheet_mm, report);
}

// Welds, drops, orients and fills until the chain is closed; wraps what filling would only close upon itself.
void close_chain(SolidMesh& mesh, std::vector<PiledFace>& piled, const RepairOptions& options, RepairedMesh& result,
                 const Progress* progress, StepShare& bar) {
    RepairReport& report = result.report;
    const std::size_t open = piled.empty() ? report.before.open_edges : open_edges(mesh.triangles);
    report.welded_vertices = weld(mesh, piled, std::min(0.1 * options.pitch_mm, 1e-5 * diagonal_mm(mesh)));
    drop_collapsed(mesh);
    if (open_edges(mesh.triangles) != 0) drop_duplicates(mesh, piled);
    report.dropped_faces = report.before.triangles - mesh.triangles.size();
    report.turned_faces = orient_consistently(mesh.triangles);
    if (report.welded_vertices + report.dropped_faces + report.turned_faces > 0)
        report.messages.push_back(
            fmt::format("The mesh was open at {} edges; {} corners were welded, {} faces dropped, {} faces turned.",
                        open, report.welded_vertices, report.dropped_faces, report.turned_faces));
    std::vector<HoleFill> fills = fill_holes(mesh.positions_mm, mesh.triangles, progress);
    const std::vector<bool> loose = loose_faces(mesh, fills);
    if (std::find(loose.begin(), loose.end(), true) != loose.end()) {
        wrap_faces(mesh, loose, options, result, progress, bar);
        fills = fill_holes(mesh.positions_mm, mesh.triangles, progress);
    }
    settle_sheets(mesh, fills, options, open, report, progress);
    fill(mesh, fills, report);
}

void turn_outward(SolidMesh& mesh, RepairReport& report, const Progress* progress) {
    const Shells shells = find_shells(mesh.triangles);
    const ShellTurns turns = orient_outward(mesh.positions_mm, mesh.triangles, shells, progress);
    report.turned_shells = turns.turned;
    report.cavities = turns.cavities;
    if (turns.turned)
        report.messages.push_back(fmt::format("{} of {} shells faced inward and {} turned outward.", turns.turned,
                                              shells.count, turns.turned == 1 ? "was" : "were"));
}

/// What lies in one place several times, and back sides. Returns all faces that lie on others.
std::vector<PiledFace> take_once(SolidMesh& mesh, const RepairOptions& options, RepairReport& report) {
    const double all_mm2 = area_mm2(mesh);
    CoincidentFaces dropped = drop_coincident_faces(mesh, options.sheet_mm > 0);
    report.dropped_faces = dropped.copies + dropped.back_sides;
    if (dropped.copies > 0)
        report.messages.push_back(
            fmt::format("{} faces lay exactly on others, as where a body is in the file several times in one place: "
                        "each was taken once.",
                        dropped.copies));
    if (dropped.back_sides > 0)
        report.messages.push_back(
            fmt::format("{} faces were the back sides of others (a two-sided mesh): they were dropped, and what the "
                        "other faces enclose is printed solid.",
                        dropped.back_sides));
    if (2 * dropped.sheet_mm2 > all_mm2 / 3) say_sheets_of_two_sides(2 * dropped.sheet_mm2 / all_mm2, report);
    return std::move(dropped.piled);
}

/// Of faces in one place that have several colours the one that looks outward gives its own.
void settle_sides(const io::TexturedMesh& textured, SolidMesh& mesh, std::span<const PiledFace> piled,
                  RepairReport& report) {
    take_outward_sources(mesh, piled);
    if (const std::size_t others = count_other_colours(textured, piled))
        report.messages.push_back(
            fmt::format("{} of the faces that lie on others have another colour than those: each place has the colour "
                        "of the first face there that looks outward.",
                        others));
}

}  // namespace

std::uint64_t repair_steps(const io::TexturedMesh& mesh) { return 3 * std::uint64_t{mesh.triangles.size()}; }

RepairedMesh repair_mesh(const io::TexturedMesh& textured, const RepairOptions& options, Progress* progress) {
    VOXTONE_EXPECT(options.pitch_mm > 0);
    RepairedMesh result;
    RepairReport& report = result.report;
    SolidMesh mesh = as_it_came(textured);
    const std::size_t triangles = mesh.triangles.size();
    StepShare first_count(progress, triangles, triangles), closing(progress, triangles, 2 * max_points);
    const auto crossings_count = [&] { return mesh.triangles.size() <= options.count_crossings_up_to; };
    std::vector<PiledFace> piled;
    if (options.mode == RepairMode::automatic || options.mode == RepairMode::fill)
        piled = take_once(mesh, options, report);
    std::optional<SolidIndex> given;
    if (crossings_count() && mesh.triangles.size() == triangles) given.emplace(mesh);
    report.before =
        diagnose(textured.positions, textured.triangles, given ? &given->tree() : nullptr, progress, &first_count);
    first_count.finish();
    if (!(report.before.area_mm2 > 0))
        throw InputError("the model has no surface: all its faces are without area, so there is nothing to print");

    const bool closed = (piled.empty() ? report.before.open_edges : open_edges(mesh.triangles)) == 0;
    if (!closed && options.mode == RepairMode::off)
        throw InputError(
            fmt::format("the model is open at {} edges ({} boundary edges, {} edges whose faces disagree), so it "
                        "encloses no body; use "
                        "--repair auto to close it",
                        report.before.open_edges, report.before.boundary_edges, report.before.inconsistent_edges));

    drop_collapsed(mesh);
    if (options.mode == RepairMode::wrap) {
        wrap_faces(mesh, std::vector<bool>(mesh.triangles.size(), true), options, result, progress, closing);
    } else if (!closed) {
        close_chain(mesh, piled, options, result, progress, closing);
    }
    VOXTONE_ENSURE(open_edges(mesh.triangles) == 0);

    if (options.mode != RepairMode::off) turn_outward(mesh, report, progress);
    settle_sides(textured, mesh, piled, report);
    closing.finish();

    const bool untouched = mesh.triangles == textured.triangles, count_again = !untouched && crossings_count();
    result.solid = untouched && given ? std::move(*given) : SolidIndex(std::move(mesh));
    StepShare second_count(progress, triangles, result.solid->triangles.size());
    report.after = untouched ? report.before
                             : diagnose(result.solid->positions_mm, result.solid->triangles,
                                        count_again ? &result.solid.tree() : nullptr, progress, &second_count);
    second_count.finish();
    return result;
}

}  // namespace voxtone::slicer
