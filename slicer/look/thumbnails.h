// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small pictures of some layers for the report, evenly spaced from the first to the last, made while layers are. They
// are for browsers that cannot show the report's voxels (voxel_sample.h), and few, to leave room for these.
#pragma once

#include <map>
#include <mutex>
#include <vector>

#include "io/layers/layer_runs.h"
#include "io/report/report.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

class Thumbnails {
public:
    static constexpr int most = 12;

    /// Of `layers` layers from `first`; `palette`: background and resins.
    Thumbnails(int first, int layers, const VoxelGrid& grid, std::vector<io::Rgb> palette);

    /// Takes it or not. From any thread, once for each layer.
    void offer(int k, const io::LayerRuns& layer);
    /// From the bottom up; nothing is left here.
    [[nodiscard]] std::vector<io::ReportLayer> take();

private:
    [[nodiscard]] int slot_of(int k) const;
    [[nodiscard]] int layer_of(int slot) const;

    int first_, layers_, count_;
    VoxelGrid grid_;
    std::vector<io::Rgb> palette_;
    std::mutex mutex_;
    std::map<int, io::ReportLayer> entries_;
};

}  // namespace voxtone::slicer
