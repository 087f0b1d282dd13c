// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the copies of a tray's parts stand: where the plan puts them, and the others beside them, by their outlines
// from above (nesting.h): on the plate, over each other, or where the coordinates in their files put them.
//
// Voxels are longer along one axis than along the other, so that a part turned by a right angle is another body. It is
// decided before the parts are prepared, on the bodies as they were read, and once for all copies of a part.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/plate/placed_copy.h"
#include "slicer/plate/ready_component.h"
#include "slicer/printer/printing_time.h"

namespace voxtone::slicer {

/// A part that is to have places.
struct StandingPart {
    const TrayPart* part;
    const JobBody* body;                        ///< null: a component
    const ReadyComponent* component = nullptr;  ///< null: a body

    [[nodiscard]] const VoxelGrid& grid() const { return body ? body->grid : component->layers->grid(); }
};

struct Arrangement {
    std::vector<std::vector<PlacedCopy>> copies;   ///< of each part, as many as the plan has
    std::vector<VoxelGrid> trays;                  ///< each from the corner of its occupied box
    std::vector<std::array<double, 3>> corner_mm;  ///< of each on the tray
    std::vector<std::string> notes;                ///< what there is to say: places that are no whole voxels
};

/// Throws InputError for parts that the plan puts off the tray or above it, and for what finds no room on as many trays
/// as there may be. `heads`: of the printer, in whose passes as few as can be they are laid.
[[nodiscard]] Arrangement arrange(std::span<const StandingPart> parts, const Eigen::Vector3d& tray_mm,
                                  const TrayOptions& options, const HeadPasses& heads = {});

/// Right angles by which each part is turned best; 0 for those that may not be.
[[nodiscard]] std::vector<int> turns_on_plate(std::span<const StandingPart> parts, const Eigen::Vector3d& tray_mm,
                                              double gap_mm, const HeadPasses& heads = {});
/// What `rotate` is where the part is turned so many right angles further than its options say, counter-clockwise from
/// above.
[[nodiscard]] std::string turned_further(const SliceOptions& options, int right_angles);

}  // namespace voxtone::slicer
