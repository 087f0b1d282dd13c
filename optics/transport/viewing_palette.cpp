// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_palette.h"

#include <algorithm>
#include <array>
#include <span>
#include <unordered_map>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/media/mirrored_box.h"
#include "optics/transport/lattice.h"

namespace voxtone::optics {
namespace {

/// Sum of count * constant: as good as unique for a mixture, and one addition a voxel.
constexpr std::array<std::uint64_t, 256> mixture_codes() {
    std::array<std::uint64_t, 256> code{};
    std::uint64_t state = 0x9e3779b97f4a7c15u;
    for (std::size_t m = 1; m < code.size(); ++m) {  // splitmix64
        std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        code[m] = (z ^ (z >> 31)) | 1u;
    }
    return code;
}
constexpr std::array<std::uint64_t, 256> code_of = mixture_codes();

/// Counts of materials in the layers of a cell.
struct Counts {
    struct Count {
        Material material;
        std::uint8_t layer;
        int n;
    };
    std::vector<Count> counts;
    void add(Material m, int layer) {
        for (Count& c : counts)
            if (c.material == m && c.layer == layer) {
                ++c.n;
                return;
            }
        counts.push_back({m, static_cast<std::uint8_t>(layer), 1});
    }
    void sort() {
        std::sort(counts.begin(), counts.end(), [](const Count& a, const Count& b) {
            return std::pair(a.layer, a.material) < std::pair(b.layer, b.material);
        });
    }
    /// Where there are too many different mixtures: layers are forgotten, the shares are rounded to eighths, the
    /// largest rests up.
    void round_to_eighths(int in_cell) {
        std::array<int, 256> by_material{};
        int all = 0;
        for (const Count& c : counts) {
            by_material[c.material] += c.n;
            all += c.n;
        }
        counts.clear();
        const int parts = std::max(1, (8 * all + in_cell / 2) / in_cell);
        std::vector<std::pair<int, std::size_t>> rest;
        int given = 0;
        for (std::size_t m = 1; m < by_material.size(); ++m) {
            if (by_material[m] == 0) continue;
            const int wanted = by_material[m] * parts;
            rest.emplace_back(-(wanted % all), counts.size());
            counts.push_back({static_cast<Material>(m), 0, wanted / all});
            given += wanted / all;
        }
        std::sort(rest.begin(), rest.end());
        for (std::size_t i = 0; given < parts; ++i, ++given) ++counts[rest[i].second].n;
        std::erase_if(counts, [](const Count& c) { return c.n == 0; });
    }
};

/// Numbers different compositions in the order in which they are first met.
class CompositionTable {
public:
    struct Entry {
        std::uint64_t key;
        std::uint8_t axis;
        Counts counts;
    };
    explicit CompositionTable(std::uint16_t first_number = 0) : first_(first_number) {}
    /// The number of the composition with this key, whose counts are asked for where it is new; 0 where there are too
    /// many.
    template <class Make>
    std::uint16_t intern(std::uint64_t key, std::uint8_t axis, Make&& counts) {
        if (const auto found = known_.find(key); found != known_.end()) return found->second;
        const std::size_t number = first_ + entries_.size();
        if (number >= 65535) {
            overflowed_ = true;
            return 0;
        }
        known_.emplace(key, static_cast<std::uint16_t>(number));
        entries_.push_back({key, axis, counts()});
        return static_cast<std::uint16_t>(number);
    }
    [[nodiscard]] bool overflowed() const { return overflowed_; }
    [[nodiscard]] std::vector<Entry>& entries() { return entries_; }

private:
    std::unordered_map<std::uint64_t, std::uint16_t> known_;
    std::vector<Entry> entries_;
    std::size_t first_;
    bool overflowed_ = false;
};

/// The voxels that count in a solid cell: its own and those of cells that gave it their resin, with their layers.
class CellVoxels {
public:
    CellVoxels(const ViewingGrid& grid, const ResinVolume& volume)
        : grid_(grid), volume_(volume), view_(grid.view_voxels) {
        for (std::size_t a = 0; a < 3; ++a) extent_[a] = 4 * view_[a];
    }
    void enter_block(std::size_t t) {
        block_ = &grid_.transport_block(t);
        corner_ = grid_.corner_of(block_->at);
        axis_ = static_cast<std::size_t>(grid_.towards[t] / 2);
        plus_ = grid_.towards[t] % 2 == 1;
        read_box(volume_, grid_.mirrored, corner_, extent_, box_);
    }
    void enter_cell(const Place& at) {
        at_ = at;
        donors_ = grid_.donors_to(block_->first_cell + static_cast<std::uint32_t>(place_in_block(at)));
    }
    [[nodiscard]] std::size_t axis() const { return axis_; }

