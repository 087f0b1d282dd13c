// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_job.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/random.h"
#include "base/warning.h"
#include "calibration/chart/chart_mixtures.h"
#include "calibration/patches/chart_csv.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/resins/checker_contrast.h"
#include "calibration/target/ideal_patch.h"
#include "calibration/target/target_file.h"
#include "calibration/target/target_scene.h"
#include "calibration/target/target_surfaces.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/pictures/srgb_code.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {
namespace {

constexpr double opaque_mm = 15;     // of any white resin
constexpr double seen_loss = 0.001;  // of a reflectance
constexpr double preview_px_per_mm = 8;

std::optional<optics::ResinSet> known_resins(const TargetJob& job, const Target& target) {
    if (job.resin_set.empty()) return std::nullopt;
    return io::find_resin_set(job.resin_set).subset(target.roles);
}

constexpr std::size_t most_chart_patches_printed = 2000;

/// What colours are expected of resins of which nothing is known: shares alone decide then.
optics::ResinSet grey_resins(const std::vector<std::string>& roles) {
    optics::ResinSet set = optics::vero_opaque();
    const optics::Resin grey = set.resins[static_cast<std::size_t>(set.find("K"))];
    set.resins.clear();
    for (const std::string& role : roles) {
        set.resins.push_back(grey);
        set.resins.back().name = set.resins.back().role = role;
    }
    return set;
}

optics::ResinSet expected_resins(const TargetJob& job) {
    const std::vector<std::string>& roles = job.layout.roles;
    if (!job.resin_set.empty()) return io::find_resin_set(job.resin_set).subset(roles);
    const optics::ResinSet usual = optics::vero_opaque();
    const bool known = std::ranges::all_of(roles, [&](const std::string& role) { return usual.find(role) >= 0; });
    return known ? usual.subset(roles) : grey_resins(roles);
}

void shuffle(std::vector<PatchMixture>& chart) {
    RandomStream random(20261125, chart.size());
    for (std::size_t k = chart.size(); k > 1; --k)
        std::swap(chart[k - 1], chart[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
}

std::vector<PatchMixture> shuffled_chart(const TargetJob& job) {
    const std::vector<std::string>& roles = job.layout.roles;
    const std::size_t least = least_chart_patches(roles.size());
    if (job.patches < least || job.patches > most_chart_patches_printed)
        throw UsageError(fmt::format("--patches {}: with {} resins a chart has {} to {} patches", job.patches,
                                     roles.size(), least, most_chart_patches_printed));
    std::vector<PatchMixture> chart;
    for (const std::vector<int>& percents : chart_mixtures(expected_resins(job), job.patches)) {
        PatchMixture& mixture = chart.emplace_back();
        for (std::size_t r = 0; r < roles.size(); ++r)
            if (percents[r] > 0) mixture.push_back({roles[r], percents[r] / 100.0});
        std::ranges::sort(mixture, {}, &ResinShare::role);
    }
    shuffle(chart);
    return chart;
}

/// Mixtures of two resins and more in the coarsest equal steps of which there are enough, taken evenly.
std::vector<PatchMixture> thin_mixtures(std::vector<std::string> roles, std::size_t wanted) {
    constexpr std::size_t most_thin = 500;
    constexpr int finest = 50;
    if (wanted < 2 || wanted > most_thin)
        throw UsageError(fmt::format("--patches {}: a target holds 2 to {} mixtures on each half", wanted, most_thin));
    std::ranges::sort(roles);  // as patch tables order them
    std::vector<PatchMixture> all;
    for (int steps = 2; all.size() < wanted && steps <= finest; ++steps) {
        all.clear();
        std::vector<int> parts(roles.size(), 0);
        const auto fill = [&](auto&& self, std::size_t r, int left) -> void {
            if (r + 1 < roles.size()) {
                for (parts[r] = 0; parts[r] <= left; ++parts[r]) self(self, r + 1, left - parts[r]);
                return;
            }
            parts[r] = left;
            PatchMixture mixture;
            for (std::size_t k = 0; k < roles.size(); ++k)
                if (parts[k] > 0) mixture.push_back({roles[k], double(parts[k]) / steps});
            if (mixture.size() > 1) all.push_back(std::move(mixture));
        };
        fill(fill, 0, steps);
    }
    if (all.size() < wanted)
        throw UsageError(fmt::format("--patches {}: {} resins have {} mixtures in steps of 2 %; ask for fewer", wanted,
                                     roles.size(), all.size()));
    std::vector<PatchMixture> taken;
    for (std::size_t k = 0; k < wanted; ++k) taken.push_back(all[k * all.size() / wanted]);
    shuffle(taken);
    return taken;
}

/// The light resin and the one beside which it tells most of how far both run: what other pairs add to it is less than
/// as many more of its own cells do.
std::vector<std::array<std::string, 2>> pairs_for_strips(const TargetJob& job) {
    const optics::ResinSet set = expected_resins(job);
    const optics::Resin& light = set.resins[static_cast<std::size_t>(set.find(job.layout.light))];
    std::array<std::string, 2> best{"", light.role};
    double most = 0;
    for (const optics::Resin& resin : set.resins)
        for (std::size_t c = 0; c < set.channels.size() && resin.role != light.role; ++c) {
            const double told = checker_contrast(light.medium(c), resin.medium(c), set.g).per_mm;
            if (best[0].empty() || told > most) most = told, best[0] = resin.role;
        }
    return {best};
}

std::string chart_form(const Target& target) {
    std::string text = fmt::format(
        "# illuminant: D50\n# Fill in L, a, b (2 degree), row by row from the upper left, markers upright\n"
        "{}patch,row,column,{},L,a,b\n",
        resins_comment(target.roles), fmt::join(target.roles, ","));
    const auto places = square_places(target);
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        text += fmt::format("{},{},{}", s + 1, places[s][0], places[s][1]);
        for (const std::string& role : target.roles) {
            const auto share = std::ranges::find(target.squares[s].top, role, &ResinShare::role);
            text += fmt::format(",{:.2f}", share == target.squares[s].top.end() ? 0.0 : share->fraction);
        }
        text += ",,,\n";
    }
    return text;
}

/// What light goes through the base, where that can be told.
void warn_of_base(const Target& target, const std::optional<optics::ResinSet>& set, Progress& progress) {
    if (!set) {
        if (target.base_mm < opaque_mm)
            progress.warn(named_warning(
                "thin-base",
                fmt::format(
                    "A base of {:.4g} mm may not be opaque: of Vero white, 5 mm are 0.03 darker over black than 15 mm. "
                    "Photograph the target on a black sheet (the fit knows the thickness), print --base 15mm, or give "
                    "--resin-set to have it computed.",
                    target.base_mm)));
        return;
    }
    for (const std::string& role : {target.light, target.dark}) {
        const std::vector<double> lost = lost_through_base(*set, role, target.base_mm);
        if (*std::max_element(lost.begin(), lost.end()) > seen_loss)
            progress.warn(named_warning(
                "thin-base",
                fmt::format("{:.4g} mm of {} are not opaque: over black they are {:.3f} darker (by channel) than "
                            "without end. Photograph the target on a black sheet (the fit knows the thickness) or "
                            "print a thicker base.",
                            target.base_mm, role, fmt::join(lost, ", "))));
    }
}

TargetColours preview_colours(const TargetJob& job, const Target& target, const std::optional<optics::ResinSet>& set) {
    if (set) return reflected_colours(target, *set);
    VOXTONE_EXPECT(job.display_rgb.size() == target.roles.size());
    std::vector<Eigen::Vector3d> colours;
    for (const auto& [red, green, blue] : job.display_rgb)
        colours.emplace_back(io::srgb8_to_linear()[red], io::srgb8_to_linear()[green], io::srgb8_to_linear()[blue]);
    return drawn_colours(target, colours);
}

void write_description(const TargetJob& job, const Target& target, const std::optional<optics::ResinSet>& set) {
    const std::filesystem::path out(job.out);
    const io::LinearPicture preview = target_preview(target, preview_colours(job, target, set), preview_px_per_mm);
    io::write_whole_file(out / "target.png", io::png_bytes(io::encode_over(preview, Eigen::Vector3f::Zero())));
    io::write_whole_file(out / "target.json", target_text(target));
    if (target.is_chart()) io::write_whole_file(out / "chart.csv", chart_form(target));
}

JobResult result_of(const TargetJob& job, const Target& target, const Eigen::Vector3d& size_mm,
                    const io::StackDescription& stack) {
    double ml = 0;
    for (const io::StackResin& resin : stack.resins) ml += resin.ml;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-target").add("version", 1);
    json.add("target", (std::filesystem::path(job.out) / "target.json").string());
    json.add("squares", target.squares.size()).add("size_mm", size_mm).add("layers", stack.layers).add("ml", ml);
    json.add("content_sha256", stack.content_sha256).end_object();
    return {json.text(), fmt::format("{}: {}, {} squares, {:.1f} x {:.1f} x {:.2f} mm, {} layers, {:.1f} ml; "
                                     "described by target.json, drawn in target.png{}\n",
                                     job.out,
                                     target.is_chart()             ? "chart"
                                     : target.layout == "mixtures" ? "thin mixtures"
                                                                   : "layout " + target.layout,
                                     target.squares.size(), size_mm.x(), size_mm.y(), size_mm.z(), stack.layers, ml,
                                     target.is_chart() ? "; measurements go into chart.csv" : "")};
}

}  // namespace

void TargetJob::validate() const {
    if (out.empty()) throw UsageError("--out is missing: the folder of the target's stack");
    if (strips && !surfaces.empty())
        throw UsageError("--strips with --surface: checkers want a base of resin; leave one of them out");
}

JobResult run_target_job(const TargetJob& job, const PrintBoxes& print, Progress& progress) {
    job.validate();
    TargetOptions layout = job.layout;
    for (const std::string& surface : job.surfaces) layout.surfaces.push_back(parse_target_surface(surface));
    if (job.patches > 0) {
        layout.layout = TargetLayout::chart;
        layout.chart = shuffled_chart(job);
    } else if (job.thin > 0) {
        layout.layout = TargetLayout::mixtures;
        layout.chart = thin_mixtures(layout.roles, job.thin);
    }
    if (job.strips) layout.strips = pairs_for_strips(job);
    const Target target = lay_out_target(layout);
    const std::optional<optics::ResinSet> set = known_resins(job, target);
    if (!target.is_chart() && target.surfaces.empty()) warn_of_base(target, set, progress);
    const Eigen::Vector3d size_mm(target.size_mm.x(), target.size_mm.y(), target.height_mm());
    const io::StackDescription stack = print(target_boxes(target), size_mm, progress);
    write_description(job, target, set);
    return result_of(job, target, size_mm, stack);
}

}  // namespace voxtone::calibration
