// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a print is cut into shards: between slabs of layers, whose borders are fixed (layers/layer_maker.h), so that no
// slab is made twice, and so that each shard has the same work, as nearly as slabs allow.
//
// Work is estimated from the meshes alone, in the time that it takes to look at every triangle once: a layer's voxels
// inside the body (the area of its section, by the divergence theorem) count little, those of its coloured shell much:
// the shell below a triangle is spread over the layers that it reaches down to along its normal. The same body gives
// the same cut on every machine. docs/decisions/014 has what was measured.
#pragma once

#include <vector>

#include "io/shards/shard_number.h"
#include "slicer/options/option_values.h"
#include "slicer/part/job_body.h"

namespace voxtone::slicer {

/// Work of each slab of `slab_layers` layers of the grid, from the bottom up; in voxels of the shell. `shell_mm`: depth
/// of the coloured shell.
[[nodiscard]] std::vector<double> slab_work(const JobBody& body, double shell_mm, int slab_layers);

/// The part of `all` that a shard makes: it begins and ends at borders of slabs, but for the ends of `all`. No layers
/// (last == first - 1) where there are more shards than slabs.
[[nodiscard]] LayerRange shard_layers(const std::vector<double>& work, int slab_layers, const LayerRange& all,
                                      const io::ShardNumber& number);

}  // namespace voxtone::slicer
