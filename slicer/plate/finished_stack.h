// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print that is sliced already, as a part of a tray: the layers of a stack of ours, or of a GCVF.
//
// A stack says its resins by name and how its bitmaps are mirrored. A container says the names that the maker's program
// uses; its bitmaps are taken to lie as this printer's do, and the air around its body, which it may have much of, is
// left away.
#pragma once

#include "base/progress.h"
#include "slicer/part/opened_job.h"
#include "slicer/plans/tray_component.h"
#include "slicer/plate/ready_component.h"

namespace voxtone::slicer {

/// Reads the stack once through. Throws as prepare_component does.
[[nodiscard]] ReadyComponent open_finished_stack(const TrayComponent& component, const OpenedJob& common,
                                                 Progress& progress);

}  // namespace voxtone::slicer
