// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the cells of a viewing grid hold.
#include <algorithm>
#include <unordered_map>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/media/mirrored_box.h"
#include "voxtone/optics/transport/coarse/viewing_grid.h"
#include "voxtone/optics/transport/lattice.h"

namespace voxtone::optics {
namespace {

/// Sum of count * constant: as good as unique for a mixture, and one addition a voxel.
std::array<std::uint64_t, 256> mixture_codes() {
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

}  // namespace

bool ViewingGrid::fill(const ResinVolume& volume, std::vector<std::uint8_t>& wanted) {
    VOXTONE_EXPECT(volume.pitch_mm() == grid.pitch_mm);
    wanted.assign(grid.block_at.size(), 0);
    const Place extent{4 * grid.options.view_voxels[0], 4 * grid.options.view_voxels[1],
                       4 * grid.options.view_voxels[2]};
    bool same = true;
    for (const std::uint32_t b : core_block) {
        GridBlock& block = grid.blocks[b];
        if (is_ghost(block.at)) continue;
        const Place corner = corner_of(block);
        int material = volume.uniform_material(corner, extent);
        if (material != block.medium && material < 0) {
            std::vector<Material> box;
            read_box(volume, mirrored_, corner, extent, box);
            material = std::all_of(box.begin(), box.end(), [&](Material m) { return m == box[0]; }) ? box[0] : -1;
        }
        if (material > 0) {
            block.medium = static_cast<std::uint16_t>(material);
            continue;
        }
        same = false;
        wanted[at3(block.at, grid.lattice)] = 1;
    }
    if (!same) return false;
    bool full = false;
    take_palette(volume, false, full);
    if (full) {
        full = false;
        take_palette(volume, true, full);
        VOXTONE_ENSURE(!full);
    }
    return true;
}

namespace {

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

}  // namespace

void ViewingGrid::take_palette(const ResinVolume& volume, bool coarse, bool& full) {
    static const std::array<std::uint64_t, 256> code = mixture_codes();
    const Place view = grid.options.view_voxels, extent{4 * view[0], 4 * view[1], 4 * view[2]};
    const int in_cell = view[0] * view[1] * view[2];
    // Ranges of blocks number their mixtures for themselves; then the numbers are made common.
    constexpr std::size_t range = 256;
    struct Part {
        std::unordered_map<std::uint64_t, std::uint16_t> known;
        struct New {
            std::uint64_t key;
            std::uint8_t axis;
            Counts counts;
        };
        std::vector<New> mixtures;
        bool full = false;
    };
    const std::size_t n = grid.transport_blocks.size(), ranges = (n + range - 1) / range;
    std::vector<Part> parts(ranges);
    parallel_for(0, ranges, 1, [&](std::size_t r) {
        Part& part = parts[r];
        std::vector<Material> box, donor;
        const auto number = [&](std::uint64_t key, std::uint8_t axis, auto&& counts) -> std::uint16_t {
            if (const auto found = part.known.find(key); found != part.known.end()) return found->second;
            if (part.mixtures.size() >= 65535) {
                part.full = true;
                return 0;
            }
            const auto index = static_cast<std::uint16_t>(part.mixtures.size());
            part.known.emplace(key, index);
            part.mixtures.push_back({key, axis, counts()});
            return index;
        };
        for (std::size_t i = r * range; i < std::min(n, (r + 1) * range); ++i) {
            const GridBlock& block = grid.blocks[grid.transport_blocks[i]];
            const Place corner = corner_of(block);
            const int only = volume.uniform_material(corner, extent);
            std::uint16_t* const medium = grid.medium.data() + block.first_cell;
            if (only > 0 && donors_of_[i] == donors_of_[i + 1]) {
                const std::uint16_t index =
                    number(static_cast<std::uint64_t>(in_cell) * code[static_cast<std::size_t>(only)], 2, [&] {
                        return Counts{{{static_cast<Material>(only), 0, coarse ? 8 : in_cell}}};
                    });
                std::fill_n(medium, 64, index);
                continue;
            }
            const auto axis = static_cast<std::size_t>(towards_[i] / 2);
            const bool plus = towards_[i] % 2 == 1;
            const int layers = view[axis];
            read_box(volume, mirrored_, corner, extent, box);
            std::uint32_t next_donor = donors_of_[i];
            for_each({4, 4, 4}, [&](const Place& at) {
                const std::size_t place = place_in_block(at[0], at[1], at[2]);
                if (!(block.node_mask >> place & 1)) return;
                // Every voxel of the cell and of what is given to it, with its layer.
                const auto layer_of = [&](int along) {
                    const int layer = std::clamp(along, 0, layers - 1);
                    return plus ? layers - 1 - layer : layer;
                };
                const std::uint32_t first_donor = next_donor;
                const auto each_voxel = [&](auto&& body) {
                    for_each(view, [&](const Place& in) {
                        body(box[at3({at[0] * view[0] + in[0], at[1] * view[1] + in[1], at[2] * view[2] + in[2]},
                                     extent)],
                             layer_of(in[axis]));
                    });
                    for (next_donor = first_donor;
                         next_donor < donors_of_[i + 1] && donors_[next_donor].to == block.first_cell + place;
                         ++next_donor) {
                        const Place& from = donors_[next_donor].from;
                        read_box(volume, mirrored_, from, view, donor);
                        const int before = from[axis] - corner[axis] - at[axis] * view[axis];
                        std::size_t k = 0;
                        for_each(view, [&](const Place& in) { body(donor[k++], layer_of(before + in[axis])); });
                    }
                };
                std::uint64_t key = 0;
                bool several = false;
                Material first = air;
                each_voxel([&](Material m, int layer) {
                    if (m == air) return;
                    several |= first != air && m != first;
                    first = m;
                    key += code[m] * code[static_cast<std::size_t>(255 - layer)];
                });
                if (!several) {  // no layers in a cell of one resin
                    key = 0;
                    each_voxel([&](Material m, int) { key += code[m]; });
                } else {
                    key = key * 31 + axis + 1;
                }
                const auto counts = [&] {
                    Counts found;
                    each_voxel([&](Material m, int layer) {
                        if (m != air) found.add(m, several ? layer : 0);
                    });
                    if (coarse) found.round_to_eighths(in_cell);
                    found.sort();
                    return found;
                };
                if (coarse) {
                    const Counts rounded = counts();
                    key = 1;
                    for (const Counts::Count& c : rounded.counts)
                        key += static_cast<std::uint64_t>(c.n) * code[c.material];
                    medium[place] = number(key, 2, [&] { return rounded; });
                } else {
                    medium[place] = number(key, static_cast<std::uint8_t>(axis), counts);
                }
            });
        }
    });
    mixtures.assign(1, {});
    grid.palette.assign(1, {});
    std::unordered_map<std::uint64_t, std::uint16_t> known;
    std::vector<std::vector<std::uint16_t>> common(ranges);
    const auto whole = static_cast<float>(coarse ? 8 : in_cell);
    for (std::size_t r = 0; r < ranges; ++r) {
        full |= parts[r].full;
        for (const typename Part::New& fresh_one : parts[r].mixtures) {
            const auto [found, fresh] = known.try_emplace(fresh_one.key, static_cast<std::uint16_t>(mixtures.size()));
            if (fresh) {
                if (mixtures.size() == 65535) {
                    full = true;
                    return;
                }
                Mixture mixture;
                mixture.axis = fresh_one.axis;
                for (const Counts::Count& c : fresh_one.counts.counts)
                    mixture.holds.push_back({c.material, c.layer, static_cast<float>(c.n) / whole});
                mixtures.push_back(std::move(mixture));
            }
            common[r].push_back(found->second);
        }
        parts[r] = {};
    }
    if (full) return;
    grid.palette.resize(mixtures.size());
    parallel_for(0, ranges, 1, [&](std::size_t r) {
        for (std::size_t i = r * range; i < std::min(n, (r + 1) * range); ++i) {
            const GridBlock& block = grid.blocks[grid.transport_blocks[i]];
            for (std::size_t place = 0; place < 64; ++place) {
                std::uint16_t& medium = grid.medium[block.first_cell + place];
                medium = block.node_mask >> place & 1 ? common[r][medium] : std::uint16_t{0};
            }
        }
    });
}

}  // namespace voxtone::optics
