// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/colour_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <tuple>
#include <utility>

#include "base/contracts.h"
#include "halftone/loop/paper.h"
#include "optics/colour/colour.h"
#include "optics/scene/surface_smoothing.h"

namespace voxtone::halftone {

namespace {

constexpr float step_within = 0.008f, all_within = 0.012f, apart = 0.05f;  // Oklab
constexpr int around_steps = 3;
constexpr double solid_mm2 = 1, least_mm2 = 0.2;
constexpr double rim_mm = 0.6, least_interior = 0.2;

using Place = std::array<std::int32_t, 3>;

bool before(const Place& a, const Place& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); }

// Cells lie in order of z, y, x.
std::int64_t cell_at(const optics::Surface& surface, const Place& place) {
    const auto found = std::ranges::lower_bound(surface.cells, place, before, &optics::SurfaceCell::cell);
    return found != surface.cells.end() && found->cell == place ? found - surface.cells.begin() : -1;
}

// All cells around one, itself too, that there are.
template <class Visit>
void visit_around(const optics::Surface& surface, std::size_t at, const Visit& visit) {
    const optics::SurfaceCell& cell = surface.cells[at];
    for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                if (const std::int64_t to = cell_at(surface, {cell.cell[0] + dx, cell.cell[1] + dy, cell.cell[2] + dz});
                    to >= 0)
                    visit(static_cast<std::size_t>(to));
}

bool look_alike(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0;
}

std::vector<std::vector<std::uint32_t>> connected_pieces(const optics::Surface& surface,
                                                         const std::vector<Eigen::Vector3f>& oklab) {
    std::vector<char> taken(oklab.size());
    std::vector<std::vector<std::uint32_t>> pieces;
    for (std::size_t first = 0; first < oklab.size(); ++first) {
        if (taken[first]) continue;
        taken[first] = 1;
        std::vector<std::uint32_t>& piece = pieces.emplace_back(1, static_cast<std::uint32_t>(first));
        for (std::size_t next = 0; next < piece.size(); ++next) {
            const std::size_t at = piece[next];
            visit_around(surface, at, [&](std::size_t other) {
                if (taken[other] || (oklab[other] - oklab[at]).norm() > step_within ||
                    (oklab[other] - oklab[first]).norm() > all_within ||
                    !look_alike(surface.cells[other].normal, surface.cells[at].normal))
                    return;
                taken[other] = 1;
                piece.push_back(static_cast<std::uint32_t>(other));
            });
        }
    }
    return pieces;
}

// Cells of a piece (ascending) by how many steps they lie from what is not of it: 1 at the border.
std::vector<int> depths(const optics::Surface& surface, const std::vector<std::uint32_t>& piece, int most) {
    const auto place_of = [&](std::size_t cell) -> std::int64_t {
        const auto found = std::ranges::lower_bound(piece, cell);
        return found != piece.end() && *found == cell ? found - piece.begin() : -1;
    };
    std::vector<int> depth(piece.size(), most);
    for (int step = 1; step < most; ++step)
        for (std::size_t i = 0; i < piece.size(); ++i) {
            if (depth[i] < step) continue;
            bool at_border = false;
            visit_around(surface, piece[i], [&](std::size_t other) {
                const std::int64_t place = place_of(other);
                at_border = at_border || place < 0 || depth[static_cast<std::size_t>(place)] < step;
            });
            if (at_border) depth[i] = step;
        }
    return depth;
}

// `cells`, and what comes of it, ascending.
std::vector<std::uint32_t> around(const optics::Surface& surface, const std::vector<std::uint32_t>& cells, int steps) {
    std::vector<std::uint32_t> found, last = cells;
    const auto holds = [](const std::vector<std::uint32_t>& list, std::uint32_t cell) {
        return std::ranges::binary_search(list, cell);
    };
    for (int step = 0; step < steps; ++step) {
        std::vector<std::uint32_t> next;
        for (const std::uint32_t at : last)
            visit_around(surface, at, [&](std::size_t other) {
                const auto cell = static_cast<std::uint32_t>(other);
                if (look_alike(surface.cells[other].normal, surface.cells[at].normal) && !holds(cells, cell) &&
                    !holds(found, cell))
                    next.push_back(cell);
            });
        std::ranges::sort(next);
        next.erase(std::unique(next.begin(), next.end()), next.end());
        found.insert(found.end(), next.begin(), next.end());
        std::ranges::sort(found);
        last = std::move(next);
    }
    return found;
}

// Of a colour of its own, with edges.
bool stands_apart(const optics::Surface& surface, const std::vector<Eigen::Vector3f>& oklab,
                  const std::vector<std::uint32_t>& piece) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (const std::uint32_t i : piece) mean += oklab[i] / static_cast<float>(piece.size());
    const std::vector<std::uint32_t> others = around(surface, piece, around_steps);
    const auto far = std::ranges::count_if(others, [&](std::uint32_t i) { return (oklab[i] - mean).norm() > apart; });
    return 2 * static_cast<std::size_t>(far) >= others.size();
}

