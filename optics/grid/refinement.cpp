// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/grid/part_contents.h"

namespace voxtone::optics {
namespace {

/// Numbers what parts hold: whole resins first, the rest in the order in which it is met.
class ContentNumbers {
public:
    ContentNumbers(ViewingGrid& grid, std::size_t most)
        : grid_(grid), contents_(grid.fine.contents), most_(most), of_mixture_(grid.mixtures.size(), 0) {
        contents_.assign(1, {});
        (void)of_key(empty_key(grid));
        for (const Mixture& mixture : grid.mixtures)
            for (const auto& hold : mixture.holds) (void)of_key(whole_key(grid, hold.material));
    }
    [[nodiscard]] std::uint16_t of_key(PartKey key) {
        if (key == air_key) return 0;
        if (const auto found = of_key_.find(key); found != of_key_.end()) return found->second;
        Mixture content = mixture_of_key(grid_, key);
        const Material some = content.holds.back().material;
        const std::uint16_t number = add(std::move(content), some);
        of_key_.emplace(key, number);
        return number;
    }
    [[nodiscard]] std::uint16_t of_mixture(std::uint16_t mixture) {
        std::uint16_t& number = of_mixture_[mixture];
        if (number == 0) number = add(grid_.mixtures[mixture], grid_.mixtures[mixture].holds.front().material);
        return number;
    }

private:
    /// Where there are more than can be numbered a part is taken to be full of one of its resins.
    [[nodiscard]] std::uint16_t add(Mixture content, Material some) {
        if (contents_.size() >= most_) {
            const auto whole = of_key_.find(whole_key(grid_, some));
            return whole == of_key_.end() ? std::uint16_t{1} : whole->second;
        }
        contents_.push_back(std::move(content));
        return static_cast<std::uint16_t>(contents_.size() - 1);
    }

    const ViewingGrid& grid_;
    std::vector<Mixture>& contents_;
    std::size_t most_;
    std::unordered_map<PartKey, std::uint16_t> of_key_;
    std::vector<std::uint16_t> of_mixture_;
};

void number_contents(ViewingGrid& grid, const std::vector<PartKey>& keys, std::size_t most) {
    FineBlocks& fine = grid.fine;
    ContentNumbers numbers(grid, most);
    PartKey last = 0;
    std::uint16_t number = 0;
    for (std::size_t t = 0; t < fine.first.size(); ++t) {
        if (fine.first[t] == not_fine) continue;
        for_each({4, 4, 4}, [&](const Place& cell) {
            const std::uint16_t mixture = grid.medium[64 * t + place_in_block(cell)];
            for_each(fine.split, [&](const Place& part) {
                const std::size_t i = fine.first[t] + fine.part(cell, part);
                if (keys[i] == mixed_key) {
                    fine.medium[i] = numbers.of_mixture(mixture);
                    return;
                }
                if (keys[i] != last) number = numbers.of_key(last = keys[i]);
                fine.medium[i] = number;
            });
        });
    }
}

/// How many of eight eighths of a part's faces lead to another resin, by area; faces to air and out of the block do not
/// count.
class PartsApart {
public:
    explicit PartsApart(const ViewingGrid& grid) : fine_(grid.fine), material_(fine_.contents.size(), air) {
        const std::array<double, 3> edge = grid.edge_mm();
        for (std::size_t a = 0; a < 3; ++a) {
            size_[a] = 4 * fine_.split[a];
            area_[a] = fine_.split[a] / edge[a];  // of the two faces across a, per volume
        }
        for (std::size_t c = 1; c < fine_.contents.size(); ++c)
            if (const auto& holds = fine_.contents[c].holds; holds.size() == 1) material_[c] = holds[0].material;
    }
    /// Of part `at` of a block whose parts begin at `first`.
    [[nodiscard]] int eighths(std::uint32_t first, const Place& at) const {
        const std::uint16_t* const medium = fine_.medium.data() + first;
        const std::uint16_t own = medium[at3(at, size_)];
        if (material_[own] == air) return 0;
        double known = 0, others = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (const int step : {-1, 1}) {
                Place beside = at;
                beside[a] += step;
                if (beside[a] < 0 || beside[a] >= size_[a]) continue;
                const std::uint16_t other = medium[at3(beside, size_)];
                if (other == 0) continue;
                known += area_[a];
                if (material_[other] != material_[own]) others += area_[a];
            }
        return known > 0 ? static_cast<int>(steps * others / known + 0.5) : 0;
    }
    static constexpr int steps = 8;

private:
    const FineBlocks& fine_;
    std::vector<Material> material_;  ///< of contents of one resin; air of others
    Place size_{};
    std::array<double, 3> area_{};
};

/// Parts of one resin are told apart by how much of others lies beside them (transport_sweep.h), as far as there are
/// numbers.
void tell_apart(ViewingGrid& grid, std::span<const std::uint32_t> chosen, std::size_t most) {
    FineBlocks& fine = grid.fine;
    std::vector<std::uint8_t> eighths(fine.medium.size());
    const PartsApart apart(grid);
    parallel_for(0, chosen.size(), 32, [&](std::size_t i) {
        const std::uint32_t first = fine.first[chosen[i]];
        std::size_t part = first;
        for_each({4 * fine.split[0], 4 * fine.split[1], 4 * fine.split[2]},
                 [&](const Place& at) { eighths[part++] = static_cast<std::uint8_t>(apart.eighths(first, at)); });
    });
    constexpr std::size_t levels = PartsApart::steps + 1;
    std::vector<std::uint16_t> variant(levels * fine.contents.size());
    for (std::size_t i = 0; i < eighths.size(); ++i) {
        if (eighths[i] == 0) continue;
        std::uint16_t& number = variant[levels * fine.medium[i] + eighths[i]];
        if (number == 0 && fine.contents.size() < most) {
            number = static_cast<std::uint16_t>(fine.contents.size());
            fine.contents.push_back(fine.contents[fine.medium[i]]);
            fine.contents.back().apart = static_cast<float>(eighths[i]) / PartsApart::steps;
        }
        if (number != 0) fine.medium[i] = number;
    }
}

}  // namespace

std::array<int, 3> parts_of_cell(const std::array<int, 3>& view_voxels, const std::array<double, 3>& pitch_mm) {
    std::array<int, 3> parts = view_voxels;
    for (std::size_t a = 0; a < 3; ++a)
        parts[a] *= std::clamp(static_cast<int>(std::ceil(pitch_mm[a] / finest_part_mm - 0.1)), 1, 4);
    return parts;
}

void refine(ViewingGrid& grid, const ResinVolume& volume, std::span<const std::uint32_t> chosen,
            const std::array<int, 3>& split, const Progress* progress, std::size_t most_contents) {
    FineBlocks& fine = grid.fine;
    fine = {};
    if (chosen.empty()) return;
    fine.split = split;
    fine.first.assign(grid.transport_blocks.size(), not_fine);
    const std::size_t parts = 64 * fine.parts();
    VOXTONE_EXPECT(chosen.size() * parts < not_fine);
    for (std::size_t i = 0; i < chosen.size(); ++i) fine.first[chosen[i]] = static_cast<std::uint32_t>(i * parts);
    fine.medium.resize(chosen.size() * parts);
    number_contents(grid, part_keys(grid, volume, chosen, progress), most_contents);
    tell_apart(grid, chosen, most_contents);
}

}  // namespace voxtone::optics
