// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels of a tray's parts: names in braces get the values of the part. Copies whose labels differ, by {copy}, differ
// in their surface, and so are parts of their own, each with its loop.
#pragma once

#include "slicer/plans/tray_part.h"

namespace voxtone::slicer {

/// Before parts that are called alike are numbered. Throws UsageError for labels that cannot be understood.
void label_copies(TrayPlan& plan);

}  // namespace voxtone::slicer
