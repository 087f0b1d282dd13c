// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/parallel.h"
#include "slicer/mesh/triangle_tree.h"
#include "slicer/mesh/work_budget.h"

namespace voxtone::slicer {

using Eigen::Vector3d;

namespace {

// Triangles joined through edges of exactly two faces, and which of them must be turned to agree with each other.
struct Patches {
    std::vector<std::uint32_t> of_triangle;
    std::vector<std::uint8_t> turned;  // per triangle: against the larger half of its patch
    std::uint32_t count = 0;
};

// Neighbours through edges of exactly two faces; `same` where both run the edge the same way.
struct Link {
    std::uint32_t from, to;
    bool same;
};

std::vector<Link> find_links(std::span<const EdgeUse> uses) {
    std::vector<Link> links;
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) return;
        const bool same = edge[0].sign == edge[1].sign;
        links.push_back({edge[0].triangle, edge[1].triangle, same});
        links.push_back({edge[1].triangle, edge[0].triangle, same});
    });
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.from < b.from; });
    return links;
}

Patches find_patches(std::size_t triangles, std::span<const EdgeUse> uses) {
    const std::vector<Link> links = find_links(uses);
    std::vector<std::size_t> first(triangles + 1, 0);
    for (const Link& l : links) ++first[l.from + 1];
    for (std::size_t t = 0; t < triangles; ++t) first[t + 1] += first[t];

    Patches patches{std::vector<std::uint32_t>(triangles), std::vector<std::uint8_t>(triangles)};
    std::vector<bool> reached(triangles, false);
    std::vector<std::uint32_t> queue;
    for (std::uint32_t seed = 0; seed < triangles; ++seed) {
        if (reached[seed]) continue;
        queue.assign(1, seed);
        reached[seed] = true;
        std::size_t turned = 0;
        for (std::size_t n = 0; n < queue.size(); ++n) {
            const std::uint32_t t = queue[n];
            patches.of_triangle[t] = patches.count;
            turned += patches.turned[t];
            for (std::size_t l = first[t]; l < first[t + 1]; ++l) {
                const std::uint32_t to = links[l].to;
                if (reached[to]) continue;
                reached[to] = true;
                patches.turned[to] = bool(patches.turned[t]) != links[l].same;
                queue.push_back(to);
            }
        }
        if (2 * turned > queue.size())
            for (const std::uint32_t t : queue) patches.turned[t] = !patches.turned[t];
        ++patches.count;
    }
    return patches;
}

// An edge where more than two faces meet, as the sum over its patches.
struct Junction {
    std::map<std::uint32_t, int> sum_of_patch;
    int sum = 0;
};

// Which patches to turn as a whole: each while that closes more at the junctions than it opens.
std::vector<bool> close_junctions(const Patches& patches, std::span<const EdgeUse> uses) {
    std::vector<Junction> junctions;
    std::map<std::uint32_t, std::vector<std::size_t>> junctions_of_patch;
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
        if (edge.size() <= 2) return;
        Junction junction;
        for (const EdgeUse& u : edge)
            junction.sum_of_patch[patches.of_triangle[u.triangle]] += patches.turned[u.triangle] ? -u.sign : u.sign;
        for (const auto& [p, n] : junction.sum_of_patch) {
            junction.sum += n;
            if (n != 0) junctions_of_patch[p].push_back(junctions.size());
        }
        junctions.push_back(std::move(junction));
    });
    std::vector<bool> turn(patches.count, false);
    for (int round = 0; round < 20; ++round) {
        bool changed = false;
        for (const auto& [p, edges] : junctions_of_patch) {
            long gain = 0;
            for (const std::size_t j : edges)
                gain += std::abs(junctions[j].sum) - std::abs(junctions[j].sum - 2 * junctions[j].sum_of_patch[p]);
            if (gain <= 0) continue;
            for (const std::size_t j : edges) {
                int& mine = junctions[j].sum_of_patch[p];
                junctions[j].sum -= 2 * mine;
                mine = -mine;
            }
            turn[p] = !turn[p];
            changed = true;
        }
        if (!changed) break;
    }
    return turn;
}

struct Shell {
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> ids;
    double volume = 0;
    Eigen::AlignedBox3d box;
};

std::vector<Shell> take_apart(std::span<const Vector3d> positions, std::span<const Triangle> triangles,
                              const Shells& shells) {
    std::vector<Shell> apart(shells.count);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        Shell& s = apart[shells.of_triangle[t]];
        s.triangles.push_back(triangles[t]);
        s.ids.push_back(t);
        for (const std::uint32_t v : triangles[t]) s.box.extend(positions[v]);
    }
    for (Shell& s : apart) {
        const Vector3d& low = s.box.min();  // about the shell's own corner, lest a far shell lose digits
        for (const Triangle& t : s.triangles)
            s.volume += (positions[t[0]] - low).dot((positions[t[1]] - low).cross(positions[t[2]] - low)) / 6;
    }
    return apart;
}

// Which shells lie inside which. Only those whose boxes hold another's are looked at, through a tree over the boxes.
class ShellNesting {
public:
    ShellNesting(std::span<const Vector3d> positions, std::span<const Shell> shells, WorkBudget& work)
        : positions_(positions), shells_(shells), work_(work), tree_(corners_of_boxes(shells), diagonals(shells)) {}