double area_of(const optics::Surface& surface, const std::vector<std::uint32_t>& cells) {
    double area = 0;
    for (const std::uint32_t i : cells) area += static_cast<double>(surface.cells[i].area_mm2);
    return area;
}

ColourRegion region_of(const optics::Surface& surface, std::span<const Eigen::Vector3f> target, RegionKind kind,
                       std::vector<std::uint32_t> cells) {
    ColourRegion region;
    std::ranges::sort(cells);
    region.area_mm2 = area_of(surface, cells);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : cells)
        sum += static_cast<double>(surface.cells[i].area_mm2) * target[i].cast<double>();
    region.target = (sum / region.area_mm2).cast<float>();
    region.kind = kind;
    region.cells = std::move(cells);
    const double edge = std::sqrt(region.area_mm2 / static_cast<double>(region.cells.size()));
    const int rim = std::max(1, static_cast<int>(std::lround(rim_mm / edge)));
    const std::vector<int> depth = depths(surface, region.cells, rim + 1);
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (depth[i] > rim) region.interior.push_back(region.cells[i]);
    if (static_cast<double>(region.interior.size()) < least_interior * static_cast<double>(region.cells.size()))
        region.interior = region.cells;
    return region;
}

struct Strokes {
    Eigen::Vector3f oklab;
    std::vector<std::uint32_t> cells;
};

// To those of its colour.
void join(std::vector<Strokes>& strokes, const Eigen::Vector3f& colour, const std::vector<std::uint32_t>& piece) {
    const auto same =
        std::ranges::find_if(strokes, [&](const Strokes& s) { return (s.oklab - colour).norm() <= all_within; });
    Strokes& into = same != strokes.end() ? *same : strokes.emplace_back(Strokes{colour, {}});
    into.cells.insert(into.cells.end(), piece.begin(), piece.end());
}

}  // namespace

