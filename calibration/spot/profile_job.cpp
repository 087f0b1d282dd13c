// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/profile_job.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/spot/profile_plot.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/profile_file.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

void check_side(const ProfileSide& side, bool photographed, const char* total, const char* photograph) {
    if (side.total && photographed)
        throw UsageError(fmt::format("{} and {} both say how much light it is; give one", total, photograph));
    if (!side.total && !photographed)
        throw UsageError(
            fmt::format("{} is missing: the measured albedo of red, green and blue; or {}, a photograph "
                        "that it is read from",
                        total, photograph));
    if (side.mm_per_px == 0) throw UsageError("--mm-per-px is missing");
}

MeasuredSide measured(const ProfileJob& job, const ProfileSide& side, const std::string& name, Progress& progress) {
    ProfileMeasureOptions options = job.measure;
    options.mm_per_px = side.mm_per_px;
    progress.begin_stage(name, 0);
    MeasuredSide result = measure_side({name, side.lit, side.dark, *side.total}, options, &progress);
    progress.end_stage();
    for (const std::string& warning : result.warnings) progress.warn(warning);
    return result;
}

void add_side(io::JsonWriter& json, const char* key, const MeasuredSide& side) {
    json.key(key).begin_object().add("centre_px", side.centre.px).add("centre_error_px", side.centre.error_px);
    json.add("samples", side.profile[0].light.size())
        .add("seconds", side.seconds)
        .add("step", side.step)
        .add("total", side.total);
    json.add("pixels_by_longest_exposure", side.pixels).add("tail", side.tail).key("channels").begin_list();
    for (const RadialProfile& p : side.profile) {
        json.begin_object().add("noise", p.noise).add("asymmetry", p.asymmetry).add("scale_error", p.scale_error);
        json.add("missing_px", p.missing).end_object();
    }
    json.end_list().end_object();
}

std::string side_text(const MeasuredSide& side, const char* name) {
    const std::size_t samples = side.profile[0].light.size();
    std::string text = fmt::format("{}: centre ({:.3f}, {:.3f}) px, to {:.4f} px; {} samples to {:.2f} mm\n", name,
                                   side.centre.px.x(), side.centre.px.y(), side.centre.error_px.maxCoeff(), samples,
                                   static_cast<double>(samples - 1) * side.spacing_mm);
    text += "  longest exposure that counts, pixels:";
    for (std::size_t k = 0; k < side.seconds.size(); ++k)
        text += fmt::format(" {} {}{}", seconds_text(side.seconds[k]), side.pixels[k + 1],
                            k + 1 < side.seconds.size() ? "," : "\n");
    constexpr const char* names[] = {"red", "green", "blue"};
    for (std::size_t c = 0; c < 3; ++c)
        text +=
            fmt::format("  {:<5} noise {:.2f} times the camera's, not round {:.2f} %, scale to {:.2f} %\n", names[c],
                        side.profile[c].noise, 100 * side.profile[c].asymmetry, 100 * side.profile[c].scale_error);
    return text;
}

std::string total_text(bool photographed, const Eigen::Vector3d& total, const char* by) {
    return photographed
               ? fmt::format("  by the {}: {:.4f}, {:.4f}, {:.4f} of the light\n", by, total[0], total[1], total[2])
               : std::string();
}

io::ProfileFile file_of(const ProfileJob& job, const MeasuredSide& R, const std::optional<MeasuredSide>& T) {
    io::ProfileFile file;
    file.name = job.name.empty() ? fs::path(job.out).stem().string() : job.name;
    file.source = fmt::format("measured from {} exposures", job.reflection.lit.size() + job.transmission.lit.size());
    for (std::size_t c = 0; c < 3; ++c) {
        file.by_channel.push_back({job.thickness_mm.value_or(0), {}, R.samples(c)});
        if (T) file.by_channel.back().T = T->samples(c);
    }
    return file;
}

}  // namespace

void ProfileJob::validate() const {
    if (!reflection.given())
        throw UsageError("--reflection is missing: photographs of the lit point from the side of the light");
    if (transmission.given() != thickness_mm.has_value())
        throw UsageError(
            "a layer has --transmission and --thickness, a target (what is wanted of a surface) has neither; one is "
            "given");
    if (thickness_mm && !(*thickness_mm > 0))
        throw UsageError(fmt::format("--thickness is {} mm; it must be above 0", *thickness_mm));
    check_side(reflection, card.has_value(), "--reflectance", "--card");
    if (!transmission.given()) {
        if (lcd) throw UsageError("--lcd: a target has no transmission; leave it out or give --transmission, too");
        return;
    }
    check_side(transmission, lcd.has_value(), "--transmittance", "--lcd");
    if (reflection.total && transmission.total) expect_no_light_made(*reflection.total, *transmission.total);
}

JobResult run_profile_job(const ProfileJob& given, Progress& progress) {
    given.validate();
    ProfileJob job = given;
    if (job.card) job.reflection.total = reflectance_by_card(*job.card, job.measure.noise, &progress);
    if (job.lcd) job.transmission.total = transmittance_by_screen(*job.lcd, job.measure.noise, &progress);
    if (job.transmission.given()) expect_no_light_made(*job.reflection.total, *job.transmission.total);
    const std::string plot = job.plot.empty() ? fs::path(job.out).replace_extension(".svg").string() : job.plot;
    io::expect_outputs({job.out, plot}, job.overwrite);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-profile").add("version", 1).add("profile", job.out);
    const MeasuredSide R = measured(job, job.reflection, "reflection", progress);
    add_side(json, "R", R);
    std::string text = side_text(R, "reflection") + total_text(job.card.has_value(), *job.reflection.total, "card");
    std::optional<MeasuredSide> T;
    if (job.transmission.given()) {
        T = measured(job, job.transmission, "transmission", progress);
        add_side(json, "T", *T);
        text += side_text(*T, "transmission") + total_text(job.lcd.has_value(), *job.transmission.total, "screen");
    }
    if (job.spot_mm) {
        const double k = blurred_from(*job.spot_mm, 0.1);
        json.add("blurred_from_per_mm", k);
        text += fmt::format(
            "The spot lowers coefficients above {:.2f} cycles per mm (waves shorter than {:.3f} mm) by more than 10 "
            "%\n",
            k, 1 / k);
    }
    const io::ProfileFile file = file_of(job, R, T);
    io::write_whole_file(job.out, io::profile_text(file));
    io::write_whole_file(plot, profile_plot(file));
    json.add("plot", plot).end_object();
    return {json.text(), text + fmt::format("Wrote {}, drawn in {}\n", job.out, plot)};
}

}  // namespace voxtone::calibration
