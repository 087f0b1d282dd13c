// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/homogenisation.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "base/random.h"
#include "optics/grid/block_voxels.h"
#include "optics/grid/lattice.h"
#include "optics/grid/viewing_faces.h"
#include "optics/media/mirrored_box.h"
#include "optics/numerics/share_ladder.h"

namespace voxtone::optics {
namespace {

/// Counts of materials in the layers of a cell; in a cell of one resin layers are not told apart.
struct Composition {
    struct Part {
        Material material;
        std::uint8_t layer;
        int count;
        bool operator==(const Part&) const = default;
    };
    std::vector<Part> parts;  ///< ascending in layer, then material
    std::uint8_t axis = 2;    ///< across the layers
    bool operator==(const Composition&) const = default;

    void clear() {
        parts.clear();
        axis = 2;
    }
    void add(Material m, int layer) {
        for (Part& p : parts)
            if (p.material == m && p.layer == layer) {
                ++p.count;
                return;
            }
        parts.push_back({m, static_cast<std::uint8_t>(layer), 1});
    }
    void close(std::size_t layers_along) {
        const bool several = std::ranges::any_of(parts, [&](const Part& p) { return p.material != parts[0].material; });
        if (several) {
            std::ranges::sort(parts, {}, [](const Part& p) { return std::pair(p.layer, p.material); });
            axis = static_cast<std::uint8_t>(layers_along);
        } else if (!parts.empty()) {
            int all = 0;
            for (const Part& p : parts) all += p.count;
            parts.erase(parts.begin() + 1, parts.end());
            parts[0] = {parts[0].material, 0, all};
        }
    }
    void forget_layers() {
        std::array<int, 256> by_material{};
        for (const Part& p : parts) by_material[p.material] += p.count;
        clear();
        for (std::size_t m = 1; m < by_material.size(); ++m)
            if (by_material[m] > 0) parts.push_back({static_cast<Material>(m), 0, by_material[m]});
    }
    /// Without layers, and counts in eighths of a cell: steps of one ladder of all shares whose first rung lies at
    /// `chance`, in [0, 1), so that over many cells each resin keeps its share.
    void round_to_eighths(int in_cell, double chance) {
        forget_layers();
        int voxels = 0, counted = 0, given = 0;
        for (const Part& p : parts) voxels += p.count;
        const double step = std::max(8.0 / in_cell, 1.0 / voxels);  // one eighth at the least
        for (Part& p : parts) {
            counted += p.count;
            const int rungs = static_cast<int>(counted * step + chance + 1e-9);
            p.count = rungs - std::exchange(given, rungs);
        }
        std::erase_if(parts, [](const Part& p) { return p.count == 0; });
    }
};

/// Counts that shares of a cell come to, as many as `rungs` in a full one.
void take_shares(std::span<const double> shares, int rungs, double chance, Composition& to) {
    to.clear();
    climb_ladder(shares, rungs, chance, [&](std::size_t r, int count) {
        to.parts.push_back({static_cast<Material>(r + 1), 0, count});
    });
}

struct CompositionHash {
    std::size_t operator()(const Composition& c) const {
        std::uint64_t sum = c.axis;
        for (const Composition::Part& p : c.parts) {
            sum ^= static_cast<std::uint64_t>(p.count) << 16 | std::uint64_t{p.layer} << 8 | p.material;
            sum *= 0x9e3779b97f4a7c15u;  // 2^64 / the golden ratio
            sum ^= sum >> 29;
        }
        return sum;
    }
};

constexpr std::size_t most_kinds = 65534;  // numbers of 16 bits, one of them for air, one for too many

/// Numbers different compositions in the order in which they are first met.
class CompositionTable {
public:
    explicit CompositionTable(std::uint16_t first_number = 0) : first_(first_number) {}
    /// 0 where there are too many.
    std::uint16_t intern(const Composition& composition) {
        const std::size_t number = first_ + in_order_.size();
        const auto [at, fresh] = known_.try_emplace(composition, static_cast<std::uint16_t>(number));
        if (!fresh) return at->second;
        overflowed_ |= number > most_kinds;
        if (!overflowed_) in_order_.push_back(&at->first);
        return overflowed_ ? std::uint16_t{0} : at->second;
    }
    [[nodiscard]] bool overflowed() const { return overflowed_; }
    [[nodiscard]] const std::vector<const Composition*>& in_order() const { return in_order_; }

private:
    std::unordered_map<Composition, std::uint16_t, CompositionHash> known_;
    std::vector<const Composition*> in_order_;
    std::size_t first_;
    bool overflowed_ = false;
};

/// Whether there are too many kinds for a grid, as soon as that is certain: by their hashes, of which there are no more
/// than of kinds.
class KindCount {
public:
    void add(const CompositionTable& table) {
        const std::scoped_lock lock(mutex_);
        for (const Composition* const one : table.in_order()) {
            if (too_many_) return;
            hashes_.insert(CompositionHash()(*one));
            too_many_ = hashes_.size() > most_kinds;
        }
    }
    [[nodiscard]] bool too_many() const { return too_many_; }

private:
    std::mutex mutex_;
    std::unordered_set<std::size_t> hashes_;
    std::atomic<bool> too_many_{false};
};

/// The voxels that count in a solid cell: its own and those of cells that gave it their resin, with their layers.
class CellVoxels : BlockVoxels {
public:
    CellVoxels(const ViewingGrid& grid, const ResinVolume& volume) : BlockVoxels(grid, volume) {}

