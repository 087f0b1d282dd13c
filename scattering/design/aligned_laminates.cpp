// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/aligned_laminates.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "base/contracts.h"

namespace voxtone::scattering {

namespace {

using Sequence = std::vector<std::size_t>;  // of materials, counted among those that occur

/// Where a laminate's layers come to lie in the periodic sequence; `place` says where in the period a material stands.
void lay_out(const Sequence& sequence, const Sequence& place, Sequence& at) {
    at.clear();
    std::size_t next = 0;
    for (const std::size_t material : sequence) {
        const std::size_t period = place.size();
        next += (place[material] + period - next % period) % period;
        at.push_back(next++);
    }
}

/// The places of the periodic sequence that some laminate needs, ascending.
Sequence needed_places(const std::set<Sequence>& sequences, const Sequence& place) {
    std::vector<bool> needed;
    Sequence at;
    for (const Sequence& sequence : sequences) {
        lay_out(sequence, place, at);
        if (!at.empty() && at.back() >= needed.size()) needed.resize(at.back() + 1);
        for (const std::size_t layer : at) needed[layer] = true;
    }
    Sequence places;
    for (std::size_t layer = 0; layer < needed.size(); ++layer)
        if (needed[layer]) places.push_back(layer);
    return places;
}

}  // namespace

AlignedLaminates align_laminates(std::span<const std::vector<LaminateLayer>> laminates) {
    std::set<std::size_t> occurring;
    for (const auto& laminate : laminates)
        for (std::size_t l = 0; l < laminate.size(); ++l) {
            VOXTONE_EXPECT(laminate[l].thickness_mm > 0 &&
                           (l == 0 || laminate[l].material != laminate[l - 1].material));
            occurring.insert(laminate[l].material);
        }
    VOXTONE_EXPECT(occurring.size() <= static_cast<std::size_t>(halftone::max_resins));
    const Sequence materials(occurring.begin(), occurring.end());
    std::vector<Sequence> of_laminate;
    for (const auto& laminate : laminates) {
        Sequence& sequence = of_laminate.emplace_back();
        for (const LaminateLayer& layer : laminate)
            sequence.push_back(static_cast<std::size_t>(
                std::lower_bound(materials.begin(), materials.end(), layer.material) - materials.begin()));
    }

    const std::set<Sequence> different(of_laminate.begin(), of_laminate.end());
    Sequence order(materials.size()), place(materials.size()), best_order, best_place, best_needed;
    std::iota(order.begin(), order.end(), std::size_t{0});
    do {
        for (std::size_t p = 0; p < order.size(); ++p) place[order[p]] = p;
        Sequence needed = needed_places(different, place);
        if (!best_order.empty() && needed.size() >= best_needed.size()) continue;
        best_order = order;
        best_place = place;
        best_needed = std::move(needed);
    } while (std::next_permutation(order.begin(), order.end()));

    AlignedLaminates aligned;
    for (const std::size_t layer : best_needed)
        aligned.material.push_back(materials[best_order[layer % best_order.size()]]);
    aligned.thickness_mm.assign(laminates.size() * aligned.layers(), 0);
    Sequence at;
    for (std::size_t s = 0; s < laminates.size(); ++s) {
        lay_out(of_laminate[s], best_place, at);
        for (std::size_t l = 0; l < at.size(); ++l) {
            const auto layer = std::lower_bound(best_needed.begin(), best_needed.end(), at[l]) - best_needed.begin();
            aligned.thickness_mm[s * aligned.layers() + static_cast<std::size_t>(layer)] = laminates[s][l].thickness_mm;
        }
    }
    return aligned;
}

}  // namespace voxtone::scattering
