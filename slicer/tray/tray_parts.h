// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of a tray, ready to be printed, and the places of their copies.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slicer/job/prepared_job.h"
#include "slicer/layers/composed_layers.h"
#include "slicer/tray/nesting.h"
#include "slicer/tray/tray_plan.h"

namespace voxtone::slicer {

struct ReadyPart {
    TrayPart part;
    std::unique_ptr<PreparedJob> ready;
    std::string report;                       ///< report.json of the part; empty: none
    std::vector<std::array<int, 3>> at{};     ///< voxels from the print's corner, one for each copy
    std::vector<std::array<int, 3>> alone{};  ///< those of them that no joined part holds (joined_parts.h)
    bool is_joined = false;
    double shared_mm3 = 0;  ///< of a joined part: that more than one of its bodies fills
};

/// Opens a part's job, whose options say where it keeps what it comes to. `kept`: its body, where that is known. It
/// goes on from where an interrupted loop of the same job was. Throws what the job throws, ResourceError where its loop
/// takes more memory than is allowed.
[[nodiscard]] std::unique_ptr<PreparedJob> open_ready(const SliceOptions& options, std::optional<JobBody> kept,
                                                      Progress& progress);

/// Reads and prepares each part; all get the resins that the first one loads. Parts keep what they come to in
/// OUT/parts/NAME. Throws what the jobs throw, beginning with the part's place.
[[nodiscard]] std::vector<ReadyPart> prepare_parts(const TrayPlan& plan, Progress& progress);

/// What stands above each cell of `cell_mm` of the plate.
[[nodiscard]] Outline outline_of(const JobBody& body, double cell_mm);

/// Gives every copy its place: those that the plan says, and the others beside them. Returns the print's grid, which
/// begins at the corner of the tray's occupied box. Throws InputError for parts that the plan puts off the tray, and
/// for what finds no room.
[[nodiscard]] VoxelGrid arrange(std::vector<ReadyPart>& parts, double gap_mm);

}  // namespace voxtone::slicer
