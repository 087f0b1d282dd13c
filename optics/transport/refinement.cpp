// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/media/mirrored_box.h"
#include "voxtone/optics/transport/lattice.h"
#include "voxtone/optics/transport/transport_sweep.h"

namespace voxtone::optics {
namespace {

/// What a part holds, in one number: up to four materials, ascending, each with the twelfths of the part that it
/// fills; or that the mixture of the cell stands for it.
using Key = std::uint64_t;
constexpr Key mixed = ~Key{0}, nothing = Key{1} << 8;
constexpr int twelfths = 12;
constexpr std::size_t most_materials = 4;

/// More of a material into a part; a fifth one is left out.
Key with(Key part, Material m, int filled) {
    std::array<int, most_materials> amount{};
    std::array<Material, most_materials> material{};
    std::size_t count = 0;
    for (Key rest = part; rest != 0; rest >>= 16, ++count) {
        material[count] = static_cast<Material>(rest >> 8 & 255);
        amount[count] = static_cast<int>(rest & 255);
    }
    std::size_t place = 0;
    while (place < count && material[place] > m) ++place;
    if (place == count || material[place] != m) {
        if (count == most_materials) return part;
        for (std::size_t k = count++; k > place; --k) {
            material[k] = material[k - 1];
            amount[k] = amount[k - 1];
        }
        material[place] = m;
        amount[place] = 0;
    }
    amount[place] = std::min(amount[place] + filled, 255);
    Key more = 0;
    for (std::size_t k = count; k-- > 0;) more = more << 16 | Key{material[k]} << 8 | static_cast<Key>(amount[k]);
    return more;
}

class BlockFiller {
public:
    BlockFiller(const ViewingGrid& viewing, const ResinVolume& volume)
        : viewing_(viewing), volume_(volume), view_(viewing.grid.view_voxels), split_(viewing.fine.split) {
        for (std::size_t a = 0; a < 3; ++a) extent_[a] = 4 * view_[a];
    }

    void fill(std::size_t t, Key* to) {
        const OpticalGrid& grid = viewing_.grid;
        const GridBlock& block = grid.blocks[grid.transport_blocks[t]];
        corner_ = viewing_.corner_of(block);
        axis_ = viewing_.towards[t] / 2;
        plus_ = viewing_.towards[t] % 2 == 1;
        read_box(volume_, viewing_.mirrored, corner_, extent_, box_);
        std::uint32_t donor = viewing_.donors_of[t];
        const std::uint32_t end = viewing_.donors_of[t + 1];
        for_each({4, 4, 4}, [&](const Place& cell) {
            const std::size_t place = place_in_block(cell[0], cell[1], cell[2]);
            if (!(block.solid >> place & 1)) {
                each_part(cell, [&](const Place&, std::size_t i) { to[i] = 0; });
                return;
            }
            const std::uint32_t first = donor;
            while (donor < end && viewing_.donors[donor].to == block.first_cell + place) ++donor;
            fill_cell(cell, first, donor, to);
        });
    }

private:
    template <class Body>
    void each_part(const Place& cell, Body&& body) const {
        for_each(split_, [&](const Place& part) { body(part, viewing_.fine.part(cell, part)); });
    }