    using BlockVoxels::enter_block;
    /// The one resin of a whole block that nothing else reaches, 0 where it is not so.
    [[nodiscard]] int only(const GridBlock& block) {
        const Place corner = grid_.corner_of(block.at);
        const int material = std::max(volume_.uniform_material(corner, extent_), 0);
        return material > 0 && spreads() && spread_.only(corner, extent_) != material ? 0 : material;
    }
    void enter_cell(const Place& at) {
        at_ = at;
        donors_ = grid_.donors_to(block_->first_cell + static_cast<std::uint32_t>(place_in_block(at)));
    }
    [[nodiscard]] std::size_t axis() const { return axis_; }

    /// Where resin runs sideways: shares of the cell's volume, one a resin.
    void add_shares(std::span<double> shares) {
        const auto add = [&](const SpreadBox& box, std::size_t voxel) {
            const std::span<const float> holds = box.shares(voxel);
            for (std::size_t r = 0; r < shares.size(); ++r)
                shares[r] += static_cast<double>(holds[r]) / static_cast<double>(product(view_));
        };
        for_each(view_, [&](const Place& in) { add(spread_, index(at_, in)); });
        for (const auto& [to, from] : donors_) {
            read_donor(from);
            for (std::size_t voxel = 0; voxel < product(view_); ++voxel) add(given_, voxel);
        }
    }

    /// body(material or air, layer).
    template <class Body>
    void each(Body&& body) {
        for_each(view_, [&](const Place& in) { body(box_[index(at_, in)], layer_of(in[axis_])); });
        for (const auto& [to, from] : donors_) {
            read_donor(from);
            const int before = from[axis_] - corner_[axis_] - at_[axis_] * view_[axis_];
            std::size_t k = 0;
            for_each(view_, [&](const Place& in) { body(donor_[k++], layer_of(before + in[axis_])); });
        }
    }

private:
    [[nodiscard]] int layer_of(int along) const {
        const int layers = view_[axis_], layer = std::clamp(along, 0, layers - 1);
        return plus_ ? layers - 1 - layer : layer;
    }

    Place at_{};
    std::span<const ViewingGrid::Donor> donors_;
};

/// How closely cells are told apart.
enum class Kinds {
    layered,  ///< by the counts in each layer
    counted,  ///< by the counts alone
    eighths,  ///< by their rounded shares
    // Of resin that runs sideways, by shares rounded as closely as there are numbers for:
    parts_of_96,
    parts_of_24,
};

/// Gives every cell of the grid the number of its composition, and the grid the list of these.
class CompositionFinder {
public:
    CompositionFinder(ViewingGrid& grid, const ResinVolume& volume, Kinds kinds, const Progress* progress)
        : grid_(grid),
          volume_(volume),
          kinds_(kinds),
          progress_(progress),
          in_cell_(static_cast<int>(product(grid.view_voxels))) {}

