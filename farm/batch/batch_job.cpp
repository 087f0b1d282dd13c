// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/batch_job.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/machine_memory.h"
#include "base/progress_bar.h"
#include "base/stop_deadline.h"
#include "base/warning.h"
#include "farm/batch/arrivals.h"
#include "farm/batch/batch_queue.h"
#include "farm/batch/batch_summary.h"
#include "farm/batch/side_names.h"
#include "io/disk/disk_space.h"
#include "io/files/json_writer.h"
#include "io/models/foreign_kind.h"
#include "io/models/model_reader.h"
#include "slicer/options/command_words.h"
#include "slicer/options/resolve_job.h"

namespace voxtone::farm {

namespace {

using Stage = QueuedJob::Stage;

void say_what_there_is(const BatchQueue& queue, std::size_t jobs, const BatchOptions& options, Progress& progress) {
    std::string text = fmt::format("{} on {} with {} of memory", counted(jobs, "job"),
                                   counted(std::uint64_t(queue.cores()), "core"), memory_text(queue.memory_bytes()));
    if (const auto free = io::free_disk_bytes(options.out))
        text += fmt::format("; the disk of {} has {} free", options.out.string(), io::bytes_text(*free));
    progress.note(text);
}

/// Of a batch in which jobs failed.
ExitCode exit_code_of(const BatchQueue& queue) {
    ExitCode code = ExitCode::done;
    for (const auto& job : queue.jobs()) {
        if (job->stage() != Stage::failed) continue;
        const auto of_job = static_cast<ExitCode>(job->state().exit_code);
        if (of_job != ExitCode::try_again) return of_job;
        code = of_job;
    }
    return code;
}

std::size_t jobs_with_losses(const BatchQueue& queue) {
    return std::size_t(std::ranges::count_if(queue.jobs(), [](const auto& job) {
        return job->stage() == Stage::done && job->state().figures && !lost_colours(*job->state().figures).empty();
    }));
}

std::string result_json(const BatchQueue& queue, const BatchOptions& options, double seconds) {
    const BatchSnapshot all = queue.snapshot(false);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-batch-result").add("version", 1).add("out", options.out.string());
    json.add("jobs", all.jobs).add("done", all.done).add("unchanged", all.unchanged).add("failed", all.failed);
    json.add("left", all.left())
        .add("lost_colours", jobs_with_losses(queue))
        .add("seconds", seconds)
        .key("failures")
        .begin_list();
    for (const auto& job : queue.jobs())
        if (job->stage() == Stage::failed)
            json.begin_object()
                .add("job", job->name())
                .add("exit_code", job->state().exit_code)
                .add("message", job->state().message)
                .end_object();
    return json.end_list().end_object().text();
}

std::string result_text(const BatchQueue& queue, const BatchOptions& options, double seconds) {
    const BatchSnapshot all = queue.snapshot(false);
    std::string text = fmt::format("{}: {} of {} done", options.out.string(), all.done, counted(all.jobs, "job"));
    if (all.unchanged > 0) text += fmt::format(" ({} before, and unchanged)", all.unchanged);
    if (all.failed > 0) text += fmt::format(", {} failed", all.failed);
    if (all.left() > 0) text += fmt::format(", {} left", all.left());
    if (const std::size_t lossy = jobs_with_losses(queue)) text += fmt::format(", {} LOST colours", lossy);
    text += fmt::format(", in {}\n", duration_text(seconds));
    for (const auto& job : queue.jobs())
        if (job->stage() == Stage::failed)
            text += fmt::format("  {} failed (exit code {}): {}\n", job->name(), job->state().exit_code,
                                job->state().message);
    return text + fmt::format("summary: {}\n", (options.out / batch_page_name).string());
}

/// A summary that cannot be written takes nothing from what was done.
void summarise(const BatchFolder& folder, Progress& progress) {
    try {
        write_batch_summary(folder);
    } catch (const Error& error) {
        progress.warn(named_warning("not-noted", fmt::format("the summary could not be written: {}", error.what())));
    }
}

/// What is asked of a batch that is told to stop: it saves what runs.
void expect_no_stop(BatchQueue& queue, const BatchFolder& folder, Progress& progress) {
    if (!progress.cancelled()) return;
    queue.stop();
    summarise(folder, progress);
    const BatchSnapshot all = queue.snapshot(false);
    set_stop_advice(fmt::format("{} of {} done, and what ran is saved as far as it was; run the same command again",
                                all.done, counted(all.jobs, "job")));
    throw Cancelled();
}

/// Until nothing is left to do.
void work(BatchQueue& queue, const BatchFolder& folder, BatchView& view, Progress& progress) {
    constexpr double summary_every_s = 30;
    Stopwatch since_summary;
    std::size_t summed_up = 0;
    for (bool left = true; left;) {
        left = queue.step();
        expect_no_stop(queue, folder, progress);
        if (view.wants_snapshot()) view.show(queue.snapshot(true));
        const BatchSnapshot all = queue.snapshot(false);
        if (since_summary.total() < summary_every_s || summed_up == all.done + all.failed) continue;
        summarise(folder, progress);
        summed_up = all.done + all.failed;
        since_summary = Stopwatch();
    }
}

/// The jobs of models as they arrive. A model that arrives again while its job runs waits for it.
class WatchedJobs {
public:
    WatchedJobs(const PlanOptions& plan, BatchQueue& queue, Progress& progress)
        : plan_(plan), queue_(queue), progress_(progress) {}

