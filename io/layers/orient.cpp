// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/orient.h"

#include <algorithm>
#include <vector>

#include "base/contracts.h"

namespace voxtone::io {
namespace {

LayerRuns transposed(const LayerRuns& layer) {
    LayerRuns result(layer.height_px(), layer.width_px());
    // Some columns at a time, so that what is laid out stays small.
    constexpr std::uint32_t columns_at_once = 64;
    const std::uint32_t height = layer.height_px();
    std::vector<Material> columns(std::size_t{columns_at_once} * height);
    std::vector<std::size_t> next_run(height, 0);     // per row: the run that holds the next column
    std::vector<std::uint32_t> run_begin(height, 0);  // and where it begins
    for (std::uint32_t first = 0; first < layer.width_px(); first += columns_at_once) {
        const std::uint32_t count = std::min(columns_at_once, layer.width_px() - first);
        for (std::uint32_t y = 0; y < height; ++y) {
            const auto row = layer.row(y);
            for (std::uint32_t x = first; x < first + count; ++x) {
                while (x >= run_begin[y] + row[next_run[y]].length) run_begin[y] += row[next_run[y]++].length;
                columns[std::size_t{x - first} * height + y] = static_cast<Material>(row[next_run[y]].material);
            }
        }
        for (std::uint32_t x = 0; x < count; ++x) {
            const Material* const column = columns.data() + std::size_t{x} * height;
            for (std::uint32_t y = 0; y < height;) {
                std::uint32_t end = y + 1;
                while (end < height && column[end] == column[y]) ++end;
                result.push(end - y, column[y]);
                y = end;
            }
            result.end_row();
        }
    }
    return result;
}

}  // namespace

LayerRuns oriented(const LayerRuns& layer, const Orientation& orientation) {
    VOXTONE_EXPECT(layer.rows() == layer.height_px());
    if (orientation.swap_xy) return oriented(transposed(layer), {orientation.flip_x, orientation.flip_y, false});
    LayerRuns result(layer.width_px(), layer.height_px());
    for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
        const auto row = layer.row(orientation.flip_y ? layer.height_px() - 1 - y : y);
        auto push = [&](const Run run) { result.push(run.length, static_cast<Material>(run.material)); };
        if (orientation.flip_x)
            std::for_each(row.rbegin(), row.rend(), push);
        else
            std::for_each(row.begin(), row.end(), push);
        result.end_row();
    }
    return result;
}

LayerRuns as_sliced(LayerRuns layer, const Orientation& o) {
    if (o == Orientation{}) return layer;
    // The mirrors came last, so they go first.
    return oriented(oriented(layer, {o.flip_x, o.flip_y, false}), {false, false, o.swap_xy});
}

}  // namespace voxtone::io
