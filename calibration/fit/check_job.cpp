// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/check_job.h"

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/fit/ended_fit.h"
#include "calibration/fit/fit_text.h"
#include "calibration/fit/patch_page.h"
#include "calibration/patches/patch_check.h"
#include "calibration/target/target_file.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {

JobResult run_check_job(const CheckJob& job, Progress& progress) {
    job.map.validate_of_squares(job.page);
    if (!job.page.empty()) io::expect_outputs({job.page}, job.overwrite);
    const optics::ResinSet set = io::find_resin_set(job.resins);
    MeasuredPatchOptions measured = job.measured;
    for (const optics::Resin& resin : set.resins) measured.reading.known.push_back(resin.role);
    PatchTable table = read_measured_patches(job.patches, measured, job.model, progress);
    if (table.is_of_laminates() && !job.page.empty())
        throw UsageError(fmt::format("--out with {}, laminates: there is no page of them. Leave it out.", job.patches));
    if (table.is_chart)
        job.map.validate(job.page);
    else if (!job.map.target.empty())
        if (const Target target = read_target(job.map.target); target.surfaces.empty())
            take_ends_off(table, square_ends(table, target, set, job.model.under));
    const PatchCheck check = check_resins(set, table, job.model);
    if (!job.page.empty())
        io::write_whole_file(job.page, check_report_html(table, check, set, read_patch_map(table, job.map, progress)));
    return {check_json(check, table), check_text(check, table)};
}

}  // namespace voxtone::calibration