    /// False where there are too many different ones; the numbers of the cells are of no use then.
    [[nodiscard]] bool run() {
        const std::size_t ranges = (grid_.transport_blocks.size() + range - 1) / range;
        std::vector<CompositionTable> tables(ranges);
        KindCount kinds;
        const auto number = [&](std::size_t r) {
            if (kinds.too_many()) return;
            CellVoxels voxels(grid_, volume_);
            for (std::size_t t = r * range; t < end_of(r); ++t) number_block(t, voxels, tables[r]);
            kinds.add(tables[r]);
        };
        parallel_for(0, ranges, 1, number, progress_);
        return !kinds.too_many() && make_common(tables);
    }

private:
    static constexpr std::size_t range = 256;  // of blocks, which number their compositions for themselves at first
    [[nodiscard]] std::size_t end_of(std::size_t r) const {
        return std::min(grid_.transport_blocks.size(), (r + 1) * range);
    }

    void number_block(std::size_t t, CellVoxels& voxels, CompositionTable& table) {
        const GridBlock& block = grid_.transport_block(t);
        const int only = voxels.only(block);
        std::uint16_t* const number = grid_.medium.data() + block.first_cell;
        if (only > 0 && grid_.donors_of[t] == grid_.donors_of[t + 1]) {
            const Composition whole{{{static_cast<Material>(only), 0, whole_cell()}}};
            std::fill_n(number, 64, table.intern(whole));
            return;
        }
        voxels.enter_block(t);
        Composition found;
        std::vector<double> shares(grid_.resins);
        for_each({4, 4, 4}, [&](const Place& at) {
            const std::size_t place = place_in_block(at);
            if (!(block.solid >> place & 1) || table.overflowed()) return;
            voxels.enter_cell(at);
            if (grid_.spread.any()) {
                std::ranges::fill(shares, 0.0);
                voxels.add_shares(shares);
                take_shares(shares, whole_cell(), chance_of(block, at), found);
                number[place] = table.intern(found);
                return;
            }
            found.clear();
            voxels.each([&](Material m, int layer) {
                if (m != air) found.add(m, layer);
            });
            if (kinds_ == Kinds::layered)
                found.close(voxels.axis());
            else if (kinds_ == Kinds::counted)
                found.forget_layers();
            else
                found.round_to_eighths(in_cell_, chance_of(block, at));
            number[place] = table.intern(found);
        });
    }
    /// What counts of a full cell sum up to.
    [[nodiscard]] int whole_cell() const {
        switch (kinds_) {
            case Kinds::eighths:
                return 8;
            case Kinds::parts_of_96:
                return 96;
            case Kinds::parts_of_24:
                return 24;
            default:
                return in_cell_;
        }
    }
    /// Of a place of the body, whatever the tile: prints are compared with each other.
    [[nodiscard]] double chance_of(const GridBlock& block, const Place& at) const {
        std::uint64_t place = 0;
        for (std::size_t a = 0; a < 3; ++a)
            place = place << 21 |
                    static_cast<std::uint64_t>(grid_.corner_of(block.at)[a] + at[a] * grid_.view_voxels[a] + (1 << 20));
        return RandomStream(0, place).uniform();
    }

    /// From the numbers of each range to those of the grid; 0 is air.
    [[nodiscard]] bool make_common(std::vector<CompositionTable>& tables) {
        CompositionTable all(1);
        std::vector<std::vector<std::uint16_t>> common(tables.size());
        for (std::size_t r = 0; r < tables.size(); ++r) {
            if (progress_) progress_->check_cancelled();
            if (tables[r].overflowed()) return false;
            for (const Composition* const one : tables[r].in_order()) common[r].push_back(all.intern(*one));
            if (all.overflowed()) return false;
            tables[r] = CompositionTable();
        }
        list_mixtures(all);
        const auto renumber = [&](std::size_t r) {
            for (std::size_t t = r * range; t < end_of(r); ++t) {
                const GridBlock& block = grid_.transport_block(t);
                for (std::size_t place = 0; place < 64; ++place) {
                    std::uint16_t& number = grid_.medium[block.first_cell + place];
                    number = block.solid >> place & 1 ? common[r][number] : std::uint16_t{0};
                }
            }
        };
        parallel_for(0, tables.size(), 1, renumber, progress_);
        return true;
    }

