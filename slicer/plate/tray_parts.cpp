// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/tray_parts.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/core.h>

#include "base/error.h"
#include "base/progress_bar.h"
#include "base/warning.h"
#include "io/layers/stack_folder.h"
#include "slicer/options/mark_options.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/plans/part_about.h"
#include "slicer/plate/arrangement.h"
#include "slicer/plate/component.h"
#include "slicer/plate/kept_loop.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// The part as a job of its own, whose folder is below the tray's. What lies there is the tray's: it is taken where it
/// is this job's, and replaced otherwise.
SliceOptions job_options(const TrayPart& part, const fs::path& out, const std::vector<std::string>& roles) {
    SliceOptions options = part.options;
    options.out = (out / io::parts_name / part.name).string();
    options.overwrite = true;
    if (options.load.empty()) options.load = roles;
    return options;
}

/// Whether a loop was interrupted that is this job's.
bool has_own_checkpoint(const OpenedJob& job, const Progress& progress) {
    if (!fs::exists(job.options.out / io::checkpoint_name)) return false;
    try {
        LoopCheckpoint::expect_same_job(job.options.out, opened_loop_identity(job, &progress));
        return true;
    } catch (const InputError&) {
        LoopCheckpoint::remove_from(job.options.out);  // of what the part was before
        return false;
    }
}

std::vector<std::string> roles_of(const OpenedJob& job) {
    std::vector<std::string> roles;
    for (const io::StackResin& resin : job.resins.entries) roles.push_back(resin.role);
    return roles;
}

/// A part on its way.
struct WaitingPart {
    TrayPart part;
    SliceOptions as_said{};                          ///< as a job, which may leave its resins to the printer, ...
    std::optional<OpenedJob> opened = std::nullopt;  ///< ... and with those of the tray; nothing: a component
    std::optional<JobBody> body = std::nullopt;
    std::optional<ReadyComponent> component = std::nullopt;
};

/// A job of another printer or of other resins is another print.
void expect_of_the_tray(const PartJob& said, const OpenedJob& opened) {
    const auto other = [](const std::string& a, const std::string& b) {
        std::error_code none;
        return !a.empty() && a != b && !(fs::exists(a, none) && fs::equivalent(a, b, none));
    };
    const auto refuse = [&](std::string_view what, const std::string& its, const std::string& the_trays) {
        throw InputError(
            fmt::format("{}: is a job for the {} {}, and this tray is for {}: say \"{}\" beside \"parts\", or slice "
                        "it on a tray of its own",
                        said.file, what, its, the_trays, what));
    };
    if (other(said.printer, opened.options.printer)) refuse("printer", said.printer, opened.options.printer);
    if (other(said.resins, opened.options.resins)) refuse("resins", said.resins, opened.options.resins);
}

/// Of a part that was set aside when it left the tray.
void take_back(const fs::path& folder) {
    std::error_code none;
    const fs::path aside = folder.parent_path() / earlier_parts_name / folder.filename();
    if (!fs::exists(folder, none) && fs::is_directory(aside, none)) fs::rename(aside, folder, none);
}

/// All are opened before the first is worked on: what refuses one is known before time is spent.
std::vector<WaitingPart> open_parts(const TrayPlan& plan, std::vector<FailedPart>& failed, Progress& progress) {
    std::vector<WaitingPart> waiting;
    std::vector<std::string> roles;
    for (const TrayPart& part : plan.parts) {
        if (part.component) {
            waiting.push_back({part});
            continue;
        }
        const SliceOptions options = job_options(part, plan.common.out, roles);
        take_back(options.out);
        (void)goes_well(part, plan.common.fail_fast, failed, progress, [&] {
            OpenedJob opened = open_job(options);
            if (opened.other)
                throw InputError(
                    fmt::format("shows {}, which a tray's parts cannot yet: print it alone", opened.other->what()));
            if (!roles.empty() && roles_of(opened) != roles)
                throw InputError("loads other resins than the first part: say \"load\" beside \"parts\"");
            if (part.job) expect_of_the_tray(*part.job, opened);
            if (roles.empty()) {
                roles = roles_of(opened);
                opened = open_job(job_options(part, plan.common.out, roles));
            }
            waiting.push_back({part, job_options(part, plan.common.out, {}), std::move(opened)});
        });
    }
    return waiting;
}

/// It would be replaced while it is read.
void refuse_own_stack(const TrayComponent& component, const fs::path& out) {
    std::error_code none;
    if (component.path.empty() || out.empty()) return;
    const fs::path stack = fs::weakly_canonical(component.path, none), own = fs::weakly_canonical(out, none);
    if (stack == own || stack.parent_path() == own)
        throw InputError(
            fmt::format("{}: is in the folder that this tray is made in, and cannot be a part of it: name "
                        "another folder with -o",
                        component.path));
}

