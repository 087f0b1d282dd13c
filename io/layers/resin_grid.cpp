// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/resin_grid.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include <fmt/core.h>
#include <openvdb/io/File.h>
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

}  // namespace

void write_resin_grid(const std::filesystem::path& file, const StackDescription& stack,
                      const std::filesystem::path& folder, Progress* progress) {
    openvdb::initialize();
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
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double pitch_mm = pitch[a] * 1e-3;
        matrix(axis, axis) = pitch_mm;
        matrix(3, axis) = stack.origin_mm[a] + 0.5 * pitch_mm;
    }
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));

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
    try {
        openvdb::io::File out(part_path(file).string());
        out.write({grid});
        out.close();
    } catch (const openvdb::Exception& error) {
        throw FileError(fmt::format("{}: could not be written ({})", file.string(), error.what()));
    }
    finish_part(file);
}

}  // namespace voxtone::io

void voxtone_write_resin_grid(const std::filesystem::path& file, const voxtone::io::StackDescription& stack,
                              const std::filesystem::path& folder, voxtone::Progress* progress) {
    voxtone::io::write_resin_grid(file, stack, folder, progress);
}
