// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layer_surfaces.h"

#include "io/programs/module_function.h"

namespace voxtone::scattering {

std::vector<LayerSurface> layer_surfaces(const slicer::JobBody& body, const WrappedLayers& wrapped, double cell_mm,
                                         Progress& progress) {
    using Mesh = void(const slicer::JobBody&, const WrappedLayers&, double, Progress&, std::vector<LayerSurface>&);
    std::vector<LayerSurface> surfaces;
    reinterpret_cast<Mesh*>(io::module_function("voxtone-layer-surfaces.so", "voxtone_mesh_layer_level_sets"))(
        body, wrapped, cell_mm, progress, surfaces);
    return surfaces;
}

}  // namespace voxtone::scattering
