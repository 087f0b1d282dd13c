// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "io/layers/layer_stack_writer.h"
#include "slicer/part/opened_job.h"
#include "tests/slicer/layers/source_voxels.h"

namespace voxtone::test {

/// A stack of these voxels with its container, as the job's printer and resins have it.
inline void write_stack(const std::filesystem::path& out, const slicer::OpenedJob& job, const SourceVoxels& print) {
    slicer::VoxelGrid grid;
    grid.pitch_mm = job.printer.sliced_pitch_mm();
    grid.size = print.size;
    io::StackOutputs outputs;
    outputs.gcvf = true;
    io::LayerStackWriter writer(out, job.describe(grid, {0, print.size[2] - 1}), outputs);
    for (int k = 0; k < print.size[2]; ++k) {
        io::LayerRuns layer(std::uint32_t(print.size[0]), std::uint32_t(print.size[1]));
        for (int j = print.size[1] - 1; j >= 0; --j) {  // rows run along -y
            for (int i = 0; i < print.size[0]; ++i) layer.push(1, print.at(i, j, k));
            layer.end_row();
        }
        writer.write(std::uint32_t(k), layer);
    }
    (void)writer.finish();
}

}  // namespace voxtone::test
