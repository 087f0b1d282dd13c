// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/resin_choice.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/parallel.h"
#include "halftone/separation/invert_appearance.h"
#include "io/profiles/resin_file.h"
#include "optics/colour/colour.h"
#include "slicer/part/job_colour.h"
#include "slicer/surface/area_samples.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

using Roles = std::vector<std::string>;

constexpr const char* clear_role = "T";

std::vector<Eigen::Vector3d> sample_colours(const JobBody& body) {
    constexpr std::size_t samples = 400;
    const Eigen::Vector3d& pitch_mm = body.grid.pitch_mm;
    const SurfaceColour asked(body.model.mesh, std::sqrt(pitch_mm.x() * pitch_mm.y()));
    const VisibleSurface& surface = *body.surface;
    const AreaSamples points(surface);
    std::vector<Eigen::Vector3d> colours;
    for (std::size_t i = 0; i < samples; ++i) {
        const auto [t, u, v] = points.at(1, i);
        const auto& corner = surface.source_uv[t];
        const Eigen::Vector2f at = float(1 - u - v) * corner[0] + float(u) * corner[1] + float(v) * corner[2];
        colours.push_back(asked.at(surface.source_triangle[t], at.x(), at.y()).cast<double>());
    }
    return colours;
}

/// Mean CIEDE2000 between colours and the nearest that these resins show on the body, taken to be thick.
double mean_loss(const OpenedJob& job, const JobBody& body, const LoadedResins& resins,
                 const std::vector<Eigen::Vector3d>& colours) {
    const optics::ShellAppearance appearance(resins.set, shell_geometry(job.options.colour, resins, body.grid.pitch_mm,
                                                                        slab_under_colour(job.options, body)));
    halftone::SeparationOptions options;
    options.channels = resins.set.channels;
    const halftone::AppearanceColour colour(appearance, options.channels);
    const auto n = static_cast<Eigen::Index>(resins.set.resins.size());
    const auto white = static_cast<Eigen::Index>(appearance.geometry().white());
    halftone::Unknowns penalty = halftone::Unknowns::Constant(n, options.ink_penalty);
    penalty[white] = 0;
    halftone::Unknowns start = halftone::Unknowns::Constant(n, 0.3);
    start[white] = 1;
    std::vector<double> loss(colours.size());
    parallel_for(0, colours.size(), 16, [&](std::size_t i) {
        const auto found = halftone::invert_appearance(colour, colours[i], penalty, options, start);
        const Eigen::Vector3d shown = colour.rgb({found.fractions.data(), static_cast<std::size_t>(n)});
        loss[i] = optics::ciede2000(optics::lab_from_linear_srgb(colours[i]), optics::lab_from_linear_srgb(shown));
    });
    return optics::summarize(loss).mean;
}

Roles candidates(const optics::ResinSet& all) {
    Roles roles;
    for (const optics::Resin& resin : all.resins)
        if (resin.role != clear_role) roles.push_back(resin.role);
    return roles;
}

/// All sets of `size` roles that hold `core`, in the order of the candidates.
std::vector<Roles> sets_of(const Roles& candidates, std::size_t size, const std::string& core) {
    std::vector<Roles> sets;
    std::vector<bool> taken(candidates.size(), false);
    std::fill(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(size), true);
    do {
        Roles roles;
        for (std::size_t i = 0; i < candidates.size(); ++i)
            if (taken[i]) roles.push_back(candidates[i]);
        if (std::find(roles.begin(), roles.end(), core) != roles.end()) sets.push_back(std::move(roles));
    } while (std::prev_permutation(taken.begin(), taken.end()));
    return sets;
}

bool is_worth_it(double then, double now) {
    constexpr double least_part = 0.75, least_gain = 0.5;
    return then < least_part * now && then < now - least_gain;
}

bool same_roles(Roles a, Roles b) {
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    return a == b;
}

Roles roles_of(const LoadedResins& resins) {
    Roles roles;
    for (const io::StackResin& entry : resins.entries) roles.push_back(entry.role);
    return roles;
}

}  // namespace

