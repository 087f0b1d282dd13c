// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/composed_layers.h"

#include <map>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr int air = 0;

/// Voxels as a function of their place.
class Voxels final : public LayerSource {
public:
    template <class Material>
    Voxels(std::array<int, 3> size, int slab, Material&& material) : slab_(slab) {
        grid_.size = size;
        for (int k = 0; k < size[2]; ++k)
            for (int j = 0; j < size[1]; ++j)
                for (int i = 0; i < size[0]; ++i) voxels_.push_back(io::Material(material(i, j, k)));
    }
    [[nodiscard]] int at(int i, int j, int k) const {
        return voxels_[std::size_t((k * grid_.size[1] + j) * grid_.size[0] + i)];
    }
    [[nodiscard]] bool holds(int i, int j, int k) const {
        return i >= 0 && j >= 0 && k >= 0 && i < grid_.size[0] && j < grid_.size[1] && k < grid_.size[2];
    }
    [[nodiscard]] const VoxelGrid& grid() const override { return grid_; }
    [[nodiscard]] int slab_layers() const override { return slab_; }
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override {
        LayerCounts counts;
        for (int k = std::max(k_begin, slab * slab_); k < std::min({k_end, (slab + 1) * slab_, grid_.size[2]}); ++k) {
            io::LayerRuns runs(std::uint32_t(grid_.size[0]), std::uint32_t(grid_.size[1]));
            for (int j = grid_.size[1] - 1; j >= 0; --j) {
                for (int i = 0; i < grid_.size[0]; ++i) runs.push(1, io::Material(at(i, j, k)));
                runs.end_row();
            }
            ++made[k];
            sink(k, runs);
        }
        return counts;
    }
    mutable std::map<int, int> made;

private:
    VoxelGrid grid_;
    int slab_;
    std::vector<io::Material> voxels_;
};

std::shared_ptr<const Voxels> noise(std::array<int, 3> size, int slab, std::uint64_t seed) {
    return std::make_shared<const Voxels>(size, slab, [seed](int i, int j, int k) {
        const std::uint64_t place = std::uint64_t((k * 100 + j) * 100 + i);
        return int(RandomStream(seed, place).uniform() * 4);  // 0 is air
    });
}

/// The voxels of the print, one by one.
std::vector<int> voxels_of(const LayerSource& print, int first, int last) {
    const std::array<int, 3>& size = print.grid().size;
    std::vector<int> voxels(std::size_t(size[0] * size[1] * (last - first)), -1);
    for (int slab = 0; slab * print.slab_layers() < size[2]; ++slab)
        (void)print.make(slab, first, last, [&](int k, const io::LayerRuns& layer) {
            REQUIRE(layer.rows() == std::uint32_t(size[1]));
            for (int j = 0; j < size[1]; ++j) {
                int i = 0;
                for (const io::Run& run : layer.row(std::uint32_t(size[1] - 1 - j)))
                    for (int n = 0; n < run.length; ++n)
                        voxels[std::size_t(((k - first) * size[1] + j) * size[0] + i++)] = run.material;
                REQUIRE(i == size[0]);
            }
        });
    return voxels;
}

/// Whose voxel it is, by looking at every part.
struct Owned {
    int material = air, part = -1;
    std::vector<int> others;  ///< that would have filled it
};
Owned owner_of(const std::vector<PlacedPart>& parts, int i, int j, int k) {
    Owned owned;
    int best = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const auto& voxels = dynamic_cast<const Voxels&>(*parts[p].layers);
        const int x = i - parts[p].at[0], y = j - parts[p].at[1], z = k - parts[p].at[2];
        if (!voxels.holds(x, y, z) || voxels.at(x, y, z) == air) continue;
        if (owned.part >= 0 && parts[p].priority < best) {
            owned.others.push_back(int(p));
            continue;
        }
        if (owned.part >= 0) owned.others.push_back(owned.part);
        best = parts[p].priority;
        owned.part = int(p);
        owned.material = parts[p].cuts ? air : voxels.at(x, y, z);
    }
    return owned;
}

}  // namespace

