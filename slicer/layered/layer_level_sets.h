// SPDX-License-Identifier: GPL-3.0-or-later
//
// layer_surfaces.h by OpenVDB: the source of the module voxtone-layer-surfaces.so.
#pragma once

#include <vector>

#include "slicer/layered/layer_surfaces.h"

namespace voxtone::slicer {

[[nodiscard]] std::vector<LayerSurface> mesh_layer_level_sets(const JobBody& body, const WrappedLayers& wrapped,
                                                              double cell_mm, Progress& progress);

}  // namespace voxtone::slicer

/// The module's door.
extern "C" void voxtone_mesh_layer_level_sets(const voxtone::slicer::JobBody& body,
                                              const voxtone::slicer::WrappedLayers& wrapped, double cell_mm,
                                              voxtone::Progress& progress,
                                              std::vector<voxtone::slicer::LayerSurface>& surfaces);
