// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/multigrid.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/grid/lattice.h"
#include "optics/numerics/parallel_sort.h"

namespace voxtone::optics {
namespace {

using Index = std::uint32_t;

using Contact = MultigridPlan::Contact;

/// Rows from an unordered list of contacts; `entry_ab[i]`, `entry_ba[i]`: where contact i went.
void make_rows(std::size_t nodes, std::span<const Contact> contacts, MultigridPlan::Level& level,
               std::vector<Index>& entry_ab, std::vector<Index>& entry_ba) {
    level.row.assign(nodes + 1, 0);
    for (const Contact& c : contacts) {
        ++level.row[c.a + 1];
        ++level.row[c.b + 1];
    }
    for (std::size_t i = 0; i < nodes; ++i) level.row[i + 1] += level.row[i];
    level.column.resize(2 * contacts.size());
    entry_ab.resize(contacts.size());
    entry_ba.resize(contacts.size());
    std::vector<Index> next(level.row.begin(), level.row.end() - 1);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        entry_ab[i] = next[contacts[i].a]++;
        entry_ba[i] = next[contacts[i].b]++;
        level.column[entry_ab[i]] = contacts[i].b;
        level.column[entry_ba[i]] = contacts[i].a;
    }
}

using Centres = std::vector<std::array<float, 3>>;

/// Numbers the parents of a level's nodes, groups of `group` viewing cells along each axis, in the order of z, y, x;
/// their centres are the means of their children's.
Centres group_nodes(const Centres& centre, int group, MultigridPlan::Level& fine) {
    struct Key {
        Place at;  // of the group
        Index node;
        bool operator<(const Key& other) const {
            return std::array{at[2], at[1], at[0]} < std::array{other.at[2], other.at[1], other.at[0]} ||
                   (at == other.at && node < other.node);
        }
    };
    const std::size_t n = centre.size();
    std::vector<Key> keys(n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t a = 0; a < 3; ++a) keys[i].at[a] = static_cast<std::int32_t>(centre[i][a]) / group;
        keys[i].node = static_cast<Index>(i);
    }
    parallel_sort(std::span(keys));
    fine.parent.resize(n);
    Centres coarse;
    std::vector<float> children;
    for (std::size_t i = 0; i < n; ++i) {
        if (i == 0 || keys[i].at != keys[i - 1].at) {
            coarse.push_back({});
            children.push_back(0);
        }
        fine.parent[keys[i].node] = static_cast<Index>(coarse.size() - 1);
        for (std::size_t a = 0; a < 3; ++a) coarse.back()[a] += centre[keys[i].node][a];
        ++children.back();
    }
    for (std::size_t i = 0; i < coarse.size(); ++i)
        for (float& v : coarse[i]) v /= children[i];
    return coarse;
}

/// A contact between parents, and the row entry of the finer level that it comes from.
using Link = std::pair<Contact, Index>;

/// Sorted; of each contact of the finer level one.
std::vector<Link> links_between_parents(const MultigridPlan::Level& fine) {
    std::vector<Link> links;
    for (Index i = 0; i < fine.nodes(); ++i)
        for (Index e = fine.row[i]; e < fine.row[i + 1]; ++e) {
            const Index p = fine.parent[i], q = fine.parent[fine.column[e]];
            if (p < q) links.push_back({{p, q}, e});
        }
    parallel_sort(std::span(links));
    return links;
}

/// Distance between the ends of a finer contact / between those of the coarse one, along the line of centres; 1 at
/// most.
float distance_ratio(const MultigridPlan::Level& fine, const Centres& centre, const Centres& coarse_centre,
                     const Link& link) {
    const auto& [pair, entry] = link;
    const Index j = fine.column[entry];
    const auto i = static_cast<Index>(std::upper_bound(fine.row.begin(), fine.row.end(), entry) - fine.row.begin() - 1);
    double fine_distance = 0, coarse_distance = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        fine_distance += std::pow(centre[i][a] - centre[j][a], 2);
        coarse_distance += std::pow(coarse_centre[pair.a][a] - coarse_centre[pair.b][a], 2);
    }
    return static_cast<float>(std::min(1.0, std::sqrt(fine_distance / coarse_distance)));
}

/// The level of the parents: contacts between them, each once, and where each finer one is gathered. `twin`: the entry
/// of the same contact in the other row.
MultigridPlan::Level coarse_level(const MultigridPlan::Level& fine, const Centres& centre, const Centres& coarse_centre,
                                  std::vector<Index>& twin) {
    const std::vector<Link> links = links_between_parents(fine);
    std::vector<Contact> contacts;
    for (const auto& [pair, entry] : links)
        if (contacts.empty() || contacts.back() != pair) contacts.push_back(pair);
    MultigridPlan::Level level;
    std::vector<Index> ab, ba;
    make_rows(coarse_centre.size(), contacts, level, ab, ba);
    level.gathered.assign(fine.column.size(), MultigridPlan::none);
    level.ratio.assign(fine.column.size(), 0);
    std::size_t at = 0;
    for (const Link& link : links) {
        while (contacts[at] != link.first) ++at;
        level.gathered[link.second] = ab[at];
        level.ratio[link.second] = distance_ratio(fine, centre, coarse_centre, link);
    }
    twin.resize(level.column.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        twin[ab[i]] = ba[i];
        twin[ba[i]] = ab[i];
    }
    return level;
}

}  // namespace