    /// Each column of voxels across the surface, outermost first, with what a cell beyond gave it, is stretched over
    /// the column of parts: so many parts, or so much of one, to each voxel that light comes to them in their order and
    /// through as much of each as in the print. Where others gave, parts hold the mixture.
    void fill_cell(const Place& cell, std::uint32_t first_donor, std::uint32_t end_donor, Key* to) {
        bool above = end_donor - first_donor <= 1;
        if (above && first_donor < end_donor) {
            const Place& from = viewing_.donors[first_donor].from;
            for (std::size_t a = 0; a < 3; ++a)
                above &= from[a] - corner_[a] - cell[a] * view_[a] == (a == axis_ ? (plus_ ? view_[a] : -view_[a]) : 0);
            if (above) read_box(volume_, viewing_.mirrored, from, view_, donor_);
        }
        const bool given = above && first_donor < end_donor;
        Place across = split_;
        across[axis_] = 1;
        for_each(across, [&](Place part) {
            column_.clear();
            Place in{};
            for (std::size_t a = 0; a < 3; ++a) in[a] = part[a] * view_[a] / split_[a];
            if (above && given) add_column(donor_, view_, {}, in);
            if (above) add_column(box_, extent_, {cell[0] * view_[0], cell[1] * view_[1], cell[2] * view_[2]}, in);
            const int parts = split_[axis_];
            for (int depth = 0; depth < parts; ++depth) {
                part[axis_] = plus_ ? parts - 1 - depth : depth;
                to[viewing_.fine.part(cell, part)] = above ? stretched(depth, parts) : mixed;
            }
        });
    }
    [[nodiscard]] Key stretched(int depth, int parts) {
        const int filled = static_cast<int>(column_.size()), whole = twelfths * parts / view_[axis_];  // of one voxel
        Key holds = filled > 0 ? 0 : nothing;
        for (int v = 0; v < filled; ++v) {
            const int first = v * parts / filled, end = std::max((v + 1) * parts / filled, first + 1);
            if (depth >= first && depth < end)
                holds = with(holds, column_[static_cast<std::size_t>(v)], whole / (end - first));
        }
        return holds;
    }
    void add_column(const std::vector<Material>& box, const Place& extent, const Place& corner, Place in) {
        for (int k = 0; k < view_[axis_]; ++k) {
            in[axis_] = plus_ ? view_[axis_] - 1 - k : k;
            const Material m = box[at3({corner[0] + in[0], corner[1] + in[1], corner[2] + in[2]}, extent)];
            if (m != air) column_.push_back(m);
        }
    }

    const ViewingGrid& viewing_;
    const ResinVolume& volume_;
    Place view_, split_, extent_{}, corner_{};
    std::size_t axis_ = 2;
    bool plus_ = true;
    std::vector<Material> box_, donor_, column_;
};

/// Numbers what parts hold: whole resins first, the rest in the order in which it is met.
class ContentNumbers {
public:
    ContentNumbers(ViewingGrid& viewing, std::size_t most)
        : viewing_(viewing), contents_(viewing.fine.contents), most_(most), of_mixture_(viewing.mixtures.size(), 0) {
        contents_.assign(1, {});
        (void)of_key(nothing);
        for (const ViewingGrid::Mixture& mixture : viewing.mixtures)
            for (const auto& hold : mixture.holds) (void)of_key(key_of_one(hold.material));
    }
    [[nodiscard]] std::uint16_t of_key(Key key) {
        if (key == 0) return 0;
        if (const auto found = of_key_.find(key); found != of_key_.end()) return found->second;
        ViewingGrid::Fine::Content content;
        for (Key rest = key; rest != 0; rest >>= 16)
            content.holds.emplace_back(static_cast<Material>(rest >> 8 & 255),
                                       static_cast<float>(rest & 255) / twelfths);
        const Material some = content.holds.back().first;
        const std::uint16_t number = add(std::move(content), some);
        of_key_.emplace(key, number);
        return number;
    }
    [[nodiscard]] std::uint16_t of_mixture(std::uint16_t mixture) {
        std::uint16_t& number = of_mixture_[mixture];
        if (number == 0) number = add({{}, mixture}, viewing_.mixtures[mixture].holds.front().material);
        return number;
    }

private:
    [[nodiscard]] static Key key_of_one(Material m) { return Key{m} << 8 | Key{twelfths}; }
    /// Where there are more than can be numbered a part is taken to be full of one of its resins.
    [[nodiscard]] std::uint16_t add(ViewingGrid::Fine::Content content, Material some) {
        if (contents_.size() >= most_) {
            const auto whole = of_key_.find(key_of_one(some));
            return whole == of_key_.end() ? std::uint16_t{1} : whole->second;
        }
        contents_.push_back(std::move(content));
        return static_cast<std::uint16_t>(contents_.size() - 1);
    }