std::vector<ColourRegion> colour_regions(const optics::Surface& surface, std::span<const Eigen::Vector3f> target) {
    VOXTONE_EXPECT(target.size() == surface.cells.size());
    std::vector<Eigen::Vector3f> oklab;
    for (const Eigen::Vector3f& rgb : target)
        oklab.push_back(optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0)).cast<float>());
    std::vector<ColourRegion> regions;
    std::vector<Strokes> strokes, thin;
    std::vector<Eigen::Vector3f> solids;
    std::vector<std::uint32_t> paper;
    for (std::vector<std::uint32_t>& piece : connected_pieces(surface, oklab)) {
        std::ranges::sort(piece);
        if (piece.size() < 4 || !stands_apart(surface, oklab, piece)) continue;
        if (paper_weight(target[piece.front()]) > 0.5f) {
            paper.insert(paper.end(), piece.begin(), piece.end());
            continue;
        }
        if (area_of(surface, piece) >= solid_mm2) {
            solids.push_back(oklab[piece.front()]);
            regions.push_back(region_of(surface, target, RegionKind::solid, std::move(piece)));
            continue;
        }
        if (std::ranges::max(depths(surface, piece, 2)) < 2)
            thin.push_back({oklab[piece.front()], std::move(piece)});
        else
            join(strokes, oklab[piece.front()], piece);
    }
    // Hairlines, and not the blurred edges of others: of a colour that something wider has.
    for (const Strokes& line : thin) {
        const auto alike = [&](const Eigen::Vector3f& colour) { return (colour - line.oklab).norm() <= all_within; };
        if (std::ranges::any_of(solids, alike) || std::ranges::any_of(strokes, alike, &Strokes::oklab))
            join(strokes, line.oklab, line.cells);
    }
    for (Strokes& s : strokes)
        if (area_of(surface, s.cells) >= least_mm2)
            regions.push_back(region_of(surface, target, RegionKind::strokes, std::move(s.cells)));
    if (area_of(surface, paper) >= solid_mm2)
        regions.push_back(region_of(surface, target, RegionKind::paper, std::move(paper)));
    std::ranges::stable_sort(regions, std::greater<>(), &ColourRegion::area_mm2);
    return regions;
}

std::vector<RegionLook> look_at(std::span<const ColourRegion> regions, const optics::Surface& surface,
                                std::span<const Eigen::Vector3f> near_target, std::span<const Eigen::Vector3f> near) {
    const auto lab = [](const Eigen::Vector3d& rgb) { return optics::lab_from_linear_srgb(rgb.cwiseMax(0)); };
    std::vector<RegionLook> looks;
    for (const ColourRegion& region : regions) {
        RegionLook& look = looks.emplace_back();
        Eigen::Vector3d target = Eigen::Vector3d::Zero(), print = target, mean = target, squares = target;
        double area = 0;
        for (const std::uint32_t i : region.interior) {
            const auto a = static_cast<double>(surface.cells[i].area_mm2);
            const Eigen::Vector3d wanted = near_target[i].cast<double>(), shown = near[i].cast<double>();
            const Eigen::Vector3d off = lab(shown) - lab(wanted);
            area += a, target += a * wanted, print += a * shown;
            mean += a * off, squares += a * off.cwiseProduct(off);
        }
        mean /= area, squares /= area;
        look.lab = lab(print / area);
        look.difference = optics::ciede2000(lab(target / area), look.lab);
        look.unevenness = std::sqrt((squares - mean.cwiseProduct(mean)).cwiseMax(0).sum());
    }
    return looks;
}

std::vector<std::uint32_t> cells_around(const optics::Surface& surface, const ColourRegion& region, int steps) {
    return around(surface, region.cells, steps);
}

double rim_chroma(const ColourRegion& region, const optics::Surface& surface,
                  std::span<const Eigen::Vector3f> near_target, std::span<const Eigen::Vector3f> near) {
    const double edge = std::sqrt(region.area_mm2 / static_cast<double>(region.cells.size()));
    std::vector<std::uint32_t> rim =
        cells_around(surface, region, std::max(1, static_cast<int>(std::lround(rim_mm / edge))));
    // Of what is hardly wider than its rim all is interior.
    if (region.interior.size() < region.cells.size())
        std::ranges::set_difference(region.cells, region.interior, std::back_inserter(rim));
    else
        rim.insert(rim.end(), region.cells.begin(), region.cells.end());
    const auto lab = [](const Eigen::Vector3f& rgb) {
        return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
    };
    double sum = 0, area = 0;
    for (const std::uint32_t i : rim) {
        const auto a = static_cast<double>(surface.cells[i].area_mm2);
        sum += a * (lab(near[i]) - lab(near_target[i])).tail<2>().norm();
        area += a;
    }
    return area > 0 ? sum / area : 0;
}

double worse_by(const RegionLook& now, const RegionLook& before) {
    return std::max(0.0, now.difference - before.difference) + 2 * std::max(0.0, now.unevenness - before.unevenness);
}

}  // namespace voxtone::halftone
