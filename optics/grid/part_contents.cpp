// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/part_contents.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "base/random.h"
#include "optics/grid/block_voxels.h"
#include "optics/numerics/share_ladder.h"

namespace voxtone::optics {
namespace {

constexpr int twelfths = 12;

/// How such a number is written: materials ascend.
struct KeyForm {
    unsigned material_bits, amount_bits;
    std::size_t most_materials;
    [[nodiscard]] unsigned bits() const { return material_bits + amount_bits; }
    [[nodiscard]] PartKey most_amount() const { return (PartKey{1} << amount_bits) - 1; }
    [[nodiscard]] Material material(PartKey key) const {
        return static_cast<Material>(key >> amount_bits & ((PartKey{1} << material_bits) - 1));
    }
    [[nodiscard]] int amount(PartKey key) const { return static_cast<int>(key & most_amount()); }
    [[nodiscard]] PartKey one(Material m, PartKey filled) const { return PartKey{m} << amount_bits | filled; }
    [[nodiscard]] PartKey nothing() const { return one(1, 0); }
};
/// A column of voxels has few materials; a voxel that others ran into may have all that are loaded.
constexpr KeyForm of_voxels{8, 8, 4}, of_shares{4, 5, 7};
KeyForm form_of(const ViewingGrid& grid) { return grid.spread.any() && grid.resins < 16 ? of_shares : of_voxels; }

/// More of a material into a part; one too many is left out.
PartKey with(const KeyForm& form, PartKey part, Material m, int filled) {
    std::array<int, of_shares.most_materials> amount{};
    std::array<Material, of_shares.most_materials> material{};
    std::size_t count = 0;
    for (PartKey rest = part; rest != 0; rest >>= form.bits(), ++count) {
        material[count] = form.material(rest);
        amount[count] = form.amount(rest);
    }
    std::size_t place = 0;
    while (place < count && material[place] > m) ++place;
    if (place == count || material[place] != m) {
        if (count == form.most_materials) return part;
        for (std::size_t k = count++; k > place; --k) {
            material[k] = material[k - 1];
            amount[k] = amount[k - 1];
        }
        material[place] = m;
        amount[place] = 0;
    }
    amount[place] = std::min(amount[place] + filled, static_cast<int>(form.most_amount()));
    PartKey more = 0;
    for (std::size_t k = count; k-- > 0;)
        more = more << form.bits() | form.one(material[k], static_cast<PartKey>(amount[k]));
    return more;
}

class PartFiller : BlockVoxels {
public:
    PartFiller(const ViewingGrid& grid, const ResinVolume& volume)
        : BlockVoxels(grid, volume), form_(form_of(grid)), split_(grid.fine.split), part_shares_(grid.resins) {}

