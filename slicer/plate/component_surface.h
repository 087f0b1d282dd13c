// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface of a component for the tray's page, from its voxels alone: cells of a fraction of a millimetre, half of
// whose voxels hold resin at least, in the colour that the mixture of their resins has in a thick layer: of a finished
// print cell by cell, of what is one mixture that of all; what is clear is seen through. No prediction: light that
// spreads between cells is left out.
#pragma once

#include <optional>

#include "base/progress.h"
#include "io/report/viewer.h"
#include "slicer/part/opened_job.h"
#include "slicer/plate/ready_component.h"

namespace voxtone::slicer {

/// In mm from the corner of its grid, with the one look "print"; in about so many bytes of a page. Nothing where no
/// cell is half full. Makes its layers. Throws what they throw, Cancelled.
[[nodiscard]] std::optional<io::ViewerSurface> component_surface(const ReadyComponent& component,
                                                                 const OpenedJob& common, std::size_t bytes,
                                                                 Progress& progress);

/// The same surface with other looks' names: it shows one thing in all of them, and differs nowhere where the others
/// know by how much they do.
[[nodiscard]] io::ViewerSurface with_looks_of(io::ViewerSurface surface, const io::ViewerSurface& other);

}  // namespace voxtone::slicer