MultigridPlan::MultigridPlan(std::vector<std::array<float, 3>> centre, std::span<const Contact> contacts) {
    levels.emplace_back();
    make_rows(centre.size(), contacts, levels[0], entry_ab, entry_ba);
    // The edge of the groups in viewing cells doubles from level to level: 2, 4 (a block), 8 ...
    for (int group = 2; levels.back().nodes() > 32 && group < 4096; group *= 2) {
        Level& fine = levels.back();
        Centres coarse_centre = group_nodes(centre, group, fine);
        if (coarse_centre.size() == centre.size() && group <= 4) {  // nothing to gather yet
            fine.parent.clear();
            continue;
        }
        std::vector<Index> twin;
        Level next = coarse_level(fine, centre, coarse_centre, twin);
        twins.push_back(std::move(twin));
        levels.push_back(std::move(next));
        centre = std::move(coarse_centre);
    }
}

std::size_t MultigridPlan::memory_bytes() const {
    std::size_t bytes = 8 * entry_ab.size();
    for (const Level& level : levels)
        bytes += 4 * (level.row.size() + level.column.size() + level.parent.size() + level.gathered.size() +
                      level.ratio.size());
    return bytes;
}

Multigrid::Multigrid(const MultigridPlan& plan, std::span<const float> conductance, std::span<const float> loss)
    : plan_(plan), values_(plan.levels.size()), b_(plan.levels.size()), x_(plan.levels.size()) {
    VOXTONE_EXPECT(conductance.size() == plan.entry_ab.size() && loss.size() == plan.levels[0].nodes());
    values_[0].c.resize(plan.levels[0].column.size());
    values_[0].loss.assign(loss.begin(), loss.end());
    for (std::size_t i = 0; i < conductance.size(); ++i)
        values_[0].c[plan.entry_ab[i]] = values_[0].c[plan.entry_ba[i]] = conductance[i];
    for (std::size_t l = 0; l < plan.levels.size(); ++l) {
        const auto& level = plan.levels[l];
        Values& here = values_[l];
        here.inverse.resize(level.nodes());
        for (std::size_t i = 0; i < level.nodes(); ++i) {
            float diagonal = here.loss[i];
            for (Index e = level.row[i]; e < level.row[i + 1]; ++e) diagonal += here.c[e];
            here.inverse[i] = diagonal > 0 ? 1 / diagonal : 0;
        }
        if (l + 1 == plan.levels.size()) break;
        const auto& coarse = plan.levels[l + 1];
        Values& next = values_[l + 1];
        next.c.assign(coarse.column.size(), 0);
        next.loss.assign(coarse.nodes(), 0);
        for (std::size_t i = 0; i < level.nodes(); ++i) next.loss[level.parent[i]] += here.loss[i];
        for (std::size_t e = 0; e < coarse.gathered.size(); ++e)
            if (coarse.gathered[e] != MultigridPlan::none) next.c[coarse.gathered[e]] += here.c[e] * coarse.ratio[e];
        for (std::size_t e = 0; e < next.c.size(); ++e) {
            const Index twin = plan.twins[l][e];
            if (next.c[e] == 0) next.c[e] = next.c[twin];
        }
        b_[l + 1].resize(coarse.nodes());
        x_[l + 1].resize(coarse.nodes());
    }
}

std::size_t Multigrid::memory_bytes() const {
    std::size_t bytes = 0;
    for (const Values& v : values_) bytes += 4 * (v.c.size() + v.inverse.size() + v.loss.size());
    for (std::size_t l = 1; l < b_.size(); ++l) bytes += 4 * (b_[l].size() + x_[l].size());
    return bytes;
}

// x = approximate solution of A x = b, from zero: forward Gauss-Seidel, coarse correction, backward Gauss-Seidel.
void Multigrid::cycle(std::size_t l, std::span<const float> b, std::span<float> x, const Progress* progress) const {
    const auto& level = plan_.levels[l];
    const Values& v = values_[l];
    const std::size_t n = level.nodes();
    const auto relax = [&](std::size_t i) {
        float sum = b[i];
        for (Index e = level.row[i]; e < level.row[i + 1]; ++e) sum += v.c[e] * x[level.column[e]];
        x[i] = sum * v.inverse[i];
    };
    std::fill(x.begin(), x.end(), 0.0f);
    if (l + 1 == plan_.levels.size()) {
        for (int sweep = 0; sweep < 8; ++sweep) {
            for (std::size_t i = 0; i < n; ++i) relax(i);
            for (std::size_t i = n; i-- > 0;) relax(i);
        }
        return;
    }
    for (std::size_t i = 0; i < n; ++i) relax(i);
    if (progress) progress->check_cancelled();
    auto& coarse_b = b_[l + 1];
    auto& coarse_x = x_[l + 1];
    std::fill(coarse_b.begin(), coarse_b.end(), 0.0f);
    for (std::size_t i = 0; i < n; ++i) {
        float r = b[i] - v.loss[i] * x[i];
        for (Index e = level.row[i]; e < level.row[i + 1]; ++e) r -= v.c[e] * (x[i] - x[level.column[e]]);
        coarse_b[level.parent[i]] += r;
    }
    cycle(l + 1, coarse_b, coarse_x, progress);
    for (std::size_t i = 0; i < n; ++i) x[i] += coarse_x[level.parent[i]];
    for (std::size_t i = n; i-- > 0;) relax(i);
}

}  // namespace voxtone::optics
