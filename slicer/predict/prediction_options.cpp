// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/prediction_options.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

namespace {

std::string extension(const std::string& file) {
    std::string ending = std::filesystem::path(file).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

/// "auto": nothing.
std::optional<BackingChoice> backing_or_auto(const std::string& text) {
    if (text == "auto") return std::nullopt;
    return parse_backing("backing", text);
}

}  // namespace

void expect_files_fit(const ResolvedPrediction& job, bool from_above) {
    for (std::size_t i = 0; i < job.kinds.size(); ++i) {
        const std::string& file = job.requested.files[i];
        const PredictedFile kind = job.kinds[i];
        if (from_above && (kind == PredictedFile::glb || kind == PredictedFile::ply))
            throw UsageError(
                fmt::format("{}: the stack is seen from above as a picture (.png, .exr); for a mesh of its whole "
                            "surface give --view body",
                            file));
        if (!from_above && kind == PredictedFile::exr)
            throw UsageError(fmt::format(
                "{}: the stack is seen as a body (.glb, .ply, .png); for a picture from above give --view top", file));
    }
}

ResolvedPrediction resolve_without_files(const PredictOptions& o) {
    const auto need = [](bool good, std::string_view key, const std::string& value, std::string_view rule) {
        if (!good) throw UsageError(fmt::format("--{} {}: {}", key, value, rule));
    };
    ResolvedPrediction job;
    job.requested = o;
    need(!o.lit || std::any_of(o.files.begin(), o.files.end(), [](const auto& f) { return extension(f) == ".glb"; }),
         "lit", "", "would be ignored: it only goes with a .glb");
    for (const std::string& file : o.files) {
        const auto kind = value_of<PredictedFile>(extension(file));
        need(
            kind.has_value(), "out", file,
            "the name says the kind of file: .png or .exr (slab), .glb, .ply or .png (body), .html (a page of either)");
        job.kinds.push_back(*kind);
    }
    need(o.cell_mm >= 0.01 && o.cell_mm <= 5, "cell", fmt::format("{}mm", o.cell_mm), "must be 0.01 to 5 mm");
    need(o.quality.paths >= 2 && o.quality.paths <= 1u << 20, "spp", fmt::format("{}", o.quality.paths),
         "must be 2 to 1048576");
    need(o.quality.error >= 0 && o.quality.error < 1, "error", fmt::format("{}", o.quality.error),
         "must be 0 (none wanted) or below 1");
    need(o.quality.sweeps >= 1 && o.quality.sweeps <= 100, "sweeps", fmt::format("{}", o.quality.sweeps),
         "must be 1 to 100");
    need(o.memory_gib >= 0 && o.memory_gib <= most_memory_gib, "memory", fmt::format("{}", o.memory_gib),
         "must be above 0 GiB, or 0 for half of the machine's");
    need(o.threads >= 0 && o.threads <= 1024, "threads", fmt::format("{}", o.threads), "must be 0 to 1024");
    job.boundary = parse_choice<BodyEnd>("boundary", o.boundary);
    job.outside = parse_choice<LightOutside>("outside", o.outside);
    job.model = parse_choice<PredictionModel>("predict", o.model);
    if (job.outside == LightOutside::followed && job.model == PredictionModel::monte_carlo) {
        need(job.boundary != BodyEnd::voxels, "outside", o.outside, "needs the mesh: not with --boundary voxels");
        job.boundary = BodyEnd::mesh;
    }
    job.view = parse_choice<PredictedView>("view", o.view);
    job.backing = backing_or_auto(o.backing);
    if (o.light != "auto" && o.light != "front" && o.light != "behind")
        refuse_choice("light", o.light, {"auto", "front", "behind"});
    if (o.light != "auto") job.from_behind = o.light == "behind";
    need(o.light != "behind" || !job.backing, "backing", o.backing,
         "would lie between the print and --light behind: leave one of the two out");
    if (!o.pitch.empty()) job.pitch_mm = parse_pitch_mm(o.pitch);
    for (const std::string& text : o.assign) job.assign.push_back(parse_assignment(text));
    job.memory_bytes = memory_budget(o.memory_gib);
    if (job.view != PredictedView::automatic) expect_files_fit(job, job.view == PredictedView::top);
    return job;
}

ResolvedPrediction resolve(const PredictOptions& o) {
    if (o.files.empty()) throw UsageError("--out (none): name a file: -o FILE.png");
    return resolve_without_files(o);
}

}  // namespace voxtone::slicer