    /// body(material or air, layer).
    template <class Body>
    void each(Body&& body) {
        for_each(view_, [&](const Place& in) {
            const Place voxel{at_[0] * view_[0] + in[0], at_[1] * view_[1] + in[1], at_[2] * view_[2] + in[2]};
            body(box_[at3(voxel, extent_)], layer_of(in[axis_]));
        });
        for (const auto& [to, from] : donors_) {
            read_box(volume_, grid_.mirrored, from, view_, donor_);
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

    const ViewingGrid& grid_;
    const ResinVolume& volume_;
    Place view_, extent_{}, corner_{}, at_{};
    const GridBlock* block_ = nullptr;
    std::size_t axis_ = 2;
    bool plus_ = true;
    std::span<const ViewingGrid::Donor> donors_;
    std::vector<Material> box_, donor_;
};

/// Gives every cell of the grid the number of its composition, and the grid the list of these.
class CompositionFinder {
public:
    /// `rounded`: to eighths, without layers.
    CompositionFinder(ViewingGrid& grid, const ResinVolume& volume, bool rounded, const Progress* progress)
        : grid_(grid),
          volume_(volume),
          rounded_(rounded),
          progress_(progress),
          in_cell_(static_cast<int>(product(grid.view_voxels))) {}

    /// False where there are too many different ones; the numbers of the cells are of no use then.
    [[nodiscard]] bool run() {
        const std::size_t ranges = (grid_.transport_blocks.size() + range - 1) / range;
        std::vector<CompositionTable> tables(ranges);
        const auto number = [&](std::size_t r) {
            CellVoxels voxels(grid_, volume_);
            for (std::size_t t = r * range; t < end_of(r); ++t) number_block(t, voxels, tables[r]);
        };
        parallel_for(0, ranges, 1, number, progress_);
        return make_common(tables);
    }

private:
    static constexpr std::size_t range = 256;  // of blocks, which number their compositions for themselves at first
    [[nodiscard]] std::size_t end_of(std::size_t r) const {
        return std::min(grid_.transport_blocks.size(), (r + 1) * range);
    }

    void number_block(std::size_t t, CellVoxels& voxels, CompositionTable& table) {
        const GridBlock& block = grid_.transport_block(t);
        const int only = volume_.uniform_material(grid_.corner_of(block.at), grid_.block_voxels());
        std::uint16_t* const number = grid_.medium.data() + block.first_cell;
        if (only > 0 && grid_.donors_of[t] == grid_.donors_of[t + 1]) {
            std::fill_n(number, 64, number_of_one(static_cast<Material>(only), table));
            return;
        }
        voxels.enter_block(t);
        for_each({4, 4, 4}, [&](const Place& at) {
            const std::size_t place = place_in_block(at);
            if (!(block.solid >> place & 1)) return;
            voxels.enter_cell(at);
            number[place] = rounded_ ? rounded_number(voxels, table) : exact_number(voxels, table);
        });
    }

    [[nodiscard]] std::uint16_t number_of_one(Material only, CompositionTable& table) const {
        return table.intern(static_cast<std::uint64_t>(in_cell_) * code_of[only], 2, [&] {
            return Counts{{{only, 0, rounded_ ? 8 : in_cell_}}};
        });
    }

    [[nodiscard]] std::uint16_t exact_number(CellVoxels& voxels, CompositionTable& table) const {
        std::uint64_t key = 0;
        bool several = false;
        Material first = air;
        voxels.each([&](Material m, int layer) {
            if (m == air) return;
            several |= first != air && m != first;
            first = m;
            key += code_of[m] * code_of[static_cast<std::size_t>(255 - layer)];
        });
        if (several) {
            key = key * 31 + voxels.axis() + 1;
        } else {  // no layers in a cell of one resin
            key = 0;
            voxels.each([&](Material m, int) { key += code_of[m]; });
        }
        return table.intern(key, static_cast<std::uint8_t>(voxels.axis()), [&] {
            Counts found;
            voxels.each([&](Material m, int layer) {
                if (m != air) found.add(m, several ? layer : 0);
            });
            found.sort();
            return found;
        });
    }

    [[nodiscard]] std::uint16_t rounded_number(CellVoxels& voxels, CompositionTable& table) const {
        Counts counts;
        voxels.each([&](Material m, int) {
            if (m != air) counts.add(m, 0);
        });
        counts.round_to_eighths(in_cell_);
        std::uint64_t key = 1;
        for (const Counts::Count& c : counts.counts) key += static_cast<std::uint64_t>(c.n) * code_of[c.material];
        return table.intern(key, 2, [&] { return counts; });
    }

    /// From the numbers of each range to those of the grid; 0 is air.
    [[nodiscard]] bool make_common(std::vector<CompositionTable>& tables) {
        CompositionTable all(1);
        std::vector<std::vector<std::uint16_t>> common(tables.size());
        for (std::size_t r = 0; r < tables.size(); ++r) {
            if (progress_) progress_->check_cancelled();
            if (tables[r].overflowed()) return false;
            for (CompositionTable::Entry& entry : tables[r].entries())
                common[r].push_back(all.intern(entry.key, entry.axis, [&] { return std::move(entry.counts); }));
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

    void list_mixtures(CompositionTable& all) {
        const auto whole = static_cast<float>(rounded_ ? 8 : in_cell_);
        grid_.mixtures.assign(1, {});
        for (const CompositionTable::Entry& entry : all.entries()) {
            ViewingGrid::Mixture& mixture = grid_.mixtures.emplace_back();
            mixture.axis = entry.axis;
            for (const Counts::Count& c : entry.counts.counts)
                mixture.holds.push_back({c.material, c.layer, static_cast<float>(c.n) / whole});
        }
    }

    ViewingGrid& grid_;
    const ResinVolume& volume_;
    bool rounded_;
    const Progress* progress_;
    int in_cell_;
};

/// The voxels of a block, beyond mirrors too.
void read_block(const ViewingGrid& grid, const ResinVolume& volume, const GridBlock& block,
                std::vector<Material>& box) {
    read_box(volume, grid.mirrored, grid.corner_of(block.at), grid.block_voxels(), box);
}

/// The material of a block, -1 where there are several, air or not.
int only_material(const ViewingGrid& grid, const ResinVolume& volume, const GridBlock& block,
                  std::vector<Material>& box) {
    const int material = volume.uniform_material(grid.corner_of(block.at), grid.block_voxels());
    if (material >= 0) return material;
    read_block(grid, volume, block, box);
    return std::all_of(box.begin(), box.end(), [&](Material m) { return m == box[0]; }) ? box[0] : -1;
}

/// Materials of the core blocks, -1 for several; of ghosts 0: they stay as they are.
std::vector<std::int16_t> core_materials(const ViewingGrid& grid, const ResinVolume& volume, const Progress* progress) {
    std::vector<std::int16_t> materials(grid.core_block.size(), 0);
    const auto look = [&](std::size_t begin, std::size_t end) {
        std::vector<Material> box;
        for (std::size_t i = begin; i < end; ++i)
            if (const GridBlock& block = grid.blocks[grid.core_block[i]]; !grid.is_ghost(block.at))
                materials[i] = static_cast<std::int16_t>(only_material(grid, volume, block, box));
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
        GridBlock& block = grid.blocks[grid.core_block[i]];
        block.medium = static_cast<std::uint32_t>(1 + grid.resins + blocks.size());
        blocks.push_back(grid.core_block[i]);
    }
    grid.core_shares.assign(grid.resins * blocks.size(), 0.0f);
    const auto share_out = [&](std::size_t begin, std::size_t end) {
        std::vector<Material> box;
        for (std::size_t i = begin; i < end; ++i) {
            read_block(grid, volume, grid.blocks[blocks[i]], box);
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

bool fill(ViewingGrid& grid, const ResinVolume& volume, std::vector<std::uint8_t>& wanted, const Progress* progress) {
    VOXTONE_EXPECT(volume.pitch_mm() == grid.pitch_mm);
    wanted.assign(grid.block_at.size(), 0);
    bool same = true;
    const std::vector<std::int16_t> materials = core_materials(grid, volume, progress);
    for (std::size_t i = 0; i < materials.size(); ++i) {
        GridBlock& block = grid.blocks[grid.core_block[i]];
        if (grid.is_ghost(block.at) || (grid.mixes_core && materials[i] < 0)) continue;
        if (materials[i] > 0) {
            block.medium = static_cast<std::uint32_t>(materials[i]);
        } else {
            same = false;
            wanted[at3(block.at, grid.lattice)] = 1;
        }
    }
    if (!same) return false;
    mix_core(grid, volume, materials, progress);
    if (!CompositionFinder(grid, volume, false, progress).run()) {
        const bool fits = CompositionFinder(grid, volume, true, progress).run();
        VOXTONE_ENSURE(fits);
    }
    return true;
}

}  // namespace voxtone::optics
