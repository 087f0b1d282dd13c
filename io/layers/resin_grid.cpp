// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/resin_grid.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include "base/error.h"
#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_scan.h"
#include "io/layers/orient.h"

namespace voxtone::io {
namespace {

constexpr std::uint32_t leaf = 8;
using Tree = openvdb::Int32Tree;
static_assert(Tree::LeafNodeType::DIM == leaf);

/// Eight layers as bytes, one row of the model's y after another.
struct Slab {
    std::uint32_t width, height;
    std::vector<Material> voxels;
    Slab(std::uint32_t w, std::uint32_t h) : width(w), height(h), voxels(std::size_t{w} * h * leaf) {}
    [[nodiscard]] Material* row(std::uint32_t j, std::uint32_t k) {
        return voxels.data() + (std::size_t{k} * height + j) * width;
    }
};

void add_block(Tree& tree, Slab& slab, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const std::uint32_t ni = std::min(leaf, slab.width - i), nj = std::min(leaf, slab.height - j);
    const Material value = slab.row(j, 0)[i];
    bool uniform = ni == leaf && nj == leaf;
    bool any = false;
    for (std::uint32_t c = 0; c < leaf; ++c)
        for (std::uint32_t b = 0; b < nj; ++b) {
            const Material* const row = slab.row(j + b, c) + i;
            for (std::uint32_t a = 0; a < ni; ++a) {
                uniform &= row[a] == value;
                any |= row[a] != background;
            }
        }
    if (!any) return;
    const openvdb::Coord origin(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
    if (uniform) {
        tree.addTile(1, origin, value, true);
        return;
    }
    auto* const node = tree.touchLeaf(origin);
    for (std::uint32_t c = 0; c < leaf; ++c)
        for (std::uint32_t b = 0; b < nj; ++b) {
            const Material* const row = slab.row(j + b, c) + i;
            for (std::uint32_t a = 0; a < ni; ++a)
                if (row[a] != background)
                    node->setValueOn(
                        openvdb::Coord(static_cast<int>(i + a), static_cast<int>(j + b), static_cast<int>(k + c)),
                        row[a]);
        }
}

openvdb::math::Transform::Ptr transform_of(const StackDescription& stack, const std::array<double, 3>& pitch_um) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double pitch_mm = pitch_um[a] * 1e-3;
        matrix(axis, axis) = pitch_mm;
        matrix(3, axis) = stack.origin_mm[a] + 0.5 * pitch_mm;
    }
    return openvdb::math::Transform::createLinearTransform(matrix);
}

/// The layers of a stack as numbers of materials, in the model's frame.
openvdb::Int32Grid::Ptr read_numbers(const StackDescription& stack, const std::filesystem::path& folder,
                                     Progress* progress) {
    auto grid = openvdb::Int32Grid::create(0);
    grid->setName("resin");
    grid->setGridClass(openvdb::GRID_UNKNOWN);
    for (std::size_t r = 0; r < stack.resins.size(); ++r)
        grid->insertMeta(fmt::format("resin_{}", r + 1),
                         openvdb::StringMetadata(fmt::format("{} {}", stack.resins[r].role, stack.resins[r].name)));
    auto size = stack.size_px;
    auto pitch = stack.pitch_um;
    if (stack.orientation.swap_xy) {
        std::swap(size[0], size[1]);
        std::swap(pitch[0], pitch[1]);
    }
    grid->setTransform(transform_of(stack, pitch));

    const auto palette = stack.palette();
    Slab slab(size[0], size[1]);
    if (progress) progress->begin_stage("volume", stack.layers, "layers");
    for (std::uint32_t first = 0; first < stack.layers; first += leaf) {
        std::fill(slab.voxels.begin(), slab.voxels.end(), background);
        const std::uint32_t count = std::min(leaf, stack.layers - first);
        parallel_for(
            0, count, 1,
            [&](std::size_t c) {
                const auto k = static_cast<std::uint32_t>(c);
                const auto path = folder / stack.layer_path(first + k);
                auto scan = scan_layer(read_whole_file(path, std::uint64_t{256} << 20), path.string(), palette);
                if (!scan.runs)
                    throw InputError(fmt::format("{}: has a colour that stands for no resin", path.string()));
                const LayerRuns layer = as_sliced(std::move(*scan.runs), stack.orientation);
                if (layer.width_px() != size[0] || layer.height_px() != size[1])
                    throw InputError(fmt::format("{}: is not of the stack's size", path.string()));
                for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
                    Material* at = slab.row(size[1] - 1 - y, k);  // rows run along -y
                    for (const Run run : layer.row(y)) {
                        std::memset(at, run.material, run.length);
                        at += run.length;
                    }
                }
            },
            progress);
        for (std::uint32_t j = 0; j < size[1]; j += leaf)
            for (std::uint32_t i = 0; i < size[0]; i += leaf) add_block(grid->tree(), slab, i, j, first);
        if (progress) progress->advance(count);
    }
    openvdb::tools::prune(grid->tree());
    if (progress) progress->end_stage();
    return grid;
}

