// SPDX-License-Identifier: GPL-3.0-or-later
//
// layer_surfaces.h by OpenVDB: the source of the module voxtone-layer-surfaces.so.
#pragma once

#include <vector>

#include "scattering/print/layer_surfaces.h"

namespace voxtone::scattering {

[[nodiscard]] std::vector<LayerSurface> mesh_layer_level_sets(const slicer::JobBody& body, const WrappedLayers& wrapped,
                                                              double cell_mm, Progress& progress);

}  // namespace voxtone::scattering

/// The module's door.
extern "C" void voxtone_mesh_layer_level_sets(const voxtone::slicer::JobBody& body,
                                              const voxtone::scattering::WrappedLayers& wrapped, double cell_mm,
                                              voxtone::Progress& progress,
                                              std::vector<voxtone::scattering::LayerSurface>& surfaces);
