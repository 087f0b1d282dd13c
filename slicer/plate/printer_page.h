// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of a job's printer folder (slicer/printer/how_to_print.h), with what support touches of its bodies.
//
// Support fills what lies below an overhang, down to the tray (slicer/look/support_contact.h has the same rule), so a
// face is on support where its column is filled anywhere above it, or where it lies on the tray. Counted in pieces of
// the visible surface.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "io/layers/layer_stack_writer.h"
#include "slicer/part/job_body.h"
#include "slicer/part/opened_job.h"
#include "slicer/printer/how_to_print.h"

namespace voxtone::slicer {

/// A body and where its copies lie in a print.
struct PlacedBody {
    std::string name;
    const JobBody& body;
    std::vector<std::array<int, 3>> at;  ///< of the corner of its grid, in voxels from the print's; one for each copy
};

[[nodiscard]] PartFinish finish_of(const PlacedBody& placed, const io::StackDescription& stack,
                                   const io::TopmostLayers& topmost);

/// What was asked for of the bodies where they are seen from above: who stands at the printer sees by it which way a
/// print lies, and whether it came out mirrored. Lower places are a fifth darker. Keeps references to what it is given.
[[nodiscard]] ColourOfColumn colour_from_above(const std::vector<PlacedBody>& bodies,
                                               const io::StackDescription& stack);

/// Keeps references to the job and the bodies. `missing`: names of parts that failed.
[[nodiscard]] io::PageOfStack printer_page(const OpenedJob& job, std::string title, std::vector<PlacedBody> bodies,
                                           std::vector<std::string> missing = {});

/// Hands OUT/printer over to `target` (--for-printer; empty: nowhere), and says so. Throws as io::hand_to_printer.
void hand_over(const std::filesystem::path& out, const std::filesystem::path& target, bool overwrite,
               Progress& progress);

}  // namespace voxtone::slicer
