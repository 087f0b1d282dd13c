// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_counts.h"

namespace voxtone::slicer {

LayerCounts& LayerCounts::operator+=(const LayerCounts& other) {
    body_voxels += other.body_voxels;
    shell_voxels += other.shell_voxels;
    thin_voxels += other.thin_voxels;
    solid_s += other.solid_s;
    shell_s += other.shell_s;
    colour_s += other.colour_s;
    screen_s += other.screen_s;
    runs_s += other.runs_s;
    return *this;
}

}  // namespace voxtone::slicer
