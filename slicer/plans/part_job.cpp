// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/part_job.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/named_path.h"
#include "io/files/json_object.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

namespace {

/// The job file, or the one that a job left in its folder.
PartJob named_job(const io::JsonObject& part, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    const std::string name = part.text(part_job_key);
    if (name.empty()) part.fail(part_job_key, "names nothing");
    const fs::path path = fs::absolute(io::named_path(folder, name)).lexically_normal();
    std::error_code none;
    if (!fs::is_directory(path, none)) return {path.string(), {}, {}, {}};
    const fs::path file = path / job_file_name;
    if (!fs::exists(file, none))
        part.fail(part_job_key,
                  fmt::format("{}: holds no {}, so that nothing says which job it is of: name the folder of a "
                              "job that was done to its end, or a job file",
                              path.string(), job_file_name));
    return {file.string(), path.string(), {}, {}};
}

}  // namespace

PartJob take_part_job(const io::JsonObject& part, const std::filesystem::path& folder,
                      std::span<const char* const> of_the_tray, SliceOptions& options, std::vector<std::string>& said) {
    PartJob job = named_job(part, folder);
    SliceOptions of_job, taken = options;
    read_job(job.file, of_job);
    read_job(job.file, taken);
    of_job = with_absolute_paths(std::move(of_job));
    if (model_kind(of_job.model) == ModelKind::tray_plan)
        part.fail(
            part_job_key,
            fmt::format("{}: is of a whole tray; name its parts here, or its stack as one (\"stack\")", job.file));
    const io::JsonObject text = io::JsonObject::read(job.file);
    if (text.has("printer")) job.printer = of_job.printer;
    job.resins = of_job.resins;
    said = of_job.named;
    for (const char* key : of_the_tray)
        if (const OptionSpec* spec = find_option(key)) {
            spec->set(taken, spec->get(options));
            std::erase(said, key);
        }
    if (options.load.empty()) taken.load = of_job.load;
    // What was said to this run is the tray's; the job's own inputs are the part's.
    taken.named = options.named;
    options = std::move(taken);
    return job;
}

}  // namespace voxtone::slicer