std::optional<ResinChoice> choose_resins(const OpenedJob& job, const JobBody& body, Progress& progress) {
    constexpr std::size_t most_sets = 100;  // more would take longer than the separation itself
    constexpr double nothing_to_gain = 0.1;
    const Roles usual = roles_of(job.resins);
    const std::size_t slots = usual.size();
    if (!job.options.load.empty() || job.other || body.surface->triangles.empty() || wants_clear(job.options))
        return std::nullopt;
    if (static_cast<int>(slots) < most_resins(job.printer)) return std::nullopt;
    const optics::ResinSet all = all_resins(job.options, job.printer);
    const Roles possible = candidates(all);
    if (possible.size() <= slots) return std::nullopt;
    const std::vector<Roles> sets = sets_of(possible, slots, job.options.colour.core);
    if (sets.size() < 2 || sets.size() > most_sets) return std::nullopt;

    progress.begin_stage("choose resins", sets.size(), "sets");
    const std::vector<Eigen::Vector3d> colours = sample_colours(body);
    ResinChoice choice;
    const double of_usual = mean_loss(job, body, job.resins, colours);
    if (of_usual < nothing_to_gain) {
        progress.end_stage();
        return std::nullopt;
    }
    choice.roles = usual;
    choice.mean_de2000 = of_usual;
    for (const Roles& roles : sets) {
        progress.check_cancelled();
        if (!same_roles(roles, usual))
            if (const double mean = mean_loss(job, body, load_roles(job.options, job.printer, all, roles), colours);
                mean < choice.mean_de2000) {
                choice.roles = roles;
                choice.mean_de2000 = mean;
            }
        progress.advance();
    }
    progress.end_stage();
    choice.why = fmt::format(
        "{} carries {} resins at once: {} show this model's colours best of {} sets (CIEDE2000 {:.1f} on average{}); "
        "--load names others.",
        job.printer.id, slots, fmt::join(choice.roles, ", "), sets.size(), choice.mean_de2000,
        same_roles(choice.roles, usual)
            ? ""
            : fmt::format(", {:.1f} with its default {}", of_usual, fmt::join(usual, ", ")));
    return choice;
}

OpenedJob with_best_resins(OpenedJob job, const JobBody& body, Progress& progress) {
    if (const auto choice = choose_resins(job, body, progress)) {
        job.load(choice->roles);
        job.why_these_resins = choice->why;
    }
    return job;
}

std::optional<HelpfulResin> most_helpful_resin(const OpenedJob& job, const JobBody& body) {
    Roles loaded = roles_of(job.resins);
    if (loaded.size() >= std::size_t{halftone::max_resins} || body.surface->triangles.empty()) return std::nullopt;
    const optics::ResinSet all = all_resins(job.options, job.printer);
    const std::vector<Eigen::Vector3d> colours = sample_colours(body);
    const double now = mean_loss(job, body, job.resins, colours);
    std::optional<HelpfulResin> best;
    for (const std::string& role : candidates(all)) {
        if (std::find(loaded.begin(), loaded.end(), role) != loaded.end()) continue;
        loaded.push_back(role);
        PrinterProfile roomy = job.printer;
        roomy.max_resins = halftone::max_resins;
        const double mean = mean_loss(job, body, load_roles(job.options, roomy, all, loaded), colours);
        loaded.pop_back();
        if (is_worth_it(mean, now) && (!best || mean < best->mean_de2000))
            best = {role, mean, now, static_cast<int>(loaded.size()) < most_resins(job.printer),
                    fmt::format("{},{}", fmt::join(loaded, ","), role)};
    }
    return best;
}

std::optional<CoreLoss> loss_with_white_core(const OpenedJob& job, const JobBody& body) {
    static const std::string white = "W";
    const Roles loaded = roles_of(job.resins);
    if (job.options.colour.core == white || body.surface->triangles.empty() ||
        std::find(loaded.begin(), loaded.end(), white) == loaded.end())
        return std::nullopt;
    const std::vector<Eigen::Vector3d> colours = sample_colours(body);
    ResolvedJob over_white = job.options;
    over_white.colour.core = white;
    const LoadedResins resins = load_roles(over_white, job.printer, all_resins(job.options, job.printer), loaded);
    const CoreLoss loss{mean_loss(job, body, resins, colours), mean_loss(job, body, job.resins, colours)};
    return is_worth_it(loss.mean_de2000, loss.now_de2000) ? std::optional(loss) : std::nullopt;
}

}  // namespace voxtone::slicer
