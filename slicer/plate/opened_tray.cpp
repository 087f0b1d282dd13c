// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/opened_tray.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/stop_deadline.h"
#include "io/files/file_digest.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "slicer/options/option_table.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/plate/joined_parts.h"
#include "slicer/printer/placement.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// What has no meaning for many parts at once.
void refuse_of_one_body(const SliceOptions& options) {
    if (!options.layers.empty())
        throw UsageError("--layers: a tray is sliced whole, or in parts of equal work (--shard I/N)");
    if (!options.mixtures.empty())
        throw UsageError(
            "--mixtures: is what the loop of one body came to; a tray keeps that of its parts in OUT/parts");
}

/// Every file that a part was made of, by its name from the plan's folder. Those of parts that failed are not: once
/// they are mended it is this tray still.
std::vector<io::SideFile> files_of(const OpenedTray& tray, const TrayParts& parts) {
    const fs::path folder = fs::absolute(tray.job.options.model).parent_path();
    std::vector<io::SideFile> files;
    std::set<std::string> seen;
    const auto add = [&](const std::string& file, const std::string& sha256) {
        const std::string name = fs::proximate(fs::absolute(file), folder).generic_string();
        if (seen.insert(name).second) files.push_back({name, sha256});
    };
    for (const ReadyPart& part : parts.ready) {
        if (part.is_joined) continue;  // of files that its parts have
        if (part.component) {
            for (const std::string& file : part.component->files) add(file, io::file_sha256(file));
            continue;
        }
        if (part.part.job) add(part.part.job->file, io::file_sha256(part.part.job->file));
        for (const JobInput& input : part.ready->identity.inputs)
            if (!input.file.empty()) add(input.file, input.sha256);
    }
    return files;
}

/// What the plan says of the print is the tray's, and stands in its job.json: who looks at its stack loads it.
OpenedJob open_with_plan(SliceOptions asked, const TrayPlan& plan) {
    for (const char* key : {"printer", "resins", "load"}) {
        const OptionSpec& spec = *find_option(key);
        spec.set(asked, spec.get(plan.common));
    }
    return open_job(asked);
}

}  // namespace

SliceOptions with_plan(SliceOptions asked, const TrayModels& models) {
    if (models.empty()) return asked;
    const fs::path folder = fs::path(asked.out) / io::parts_name;
    fs::create_directories(folder);
    io::write_whole_file(folder / tray_plan_name, tray_plan_of(models, folder));
    asked.model = (folder / tray_plan_name).string();
    return asked;
}

TrayOptions tray_options_of(const SliceOptions& common) {
    return {common.gap_mm, parse_choice<Arrange>("arrange", common.arrange), common.turn, common.trays,
            common.fail_fast};
}

OpenedTray open_tray(const SliceOptions& asked) {
    if (asked.out.empty()) throw UsageError("tray: name the folder for the print (-o OUT)");
    refuse_of_one_body(asked);
    TrayPlan plan = read_tray_plan(asked.model, asked);
    return {open_with_plan(asked, plan), std::move(plan)};
}

OpenedTray open_tray_of_models(SliceOptions asked, const TrayModels& models) {
    refuse_of_one_body(asked);
    asked.model = tray_plan_name;
    TrayPlan plan = tray_plan_of_models(models, asked);
    return {open_with_plan(std::move(asked), plan), std::move(plan)};
}

PreparedTray prepare_tray(const OpenedTray& tray, Progress& progress) {
    PreparedTray prepared{prepare_parts(tray.plan, progress), {}, {}};
    std::vector<StandingPart> standing;
    for (const ReadyPart& part : prepared.parts.ready)
        standing.push_back(
            {&part.part, part.ready ? &part.ready->body : nullptr, part.component ? &*part.component : nullptr});
    const PrinterProfile printer = prepared.any_job().printer;
    for (const std::string& warning : printer.warnings()) progress.warn(warning);
    const SliceOptions& common = tray.plan.common;
    prepared.places = arrange(standing, printer.sliced_tray_mm(), tray_options_of(common), printer.sliced_passes());
    for (const std::string& note : prepared.places.notes) progress.note(note);
    for (std::size_t p = 0; p < standing.size(); ++p) prepared.parts.ready[p].copies = prepared.places.copies[p];
    join_near_parts(prepared.parts.ready, common.out, progress);
    for (const VoxelGrid& grid : prepared.places.trays) check_layer_count(grid.size[2], printer, "larger (\"size\")");
    prepared.identity = identify(tray.job, files_of(tray, prepared.parts), &progress);
    return prepared;
}

void rearrange_parts(const OpenedTray& tray, PreparedTray& prepared, Progress& progress) {
    TrayParts& parts = prepared.parts;
    std::erase_if(parts.ready, [&](ReadyPart& part) {
        if (part.alone.empty() || part.component) return false;  // its copies are all of joined parts, or finished
        progress.note(fmt::format("part {}", part.part.name));
        return !goes_well(part.part, tray.plan.common.fail_fast, parts.failed, progress, [&] {
            Print& print = *part.ready->print;
            print.prepare(progress);
            print.rearrange(progress);
            (void)print.keep_loop();
            LoopCheckpoint::remove_from(part.ready->job.options.out);
            set_stop_advice("the loops of parts that are done are kept: run the same command again");
        });
    });
}

ComposedLayers compose(const PreparedTray& prepared, int tray, const PartSinks& seen) {
    std::vector<PlacedPart> placed;
    for (const ReadyPart& part : prepared.parts.ready) {
        if (part.alone.empty()) continue;
        const std::shared_ptr<const LayerSource> layers = part.layers();
        const auto sink = seen.find(&part);
        LayerSink to = sink == seen.end() ? LayerSink() : sink->second;
        for (const PlacedCopy& copy : part.alone)
            if (copy.tray == tray)
                placed.push_back({layers, copy.at, part.part.priority, part.part.cuts, std::exchange(to, {})});
    }
    if (placed.empty())
        throw Error(prepared.parts.failed.front().exit_code,
                    fmt::format("nothing is left of tray {}; {}", tray + 1, prepared.parts.failed.front().message));
    return {prepared.places.trays[std::size_t(tray)], std::move(placed)};
}

bool is_one_body(const PreparedTray& prepared) {
    const ReadyPart* only = nullptr;
    for (const ReadyPart& part : prepared.parts.ready) {
        if (part.alone.empty()) continue;
        if (only || !part.ready || part.alone.size() > 1 || part.part.cuts) return false;
        only = &part;
    }
    return only && prepared.trays() == 1 && prepared.places.trays[0].size == only->ready->body.grid.size;
}

fs::path folder_of_tray(const fs::path& out, int tray) {
    if (tray == 0) return out;
    // "out/" is no name to add to.
    const fs::path plain = out.has_filename() ? out : out.parent_path();
    return plain.parent_path() / fmt::format("{}-{}", plain.filename().string(), tray + 1);
}

}  // namespace voxtone::slicer