void prepare_components(const TrayPlan& plan, std::vector<WaitingPart>& waiting, TrayParts& parts, Progress& progress) {
    const auto is_component = [](const WaitingPart& part) { return part.part.component.has_value(); };
    if (std::ranges::none_of(waiting, is_component)) return;
    const auto model = std::ranges::find_if_not(waiting, is_component);
    parts.common = std::make_shared<const OpenedJob>(
        *common_job(plan, model == waiting.end() ? std::vector<std::string>() : model->opened->options.load));
    std::erase_if(waiting, [&](WaitingPart& part) {
        if (!part.part.component) return false;
        return !goes_well(part.part, plan.common.fail_fast, parts.failed, progress, [&] {
            refuse_own_stack(*part.part.component, plan.common.out);
            part.component = prepare_component(part.part, *parts.common, progress);
        });
    });
}

StandingPart standing(const WaitingPart& part) {
    return {&part.part, part.body ? &*part.body : nullptr, part.component ? &*part.component : nullptr};
}

/// A mark's side or point is one of the print: turned below it, another face of the body would have it.
bool has_marked_sides(const ResolvedJob& job) {
    return std::ranges::any_of(job.marks, [](const MarkOptions& mark) {
        const MarkSide* side = std::get_if<MarkSide>(&mark.place);
        return side ? *side > MarkSide::flattest : std::holds_alternative<Eigen::Vector3d>(mark.place);
    });
}

/// Its body, turned; as it was, where it cannot be, as its labels find no place then.
void turn_part(WaitingPart& part, int turns, Progress& progress) {
    SliceOptions turned = part.opened->options.raw;
    turned.rotate = turned_further(turned, turns);
    try {
        OpenedJob job = open_job(turned);
        part.body.emplace(prepare_body(job.options, job.printer, progress));
        part.opened.emplace(std::move(job));
    } catch (const InputError& error) {
        progress.note(fmt::format("{}: is not turned, for {}", part.part.name, error.what()));
        return;
    }
    progress.note(fmt::format("{}: is turned by {} degrees", part.part.name, 90 * turns));
}

/// Turns parts that may be; their bodies are kept, so that none is read twice but those that are turned.
void turn_parts(const TrayPlan& plan, std::vector<WaitingPart>& waiting, std::vector<FailedPart>& failed,
                Progress& progress) {
    if (std::ranges::none_of(waiting, [](const WaitingPart& part) { return part.part.turn; })) return;
    std::erase_if(waiting, [&](WaitingPart& part) {
        if (part.component) return false;
        return !goes_well(part.part, plan.common.fail_fast, failed, progress, [&] {
            part.body.emplace(prepare_body(part.opened->options, part.opened->printer, progress));
            if (!part.part.turn || !has_marked_sides(part.opened->options)) return;
            part.part.turn = false;
            progress.note(part.part.name + ": is not turned, for its labels or decals have places on the print");
        });
    });
    const auto model = std::ranges::find_if(waiting, [](const WaitingPart& part) { return part.body.has_value(); });
    if (model == waiting.end()) return;
    std::vector<StandingPart> all;
    for (const WaitingPart& part : waiting) all.push_back(standing(part));
    const PrinterProfile& printer = model->opened->printer;
    const std::vector<int> turns =
        turns_on_plate(all, printer.sliced_tray_mm(), plan.common.gap_mm, printer.sliced_passes());
    for (std::size_t p = 0; p < waiting.size(); ++p)
        if (turns[p] != 0) turn_part(waiting[p], turns[p], progress);
}

/// With the loop of the job that it was alone; null where that is not to be had. The job says its resins as it did
/// then; where it chooses others for its colours than this tray loads, it is another job.
std::unique_ptr<PreparedJob> open_with_kept_loop(WaitingPart& part, bool loops_elsewhere, Progress& progress) {
    SliceOptions options = part.as_said;
    options.until = SliceOptions{}.until;  // that it is run, is done
    OpenedJob opened = open_job(options);
    if (!take_kept_loop(part.part.name, part.part.job->folder, opened, progress)) return nullptr;
    auto ready = make_ready(std::move(opened), std::move(part.body), progress, loops_elsewhere);
    if (roles_of(ready->job) == part.opened->options.load && is_loop_of(part.part.name, *ready, progress)) return ready;
    std::error_code none;
    fs::remove(ready->job.options.loop.mixtures, none);
    part.body.reset();  // is read anew
    return nullptr;
}

