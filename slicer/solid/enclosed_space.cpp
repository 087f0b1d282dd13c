// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/solid/enclosed_space.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <span>
#include <unordered_map>

#include "base/contracts.h"
#include "base/parallel.h"
#include "slicer/mesh/box.h"
#include "slicer/mesh/disjoint_sets.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/triangle_cell.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

constexpr double most_cells = 1 << 26;
constexpr EnclosedSpace::Label unknown = 255;  // while cells are labelled
constexpr std::size_t most_voids = 250;

// Free cells [begin, end) of a row.
struct FreeRun {
    std::int32_t begin, end;
};

// Rows of cells as runs of those that are not shut, and which of them hang together.
class FreeRuns {
public:
    FreeRuns(const std::vector<bool>& shut, const std::array<int, 3>& size)
        : size_(size), row_begin_(std::size_t(size[1]) * std::size_t(size[2]) + 1) {
        std::size_t at = 0;
        for (std::size_t row = 0; row + 1 < row_begin_.size(); ++row) {
            row_begin_[row] = runs_.size();
            for (int i = 0; i < size[0]; ++i, ++at) {
                if (shut[at]) continue;
                if (i > 0 && !shut[at - 1])
                    runs_.back().end = i + 1;
                else
                    runs_.push_back({i, i + 1});
            }
        }
        row_begin_.back() = runs_.size();
    }
    [[nodiscard]] std::span<const FreeRun> runs() const { return runs_; }
    [[nodiscard]] std::size_t row_begin(std::size_t row) const { return row_begin_[row]; }

    [[nodiscard]] std::vector<std::uint32_t> components() const {
        DisjointSets sets(runs_.size());
        const auto rows = std::size_t(size_[1]);
        for (std::size_t row = 0; row + 1 < row_begin_.size(); ++row) {
            if (row % rows + 1 < rows) unite(sets, row, row + 1);
            if (row + rows + 1 < row_begin_.size()) unite(sets, row, row + rows);
        }
        std::vector<std::uint32_t> component(runs_.size());
        for (std::uint32_t r = 0; r < component.size(); ++r) component[r] = sets.root(r);
        return component;
    }

private:
    void unite(DisjointSets& sets, std::size_t row, std::size_t other) const {
        std::size_t a = row_begin_[row], b = row_begin_[other];
        while (a < row_begin_[row + 1] && b < row_begin_[other + 1]) {
            if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end)
                sets.unite(std::uint32_t(a), std::uint32_t(b));
            runs_[a].end < runs_[b].end ? ++a : ++b;
        }
    }

    std::array<int, 3> size_;
    std::vector<FreeRun> runs_;
    std::vector<std::size_t> row_begin_;
};

}  // namespace

EnclosedSpace::EnclosedSpace(const SolidMesh& solid, const EnclosureOptions& options, const Progress* progress) {
    VOXTONE_EXPECT(options.cell_mm > 0 && options.closing >= 0);
    lay_cells(solid, options);
    mark_surface(solid);
    if (progress) progress->check_cancelled();
    mark_inside(solid);
    const std::vector<bool> shut = closed(options.closing);
    if (progress) progress->check_cancelled();
    label_free(shut, options.smallest_mm3);
    if (options.closing > 0) grow_into(shut, 3 * options.closing);
    std::ranges::replace(label_, unknown, pocket);
}

// With cells all around that are free even of closed walls.
void EnclosedSpace::lay_cells(const SolidMesh& solid, const EnclosureOptions& options) {
    const int margin = options.closing + 2;
    const Eigen::AlignedBox3d box = bounding_box(solid.positions_mm, solid.triangles);
    cell_mm_ = std::max(options.cell_mm, std::cbrt(box.volume() / most_cells));
    for (;; cell_mm_ *= 1.1) {
        double cells = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double across = std::ceil(box.sizes()[axis] / cell_mm_) + 2 * margin;
            cells *= across;
            size_[std::size_t(axis)] = int(across);
        }
        if (cells <= most_cells) break;
    }
    origin_mm_ = box.min() - Vector3d::Constant(margin * cell_mm_);
    label_.assign(index(0, 0, size_[2]), unknown);
}

void EnclosedSpace::mark_surface(const SolidMesh& solid) {
    parallel_for(0, solid.triangles.size(), 256, [&](std::size_t t) {
        const auto& [a, b, c] = solid.triangles[t];
        mark_triangle({(solid.positions_mm[a] - origin_mm_) / cell_mm_, (solid.positions_mm[b] - origin_mm_) / cell_mm_,
                       (solid.positions_mm[c] - origin_mm_) / cell_mm_});
    });
}

