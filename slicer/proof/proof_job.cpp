// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_job.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/pictures/exr_writer.h"
#include "io/pictures/picture_writer.h"
#include "optics/camera/camera_paths.h"
#include "optics/colour/channels.h"
#include "slicer/proof/proof_colours.h"
#include "slicer/proof/proof_scene.h"

namespace voxtone::slicer {

namespace {

using optics::CameraPicture;

using Colours = std::vector<Eigen::Vector3f>;

/// Standard error of luminance from which a picture looks flecked: 1.2 in L* of a mid grey.
constexpr double seen_noise = 0.01;

io::LinearPicture developed(const CameraPicture& picture, const Colours& colours, double exposure_ev) {
    const auto scale = static_cast<float>(std::exp2(exposure_ev));
    io::LinearPicture out{
        static_cast<std::uint32_t>(picture.width_px), static_cast<std::uint32_t>(picture.height_px), {}};
    for (const Eigen::Vector3f& colour : colours) {
        const Eigen::Vector3f rgb = scale * colour;
        out.pixels.emplace_back(rgb.x(), rgb.y(), rgb.z(), 1.0f);
    }
    return out;
}

/// The alpha of the print that the middle of a pixel sees: matt where support touched it.
float roughness_at(const ProofScene& scene, const optics::Camera& camera, std::size_t pixel) {
    const std::optional<SeenPoint> seen = seen_print(scene, camera, pixel);
    if (!seen) return 0;
    return static_cast<float>(
        scene.camera.prints[seen->print].finish->roughness(seen->place_mm, seen->normals.geometric));
}

/// R, G, B; then A, 1; "error.R"...; sets of other channels have these besides; "samples", "roughness" and "seen" (0
/// sky, 1 ground, 2 print, 3 target).
io::NumberPicture numbers(const CameraPicture& picture, const Colours& colours, const ProofScene& scene) {
    const optics::Channels& channels = scene.channels();
    io::NumberPicture out{static_cast<std::uint32_t>(picture.width_px),
                          static_cast<std::uint32_t>(picture.height_px),
                          {"R", "G", "B", "A", "error.R", "error.G", "error.B", "samples", "roughness", "seen"},
                          {}};
    if (!channels.is_rgb())
        for (const char* of : {"", "error."})
            for (std::size_t c = 0; c < channels.size(); ++c) out.names.push_back(of + channel_word(channels, c));
    const optics::Camera camera(scene.camera.view);
    for (std::size_t p = 0; p < picture.samples.size(); ++p) {
        for (const float x : colours[p]) out.values.push_back(x);
        out.values.push_back(1);
        for (std::size_t c = 0; c < 3; ++c) out.values.push_back(picture.colour_error[3 * p + c]);
        out.values.push_back(static_cast<float>(picture.samples[p]));
        out.values.push_back(picture.sees[p] == 2 ? roughness_at(scene, camera, p) : 0.0f);
        out.values.push_back(picture.sees[p]);
        if (channels.is_rgb()) continue;
        for (const auto* rows : {&picture.value, &picture.standard_error})
            for (std::size_t c = 0; c < picture.channels; ++c) out.values.push_back((*rows)[p * picture.channels + c]);
    }
    return out;
}

std::string comment_of(const CameraPicture& picture, const ResolvedProof& job) {
    const auto [least, most] = std::minmax_element(picture.samples.begin(), picture.samples.end());
    std::string text = fmt::format(
        "Proof of a print by light paths: {} to {} samples a pixel, standard error of luminance where a body is seen "
        "{:.4f} (rms; 1 is a white diffuser that lies in the open), light {}, exposure {:+g} EV.",
        *least, *most, picture.rms_error, job.light ? name_of(*job.light) : "from a picture",
        job.requested.exposure_ev);
    if (job.requested.with_target) text += " The target, on the right, has the print's finish.";
    if (picture.rms_error > seen_noise) text += " Flecks of colour are noise of the picture, not of the print.";
    if (!picture.complete) text += " Stopped before it was as wanted.";
    return text;
}

void write_files(const CameraPicture& picture, const ProofScene& scene, const ResolvedProof& job) {
    const std::string comment = comment_of(picture, job);
    const Colours colours = proof_colours(picture, scene);
    for (const std::string& file : job.requested.files) {
        if (file.ends_with(".exr"))
            io::write_whole_file(file, io::exr_bytes(numbers(picture, colours, scene), {0, 0}, comment));
        else
            io::write_whole_file(file,
                                 io::png_bytes(io::encode_over(developed(picture, colours, job.requested.exposure_ev),
                                                               Eigen::Vector3f::Zero()),
                                               {0, 0}, comment));
    }
}

/// Sums and squares, light and shares, values and errors of the channels, and the bytes of the files.
void expect_picture_fits(const ResolvedProof& job, std::size_t channels) {
    constexpr std::uint64_t of_three = 320, of_each_more = 80;
    const std::uint64_t needed = std::uint64_t(job.width_px) * std::uint64_t(job.height_px) *
                                 (of_three + of_each_more * (std::max<std::size_t>(channels, 3) - 3));
    if (needed <= job.memory_bytes / 4) return;
    throw ResourceError(fmt::format(
        "--size {}: a picture of so many pixels takes {:.2f} GiB while it is drawn, more than a quarter of the {:.2f} "
        "GiB allowed; ask for fewer pixels, or allow more (--memory)",
        job.requested.size, double(needed) / (1 << 30), double(job.memory_bytes) / (1 << 30)));
}

JobResult describe(const CameraPicture& picture, const ProofScene& scene, const ResolvedProof& job, double seconds) {
    const auto [least, most] = std::minmax_element(picture.samples.begin(), picture.samples.end());
    const optics::CameraView& view = scene.camera.view;
    std::vector<std::string> surfaces;
    for (const auto& print : scene.prints) surfaces.push_back(print->boundary_is);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-proof").add("version", 1).add("stacks", job.requested.stacks);
    json.add("files", job.requested.files).add("size_px", std::array{picture.width_px, picture.height_px});
    json.add("camera_mm", view.position).add("look_at_mm", view.target).add("focal_mm", view.focal_mm);
    json.add("light", job.requested.light).add("finish", name_of(job.finish)).add("surface", surfaces);
    json.add("samples", std::array{*least, *most}).add("paths", picture.paths);
    json.add("standard_error", picture.rms_error).add("complete", picture.complete).add("seconds", seconds);
    json.add("peak_memory_bytes", peak_memory_bytes()).end_object();
    std::string text = fmt::format(
        "{}: {} x {} pixels, {} to {} samples each\n"
        "  standard error of luminance where a body is seen: {:.4f} (rms; 1 is a white diffuser)\n"
        "  {:.1f} million paths from the camera in {:.1f} s, peak memory {:.0f} MB\n",
        fmt::join(job.requested.files, ", "), picture.width_px, picture.height_px, *least, *most, picture.rms_error,
        double(picture.paths) * 1e-6, seconds, double(peak_memory_bytes()) * 1e-6);
    if (job.requested.with_target) text += "  the target, on the right, has the print's finish\n";
    if (picture.rms_error > seen_noise)
        text +=
            "  flecks of colour are noise of the picture, not of the print: --error 0.01 takes longer and has less\n";
    if (!picture.complete) text += "  stopped before it was as wanted: noisier than asked for\n";
    return {json.text(), text, picture.complete ? ExitCode::done : ExitCode::unfinished};
}

}  // namespace

JobResult run_proof_job(const ProofOptions& options, Progress& progress) {
    const ResolvedProof job = resolve(options);
    expect_picture_fits(job, 3);
    const std::vector<std::filesystem::path> files(options.files.begin(), options.files.end());
    for (const std::string& stack : options.stacks) io::expect_apart_from_layers(stack, files);
    io::expect_outputs(files, options.overwrite);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    Stopwatch watch;
    const auto scene = make_proof_scene(job, progress);
    expect_picture_fits(job, scene->channels().size());
    const CameraPicture picture = take_picture(scene->camera,
                                               {.samples = options.samples,
                                                .error = options.error,
                                                .max_samples = std::max(options.samples, 1u << 16),
                                                .seed = options.seed,
                                                .filter_px = options.filter_px},
                                               progress);
    if (!picture.complete) {
        progress.forgive();
        progress.warn(
            named_warning("stopped-early", "stopped: what was drawn so far is written, noisier than was asked for"));
    }
    write_files(picture, *scene, job);
    return describe(picture, *scene, job, watch.lap());
}

}  // namespace voxtone::slicer
