// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/run_print.h"

#include <filesystem>
#include <memory>

#include "base/error.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_values.h"
#include "slicer/print/body_plate.h"
#include "slicer/print/merged_tray.h"
#include "slicer/print/run_shard.h"
#include "slicer/print/run_whole.h"
#include "slicer/print/tray_estimate.h"
#include "slicer/print/tray_plate.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

bool is_plan_of_tray(const SliceOptions& options) { return model_kind(options.model) == ModelKind::tray_plan; }

bool is_of_tray(const PrintRequest& request) {
    return request.of_tray || !request.models.empty() || is_plan_of_tray(request.options);
}

bool holds_tray(const fs::path& out) {
    for (const fs::path& folder : {io::shards_folder(out), out}) try {
            SliceOptions recorded;
            read_job((folder / job_file_name).string(), recorded);
            return is_plan_of_tray(recorded);
        } catch (const Error&) {
            continue;  // whoever reads it says what is wrong
        }
    return false;
}

}  // namespace

JobResult run_print(PrintRequest request, Progress& progress) {
    const SliceOptions& options = request.options;
    std::unique_ptr<Plate> plate;
    if (is_of_tray(request)) {
        // Its plan is made there before it is opened.
        if (options.out.empty()) throw UsageError("tray: name the folder for the print (-o OUT)");
        if (request.models.empty() && !is_plan_of_tray(options) && !options.model.empty())
            request.models.files = {options.model};
        plate = tray_plate(options, request.models);
    } else {
        plate = body_plate(options, progress);
    }
    return options.shard.empty() ? run_whole(*plate, progress) : run_shard(*plate, progress);
}

JobResult run_merge(const MergeOptions& options, Progress& progress) {
    const bool of_tray = holds_tray(options.out);
    return run_merge_job(options, of_tray ? telling_of_tray(options, progress) : telling_of_body(options, progress),
                         progress);
}

JobEstimate estimate_print(const PrintRequest& request, Progress& progress, const EstimateScope& scope) {
    return is_of_tray(request) ? estimate_tray(request.options, request.models, progress, scope)
                               : estimate_job(request.options, progress, scope);
}

}  // namespace voxtone::slicer