    void list_mixtures(const CompositionTable& all) {
        const auto whole = static_cast<float>(whole_cell());
        grid_.mixtures.assign(1, {});
        for (const Composition* const one : all.in_order()) {
            Mixture& mixture = grid_.mixtures.emplace_back();
            mixture.axis = one->axis;
            for (const Composition::Part& p : one->parts)
                mixture.holds.push_back({p.material, p.layer, static_cast<float>(p.count) / whole});
        }
    }

    ViewingGrid& grid_;
    const ResinVolume& volume_;
    Kinds kinds_;
    const Progress* progress_;
    int in_cell_;
};

/// Materials of the core blocks, -1 for several; of ghosts 0: they stay as they are.
std::vector<std::int16_t> core_materials(const ViewingGrid& grid, const ResinVolume& volume, const Progress* progress) {
    std::vector<std::int16_t> materials(grid.core_block.size(), 0);
    const auto look = [&](std::size_t begin, std::size_t end) {
        std::vector<Material> box;
        for (std::size_t i = begin; i < end; ++i) {
            const GridBlock& block = grid.blocks[grid.core_block[i]];
            if (grid.is_ghost(block.at)) continue;
            const auto [resin, any_air] = grid.content_of(block, volume, box);
            // Below a sheet there is nothing but air.
            materials[i] = resin > 0 && any_air && !grid.is_on_sheet(block.at) ? std::int16_t{-1} : resin;
        }
    };
    parallel_ranges(0, materials.size(), 1 << 8, look, progress);
    return materials;
}

/// Numbers the core blocks of several materials and finds their shares.
void mix_core(ViewingGrid& grid, const ResinVolume& volume, const std::vector<std::int16_t>& materials,
              const Progress* progress) {
    std::vector<std::uint32_t> blocks;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (materials[i] >= 0) continue;
        grid.core_medium[i] = static_cast<std::uint32_t>(1 + grid.resins + blocks.size());
        blocks.push_back(grid.core_block[i]);
    }
    grid.core_shares.assign(grid.resins * blocks.size(), 0.0f);
    const auto share_out = [&](std::size_t begin, std::size_t end) {
        std::vector<Material> box;
        for (std::size_t i = begin; i < end; ++i) {
            read_box(volume, grid.mirrored, grid.corner_of(grid.blocks[blocks[i]].at), grid.block_voxels(), box);
            const std::span<float> shares = std::span(grid.core_shares).subspan(i * grid.resins, grid.resins);
            for (const Material m : box)
                if (m != air) ++shares[m - 1u];
            const auto solid = box.size() - static_cast<std::size_t>(std::count(box.begin(), box.end(), air));
            for (float& share : shares) share /= static_cast<float>(solid);
        }
    };
    parallel_ranges(0, blocks.size(), 1 << 6, share_out, progress);
}

}  // namespace

bool homogenise(ViewingGrid& grid, const ResinVolume& volume, std::vector<std::uint8_t>& wanted,
                const Progress* progress) {
    VOXTONE_EXPECT(volume.pitch_mm() == grid.pitch_mm);
    wanted.assign(grid.block_at.size(), 0);
    bool same = true;
    const std::vector<std::int16_t> materials = core_materials(grid, volume, progress);
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const GridBlock& block = grid.blocks[grid.core_block[i]];
        if (grid.is_ghost(block.at) || (grid.mixes_core && materials[i] < 0)) continue;
        if (materials[i] > 0) {
            grid.core_medium[i] = static_cast<std::uint32_t>(materials[i]);
        } else {
            same = false;
            wanted[at3(block.at, grid.lattice)] = 1;
        }
    }
    if (!same) return false;
    mix_core(grid, volume, materials, progress);
    const auto kinds = grid.spread.any() ? std::array{Kinds::parts_of_96, Kinds::parts_of_24, Kinds::eighths}
                                         : std::array{Kinds::layered, Kinds::counted, Kinds::eighths};
    const bool fits =
        std::ranges::any_of(kinds, [&](Kinds kind) { return CompositionFinder(grid, volume, kind, progress).run(); });
    VOXTONE_ENSURE(fits);
    choose_face_indices(grid);
    return true;
}

}  // namespace voxtone::optics
