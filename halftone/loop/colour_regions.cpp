// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/colour_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "halftone/loop/paper.h"
#include "optics/colour/colour.h"
#include "optics/scene/surface_smoothing.h"

namespace voxtone::halftone {

// Which cells touch: in order of z, y, x, as the cells of a surface lie, a row of one z and y is looked up at once.
class CellNeighbours::Rows {
public:
    explicit Rows(const optics::Surface& surface) : cells_(surface.cells) {
        if (cells_.empty()) return;
        low_ = high_ = {cells_.front().cell[1], cells_.front().cell[2]};
        for (const optics::SurfaceCell& cell : cells_)
            for (std::size_t a = 0; a < 2; ++a)
                low_[a] = std::min(low_[a], cell.cell[a + 1]), high_[a] = std::max(high_[a], cell.cell[a + 1]);
        first_.assign(rows_along_y() * static_cast<std::size_t>(high_[1] - low_[1] + 1) + 1, 0);
        for (const optics::SurfaceCell& cell : cells_) ++first_[row_of(cell.cell[1], cell.cell[2]) + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
    }
    // All cells around one, itself too, that there are; ascending.
    template <class Visit>
    void visit_around(std::size_t at, const Visit& visit) const {
        const auto& [x, y, z] = cells_[at].cell;
        for (int k = std::max(z - 1, low_[1]); k <= std::min(z + 1, high_[1]); ++k)
            for (int j = std::max(y - 1, low_[0]); j <= std::min(y + 1, high_[0]); ++j) {
                const std::size_t row = row_of(j, k);
                const auto end = cells_.begin() + first_[row + 1];
                auto cell = std::lower_bound(cells_.begin() + first_[row], end, x - 1,
                                             [](const optics::SurfaceCell& c, int to) { return c.cell[0] < to; });
                for (; cell != end && cell->cell[0] <= x + 1; ++cell)
                    visit(static_cast<std::size_t>(cell - cells_.begin()));
            }
    }

private:
    [[nodiscard]] std::size_t rows_along_y() const { return static_cast<std::size_t>(high_[0] - low_[0] + 1); }
    [[nodiscard]] std::size_t row_of(int y, int z) const {
        return static_cast<std::size_t>(z - low_[1]) * rows_along_y() + static_cast<std::size_t>(y - low_[0]);
    }
    std::span<const optics::SurfaceCell> cells_;
    std::array<std::int32_t, 2> low_{}, high_{};  // of y and z
    std::vector<std::uint32_t> first_;            // cell of each row, and where the last one ends
};

namespace {

constexpr float step_within = 0.008f, all_within = 0.012f, apart = 0.05f;  // Oklab
constexpr int around_steps = 3;
constexpr double solid_mm2 = 1, least_mm2 = 0.2;
constexpr double rim_mm = 0.6, least_interior = 0.2;

using CellRows = CellNeighbours::Rows;

// A number for each cell of the surface.
using Marks = std::vector<int>;

bool look_alike(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0;
}

std::vector<std::vector<std::uint32_t>> connected_pieces(const optics::Surface& surface, const CellRows& rows,
                                                         const std::vector<Eigen::Vector3f>& oklab) {
    std::vector<char> taken(oklab.size());
    std::vector<std::vector<std::uint32_t>> pieces;
    for (std::size_t first = 0; first < oklab.size(); ++first) {
        if (taken[first]) continue;
        taken[first] = 1;
        std::vector<std::uint32_t>& piece = pieces.emplace_back(1, static_cast<std::uint32_t>(first));
        for (std::size_t next = 0; next < piece.size(); ++next) {
            const std::size_t at = piece[next];
            rows.visit_around(at, [&](std::size_t other) {
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

// Cells of a piece by how many steps they lie from what is not of it: 1 at the border. All of `mark` is 0, before and
// after.
std::vector<int> depths(const CellRows& rows, const std::vector<std::uint32_t>& piece, int most, Marks& mark) {
    for (const std::uint32_t cell : piece) mark[cell] = most;
    std::vector<std::uint32_t> last, next;
    for (const std::uint32_t cell : piece) {
        bool at_border = false;
        rows.visit_around(cell, [&](std::size_t other) { at_border = at_border || mark[other] == 0; });
        if (at_border && most > 1) last.push_back(cell);
    }
    for (const std::uint32_t cell : last) mark[cell] = 1;
    for (int step = 2; step < most; ++step, std::swap(last, next)) {
        next.clear();
        for (const std::uint32_t cell : last)
            rows.visit_around(cell, [&](std::size_t other) {
                if (mark[other] <= step) return;
                mark[other] = step;
                next.push_back(static_cast<std::uint32_t>(other));
            });
    }
    std::vector<int> depth;
    depth.reserve(piece.size());
    for (const std::uint32_t cell : piece) depth.push_back(std::exchange(mark[cell], 0));
    return depth;
}

// What lies within so many steps of `cells` and looks the same way; ascending. All of `mark` is 0, before and after.
std::vector<std::uint32_t> around(const optics::Surface& surface, const CellRows& rows,
                                  const std::vector<std::uint32_t>& cells, int steps, Marks& mark) {
    std::vector<std::uint32_t> found, last = cells, next;
    for (const std::uint32_t cell : cells) mark[cell] = 1;
    for (int step = 0; step < steps; ++step, std::swap(last, next)) {
        next.clear();
        for (const std::uint32_t at : last)
            rows.visit_around(at, [&](std::size_t other) {
                if (mark[other] != 0 || !look_alike(surface.cells[other].normal, surface.cells[at].normal)) return;
                mark[other] = 1;
                next.push_back(static_cast<std::uint32_t>(other));
            });
        found.insert(found.end(), next.begin(), next.end());
    }
    for (const std::uint32_t cell : cells) mark[cell] = 0;
    for (const std::uint32_t cell : found) mark[cell] = 0;
    std::ranges::sort(found);
    return found;
}

// Of a colour of its own, with edges.
bool stands_apart(const optics::Surface& surface, const CellRows& rows, const std::vector<Eigen::Vector3f>& oklab,
                  const std::vector<std::uint32_t>& piece, Marks& mark) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (const std::uint32_t i : piece) mean += oklab[i] / static_cast<float>(piece.size());
    const std::vector<std::uint32_t> others = around(surface, rows, piece, around_steps, mark);
    const auto far = std::ranges::count_if(others, [&](std::uint32_t i) { return (oklab[i] - mean).norm() > apart; });
    return 2 * static_cast<std::size_t>(far) >= others.size();
}

// Nowhere wider than two cells, and of the colours that lie on either side, mixed: the cells that a border runs
// through.
bool is_blurred_edge(const CellRows& rows, std::span<const Eigen::Vector3f> target,
                     const std::vector<std::uint32_t>& piece, Marks& mark) {
    constexpr float off_the_line = 0.1f;  // of the distance between those colours
    if (std::ranges::max(depths(rows, piece, 2, mark)) > 1) return false;
    const auto is_mixed = [&](std::uint32_t cell) {
        Eigen::Vector3f far = Eigen::Vector3f::Zero(), other = far;
        const auto each = [&](const auto& visit) {
            rows.visit_around(cell, [&](std::size_t near) { visit(Eigen::Vector3f(target[near] - target[cell])); });
        };
        each([&](const Eigen::Vector3f& d) { far = d.norm() > far.norm() ? d : far; });
        each([&](const Eigen::Vector3f& d) { other = d.dot(far) < other.dot(far) ? d : other; });
        const Eigen::Vector3f between = far - other;
        const Eigen::Vector3f beside = far - far.dot(between) / between.squaredNorm() * between;
        return other.dot(far) < 0 && beside.norm() < off_the_line * between.norm();
    };
    return 2 * static_cast<std::size_t>(std::ranges::count_if(piece, is_mixed)) >= piece.size();
}

double area_of(const optics::Surface& surface, const std::vector<std::uint32_t>& cells) {
    double area = 0;
    for (const std::uint32_t i : cells) area += static_cast<double>(surface.cells[i].area_mm2);
    return area;
}

ColourRegion region_of(const optics::Surface& surface, const CellRows& rows, std::span<const Eigen::Vector3f> target,
                       RegionKind kind, std::vector<std::uint32_t> cells, Marks& mark) {
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
    const std::vector<int> depth = depths(rows, region.cells, rim + 1, mark);
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
    std::vector<Eigen::Vector3f> oklab(target.size());
    parallel_for(0, oklab.size(), 1024, [&](std::size_t i) {
        oklab[i] = optics::oklab_from_linear_srgb(target[i].cast<double>().cwiseMax(0)).cast<float>();
    });
    const CellRows rows(surface);
    Marks mark(surface.cells.size());
    std::vector<ColourRegion> regions;
    std::vector<Strokes> strokes, thin, papers;
    std::vector<Eigen::Vector3f> solids;
    for (std::vector<std::uint32_t>& piece : connected_pieces(surface, rows, oklab)) {
        std::ranges::sort(piece);
        if (piece.size() < 4 || !stands_apart(surface, rows, oklab, piece, mark)) continue;
        if (paper_weight(target[piece.front()]) > 0.5f) {
            join(papers, oklab[piece.front()], piece);
            continue;
        }
        if (area_of(surface, piece) >= solid_mm2) {
            if (is_blurred_edge(rows, target, piece, mark)) continue;
            solids.push_back(oklab[piece.front()]);
            regions.push_back(region_of(surface, rows, target, RegionKind::solid, std::move(piece), mark));
            continue;
        }
        if (std::ranges::max(depths(rows, piece, 2, mark)) < 2)
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
            regions.push_back(region_of(surface, rows, target, RegionKind::strokes, std::move(s.cells), mark));
    for (Strokes& paper : papers)
        if (area_of(surface, paper.cells) >= solid_mm2)
            regions.push_back(region_of(surface, rows, target, RegionKind::paper, std::move(paper.cells), mark));
    std::ranges::stable_sort(regions, std::greater<>(), &ColourRegion::area_mm2);
    return regions;
}

std::vector<RegionLook> look_at(std::span<const ColourRegion> regions, const optics::Surface& surface,
                                std::span<const Eigen::Vector3f> near_target, std::span<const Eigen::Vector3f> near) {
    const auto lab = [](const Eigen::Vector3d& rgb) { return optics::lab_from_linear_srgb(rgb.cwiseMax(0)); };
    std::vector<RegionLook> looks;
    std::vector<Eigen::Vector3d> difference;
    for (const ColourRegion& region : regions) {
        RegionLook& look = looks.emplace_back();
        difference.resize(region.interior.size());
        parallel_for(0, difference.size(), 1024, [&](std::size_t n) {
            const std::uint32_t i = region.interior[n];
            difference[n] = lab(near[i].cast<double>()) - lab(near_target[i].cast<double>());
        });
        Eigen::Vector3d target = Eigen::Vector3d::Zero(), print = target, mean = target, squares = target;
        double area = 0;
        for (std::size_t n = 0; n < difference.size(); ++n) {
            const std::uint32_t i = region.interior[n];
            const auto a = static_cast<double>(surface.cells[i].area_mm2);
            const Eigen::Vector3d wanted = near_target[i].cast<double>(), shown = near[i].cast<double>();
            const Eigen::Vector3d& off = difference[n];
            area += a, target += a * wanted, print += a * shown;
            mean += a * off, squares += a * off.cwiseProduct(off);
        }
        mean /= area, squares /= area;
        look.lab = lab(print / area);
        look.asked = lab(target / area);
        look.difference = optics::ciede2000(look.asked, look.lab);
        look.unevenness = std::sqrt((squares - mean.cwiseProduct(mean)).cwiseMax(0).sum());
    }
    return looks;
}

CellNeighbours::CellNeighbours(const optics::Surface& surface)
    : surface_(surface), rows_(std::make_unique<const Rows>(surface)) {}
CellNeighbours::~CellNeighbours() = default;

std::vector<std::uint32_t> CellNeighbours::around(const ColourRegion& region, int steps) const {
    Marks mark(surface_.cells.size());
    return halftone::around(surface_, *rows_, region.cells, steps, mark);
}

void CellNeighbours::visit_around(std::size_t cell, BorrowedFunction<std::size_t> visit) const {
    rows_->visit_around(cell, visit);
}

double rim_chroma(const ColourRegion& region, const CellNeighbours& cells, std::span<const Eigen::Vector3f> near_target,
                  std::span<const Eigen::Vector3f> near) {
    const optics::Surface& surface = cells.surface();
    const double edge = std::sqrt(region.area_mm2 / static_cast<double>(region.cells.size()));
    std::vector<std::uint32_t> rim = cells.around(region, std::max(1, static_cast<int>(std::lround(rim_mm / edge))));
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