ReadyPart prepare_part(WaitingPart& part, bool loops_elsewhere, Progress& progress) {
    if (part.body)
        for (const std::string& warning : part.body->warnings) progress.warn(warning);
    ReadyPart made;
    made.part = part.part;
    made.component = std::move(part.component);
    if (made.component) return made;
    const bool is_turned = part.opened->options.raw.rotate != part.as_said.rotate;
    if (part.part.job && !part.part.job->folder.empty() && !is_turned)
        made.ready = open_with_kept_loop(part, loops_elsewhere, progress);
    if (!made.ready) made.ready = make_ready(*std::move(part.opened), std::move(part.body), progress, loops_elsewhere);
    return made;
}

}  // namespace

bool goes_well(const TrayPart& part, bool fail_fast, std::vector<FailedPart>& failed, Progress& progress,
               const std::function<void()>& work) {
    const auto placed = [&](const Error& error) { return fault_at_place(part, error.what()); };
    try {
        const WarningsOfPart of_part(progress, part.name);
        work();
        return true;
    } catch (const TryAgain&) {
        throw;
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        if (fail_fast) throw Error(error.exit_code(), placed(error));
        failed.push_back({part.name, placed(error), error.exit_code(), customer_of(part)});
    }
    progress.warn(failed_warning(failed.back()));
    return false;
}

std::string failed_warning(const FailedPart& part) {
    return named_warning("part-failed",
                         fmt::format("{}: fails, and the tray is made without it (--fail-fast stops there): {}",
                                     part.who(), part.message));
}

void expect_some(const std::vector<FailedPart>& failed, std::size_t ready) {
    if (ready == 0)
        throw Error(failed.front().exit_code,
                    fmt::format("none of the tray's parts can be printed; {}", failed.front().message));
}

std::unique_ptr<PreparedJob> make_ready(OpenedJob opened, std::optional<JobBody> kept, Progress& progress,
                                        bool loop_elsewhere) {
    fs::create_directories(opened.options.out);
    opened.run.goes_on = opened.run.goes_on || has_own_checkpoint(opened, progress);
    opened.run.loop_elsewhere = opened.run.loop_elsewhere || loop_elsewhere;
    auto ready = std::make_unique<PreparedJob>(std::move(opened), std::move(kept), progress);
    if (!ready->plan.loop.does_not_fit.empty()) throw ResourceError(ready->plan.loop.does_not_fit);
    return ready;
}

std::optional<OpenedJob> common_job(const TrayPlan& plan, const std::vector<std::string>& roles) {
    if (std::ranges::none_of(plan.parts, [](const TrayPart& part) { return part.component.has_value(); }))
        return std::nullopt;
    SliceOptions options = plan.common;
    for (const auto& [mirrors, name] : {std::pair{options.flip_x, "flip-x"}, std::pair{options.flip_y, "flip-y"},
                                        std::pair{options.swap_xy, "swap-xy"}})
        if (mirrors)
            throw UsageError(
                fmt::format("--{}: would mirror the tray's models, each for itself, and none of its boxes, cuts and "
                            "finished prints; mirror in the printer's profile, or in the files of the models",
                            name));
    options.model = plan.file;
    if (options.load.empty()) options.load = roles;
    return open_job(options);
}

std::uint64_t ReadyPart::disk_bytes(const OpenedJob& common) const {
    if (alone.empty()) return 0;
    if (!ready) return alone.size() * component_disk_bytes(*component, part.cuts, common);
    return ready->plan.disk_bytes +
           (alone.size() - 1) * disk_bytes_of_copy(ready->job, ready->body, ready->plan.layers);
}

const OpenedJob& TrayParts::any_job() const {
    const auto model = std::ranges::find_if(ready, [](const ReadyPart& part) { return part.ready != nullptr; });
    return model != ready.end() ? model->ready->job : *common;
}

std::string FailedPart::who() const { return name_for(name, customer); }

TrayParts prepare_parts(const TrayPlan& plan, Progress& progress) {
    TrayParts parts;
    std::vector<WaitingPart> waiting = open_parts(plan, parts.failed, progress);
    prepare_components(plan, waiting, parts, progress);
    turn_parts(plan, waiting, parts.failed, progress);
    std::size_t number = 0;
    for (WaitingPart& part : waiting) {
        progress.note(fmt::format("part {} ({} of {})", part.part.name, ++number, waiting.size()));
        (void)goes_well(part.part, plan.common.fail_fast, parts.failed, progress,
                        [&] { parts.ready.push_back(prepare_part(part, plan.loops_elsewhere, progress)); });
    }
    expect_some(parts.failed, parts.ready.size());
    return parts;
}

}  // namespace voxtone::slicer
