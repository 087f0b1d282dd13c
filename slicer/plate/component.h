// SPDX-License-Identifier: GPL-3.0-or-later
//
// From what a plan says of a component to its voxels.
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "slicer/part/opened_job.h"
#include "slicer/plans/tray_part.h"
#include "slicer/plate/ready_component.h"

namespace voxtone::slicer {

/// `common`: the printer and the resins of the tray. A stack is read once through, so that one that is torn, or not
/// what its manifest says, is refused before time is spent. Throws InputError (of another pitch, a resin that is not
/// loaded, layers missing or changed, no voxel), FileError, Cancelled.
[[nodiscard]] ReadyComponent prepare_component(const TrayPart& part, const OpenedJob& common, Progress& progress);

/// Most that its layers, once, take on disk.
[[nodiscard]] std::uint64_t component_disk_bytes(const ReadyComponent& component, bool cuts, const OpenedJob& common);

}  // namespace voxtone::slicer
