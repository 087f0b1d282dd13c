// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tray as a job: its model is the plan, what its parts read lies beside it (part/job_identity.h). Whole trays, shards
// and merges open theirs here.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "slicer/layers/composed_layers.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/opened_job.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/plate/arrangement.h"
#include "slicer/plate/tray_parts.h"

namespace voxtone::slicer {

/// Beside the stack: what stands where, and what became of it; the plate from above.
inline constexpr std::string_view tray_file_name = "tray.json", tray_picture_name = "tray.png";

/// The models become a plan in OUT/parts, which is made; with none the options name the plan.
[[nodiscard]] SliceOptions with_plan(SliceOptions asked, const TrayModels& models);

[[nodiscard]] TrayOptions tray_options_of(const SliceOptions& common);

struct OpenedTray {
    OpenedJob job;  ///< the tray's own: what the user said, for its identity; no part is sliced by it
    TrayPlan plan;
};

/// Throws UsageError, InputError, FileError. Changes nothing on disk.
[[nodiscard]] OpenedTray open_tray(const SliceOptions& asked);
/// The tray of these models, without a plan on disk.
[[nodiscard]] OpenedTray open_tray_of_models(SliceOptions asked, const TrayModels& models);

/// Its parts, prepared, in their places.
struct PreparedTray {
    TrayParts parts;
    Arrangement places;
    JobIdentity identity;

    /// For what all have: printer, resins, formats.
    [[nodiscard]] const OpenedJob& any_job() const { return parts.any_job(); }
    [[nodiscard]] int trays() const { return int(places.trays.size()); }
};

/// Says what there is to say. Throws what parts and places throw, and InputError for too few layers.
[[nodiscard]] PreparedTray prepare_tray(const OpenedTray& tray, Progress& progress);

/// The appearance loop of every part, kept for the next time. Parts that fail go from `ready` to `failed`.
void rearrange_parts(const OpenedTray& tray, PreparedTray& prepared, Progress& progress);

/// Who looks at the layers of a part by itself.
using PartSinks = std::map<const ReadyPart*, LayerSink>;

/// The layers of a tray, once the parts are rearranged. `seen`: by them, of the part's first copy on the tray.
[[nodiscard]] ComposedLayers compose(const PreparedTray& prepared, int tray, const PartSinks& seen = {});

/// Whether there is nothing but one body, once: the tray is the print that it would be alone.
[[nodiscard]] bool is_one_body(const PreparedTray& prepared);

/// Folder of a tray: OUT, OUT-2, OUT-3 ...
[[nodiscard]] std::filesystem::path folder_of_tray(const std::filesystem::path& out, int tray);

}  // namespace voxtone::slicer