    void take(const std::filesystem::path& model) {
        try {
            for (PlannedJob& job : plan_jobs({model.string(), {row_of(model)}, {}}, plan_, &progress_)) accept(job);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error& error) {
            progress_.warn(named_warning("no-model", error.what()));
        }
    }
    void queue_what_waits() {
        std::erase_if(waiting_, [&](const PlannedJob& job) { return queue_.add_or_replace(job); });
    }

private:
    void accept(PlannedJob& job) {
        const auto [known, is_new] = model_of_.emplace(job.name, job.options.model);
        if (!is_new && known->second != job.options.model) {
            progress_.warn(named_warning(
                "no-model", fmt::format("{}: is left aside: its job would be called '{}', as that of {}; rename it",
                                        job.options.model, job.name, known->second)));
            return;
        }
        std::erase_if(waiting_, [&](const PlannedJob& other) { return other.name == job.name; });
        waiting_.push_back(std::move(job));
    }

    const PlanOptions& plan_;
    BatchQueue& queue_;
    Progress& progress_;
    std::map<std::string, std::string> model_of_;  // by the job's name
    std::vector<PlannedJob> waiting_;
};

/// What is said of a file that was dropped into a watched folder and is no model.
std::string why_not_sliced(const std::filesystem::path& file) {
    if (std::string why = io::foreign_kind(file); !why.empty()) return why;
    if (io::is_picture_name(file))
        return fmt::format(
            "{}: is a picture, and --watch slices models only; it is left where it lies, for it may be the texture of "
            "a model to come. To slice it, name it: `voxtone batch {}`",
            file.string(), slicer::shell_line(std::array{file.string()}));
    return fmt::format("{}: is no model ({}) and is left where it lies", file.string(), io::model_name_endings);
}

/// As the job of a model would read it. Throws Error.
std::vector<io::SideFile> names_beside(const std::filesystem::path& model, const PlanOptions& plan,
                                       const Progress& progress) {
    const std::vector<PlannedJob> jobs = plan_jobs({model.string(), {row_of(model)}, {}}, plan, nullptr);
    if (jobs.empty()) return {};
    io::ReadOptions reading = slicer::resolve(jobs[0].options).reading;
    reading.progress = &progress;
    return io::side_files_of(model, reading);
}

/// Models that have become complete in a watched folder, and what is to be said of them.
class WatchedFolder {
public:
    WatchedFolder(const std::filesystem::path& folder, const PlanOptions& plan, const BatchOptions& options,
                  Progress& progress)
        : wait_s_(options.wait_s),
          progress_(progress),
          names_(
              [&plan, &progress](const std::filesystem::path& model) { return names_beside(model, plan, progress); }),
          arrivals_(folder, {quiet_s, wait_s_, clock_}, [this](const auto& model) { return names_.of(model); }) {
        (void)arrivals_.poll();
    }

    /// Looks where it is time to: what has become complete.
    [[nodiscard]] std::vector<ArrivedModel> look() {
        if (clock_() < next_look_s_) return {};
        const Arrivals::Arrived arrived = arrivals_.poll();
        tell(arrived);
        next_look_s_ = clock_() + (arrived.is_reading ? look_soon_s : look_every_s);
        std::vector<ArrivedModel> models;
        for (const std::filesystem::path& model : arrived.models) {
            models.push_back({model.string(), {}, std::ranges::find(arrived.again, model) != arrived.again.end()});
            for (const std::filesystem::path& file : arrivals_.beside(model))
                models.back().beside.push_back(file.string());
        }
        return models;
    }

private:
    static constexpr double quiet_s = 3, look_every_s = 0.5, look_soon_s = 0.05;

