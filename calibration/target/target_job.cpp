// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/target/target_job.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/calibration/target/ideal_patch.h"
#include "voxtone/calibration/target/target_file.h"
#include "voxtone/calibration/target/target_scene.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/pictures/srgb_code.h"
#include "voxtone/io/profiles/resin_file.h"

namespace voxtone::calibration {
namespace {

constexpr double opaque_mm = 15;     // of any white resin
constexpr double seen_loss = 0.001;  // of a reflectance
constexpr double preview_px_per_mm = 8;

std::optional<optics::ResinSet> known_resins(const TargetJob& job, const Target& target) {
    if (job.resin_set.empty()) return std::nullopt;
    return io::find_resin_set(job.resin_set).subset(target.roles);
}

/// What light goes through the base, where that can be told.
void warn_of_base(const Target& target, const std::optional<optics::ResinSet>& set, Progress& progress) {
    if (!set) {
        if (target.base_mm < opaque_mm)
            progress.warn(fmt::format(
                "A base of {:.4g} mm may not be opaque: of Vero white, 5 mm are 0.03 darker over black than 15 mm. "
                "Photograph the target on a black sheet (the fit knows the thickness), print --base 15mm, or give "
                "--resin-set to have it computed.",
                target.base_mm));
        return;
    }
    for (const std::string& role : {target.light, target.dark}) {
        const std::vector<double> lost = lost_through_base(*set, role, target.base_mm);
        if (*std::max_element(lost.begin(), lost.end()) > seen_loss)
            progress.warn(
                fmt::format("{:.4g} mm of {} are not opaque: over black they are {:.3f} darker (by channel) than "
                            "without end. Photograph the target on a black sheet (the fit knows the thickness) or "
                            "print a thicker base.",
                            target.base_mm, role, fmt::join(lost, ", ")));
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
}

JobResult result_of(const TargetJob& job, const Target& target, const Eigen::Vector3d& size_mm,
                    const io::StackDescription& stack) {
    double ml = 0;
    for (const io::StackResin& resin : stack.resins) ml += resin.ml;
    const nlohmann::ordered_json json{{"format", "voxtone-calibrate-target"},
                                      {"version", 1},
                                      {"target", (std::filesystem::path(job.out) / "target.json").string()},
                                      {"squares", target.squares.size()},
                                      {"size_mm", {size_mm.x(), size_mm.y(), size_mm.z()}},
                                      {"layers", stack.layers},
                                      {"ml", ml},
                                      {"content_sha256", stack.content_sha256}};
    return {json.dump(), fmt::format("{}: layout {}, {} squares, {:.1f} x {:.1f} x {:.2f} mm, {} layers, {:.1f} ml; "
                                     "described by target.json, drawn in target.png\n",
                                     job.out, target.layout, target.squares.size(), size_mm.x(), size_mm.y(),
                                     size_mm.z(), stack.layers, ml)};
}

}  // namespace

void TargetJob::validate() const {
    if (out.empty()) throw UsageError("--out is missing: the folder of the target's stack");
}

JobResult run_target_job(const TargetJob& job, const PrintBoxes& print, Progress& progress) {
    job.validate();
    const Target target = lay_out_target(job.layout);
    const std::optional<optics::ResinSet> set = known_resins(job, target);
    warn_of_base(target, set, progress);
    const Eigen::Vector3d size_mm(target.size_mm.x(), target.size_mm.y(), target.base_mm + target.top_mm);
    const io::StackDescription stack = print(target_boxes(target), size_mm, progress);
    write_description(job, target, set);
    return result_of(job, target, size_mm, stack);
}

}  // namespace voxtone::calibration