// In cells. From any thread: each writes the same.
void EnclosedSpace::mark_triangle(const std::array<Vector3d, 3>& corners) {
    for_each_cell_of_triangle(corners, [&](int i, int j, int k) {
        if (i < 0 || j < 0 || k < 0 || i >= size_[0] || j >= size_[1] || k >= size_[2]) return;
        std::atomic_ref(label_[index(i, j, k)]).store(wall, std::memory_order_relaxed);
    });
}

void EnclosedSpace::mark_inside(const SolidMesh& solid) {
    const Solid cells(solid, {origin_mm_, Vector3d::Constant(cell_mm_), size_});
    constexpr std::size_t layers_at_once = 16;
    const auto layers = std::size_t(size_[2]);
    parallel_for(0, (layers + layers_at_once - 1) / layers_at_once, 1, [&](std::size_t part) {
        const int begin = int(part * layers_at_once), end = int(std::min(layers, (part + 1) * layers_at_once));
        const SpanSlab slab = cells.slab(begin, end);
        for (int k = begin; k < end; ++k)
            for (int j = 0; j < size_[1]; ++j)
                for (const Span& span : slab.row(j, k))
                    std::fill(label_.begin() + std::ptrdiff_t(index(span.begin, j, k)),
                              label_.begin() + std::ptrdiff_t(index(span.end, j, k)), wall);
    });
}

// Walls, each grown into the cube of cells around it. Beyond the cells there are none.
std::vector<bool> EnclosedSpace::closed(int cells) const {
    std::vector<bool> shut(label_.size());
    for (std::size_t c = 0; c < shut.size(); ++c) shut[c] = label_[c] == wall;
    std::array<std::size_t, 3> step{1, std::size_t(size_[0]), std::size_t(size_[0]) * std::size_t(size_[1])};
    for (std::size_t axis = 0; axis < 3 && cells > 0; ++axis) {
        std::vector<bool> grown(shut.size());
        const auto length = std::size_t(size_[axis]);
        for (std::size_t c = 0; c < shut.size(); ++c) {
            if (c / step[axis] % length != 0) continue;  // the first of each line
            std::ptrdiff_t last_wall = -2 * std::ptrdiff_t(length) - cells;
            std::size_t next = 0;
            for (std::size_t n = 0; n < length; ++n) {
                for (; next < length && next <= n + std::size_t(cells); ++next)
                    if (shut[c + next * step[axis]]) last_wall = std::ptrdiff_t(next);
                grown[c + n * step[axis]] = std::ptrdiff_t(n) - last_wall <= cells;
            }
        }
        shut = std::move(grown);
    }
    return shut;
}

// Cells that are not shut: outside, voids by their size, pockets.
void EnclosedSpace::label_free(const std::vector<bool>& shut, double smallest_mm3) {
    const FreeRuns free(shut, size_);
    const std::vector<std::uint32_t> component = free.components();
    struct Extent {
        std::uint32_t component = 0;
        double cells = 0, longest = 0;
        Vector3d sum = Vector3d::Zero(), inside = Vector3d::Zero();
    };
    std::vector<Extent> extents(component.size());
    for (std::size_t row = 0, r = 0; r < component.size(); ++row)
        for (; r < free.row_begin(row + 1); ++r) {
            const FreeRun& run = free.runs()[r];
            const double n = run.end - run.begin;
            Extent& extent = extents[component[r]];
            extent.component = component[r];
            const Vector3d middle(0.5 * (run.begin + run.end), double(row % std::size_t(size_[1])) + 0.5,
                                  double(row / std::size_t(size_[1])) + 0.5);
            extent.cells += n;
            extent.sum += n * middle;
            if (n > extent.longest) extent.longest = n, extent.inside = middle;
        }
    std::vector<Label> label_of(component.size(), unknown);
    const std::uint32_t around = component.empty() ? 0 : component[0];  // the first cell is a corner, and free
    std::erase_if(extents, [&](const Extent& e) {
        return e.component == around || e.cells * std::pow(cell_mm_, 3) < smallest_mm3 || e.cells < 1;
    });
    std::ranges::stable_sort(extents, std::greater{}, &Extent::cells);
    extents.resize(std::min(extents.size(), most_voids));
    for (std::size_t n = 0; n < extents.size(); ++n) {
        label_of[extents[n].component] = Label(first_void + n);
        voids_.push_back({extents[n].cells * std::pow(cell_mm_, 3), origin_mm_ + cell_mm_ * extents[n].inside,
                          origin_mm_ + cell_mm_ * extents[n].sum / extents[n].cells});
    }
    if (!component.empty()) label_of[around] = outside;
    for (std::size_t row = 0, r = 0; r < component.size(); ++row)
        for (; r < free.row_begin(row + 1); ++r) {
            const auto at = label_.begin() + std::ptrdiff_t(row * std::size_t(size_[0]));
            std::fill(at + free.runs()[r].begin, at + free.runs()[r].end, label_of[component[r]]);
        }
}