    /// Whether a lies inside one of the shells that `counts` says.
    template <class Counts>
    [[nodiscard]] bool lies_inside_any(std::size_t a, Counts&& counts) const {
        std::vector<std::uint32_t> near;
        tree_.overlapping(shells_[a].box.min(), shells_[a].box.max(), near);
        work_.spend(near.size() + 1);
        return std::any_of(near.begin(), near.end(),
                           [&](std::uint32_t b) { return b != a && counts(b) && lies_inside(shells_[a], shells_[b]); });
    }

private:
    /// The boxes as triangles from corner to corner, which is all of them that a tree looks at here.
    std::span<const Vector3d> corners_of_boxes(std::span<const Shell> shells) {
        for (const Shell& s : shells) {
            corners_.push_back(s.box.min());
            corners_.push_back(s.box.max());
        }
        return corners_;
    }
    std::span<const Triangle> diagonals(std::span<const Shell> shells) {
        for (std::uint32_t s = 0; s < shells.size(); ++s) diagonals_.push_back({2 * s, 2 * s + 1, 2 * s + 1});
        return diagonals_;
    }

    /// a lies inside b when b winds around points of a that are not on b.
    bool lies_inside(const Shell& a, const Shell& b) const {
        if (std::abs(b.volume) <= std::abs(a.volume) || !b.box.contains(a.box)) return false;
        const std::size_t samples = std::min<std::size_t>(a.triangles.size(), 5);
        for (std::size_t n = 0; n < samples; ++n) {
            const Triangle& t = a.triangles[n * a.triangles.size() / samples];
            const Vector3d p = (positions_[t[0]] + positions_[t[1]] + positions_[t[2]]) / 3;
            work_.spend(4 * b.triangles.size());
            if (std::abs(std::lround(winding_number(positions_, b.triangles, p))) == 0) return false;
        }
        return true;
    }

    std::span<const Vector3d> positions_;
    std::span<const Shell> shells_;
    WorkBudget& work_;
    std::vector<Vector3d> corners_;
    std::vector<Triangle> diagonals_;
    TriangleTree tree_;
};

/// Shells of negative volume that are no cavities, and what was drawn inside out with them.
std::vector<std::uint8_t> shells_to_turn(std::span<const Vector3d> positions, std::span<const Shell> shells,
                                         WorkBudget& work) {
    std::vector<std::uint8_t> turn(shells.size(), 0);
    const auto is_negative = [](const Shell& s) { return s.volume < 0; };
    if (std::none_of(shells.begin(), shells.end(), is_negative)) return turn;
    const ShellNesting nesting(positions, shells, work);
    parallel_for(0, shells.size(), 16, [&](std::size_t a) {
        turn[a] = is_negative(shells[a]) && !nesting.lies_inside_any(a, [](std::size_t) { return true; });
    });
    if (std::find(turn.begin(), turn.end(), 1) == turn.end()) return turn;
    std::vector<std::uint8_t> with_it(shells.size(), 0);
    parallel_for(0, shells.size(), 16, [&](std::size_t b) {
        with_it[b] = turn[b] || nesting.lies_inside_any(b, [&](std::size_t a) { return turn[a] != 0; });
    });
    return with_it;
}

}  // namespace

std::size_t orient_consistently(std::span<Triangle> triangles) {
    const std::vector<EdgeUse> uses = edge_uses(triangles);
    const Patches patches = find_patches(triangles.size(), uses);
    const std::vector<bool> turn_patch = close_junctions(patches, uses);
    std::size_t turned = 0;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (bool(patches.turned[t]) == turn_patch[patches.of_triangle[t]]) continue;
        std::swap(triangles[t][1], triangles[t][2]);
        ++turned;
    }
    return turned;
}

ShellTurns orient_outward(std::span<const Vector3d> positions, std::span<Triangle> triangles, const Shells& shells,
                          const Progress* progress, std::uint64_t most_steps) {
    const std::vector<Shell> shell = take_apart(positions, triangles, shells);
    WorkBudget work(most_steps ? most_steps : WorkBudget::for_triangles(triangles.size()), progress);
    std::vector<std::uint8_t> turn;
    try {
        turn = shells_to_turn(positions, shell, work);
    } catch (const WorkExceeded&) {
        throw InputError(fmt::format(
            "the model's {} shells lie inside one another so often that it cannot be told which of them are "
            "cavities; unite them in a mesh editor (boolean union)",
            shell.size()));
    }
    ShellTurns result;
    result.turned_triangle.assign(triangles.size(), 0);
    for (std::size_t a = 0; a < shell.size(); ++a) {
        result.cavities += turn[a] ? shell[a].volume > 0 : shell[a].volume < 0;
        if (!turn[a]) continue;
        ++result.turned;
        for (const std::uint32_t t : shell[a].ids) {
            std::swap(triangles[t][1], triangles[t][2]);
            result.turned_triangle[t] = 1;
        }
    }
    return result;
}

}  // namespace voxtone::slicer
