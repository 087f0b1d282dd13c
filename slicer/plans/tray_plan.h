// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plan of a tray (data/schema/tray.schema.json):
//   {"format": "voxtone-tray", "version": 1, "printer": "stratasys-j750-hm", "resins": "vero-opaque", "gap": "2mm",
//    "parts": [{"model": "spot.obj", "size": "40mm", "copies": 3},
//              {"model": "card.png", "width": "30mm", "at": [0, 0], "priority": 1},
//              {"box": [10, 5, 2], "resin": "VeroClear"}]}                            (components: tray_component.h)
// or a table (.csv, .tsv, .txt of a spreadsheet) whose header names options and the words of a part:
// model,size,copies,priority. Options of a job (docs/job-files) stand beside the parts, for all of them, or in a part,
// for that one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "slicer/options/slice_options.h"
#include "slicer/plans/tray_part.h"

namespace voxtone::slicer {

/// Paths are made absolute. Nothing but the plan is read. Throws FileError, InputError that names the place and the
/// key. `common`: what was said besides. What of it was named (SliceOptions::named) wins over what the plan says of all
/// parts, and what the plan says over the rest.
[[nodiscard]] TrayPlan read_tray_plan(const std::string& file, const SliceOptions& common);

/// Words that a part of a plan may have: options, and its own.
[[nodiscard]] std::vector<std::string> keys_of_part();

/// Of the plan that stands for models alone.
inline constexpr std::string_view tray_plan_name = "tray-plan.json";
/// Models without a plan, each so many times.
struct TrayModels {
    std::vector<std::string> files;
    int copies = 1;

    [[nodiscard]] bool empty() const { return files.empty(); }
};
/// Such a plan, to be written into `folder`: a part for each model, in this order.
[[nodiscard]] std::string tray_plan_of(const TrayModels& models, const std::filesystem::path& folder);
/// What `read_tray_plan` would read of it. Nothing is written.
[[nodiscard]] TrayPlan tray_plan_of_models(const TrayModels& models, const SliceOptions& common);

/// Whether the file says that it is the plan of a tray. A table is one where its header has a word of a part that no
/// job of a batch has.
[[nodiscard]] bool is_tray_plan(const std::filesystem::path& file);

}  // namespace voxtone::slicer