// Into free cells that the closing shut, step by step, outside first.
void EnclosedSpace::grow_into(const std::vector<bool>& shut, int steps) {
    const std::array<std::ptrdiff_t, 3> step{1, size_[0], std::ptrdiff_t(size_[0]) * size_[1]};
    std::vector<std::uint32_t> front, next;
    const auto labelled = [](Label l) { return l != wall && l != unknown; };
    for (std::uint32_t c = 0; c < label_.size(); ++c)
        if (!shut[c] && labelled(label_[c])) front.push_back(c);
    std::ranges::stable_partition(front, [&](std::uint32_t c) { return label_[c] == outside; });
    for (int n = 0; n < steps && !front.empty(); ++n) {
        next.clear();
        for (const std::uint32_t c : front)
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (const std::ptrdiff_t way : {-step[axis], step[axis]}) {
                    const std::ptrdiff_t to = std::ptrdiff_t(c) + way;
                    if (to < 0 || to >= std::ptrdiff_t(label_.size()) || label_[std::size_t(to)] != unknown) continue;
                    label_[std::size_t(to)] = label_[c];
                    next.push_back(std::uint32_t(to));
                }
        std::swap(front, next);
        std::ranges::stable_partition(front, [&](std::uint32_t c) { return label_[c] == outside; });
    }
}

std::vector<bool> EnclosedSpace::with_walls(Label of_void) const {
    std::vector<bool> taken(label_.size());
    for (int k = 1; k + 1 < size_[2]; ++k)
        for (int j = 1; j + 1 < size_[1]; ++j)
            for (int i = 1; i + 1 < size_[0]; ++i) {
                if (label_[index(i, j, k)] != of_void) continue;
                for (int c = k - 1; c <= k + 1; ++c)
                    for (int b = j - 1; b <= j + 1; ++b)
                        for (int a = i - 1; a <= i + 1; ++a) {
                            const Label beside = label_[index(a, b, c)];
                            if (beside == of_void || beside == wall) taken[index(a, b, c)] = true;
                        }
            }
    return taken;
}

SolidMesh EnclosedSpace::plug(Label of_void) const {
    const std::vector<bool> taken = with_walls(of_void);
    SolidMesh mesh;
    std::unordered_map<std::size_t, std::uint32_t> number;
    const auto corner = [&](const std::array<int, 3>& at) {
        const auto [known, is_new] = number.emplace(index(at[0], at[1], at[2]), mesh.positions_mm.size());
        if (is_new) mesh.positions_mm.emplace_back(origin_mm_ + cell_mm_ * Vector3d(at[0], at[1], at[2]));
        return known->second;
    };
    // The face of a cell towards +axis or -axis, seen from there.
    const auto add_face = [&](const std::array<int, 3>& cell, std::size_t axis, bool up) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        std::array<std::uint32_t, 4> ring{};
        for (int c = 0; c < 4; ++c) {
            std::array<int, 3> at = cell;
            at[axis] += up;
            at[u] += c == 1 || c == 2;
            at[v] += c >= 2;
            ring[std::size_t(c)] = corner(at);
        }
        if (!up) std::swap(ring[1], ring[3]);
        mesh.triangles.push_back({ring[0], ring[1], ring[2]});
        mesh.triangles.push_back({ring[0], ring[2], ring[3]});
    };
    for (int k = 0; k < size_[2]; ++k)
        for (int j = 0; j < size_[1]; ++j)
            for (int i = 0; i < size_[0]; ++i) {
                if (!taken[index(i, j, k)]) continue;
                for (std::size_t axis = 0; axis < 3; ++axis)
                    for (const bool up : {false, true}) {
                        std::array<int, 3> beside{i, j, k};
                        beside[axis] += up ? 1 : -1;
                        if (!taken[index(beside[0], beside[1], beside[2])]) add_face({i, j, k}, axis, up);
                    }
            }
    mesh.source_triangle.assign(mesh.triangles.size(), -1);
    return mesh;
}

EnclosedSpace::Label EnclosedSpace::at(const Vector3d& p) const {
    const Vector3d cell = ((p - origin_mm_) / cell_mm_).array().floor();
    for (int axis = 0; axis < 3; ++axis)
        if (!(cell[axis] >= 0 && cell[axis] < size_[std::size_t(axis)])) return outside;
    return label_[index(int(cell[0]), int(cell[1]), int(cell[2]))];
}

}  // namespace voxtone::slicer
