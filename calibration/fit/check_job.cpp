// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/fit/check_job.h"

#include "voxtone/calibration/fit/fit_text.h"
#include "voxtone/calibration/patches/patch_check.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::calibration {

JobResult run_check_job(const CheckJob& job, Progress& progress) {
    const PatchTable table = read_measured_patches(job.patches, job.measured, job.model, progress);
    const PatchCheck check = check_resins(io::find_resin_set(job.resins), table, job.model);
    return {check_json(check, table), check_text(check, table)};
}

}  // namespace voxtone::calibration
