// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/voxel_sample.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "io/files/deflate.h"
#include "io/report/viewer_data.h"

namespace voxtone::slicer {

namespace {

static_assert(io::max_materials <= 16, "two voxels a byte");
constexpr int deflate_level = 4;  // of deflate: dithered voxels become hardly smaller at higher levels

using Sizes = std::array<std::uint32_t, 3>;

std::uint32_t thinned(std::uint32_t size, std::uint32_t step) { return (size + step - 1) / step; }

Sizes steps_for(const Sizes& size, const std::array<double, 3>& pitch_mm, double most) {
    Sizes step{1, 1, 1};
    const auto voxels = [&] {
        double product = 1;
        for (std::size_t a = 0; a < 3; ++a) product *= thinned(size[a], step[a]);
        return product;
    };
    while (voxels() > most) {
        const std::uint32_t least = *std::min_element(step.begin(), step.end());
        std::size_t closest = 3;
        for (std::size_t a = 0; a < 3; ++a)
            if ((step[a] == least || least >= 2) &&
                (closest == 3 || step[a] * pitch_mm[a] < step[closest] * pitch_mm[closest]))
                closest = a;
        ++step[closest];
    }
    return step;
}

/// Rows of materials as the viewer takes them.
class HalfBytes {
public:
    HalfBytes(std::uint32_t columns, std::uint32_t rows) : columns_(columns), row_bytes_((columns + 1) / 2) {
        bytes_.assign(std::size_t{row_bytes_} * rows, std::byte{0});
    }
    void set(std::uint32_t column, std::uint32_t row, io::Material material) {
        bytes_[std::size_t{row} * row_bytes_ + column / 2] |= std::byte(material << (column % 2 ? 4 : 0));
    }
    [[nodiscard]] std::vector<std::byte> deflated() const { return io::deflated(bytes_, deflate_level); }

private:
    std::uint32_t columns_, row_bytes_;
    std::vector<std::byte> bytes_;
};

std::vector<std::byte> taken(const io::LayerRuns& layer, std::uint32_t step_x, std::uint32_t step_y) {
    HalfBytes halves(thinned(layer.width_px(), step_x), thinned(layer.height_px(), step_y));
    for (std::uint32_t y = 0; y < layer.height_px(); y += step_y) {
        std::uint32_t x = 0;
        for (const io::Run& run : layer.row(y)) {
            const std::uint32_t end = x + run.length;
            if (run.material != io::background)
                for (std::uint32_t at = thinned(x, step_x) * step_x; at < end; at += step_x)
                    halves.set(at / step_x, y / step_y, io::Material(run.material));
            x = end;
        }
    }
    return halves.deflated();
}

/// Every second column and row of what was taken.
std::vector<std::byte> thinned_again(const std::vector<std::byte>& deflated, std::uint32_t columns,
                                     std::uint32_t rows) {
    const std::size_t row_bytes = (columns + 1) / 2;
    const std::vector<std::byte> bytes = io::inflated(deflated, row_bytes * rows);
    HalfBytes halves(thinned(columns, 2), thinned(rows, 2));
    for (std::uint32_t y = 0; y < rows; y += 2)
        for (std::uint32_t x = 0; x < columns; x += 2)
            halves.set(x / 2, y / 2, std::to_integer<io::Material>(bytes[y * row_bytes + x / 2] & std::byte{15}));
    return halves.deflated();
}

template <class Keep>
void keep_if(std::vector<io::ViewerLayer>& layers, Keep keep) {
    std::vector<io::ViewerLayer> kept;
    for (std::size_t i = 0; i < layers.size(); ++i)
        if (keep(i)) kept.push_back(std::move(layers[i]));
    layers = std::move(kept);
}

void thin_sideways(io::ViewerVoxels& v) {
    const std::uint32_t columns = thinned(v.size[0], v.step[0]), rows = thinned(v.size[1], v.step[1]);
    parallel_for(0, v.layers.size(), 16,
                 [&](std::size_t i) { v.layers[i].deflated = thinned_again(v.layers[i].deflated, columns, rows); });
    v.step[0] *= 2;
    v.step[1] *= 2;
}

void make_fit(io::ViewerVoxels& v, std::size_t bytes) {
    constexpr std::uint32_t coarsest = 16;
    // Whole layers may take a third of the room.
    while (!v.whole.empty() && io::packed_bytes(v.whole) > bytes / 3) {
        const std::size_t count = v.whole.size();
        keep_if(v.whole, [count](std::size_t i) { return count > 1 && i % 2 == 0; });
    }
    while (io::packed_bytes(v) > bytes && v.step[2] < coarsest) {
        if (v.step[2] <= v.step[0]) {
            keep_if(v.layers, [](std::size_t i) { return i % 2 == 0; });
            v.step[2] *= 2;
        } else {
            thin_sideways(v);
        }
    }
}

}  // namespace

VoxelSample::VoxelSample(int first, int layers, const VoxelGrid& grid, double most)
    : first_(first), layers_(layers), grid_(grid) {
    VOXTONE_EXPECT(layers >= 1);
    step_ = steps_for({std::uint32_t(grid.size[0]), std::uint32_t(grid.size[1]), std::uint32_t(layers)},
                      {grid.pitch_mm.x(), grid.pitch_mm.y(), grid.pitch_mm.z()}, most);
}

/// Where every column and row is taken anyway, whole layers are among those that are.
bool VoxelSample::is_whole(int k) const {
    if (step_[0] == 1 && step_[1] == 1) return false;
    const std::int64_t count = std::min(most_whole_layers, layers_), at = k - first_;
    const std::int64_t slot = (at * count + layers_ - 1) / layers_;
    return slot * layers_ / count == at || at == layers_ - 1;
}

void VoxelSample::offer(int k, const io::LayerRuns& layer) {
    const bool thin = is_thinned(k), whole = is_whole(k);
    io::ViewerLayer mine{std::uint32_t(k), {}}, all{std::uint32_t(k), {}};
    if (thin) mine.deflated = taken(layer, step_[0], step_[1]);
    if (whole) all.deflated = taken(layer, 1, 1);
    if (!thin && !whole) return;
    const std::scoped_lock lock(mutex_);
    if (thin) thinned_[k] = std::move(mine);
    if (whole) whole_[k] = std::move(all);
}

io::ViewerLayers VoxelSample::take_layers() {
    io::ViewerLayers taken;
    for (auto& [k, layer] : std::exchange(thinned_, {})) taken.thinned.push_back(std::move(layer));
    for (auto& [k, layer] : std::exchange(whole_, {})) taken.whole.push_back(std::move(layer));
    return taken;
}

void VoxelSample::put(const io::ViewerLayers& layers) {
    for (const io::ViewerLayer& layer : layers.thinned) thinned_[int(layer.number)] = layer;
    for (const io::ViewerLayer& layer : layers.whole) whole_[int(layer.number)] = layer;
}

io::ViewerVoxels VoxelSample::take(std::size_t bytes) {
    io::ViewerVoxels v;
    v.size = {std::uint32_t(grid_.size[0]), std::uint32_t(grid_.size[1]), std::uint32_t(grid_.size[2])};
    v.pitch_mm = {grid_.pitch_mm.x(), grid_.pitch_mm.y(), grid_.pitch_mm.z()};
    v.step = step_;
    io::ViewerLayers taken = take_layers();
    v.layers = std::move(taken.thinned);
    v.whole = std::move(taken.whole);
    make_fit(v, bytes);
    return v;
}

io::ViewerVoxels voxels_of(const optics::ResinVolume& volume, std::size_t bytes) {
    const auto& pitch = volume.pitch_mm();
    const VoxelGrid grid{Eigen::Vector3d::Zero(), {pitch[0], pitch[1], pitch[2]}, volume.size()};
    const auto [width, height, layers] = volume.size();
    const std::array<int, 3> extent{width, height, 1};
    const std::size_t row_voxels = std::size_t(width);
    VoxelSample sample(0, layers, grid);
    parallel_for(0, std::size_t(layers), 8, [&](std::size_t k) {
        std::vector<optics::Material> layer(row_voxels * std::size_t(extent[1]));
        volume.copy_box({0, 0, int(k)}, extent, layer);
        io::LayerRuns runs{std::uint32_t(extent[0]), std::uint32_t(extent[1])};
        for (std::size_t end = layer.size(); end > 0; end -= row_voxels) {  // rows run along -y
            for (std::size_t i = end - row_voxels; i < end; ++i) runs.push(1, layer[i]);
            runs.end_row();
        }
        sample.offer(int(k), runs);
    });
    return sample.take(bytes);
}

}  // namespace voxtone::slicer
