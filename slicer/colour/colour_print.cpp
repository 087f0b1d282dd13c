// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/colour_print.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/files/json_writer.h"
#include "slicer/colour/asked_alpha.h"
#include "slicer/colour/colour_report.h"
#include "slicer/colour/loop_report.h"
#include "slicer/colour/verdict.h"
#include "slicer/colour/viewer_report.h"
#include "slicer/look/cell_mesh.h"
#include "slicer/part/phase.h"

namespace voxtone::slicer {

namespace {

std::unique_ptr<const JobColour> separate(const OpenedJob& job, const JobBody& body, double& seconds,
                                          Progress& progress) {
    const Stopwatch watch;
    auto colour = prepare_colour(job.options.colour, job.resins, body.grid.pitch_mm,
                                 slab_under_colour(job.options, body), progress);
    seconds = watch.total();
    return colour;
}

}  // namespace

ColourPrint::ColourPrint(const OpenedJob& job, const JobBody& body, const JobIdentity& identity, const JobPlan& plan,
                         Progress& progress)
    : job_(job),
      body_(body),
      identity_(identity),
      colour_(separate(job, body, separation_s_, progress)),
      parts_(job.options, body, job.resins, *colour_, progress),
      plan_(plan),
      why_no_loop_(plan.loop.why_not) {}

SkinFile ColourPrint::skin_file() const {
    return {job_.options.loop.mixtures, identity_.opened_loop, identity_.loop, job_.options.loop};
}

bool ColourPrint::may_loop() const {
    const JobLoopOptions& loop = job_.options.loop;
    return (loop.iterations != 0 || job_.run.goes_on) && !(plan_.all_white && !loop.iterations) &&
           nothing_to_rearrange(body_, job_.resins).empty();
}

bool ColourPrint::take_saved_loop(Progress& progress) {
    const SkinFile file = skin_file();
    const JobLoopOptions& options = job_.options.loop;
    const bool is_made_here = job_.options.until == Until::loop;
    if (!file.exists()) {
        if (options.mixtures_named && !is_made_here && !job_.run.loop_elsewhere)
            throw FileError(fmt::format("{}: is not there; slice --until loop --mixtures {} makes it",
                                        file.path().string(), file.path().string()));
        return false;
    }
    if (job_.options.overwrite && !job_.run.loop_elsewhere && (is_made_here || !options.mixtures_named)) {
        foreign_skin_ = !file.is_of_this_job();
        if (foreign_skin_ || is_made_here) return false;
    }
    const double colour_mm = colour_->appearance.geometry().shell_mm;
    SavedSkin saved = file.read(halftone::skin_layers(colour_mm).size());
    progress.note(fmt::format("the appearance loop was run before: {}", file.path().string()));
    if (!saved.left_out.empty()) {
        why_no_loop_ = std::move(saved.left_out);
        return true;
    }
    loop_ = loop_of(std::move(saved), body_, parts_.zones(), colour_mm);
    print_loop();
    return true;
}

void ColourPrint::print_loop() {
    if (!loop_->mixtures.empty())
        skin_.emplace(loop_->cells->map(), loop_->mixtures, job_.resins.set.resins.size(), job_.resins.core);
}

JobResult ColourPrint::keep_loop() const {
    const SkinFile file = skin_file();
    SavedSkin skin;
    if (loop_) skin = saved_skin(*loop_);
    if (!loop_) skin.left_out = why_no_loop_.empty() ? "No appearance loop was asked for." : why_no_loop_;
    if (!loop_ || !loop_->reread) file.write(skin);
    const std::string what = loop_ ? fmt::format("{}, seen difference {:.2f} CIEDE2000 on average",
                                                 counted(loop_->result.state.steps.size() - 1, "iteration"),
                                                 loop_->result.state.steps[loop_->result.state.best].seen.mean)
                                   : skin.left_out;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-loop").add("version", 1).add("mixtures", file.path().string());
    json.add("cells", loop_ ? loop_->cells->seen.target.size() : 0).add("left_out", skin.left_out).end_object();
    return {json.text(), fmt::format("{}: {}\n", file.path().string(), what), ExitCode::done};
}

void ColourPrint::prepare(Progress& progress) {
    if (const auto* translucency = parts_.translucency())
        alpha_warning_ = PrintedAlpha(*body_.surface, parts_.surface_colour(), *translucency).warning();
    if (!alpha_warning_.empty()) progress.warn(alpha_warning_);
    if (may_loop()) {
        const Stopwatch watch;
        if (take_saved_loop(progress)) {
            loop_s_ = watch.total();
            return;
        }
        if (job_.run.loop_elsewhere)
            throw InputError(fmt::format(
                "{}: is not there, and the appearance loop is one task for all shards of a body: run the same command "
                "with --until loop in the place of --shard first, or leave the loop out (--iterations 0)",
                job_.options.loop.mixtures.string()));
    }
    if (!plan_.loop.wanted) {
        if (!why_no_loop_.empty()) progress.note(why_no_loop_);
        return;
    }
    if (!plan_.loop.does_not_fit.empty()) throw ResourceError(plan_.loop.does_not_fit);
    const Stopwatch watch;
    progress.begin_stage(name_of(Phase::prepare_loop), 0);
    auto problem = std::make_unique<const LoopProblem>(job_.options, body_, job_.resins, *colour_, parts_, progress);
    progress.end_stage();
    const LoopCheckpoint checkpoint(job_.options.out, identity_.opened_loop, identity_.loop,
                                    problem->cells->seen.target);
    prepared_.emplace(std::move(problem), checkpoint, std::nullopt);
    if (job_.run.goes_on)
        prepared_->before = checkpoint.read(progress);
    else if (checkpoint.exists())
        progress.note("--overwrite: the saved state of an interrupted appearance loop is thrown away");
    if (plan_.loop.iterations == 0 && !prepared_->before) prepared_.reset();
    loop_s_ = watch.total();
}

std::optional<ColourRecipes> ColourPrint::made_with() const {
    return ColourRecipes{colour_->appearance, colour_->separation,
                         prepared_ ? prepared_->problem->recipes.get() : nullptr};
}

void ColourPrint::rearrange(Progress& progress) {
    if (!prepared_) return;
    const Stopwatch watch;
    loop_ =
        run_job_loop(*prepared_->problem, plan_.loop, prepared_->checkpoint, std::move(prepared_->before), progress);
    loop_->seconds += loop_s_;
    print_loop();
    prepared_.reset();
    loop_s_ += watch.total();
}

std::unique_ptr<const LayerSource> ColourPrint::layers() const {
    return std::make_unique<LayerMaker>(parts_.sources(skin_ ? &*skin_ : nullptr));
}

void ColourPrint::expect_layers(const LayerRange&) {
    prediction_plan_ = plan_prediction(job_, body_, plan_, loop_.has_value());
    // One that was run for a job without a report took none.
    if (prediction_plan_.last_look && loop_->result.last_look.empty()) prediction_plan_.by = PredictionPlan::By::model;
    // The volume and its white twin are held at once.
    if (prediction_plan_.by != PredictionPlan::By::nothing)
        volume_.emplace(body_.grid, job_.options.prediction.memory_bytes / 2);
}

void ColourPrint::take_layer(int k, const io::LayerRuns& layer) {
    if (volume_) volume_->add(k, layer);
}

bool ColourPrint::sees_as_the_loop() const {
    // White all over is as white as itself, to the last bit.
    return !plan_.all_white && prediction_plan_.model == PredictionModel::transport &&
           job_.options.loop.model == PredictionModel::transport && !job_.options.picture.is_lit_from_behind() &&
           !loop_->result.state.white.empty() && colour_->appearance.geometry().white() == job_.resins.set.find("W");
}

JobPrediction ColourPrint::predict(optics::ResinVolume volume, Progress& progress) const {
    volume = parts_.without_coat(std::move(volume), job_.options.prediction.memory_bytes / 2, progress);
    if (prediction_plan_.by == PredictionPlan::By::loop) {
        JobPrediction known = prediction_of_loop(*loop_, std::move(volume));
        if (loop_->reread) find_faces(known, progress);
        return known;
    }
    std::optional<optics::ResinVolume> white;
    if (parts_.zones().any()) {
        const int white_resin = colour_->appearance.geometry().white();
        white = parts_.shape(static_cast<optics::Material>(white_resin + 1), job_.options.prediction.memory_bytes / 2,
                             progress);
    }
    // However the loop came here: a print's shards merged say what the whole says.
    const WhiteTwin twin{white ? &*white : nullptr, loop_ && sees_as_the_loop() ? &loop_->result.state.white : nullptr};
    JobPrediction prediction =
        predict_print(job_.options, prediction_plan_.model, body_, job_.resins, std::move(volume),
                      loop_ && !loop_->reread ? &loop_->cells->seen : nullptr, twin, progress);
    if (loop_) prediction.open_loop = loop_->result.state.open;
    return prediction;
}

void ColourPrint::find_faces(JobPrediction& prediction, const Progress& progress) const {
    optics::Surface& cells = prediction.predicted.surface;
    const optics::Scene scene = scene_of(prediction.volume, job_.resins, body_, job_.options.picture.backing);
    optics::Surface found = optics::find_surface(scene, cells.cell_voxels, seen_part(body_), &progress);
    if (found.cells.size() == cells.cells.size()) cells = std::move(found);
}

void ColourPrint::evaluate(const io::StackDescription&, Progress& progress) {
    const bool is_replaced = foreign_skin_ && !job_.options.keep_loop;
    if (std::error_code not_there; is_replaced) std::filesystem::remove(job_.options.loop.mixtures, not_there);
    if (!volume_) return;
    std::string why_not;
    try {
        if (auto whole = volume_->finish())
            prediction_ = predict(std::move(*whole), progress);
        else
            why_not = volume_->why_not();
    } catch (const ResourceError& error) {
        why_not = error.what();
    }
    volume_.reset();
    if (prediction_) {
        const bool known = prediction_plan_.by == PredictionPlan::By::loop;
        prediction_->seen = seen_from(*prediction_, job_.options.loop.viewing_distance_mm,
                                      job_.options.loop.intent != halftone::Intent::absolute,
                                      known ? std::exchange(loop_->result.seen_target, nullptr) : nullptr);
        if (parts_.night())
            night_ = predict_night(job_.options, prediction_plan_.model, body_, job_.resins, *parts_.night(),
                                   *prediction_, progress);
        prediction_->sides = SidesSeen(body_, prediction_->predicted.surface, progress);
        return;
    }
    prediction_plan_.why_not = "The print is not predicted: " + why_not + ".";
    progress.warn(named_warning("not-predicted", prediction_plan_.why_not));
}

std::vector<io::ReportStage> ColourPrint::stages_before_layers() const {
    return {{std::string(name_of(Phase::separate)), separation_s_}, {std::string(name_of(Phase::loop)), loop_s_}};
}

std::vector<io::ReportStage> ColourPrint::stages_after_layers() const {
    if (!prediction_) return {};
    return {{std::string(name_of(Phase::predict)), prediction_->seconds}};
}

void ColourPrint::add_to(io::Report& report) const {
    add_colour_report({job_, body_, *colour_, parts_.surface_colour(), prediction_, {}, parts_.translucency()},
                      prediction_plan_.why_not, report);
    if (loop_) report.loop = loop_report(*loop_, body_, prediction_ ? &prediction_->volume : nullptr, job_.palette());
    report.verdict =
        judge({job_, body_, *colour_, prediction_, prediction_plan_.why_not, *report.gamut, loop_, plan_.all_white});
    if (!why_no_loop_.empty() && !plan_.all_white)
        report.warnings.push_back(named_warning("loop-left-out", why_no_loop_));
    if (!alpha_warning_.empty()) report.warnings.push_back(alpha_warning_);
    add_remarks(loop_, prediction_, report);
}

ColourReport ColourPrint::drawn() const {
    ColourReport sources{job_, body_, *colour_, parts_.surface_colour(), prediction_, {}, parts_.translucency()};
    if (prediction_ && !body_.is_picture)
        sources.cell_triangles = cell_triangles(prediction_->volume, prediction_->predicted.surface);
    return sources;
}

void ColourPrint::draw(io::Report& report, Progress& progress) const {
    const ColourReport sources = drawn();
    draw_colour_report(sources, report, job_.options.out, progress);
    if (night_) report.sections.push_back(draw_night(*night_, *prediction_, job_.options.out));
    add_viewer(sources, report, progress);
}

std::optional<io::ViewerSurface> ColourPrint::viewer_surface(std::size_t bytes, Progress& progress) const {
    return slicer::viewer_surface(drawn(), bytes, progress);
}

std::string ColourPrint::summary(const io::Report& report) const {
    return colour_summary(report) + (night_ ? fmt::format("  {}\n", night_->words()) : "");
}

}  // namespace voxtone::slicer
