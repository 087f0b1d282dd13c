// SPDX-License-Identifier: GPL-3.0-or-later
//
// An upright cut through a print along x, collected from its layers as they are made: +z is up, true to scale.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/layers/layer_runs.h"
#include "io/report/report.h"
#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

class UprightCut {
public:
    /// Through the voxels of row `j`, layers first to last.
    UprightCut(const VoxelGrid& grid, int first_layer, int last_layer, int j);
    /// From any thread, once for each layer.
    void add(int k, const io::LayerRuns& layer);
    /// `palette`: background and resins; air is transparent. The longer side is about `longest_px`.
    [[nodiscard]] io::ReportPicture picture(const std::vector<io::Rgb>& palette, std::string caption,
                                            double longest_px = 1400) const;

private:
    VoxelGrid grid_;
    int first_, last_, row_;
    std::vector<io::Material> material_;  ///< layer by layer, along x
};

}  // namespace voxtone::slicer