/// 1 where a material is, of numbers of materials.
openvdb::FloatTree::Ptr where_is(const Tree& numbers, std::int32_t material) {
    auto places = std::make_shared<openvdb::FloatTree>(0.0f);
    auto tile = numbers.cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (*tile == material) places->addTile(tile.getLevel(), tile.getCoord(), 1.0f, true);
    for (auto node = numbers.cbeginLeaf(); node; ++node) {
        openvdb::FloatTree::LeafNodeType* place = nullptr;
        for (auto voxel = node->cbeginValueOn(); voxel; ++voxel) {
            if (*voxel != material) continue;
            if (!place) place = places->touchLeaf(node->origin());
            place->setValueOn(voxel.getCoord(), 1.0f);
        }
    }
    return places;
}

/// Grid `index` of the file for other programs: the body, then each resin.
openvdb::FloatGrid::Ptr float_grid(const openvdb::Int32Grid& numbers, const StackDescription& stack,
                                   std::size_t index) {
    auto grid = openvdb::FloatGrid::create(
        index == 0 ? std::make_shared<openvdb::FloatTree>(numbers.tree(), 0.0f, 1.0f, openvdb::TopologyCopy())
                   : where_is(numbers.tree(), static_cast<std::int32_t>(index)));
    constexpr const char* body = "density";  // as programs that draw smoke look for it
    grid->setName(body);
    if (index > 0) {
        const StackResin& resin = stack.resins[index - 1];
        grid->setName(resin.role == body ? "resin " + resin.role : resin.role);
        grid->insertMeta("resin", openvdb::StringMetadata(resin.name));
    }
    grid->setTransform(numbers.transform().copy());
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setSaveFloatAsHalf(true);
    openvdb::tools::prune(grid->tree());
    return grid;
}

/// A file of several grids, each of which is made when its turn comes: there is memory for one.
class GridsInTurn : public openvdb::io::Archive {
public:
    template <class Make>
    void write_each(std::ostream& out, std::size_t count, const Make& make) const {
        writeHeader(out, true);
        openvdb::MetaMap().writeMeta(out);
        const auto number = static_cast<std::int32_t>(count);
        out.write(reinterpret_cast<const char*>(&number), sizeof number);
        for (std::size_t i = 0; i < count; ++i) {
            const openvdb::GridBase::ConstPtr grid = make(i);
            openvdb::io::GridDescriptor descriptor(grid->getName(), grid->type(), grid->saveFloatAsHalf());
            writeGrid(descriptor, grid, out, true);
        }
    }
};

template <class Make>
void write_grids(const std::filesystem::path& file, std::size_t count, const Make& make) {
    try {
        std::ofstream out(part_path(file), std::ios::binary | std::ios::trunc);
        GridsInTurn().write_each(out, count, make);
        out.close();
        if (!out) throw FileError(fmt::format("{}: could not be written; is the disk full?", file.string()));
    } catch (const openvdb::Exception& error) {
        throw FileError(fmt::format("{}: could not be written ({})", file.string(), error.what()));
    }
    finish_part(file);
}

}  // namespace

void write_resin_grids(const std::filesystem::path& file, const std::filesystem::path& numbers_file,
                       const StackDescription& stack, const std::filesystem::path& folder, Progress* progress) {
    openvdb::initialize();
    const openvdb::Int32Grid::Ptr numbers = read_numbers(stack, folder, progress);
    write_grids(numbers_file, 1, [&](std::size_t) { return numbers; });
    write_grids(file, 1 + stack.resins.size(), [&](std::size_t i) {
        if (progress) progress->check_cancelled();
        return float_grid(*numbers, stack, i);
    });
}

}  // namespace voxtone::io

void voxtone_write_resin_grids(const std::filesystem::path& file, const std::filesystem::path& numbers,
                               const voxtone::io::StackDescription& stack, const std::filesystem::path& folder,
                               voxtone::Progress* progress) {
    voxtone::io::write_resin_grids(file, numbers, stack, folder, progress);
}