    void fill(std::size_t t, PartKey* to) {
        enter_block(t);
        for_each({4, 4, 4}, [&](const Place& cell) {
            const auto place = static_cast<std::uint32_t>(place_in_block(cell));
            if (block_->solid >> place & 1)
                fill_cell(cell, grid_.donors_to(block_->first_cell + place), to);
            else
                for_each(split_, [&](const Place& part) { to[grid_.fine.part(cell, part)] = air_key; });
        });
    }

private:
    /// Each column of voxels across the surface, outermost first, with what a cell beyond gave it, is stretched over
    /// the column of parts: so many parts, or so much of one, to each voxel that light comes to them in their order and
    /// through as much of each as in the print. Where others gave, parts hold the mixture.
    void fill_cell(const Place& cell, std::span<const ViewingGrid::Donor> donors, PartKey* to) {
        bool above = donors.size() <= 1;
        if (donors.size() == 1) {
            const Place& from = donors[0].from;
            for (std::size_t a = 0; a < 3; ++a)
                above &= from[a] - corner_[a] - cell[a] * view_[a] == (a == axis_ ? (plus_ ? view_[a] : -view_[a]) : 0);
            if (above) read_donor(from);
        }
        const bool given = above && !donors.empty();
        Place across = split_;
        across[axis_] = 1;
        for_each(across, [&](Place part) {
            column_.clear();
            column_of_shares_.clear();
            Place in{};
            for (std::size_t a = 0; a < 3; ++a) in[a] = part[a] * view_[a] / split_[a];
            if (given) add_column(donor_, given_, view_, {}, in);
            if (above) add_column(box_, spread_, extent_, cell, in);
            const int parts = split_[axis_];
            for (int depth = 0; depth < parts; ++depth) {
                part[axis_] = plus_ ? parts - 1 - depth : depth;
                to[grid_.fine.part(cell, part)] = !above      ? mixed_key
                                                  : spreads() ? stretched_shares(depth, parts, cell, part)
                                                              : stretched(depth, parts);
            }
        });
    }
    [[nodiscard]] PartKey stretched(int depth, int parts) {
        const int filled = static_cast<int>(column_.size()), whole = twelfths * parts / view_[axis_];  // of one voxel
        PartKey holds = filled > 0 ? 0 : form_.nothing();
        for (int v = 0; v < filled; ++v) {
            const int first = v * parts / filled, end = std::max((v + 1) * parts / filled, first + 1);
            if (depth >= first && depth < end)
                holds = with(form_, holds, column_[static_cast<std::size_t>(v)], whole / (end - first));
        }
        return holds;
    }
    /// The same of voxels that others ran into: twelfths by share_ladder.h.
    [[nodiscard]] PartKey stretched_shares(int depth, int parts, const Place& cell, const Place& part) {
        const int filled = static_cast<int>(column_of_shares_.size());
        if (filled == 0) return form_.nothing();
        std::ranges::fill(part_shares_, 0.0);
        for (int v = 0; v < filled; ++v) {
            const int first = v * parts / filled, end = std::max((v + 1) * parts / filled, first + 1);
            if (depth < first || depth >= end) continue;
            const double whole = static_cast<double>(parts) / view_[axis_] / (end - first);  // of one voxel
            const std::span<const float> holds = column_of_shares_[static_cast<std::size_t>(v)];
            for (std::size_t r = 0; r < part_shares_.size(); ++r)
                part_shares_[r] += whole * static_cast<double>(holds[r]);
        }
        std::uint64_t place = 0;
        for (std::size_t a = 0; a < 3; ++a)
            place = place << 21 | static_cast<std::uint64_t>((corner_[a] + cell[a] * view_[a]) * split_[a] / view_[a] +
                                                             part[a] + (1 << 20));
        const double chance = RandomStream(1, place).uniform();
        PartKey holds = 0;
        climb_ladder(part_shares_, twelfths, chance, [&](std::size_t r, int count) {
            holds = with(form_, holds, static_cast<Material>(r + 1), count);
        });
        return holds;
    }
    void add_column(const std::vector<Material>& box, const SpreadBox& spread, const Place& extent, const Place& cell,
                    Place in) {
        for (int k = 0; k < view_[axis_]; ++k) {
            in[axis_] = plus_ ? view_[axis_] - 1 - k : k;
            const std::size_t voxel =
                at3({cell[0] * view_[0] + in[0], cell[1] * view_[1] + in[1], cell[2] * view_[2] + in[2]}, extent);
            if (spreads()) {
                if (!spread.is_air(voxel)) column_of_shares_.push_back(spread.shares(voxel));
            } else if (box[voxel] != air) {
                column_.push_back(box[voxel]);
            }
        }
    }

    KeyForm form_;
    Place split_;
    std::vector<Material> column_;
    std::vector<std::span<const float>> column_of_shares_;  ///< in its place where resin runs sideways
    std::vector<double> part_shares_;
};

}  // namespace

std::vector<PartKey> part_keys(const ViewingGrid& grid, const ResinVolume& volume,
                               std::span<const std::uint32_t> blocks, const Progress* progress) {
    std::vector<PartKey> keys(blocks.size() * 64 * grid.fine.parts());
    const auto fill_range = [&](std::size_t first, std::size_t last) {
        PartFiller filler(grid, volume);
        for (std::size_t i = first; i < last; ++i) filler.fill(blocks[i], keys.data() + grid.fine.first[blocks[i]]);
    };
    parallel_ranges(0, blocks.size(), 32, fill_range, progress);
    return keys;
}

PartKey whole_key(const ViewingGrid& grid, Material m) { return form_of(grid).one(m, twelfths); }

PartKey empty_key(const ViewingGrid& grid) { return form_of(grid).nothing(); }

Mixture mixture_of_key(const ViewingGrid& grid, PartKey key) {
    const KeyForm form = form_of(grid);
    Mixture content;
    for (PartKey rest = key; rest != 0; rest >>= form.bits())
        content.holds.push_back({form.material(rest), 0, static_cast<float>(form.amount(rest)) / twelfths});
    return content;
}

}  // namespace voxtone::optics