    const ViewingGrid& viewing_;
    std::vector<ViewingGrid::Fine::Content>& contents_;
    std::size_t most_;
    std::unordered_map<Key, std::uint16_t> of_key_;
    std::vector<std::uint16_t> of_mixture_;
};

void number_contents(ViewingGrid& viewing, const std::vector<Key>& keys, std::size_t most) {
    ViewingGrid::Fine& fine = viewing.fine;
    ContentNumbers numbers(viewing, most);
    Key last = 0;
    std::uint16_t number = 0;
    for (std::size_t t = 0; t < fine.first.size(); ++t) {
        if (fine.first[t] == not_fine) continue;
        for_each({4, 4, 4}, [&](const Place& cell) {
            const std::uint16_t mixture = viewing.grid.medium[64 * t + place_in_block(cell[0], cell[1], cell[2])];
            for_each(fine.split, [&](const Place& part) {
                const std::size_t i = fine.first[t] + fine.part(cell, part);
                if (keys[i] == mixed) {
                    fine.medium[i] = numbers.of_mixture(mixture);
                    return;
                }
                if (keys[i] != last) number = numbers.of_key(last = keys[i]);
                fine.medium[i] = number;
            });
        });
    }
}

}  // namespace

std::array<int, 3> parts_of_cell(const std::array<int, 3>& view_voxels, const std::array<double, 3>& pitch_mm,
                                 double finest_mm) {
    std::array<int, 3> parts = view_voxels;
    for (std::size_t a = 0; finest_mm > 0 && a < 3; ++a)
        parts[a] *= std::clamp(static_cast<int>(std::ceil(pitch_mm[a] / finest_mm - 0.1)), 1, 4);
    return parts;
}

namespace {

bool is_lit(const OpticalGrid& grid, const GridBlock& block) {
    const auto first = grid.faces.begin() + block.first_face;
    return std::any_of(first, first + block.faces, [](const OuterFace& face) { return face.kind == FaceKind::light; });
}

}  // namespace

std::vector<std::uint32_t> blocks_to_refine(const ViewingGrid& viewing, const ResinVolume& volume, Refinement which) {
    const OpticalGrid& grid = viewing.grid;
    std::vector<std::uint32_t> chosen;
    if (which == Refinement::none) return chosen;
    const Place& view = grid.view_voxels;
    std::vector<std::int16_t> only(grid.blocks.size());  // material of each block, -1: several
    for (std::size_t b = 0; b < only.size(); ++b)
        only[b] = static_cast<std::int16_t>(
            volume.uniform_material(viewing.corner_of(grid.blocks[b]), Place{4 * view[0], 4 * view[1], 4 * view[2]}));
    for (std::size_t t = 0; t < grid.transport_blocks.size(); ++t) {
        const std::uint32_t b = grid.transport_blocks[t];
        if (which == Refinement::contrast && !is_lit(grid, grid.blocks[b])) continue;
        bool wanted = only[b] < 0 || which == Refinement::all;
        for (const std::int32_t other : grid.blocks[b].neighbour) {
            const int beside = other < 0 ? only[b] : only[static_cast<std::size_t>(other)];
            wanted |= beside >= 0 && beside != only[b];
        }
        if (wanted) chosen.push_back(static_cast<std::uint32_t>(t));
    }
    return chosen;
}

void refine(ViewingGrid& viewing, const ResinVolume& volume, Refinement which, const std::array<int, 3>& split,
            const Progress* progress, std::size_t most_contents) {
    ViewingGrid::Fine& fine = viewing.fine;
    fine = {};
    if (which == Refinement::none) return;
    fine.split = split;
    fine.first.assign(viewing.grid.transport_blocks.size(), not_fine);
    const std::size_t parts = 64 * fine.parts();
    const std::vector<std::uint32_t> chosen = blocks_to_refine(viewing, volume, which);
    VOXTONE_EXPECT(chosen.size() * parts < not_fine);
    for (std::size_t i = 0; i < chosen.size(); ++i) fine.first[chosen[i]] = static_cast<std::uint32_t>(i * parts);
    fine.medium.resize(chosen.size() * parts);
    std::vector<Key> keys(fine.medium.size());
    const auto fill_range = [&](std::size_t first, std::size_t last) {
        BlockFiller filler(viewing, volume);
        for (std::size_t i = first; i < last; ++i) filler.fill(chosen[i], keys.data() + fine.first[chosen[i]]);
    };
    parallel_ranges(0, chosen.size(), 32, fill_range, progress);
    number_contents(viewing, keys, most_contents);
}

}  // namespace voxtone::optics