TEST_CASE("Parts lie where they were put, and the higher priority has the voxel") {
    const auto one = noise({9, 5, 7}, 3, 1), other = noise({6, 8, 10}, 4, 2);
    const bool beside = GENERATE(true, false);
    CAPTURE(beside);
    std::vector<PlacedPart> parts{{one, {0, 1, 0}, 0, false}, {other, {9, 0, 2}, 0, false}};
    if (!beside) {
        parts = {{one, {1, 1, 0}, 2, false},
                 {other, {4, 0, 2}, 1, false},
                 {one, {7, 3, 5}, 2, false},
                 {noise({4, 4, 4}, 1, 3), {5, 2, 4}, 3, true}};
    }
    VoxelGrid grid;
    grid.size = {17, 9, 14};
    const ComposedLayers print(grid, parts);
    CHECK(print.slab_layers() == 4);
    std::vector<std::uint64_t> lost(parts.size());
    for (const auto& [first, last] : {std::pair(0, 14), std::pair(3, 9)}) {
        const std::vector<int> voxels = voxels_of(print, first, last);
        std::size_t wrong = 0, at = 0;
        for (int k = first; k < last; ++k)
            for (int j = 0; j < 9; ++j)
                for (int i = 0; i < 17; ++i) {
                    const Owned owned = owner_of(parts, i, j, k);
                    wrong += voxels[at++] != owned.material;
                    if (last - first == 14)
                        for (const int p : owned.others) ++lost[std::size_t(p)];
                }
        CHECK(wrong == 0);
    }
    const auto voxels_lost = [](const std::vector<Overlap>& overlaps) {
        std::vector<std::uint64_t> voxels;
        for (const Overlap& overlap : overlaps) voxels.push_back(overlap.voxels);
        return voxels;
    };
    CHECK(voxels_lost(print.overlapped(0, 14)) == lost);
    CHECK((lost == std::vector<std::uint64_t>(parts.size())) == beside);
}

TEST_CASE("Parts whose boxes overlap and whose voxels do not lie beside each other") {
    const auto half = [](bool upper, std::uint64_t seed) {
        return std::make_shared<const Voxels>(std::array{8, 8, 6}, 4, [=](int i, int j, int k) {
            if (i == j || (i > j) == upper) return air;
            return int(RandomStream(seed, std::uint64_t((k * 8 + j) * 8 + i)).uniform() * 4);
        });
    };
    const auto upper = half(true, 1), lower = half(false, 2);
    const std::vector<PlacedPart> parts{{upper, {9, 1, 0}, 0, false},
                                        {lower, {9, 1, 0}, 1, false},
                                        {lower, {0, 0, 1}, 0, true},
                                        {upper, {1, 0, 1}, 0, false}};
    VoxelGrid grid;
    grid.size = {18, 9, 7};
    const ComposedLayers print(grid, parts);
    const std::vector<int> voxels = voxels_of(print, 0, 7);
    std::size_t wrong = 0, at = 0;
    for (int k = 0; k < 7; ++k)
        for (int j = 0; j < 9; ++j)
            for (int i = 0; i < 18; ++i) {
                const Owned owned = owner_of(parts, i, j, k);
                CHECK(owned.others.empty());
                wrong += voxels[at++] != owned.material;
            }
    CHECK(wrong == 0);
    for (const Overlap& overlap : print.overlapped()) CHECK(overlap.voxels == 0);
}

TEST_CASE("One part that fills the print is that part") {
    const auto part = noise({12, 7, 9}, 4, 5);
    VoxelGrid grid;
    grid.size = {12, 7, 9};
    CHECK(voxels_of(ComposedLayers(grid, {{part, {}, 0, false}}), 0, 9) == voxels_of(*part, 0, 9));
}

TEST_CASE("A part at many places of one height is made once") {
    const auto part = noise({5, 5, 8}, 4, 9);
    VoxelGrid grid;
    grid.size = {30, 12, 11};
    std::vector<PlacedPart> copies;
    for (int n = 0; n < 10; ++n) copies.push_back({part, {n % 5 * 6, n / 5 * 6, 0}, 0, false});
    copies.push_back({part, {0, 0, 3}, 0, false});  // stands higher
    const ComposedLayers print(grid, copies);
    (void)voxels_of(print, 0, 11);
    for (int k = 0; k < 8; ++k) CHECK(part->made.at(k) == 2);
}

TEST_CASE("A part is seen as it stands, whoever has its voxels, and is not made twice for that") {
    const auto part = noise({5, 5, 8}, 4, 9), other = noise({6, 6, 8}, 4, 3);
    const bool alone = GENERATE(false, true);
    CAPTURE(alone);
    VoxelGrid grid;
    grid.size = alone ? part->grid().size : std::array<int, 3>{20, 12, 8};
    std::map<int, std::vector<int>> seen;
    const LayerSink look = [&](int k, const io::LayerRuns& layer) {
        CHECK(seen[k].empty());
        for (std::uint32_t row = layer.rows(); row-- > 0;)
            for (const io::Run& run : layer.row(row)) seen[k].insert(seen[k].end(), run.length, run.material);
    };
    std::vector<PlacedPart> parts{{part, {0, 0, 0}, 0, false, look}};
    if (!alone) parts.insert(parts.end(), {{part, {8, 0, 0}, 0, false}, {other, {2, 2, 0}, 1, false}});
    const ComposedLayers print(grid, parts);
    const std::vector<int> voxels = voxels_of(print, 0, 8), own = voxels_of(*part, 0, 8);
    REQUIRE(seen.size() == 8);
    std::vector<int> all;
    for (const auto& [k, layer] : seen) all.insert(all.end(), layer.begin(), layer.end());
    CHECK(all == own);
    CHECK((voxels == own) == alone);
    for (int k = 0; k < 8; ++k) CHECK(part->made.at(k) == 2);  // once by `own`
}
