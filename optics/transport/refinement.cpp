// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/random.h"
#include "optics/media/mirrored_box.h"
#include "optics/numerics/share_ladder.h"
#include "optics/transport/lattice.h"
#include "optics/transport/transport_sweep.h"

namespace voxtone::optics {
namespace {

/// What a part holds, in one number: a few materials, ascending, each with the twelfths of the part that it fills; or
/// that the mixture of the cell stands for it.
using Key = std::uint64_t;
constexpr Key mixed = ~Key{0};
constexpr int twelfths = 12;

/// How such a number is written.
struct KeyForm {
    unsigned material_bits, amount_bits;
    std::size_t most_materials;
    [[nodiscard]] unsigned bits() const { return material_bits + amount_bits; }
    [[nodiscard]] Key most_amount() const { return (Key{1} << amount_bits) - 1; }
    [[nodiscard]] Material material(Key key) const {
        return static_cast<Material>(key >> amount_bits & ((Key{1} << material_bits) - 1));
    }
    [[nodiscard]] int amount(Key key) const { return static_cast<int>(key & most_amount()); }
    [[nodiscard]] Key one(Material m, Key filled) const { return Key{m} << amount_bits | filled; }
    [[nodiscard]] Key nothing() const { return one(1, 0); }
};
/// A column of voxels has few materials; a voxel that others ran into may have all that are loaded.
constexpr KeyForm of_voxels{8, 8, 4}, of_shares{4, 5, 7};
KeyForm form_of(const ViewingGrid& grid) { return grid.spread.any() && grid.resins < 16 ? of_shares : of_voxels; }

/// More of a material into a part; one too many is left out.
Key with(const KeyForm& form, Key part, Material m, int filled) {
    std::array<int, of_shares.most_materials> amount{};
    std::array<Material, of_shares.most_materials> material{};
    std::size_t count = 0;
    for (Key rest = part; rest != 0; rest >>= form.bits(), ++count) {
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
    Key more = 0;
    for (std::size_t k = count; k-- > 0;)
        more = more << form.bits() | form.one(material[k], static_cast<Key>(amount[k]));
    return more;
}

class BlockFiller {
public:
    BlockFiller(const ViewingGrid& grid, const ResinVolume& volume)
        : grid_(grid),
          volume_(volume),
          form_(form_of(grid)),
          view_(grid.view_voxels),
          split_(grid.fine.split),
          spread_(volume, grid.mirrored, grid.spread, grid.resins),
          given_(spread_),
          part_shares_(grid.resins) {
        for (std::size_t a = 0; a < 3; ++a) extent_[a] = 4 * view_[a];
    }

    void fill(std::size_t t, Key* to) {
        const GridBlock& block = grid_.transport_block(t);
        corner_ = grid_.corner_of(block.at);
        axis_ = grid_.towards[t] / 2;
        plus_ = grid_.towards[t] % 2 == 1;
        if (grid_.spread.any())
            spread_.read(corner_, extent_);
        else
            read_box(volume_, grid_.mirrored, corner_, extent_, box_);
        for_each({4, 4, 4}, [&](const Place& cell) {
            const auto place = static_cast<std::uint32_t>(place_in_block(cell));
            if (block.solid >> place & 1)
                fill_cell(cell, grid_.donors_to(block.first_cell + place), to);
            else
                for_each(split_, [&](const Place& part) { to[grid_.fine.part(cell, part)] = 0; });
        });
    }

private:
    /// Each column of voxels across the surface, outermost first, with what a cell beyond gave it, is stretched over
    /// the column of parts: so many parts, or so much of one, to each voxel that light comes to them in their order and
    /// through as much of each as in the print. Where others gave, parts hold the mixture.
    void fill_cell(const Place& cell, std::span<const ViewingGrid::Donor> donors, Key* to) {
        bool above = donors.size() <= 1;
        if (donors.size() == 1) {
            const Place& from = donors[0].from;
            for (std::size_t a = 0; a < 3; ++a)
                above &= from[a] - corner_[a] - cell[a] * view_[a] == (a == axis_ ? (plus_ ? view_[a] : -view_[a]) : 0);
            if (above && grid_.spread.any()) given_.read(from, view_);
            if (above && !grid_.spread.any()) read_box(volume_, grid_.mirrored, from, view_, donor_);
        }
        const bool given = above && !donors.empty();
        Place across = split_;
        across[axis_] = 1;
        for_each(across, [&](Place part) {
            column_.clear();
            column_of_shares_.clear();
            Place in{};
            for (std::size_t a = 0; a < 3; ++a) in[a] = part[a] * view_[a] / split_[a];
            if (above && given) add_column(donor_, given_, view_, {}, in);
            if (above)
                add_column(box_, spread_, extent_, {cell[0] * view_[0], cell[1] * view_[1], cell[2] * view_[2]}, in);
            const int parts = split_[axis_];
            for (int depth = 0; depth < parts; ++depth) {
                part[axis_] = plus_ ? parts - 1 - depth : depth;
                to[grid_.fine.part(cell, part)] = !above               ? mixed
                                                  : grid_.spread.any() ? stretched_shares(depth, parts, cell, part)
                                                                       : stretched(depth, parts);
            }
        });
    }
    [[nodiscard]] Key stretched(int depth, int parts) {
        const int filled = static_cast<int>(column_.size()), whole = twelfths * parts / view_[axis_];  // of one voxel
        Key holds = filled > 0 ? 0 : form_.nothing();
        for (int v = 0; v < filled; ++v) {
            const int first = v * parts / filled, end = std::max((v + 1) * parts / filled, first + 1);
            if (depth >= first && depth < end)
                holds = with(form_, holds, column_[static_cast<std::size_t>(v)], whole / (end - first));
        }
        return holds;
    }
    /// The same of voxels that others ran into: twelfths by share_ladder.h.
    [[nodiscard]] Key stretched_shares(int depth, int parts, const Place& cell, const Place& part) {
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
        Key holds = 0;
        climb_ladder(part_shares_, twelfths, chance, [&](std::size_t r, int count) {
            holds = with(form_, holds, static_cast<Material>(r + 1), count);
        });
        return holds;
    }
    void add_column(const std::vector<Material>& box, const SpreadBox& spread, const Place& extent, const Place& corner,
                    Place in) {
        for (int k = 0; k < view_[axis_]; ++k) {
            in[axis_] = plus_ ? view_[axis_] - 1 - k : k;
            const std::size_t voxel = at3({corner[0] + in[0], corner[1] + in[1], corner[2] + in[2]}, extent);
            if (grid_.spread.any()) {
                if (!spread.is_air(voxel)) column_of_shares_.push_back(spread.shares(voxel));
            } else if (box[voxel] != air) {
                column_.push_back(box[voxel]);
            }
        }
    }

    const ViewingGrid& grid_;
    const ResinVolume& volume_;
    KeyForm form_;
    Place view_, split_, extent_{}, corner_{};
    std::size_t axis_ = 2;
    bool plus_ = true;
    std::vector<Material> box_, donor_, column_;
    SpreadBox spread_, given_;  ///< in their place where resin runs sideways
    std::vector<std::span<const float>> column_of_shares_;
    std::vector<double> part_shares_;
};

/// Numbers what parts hold: whole resins first, the rest in the order in which it is met.
class ContentNumbers {
public:
    ContentNumbers(ViewingGrid& grid, std::size_t most)
        : grid_(grid),
          form_(form_of(grid)),
          contents_(grid.fine.contents),
          most_(most),
          of_mixture_(grid.mixtures.size(), 0) {
        contents_.assign(1, {});
        (void)of_key(form_.nothing());
        for (const ViewingGrid::Mixture& mixture : grid.mixtures)
            for (const auto& hold : mixture.holds) (void)of_key(key_of_one(hold.material));
    }
    [[nodiscard]] std::uint16_t of_key(Key key) {
        if (key == 0) return 0;
        if (const auto found = of_key_.find(key); found != of_key_.end()) return found->second;
        ViewingGrid::Mixture content;
        for (Key rest = key; rest != 0; rest >>= form_.bits())
            content.holds.push_back({form_.material(rest), 0, static_cast<float>(form_.amount(rest)) / twelfths});
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
    [[nodiscard]] Key key_of_one(Material m) const { return form_.one(m, twelfths); }
    /// Where there are more than can be numbered a part is taken to be full of one of its resins.
    [[nodiscard]] std::uint16_t add(ViewingGrid::Mixture content, Material some) {
        if (contents_.size() >= most_) {
            const auto whole = of_key_.find(key_of_one(some));
            return whole == of_key_.end() ? std::uint16_t{1} : whole->second;
        }
        contents_.push_back(std::move(content));
        return static_cast<std::uint16_t>(contents_.size() - 1);
    }

    const ViewingGrid& grid_;
    KeyForm form_;
    std::vector<ViewingGrid::Mixture>& contents_;
    std::size_t most_;
    std::unordered_map<Key, std::uint16_t> of_key_;
    std::vector<std::uint16_t> of_mixture_;
};

void number_contents(ViewingGrid& grid, const std::vector<Key>& keys, std::size_t most) {
    ViewingGrid::Fine& fine = grid.fine;
    ContentNumbers numbers(grid, most);
    Key last = 0;
    std::uint16_t number = 0;
    for (std::size_t t = 0; t < fine.first.size(); ++t) {
        if (fine.first[t] == not_fine) continue;
        for_each({4, 4, 4}, [&](const Place& cell) {
            const std::uint16_t mixture = grid.medium[64 * t + place_in_block(cell)];
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
    const ViewingGrid::Fine& fine_;
    std::vector<Material> material_;  ///< of contents of one resin; air of others
    Place size_{};
    std::array<double, 3> area_{};
};

/// Parts of one resin are told apart by how much of others lies beside them (transport_sweep.h), as far as there are
/// numbers.
void tell_apart(ViewingGrid& grid, std::span<const std::uint32_t> chosen, std::size_t most) {
    ViewingGrid::Fine& fine = grid.fine;
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

namespace {

bool is_lit(const ViewingGrid& grid, const GridBlock& block) {
    const auto first = grid.faces.begin() + block.first_face;
    return std::any_of(first, first + block.faces, [](const OuterFace& face) { return face.kind == FaceKind::light; });
}

}  // namespace

std::vector<std::uint32_t> blocks_to_refine(const ViewingGrid& grid, const ResinVolume& volume, Refinement which) {
    std::vector<std::uint32_t> chosen;
    if (which == Refinement::none) return chosen;
    std::vector<std::int16_t> only(grid.blocks.size());
    parallel_ranges(0, only.size(), 64, [&](std::size_t first, std::size_t last) {
        std::vector<Material> box;
        for (std::size_t b = first; b < last; ++b) only[b] = grid.content_of(grid.blocks[b], volume, box).resin;
    });
    for (std::size_t t = 0; t < grid.transport_blocks.size(); ++t) {
        const std::uint32_t b = grid.transport_blocks[t];
        if (which == Refinement::contrast && !is_lit(grid, grid.blocks[b])) continue;
        bool wanted = only[b] < 0 || which == Refinement::all;
        for (const std::int32_t other : grid.blocks[b].neighbour) {
            const int beside = other < 0 ? only[b] : only[static_cast<std::size_t>(other)];
            wanted |= beside > air && beside != only[b];
        }
        if (wanted) chosen.push_back(static_cast<std::uint32_t>(t));
    }
    return chosen;
}

namespace {

/// Sums of volume, and of L and its square by channel.
class ToneSums {
public:
    ToneSums(std::size_t count, std::size_t channels) : channels_(channels), sum_(count * (1 + 2 * channels)) {}
    void add(std::size_t to, double volume, const float* lightness) {
        double* const sum = at(to);
        sum[0] += volume;
        for (std::size_t c = 0; c < channels_; ++c) {
            const auto l = static_cast<double>(lightness[c]);
            sum[1 + 2 * c] += volume * l;
            sum[2 + 2 * c] += volume * l * l;
        }
    }
    void add(std::size_t to, const ToneSums& from, std::size_t which) {
        const double* const more = from.at(which);
        double* const sum = at(to);
        for (std::size_t i = 0; i < 1 + 2 * channels_; ++i) sum[i] += more[i];
    }
    [[nodiscard]] bool empty(std::size_t i) const { return !(at(i)[0] > 0); }
    [[nodiscard]] double mean(std::size_t i, std::size_t channel) const { return at(i)[1 + 2 * channel] / at(i)[0]; }
    [[nodiscard]] double variance(std::size_t i, std::size_t channel) const {
        const double m = mean(i, channel);
        return std::max(at(i)[2 + 2 * channel] / at(i)[0] - m * m, 0.0);
    }

private:
    [[nodiscard]] double* at(std::size_t i) { return sum_.data() + i * (1 + 2 * channels_); }
    [[nodiscard]] const double* at(std::size_t i) const { return sum_.data() + i * (1 + 2 * channels_); }
    std::size_t channels_;
    std::vector<double> sum_;
};

ToneSums tones_of_mixtures(const ViewingGrid& grid, const ResinSet& resins) {
    const std::size_t channels = resins.channels.size();
    const std::vector<float> lightness = lightness_of_resins(resins);
    ToneSums of(grid.mixtures.size(), channels);
    for (std::size_t m = 0; m < grid.mixtures.size(); ++m)
        for (const auto& hold : grid.mixtures[m].holds)
            of.add(m, static_cast<double>(hold.share), lightness.data() + (hold.material - 1u) * channels);
    return of;
}

}  // namespace

std::vector<float> lightness_of_resins(const ResinSet& resins) {
    std::vector<float> lightness;
    for (const Resin& resin : resins.resins)
        for (std::size_t c = 0; c < resins.channels.size(); ++c) {
            const double albedo = resin.medium(c).albedo();
            const double s = std::sqrt((1 - albedo) / (1 - resins.g * albedo));
            const double reflected = (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
            lightness.push_back(static_cast<float>(std::max(116 * std::cbrt(reflected) - 16, 0.0)));
        }
    return lightness;
}

std::vector<float> contrast_of_blocks(const ViewingGrid& grid, const ResinSet& resins) {
    const std::size_t channels = resins.channels.size(), count = grid.blocks.size();
    const ToneSums of_mixtures = tones_of_mixtures(grid, resins);
    ToneSums of_blocks(count, channels);
    parallel_for(0, grid.transport_blocks.size(), 64, [&](std::size_t t) {
        for (std::size_t cell = 64 * t; cell < 64 * t + 64; ++cell)
            of_blocks.add(grid.transport_blocks[t], of_mixtures, grid.medium[cell]);
    });
    std::vector<float> contrast(grid.transport_blocks.size());
    parallel_for(0, contrast.size(), 64, [&](std::size_t t) {
        const std::uint32_t b = grid.transport_blocks[t];
        if (of_blocks.empty(b)) return;
        double most = 0;
        for (std::size_t c = 0; c < channels; ++c) most += of_blocks.variance(b, c);
        for (const std::int32_t other : grid.blocks[b].neighbour) {
            if (other < 0 || of_blocks.empty(static_cast<std::size_t>(other))) continue;
            double sum = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                const double apart = of_blocks.mean(b, c) - of_blocks.mean(static_cast<std::size_t>(other), c);
                sum += 0.25 * apart * apart;
            }
            most = std::max(most, sum);
        }
        contrast[t] = static_cast<float>(std::sqrt(most / static_cast<double>(channels)));
    });
    return contrast;
}

std::vector<std::uint32_t> blocks_of_contrast(const ViewingGrid& grid, const ResinSet& resins,
                                              std::vector<std::uint32_t> blocks, double least) {
    if (least <= 0 || blocks.empty()) return blocks;
    const std::vector<float> contrast = contrast_of_blocks(grid, resins);
    std::erase_if(blocks, [&](std::uint32_t t) { return static_cast<double>(contrast[t]) < least; });
    return blocks;
}

void refine(ViewingGrid& grid, const ResinVolume& volume, std::span<const std::uint32_t> chosen,
            const std::array<int, 3>& split, const Progress* progress, std::size_t most_contents) {
    ViewingGrid::Fine& fine = grid.fine;
    fine = {};
    if (chosen.empty()) return;
    fine.split = split;
    fine.first.assign(grid.transport_blocks.size(), not_fine);
    const std::size_t parts = 64 * fine.parts();
    VOXTONE_EXPECT(chosen.size() * parts < not_fine);
    for (std::size_t i = 0; i < chosen.size(); ++i) fine.first[chosen[i]] = static_cast<std::uint32_t>(i * parts);
    fine.medium.resize(chosen.size() * parts);
    std::vector<Key> keys(fine.medium.size());
    const auto fill_range = [&](std::size_t first, std::size_t last) {
        BlockFiller filler(grid, volume);
        for (std::size_t i = first; i < last; ++i) filler.fill(chosen[i], keys.data() + fine.first[chosen[i]]);
    };
    parallel_ranges(0, chosen.size(), 32, fill_range, progress);
    number_contents(grid, keys, most_contents);
    tell_apart(grid, chosen, most_contents);
}

}  // namespace voxtone::optics