    void tell(const Arrivals::Arrived& arrived) {
        for (const auto& [model, names] : arrived.waits)
            progress_.note(fmt::format("{}: waits up to {:g} s for what it names and what is not there yet: {}",
                                       model.string(), wait_s_, fmt::join(names, ", ")));
        for (const std::filesystem::path& model : arrived.again)
            progress_.note(fmt::format("{}: what it names has come or changed: it is sliced again", model.string()));
        for (const auto& [model, names] : arrived.lacks)
            progress_.warn(named_warning(
                "lost-colour", fmt::format("{}: is sliced without what it names and what did not come: {}; when that "
                                           "comes, again",
                                           model.string(), fmt::join(names, ", "))));
        for (const std::filesystem::path& file : arrived.strays)
            progress_.warn(named_warning("no-model", why_not_sliced(file)));
    }

    const SecondsClock clock_ = steady_seconds();
    double wait_s_;
    Progress& progress_;
    SideNames names_;
    Arrivals arrivals_;
    double next_look_s_ = 0;
};

}  // namespace

void run_watch_job(const std::filesystem::path& watched, const PlanOptions& plan, const BatchOptions& options,
                   BatchView& view, Progress& progress) {
    if (plan.name.find("{n}") != std::string::npos || plan.name.find("{n:") != std::string::npos)
        throw UsageError("--name: names that count do not go with --watch: a model would get another at each start");
    WatchedFolder arriving(watched, plan, options, progress);
    const BatchFolder folder = BatchFolder::make(options.out);
    BatchContext context{options, folder, view, progress};
    BatchQueue queue(context);
    WatchedJobs jobs(plan, queue, progress);
    progress.note(fmt::format("watching {}; Ctrl-C ends it", watched.string()));
    std::size_t summed_up = 0;
    for (;;) {
        for (const ArrivedModel& arrived : arriving.look()) jobs.take(arrived.model);
        jobs.queue_what_waits();
        const bool busy = queue.step();
        expect_no_stop(queue, folder, progress);
        if (view.wants_snapshot()) view.show(queue.snapshot(true));
        if (const std::size_t ended = queue.ended(); !busy && ended != summed_up) {
            summarise(folder, progress);
            summed_up = ended;
        }
        constexpr std::chrono::milliseconds idle(100);
        if (!busy) std::this_thread::sleep_for(idle);
    }
}

void run_arrivals_job(const std::filesystem::path& watched, const PlanOptions& plan, const BatchOptions& options,
                      BatchView& view, Progress& progress) {
    WatchedFolder arriving(watched, plan, options, progress);
    progress.note(fmt::format("watching {}; Ctrl-C ends it", watched.string()));
    for (;;) {
        for (const ArrivedModel& arrived : arriving.look()) view.arrived(arrived);
        progress.check_cancelled();
        constexpr std::chrono::milliseconds idle(100);
        std::this_thread::sleep_for(idle);
    }
}

JobResult run_batch_job(const PlanOptions& plan, const BatchOptions& options, BatchView& view, Progress& progress) {
    const Stopwatch watch;
    std::vector<PlannedJob> jobs = read_plan(plan, &progress);
    const BatchFolder folder = BatchFolder::make(options.out);
    BatchContext context{options, folder, view, progress};
    BatchQueue queue(context);
    say_what_there_is(queue, jobs.size(), options, progress);
    for (PlannedJob& job : jobs) {
        progress.check_cancelled();
        queue.add(std::move(job));
    }
    work(queue, folder, view, progress);
    summarise(folder, progress);
    return {result_json(queue, options, watch.total()), result_text(queue, options, watch.total()),
            exit_code_of(queue)};
}

JobResult print_batch_commands(const PlanOptions& plan, const std::filesystem::path& program, Progress& progress) {
    std::string text;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-batch-commands").add("version", 1).key("commands").begin_list();
    for (const PlannedJob& job : read_plan(plan, &progress)) {
        std::vector<std::string> arguments{program.string()};
        arguments.insert(arguments.end(), job.command.begin(), job.command.end());
        text += slicer::shell_line(arguments) + "\n";
        json.value(arguments);
    }
    return {json.end_list().end_object().text(), text};
}

}  // namespace voxtone::farm
