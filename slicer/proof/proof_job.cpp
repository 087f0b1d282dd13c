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
#include "base/machine_memory.h"
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
#include "slicer/proof/beam_response.h"
#include "slicer/proof/proof_beam.h"
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
    const std::size_t of_one = std::size_t(scene.camera.view.width_px) * std::size_t(scene.camera.view.height_px);
    for (std::size_t p = 0; p < picture.samples.size(); ++p) {
        for (const float x : colours[p]) out.values.push_back(x);
        out.values.push_back(1);
        for (std::size_t c = 0; c < 3; ++c) out.values.push_back(picture.colour_error[3 * p + c]);
        out.values.push_back(static_cast<float>(picture.samples[p]));
        out.values.push_back(picture.sees[p] == 2 ? roughness_at(scene, camera, p % of_one) : 0.0f);
        out.values.push_back(picture.sees[p]);
        if (channels.is_rgb()) continue;
        for (const auto* rows : {&picture.value, &picture.standard_error})
            for (std::size_t c = 0; c < picture.channels; ++c) out.values.push_back((*rows)[p * picture.channels + c]);
    }
    return out;
}

/// Under one light.
struct Shot {
    CameraPicture picture;
    Colours colours;
    std::optional<optics::Beam> beam;
    std::vector<BeamResponse> responses;
};

/// "studio", "from a picture", "the edge of a beam ..."; several from the top.
std::string light_words(const std::vector<Shot>& shots, const ResolvedProof& job) {
    std::vector<std::string> words;
    for (std::size_t k = 0; k < shots.size(); ++k) {
        const ProofLamp& lamp = job.lamps[k];
        words.push_back(shots[k].beam ? beam_words(*shots[k].beam)
                        : lamp.kind   ? std::string(name_of(*lamp.kind))
                                      : "from a picture");
    }
    return fmt::format("{}{}", fmt::join(words, "; below "),
                       shots.size() < job.lamps.size() ? "; the rest is missing" : "");
}

/// Pictures one above the other, as one.
CameraPicture one_below_the_other(const std::vector<Shot>& shots) {
    CameraPicture all = shots.front().picture;
    double squares = all.rms_error * all.rms_error;
    for (std::size_t k = 1; k < shots.size(); ++k) {
        const CameraPicture& more = shots[k].picture;
        const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        append(all.value, more.value);
        append(all.standard_error, more.standard_error);
        append(all.colour_error, more.colour_error);
        append(all.samples, more.samples);
        append(all.sees, more.sees);
        all.height_px += more.height_px;
        all.paths += more.paths;
        all.complete = all.complete && more.complete;
        squares += more.rms_error * more.rms_error;
    }
    if (shots.size() > 1) all.rms_error = std::sqrt(squares / double(shots.size()));
    return all;
}

std::string comment_of(const CameraPicture& picture, const std::string& light, const ResolvedProof& job) {
    const auto [least, most] = std::minmax_element(picture.samples.begin(), picture.samples.end());
    std::string text = fmt::format(
        "Proof of a print by light paths: {} to {} samples a pixel, standard error of luminance where a body is seen "
        "{:.4f} (rms; 1 is a white diffuser that lies in the open), light {}, exposure {:+g} EV.",
        *least, *most, picture.rms_error, light, job.requested.exposure_ev);
    if (job.requested.with_target) text += " The target, on the right, has the print's finish.";
    if (picture.rms_error > seen_noise) text += " Flecks of colour are noise of the picture, not of the print.";
    if (!picture.complete) text += " Stopped before it was as wanted.";
    return text;
}

void write_files(const CameraPicture& picture, const std::vector<Shot>& shots, const ProofScene& scene,
                 const ResolvedProof& job) {
    const std::string comment = comment_of(picture, light_words(shots, job), job);
    Colours colours;
    for (const Shot& shot : shots) colours.insert(colours.end(), shot.colours.begin(), shot.colours.end());
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
    const std::uint64_t needed = job.lamps.size() * std::uint64_t(job.width_px) * std::uint64_t(job.height_px) *
                                 (of_three + of_each_more * (std::max<std::size_t>(channels, 3) - 3));
    if (needed <= job.memory_bytes / 4) return;
    throw ResourceError(
        fmt::format("--size {}: a picture of so many pixels takes {} while it is drawn, more than a quarter of the {} "
                    "allowed; ask for fewer pixels, or allow more (--memory)",
                    job.requested.size, memory_text(needed), memory_text(job.memory_bytes)));
}

void add_fall(io::JsonWriter& json, const std::string& name, const std::optional<FallDistance>& fall) {
    if (fall) json.add(name + "_mm", fall->mm).add(name + "_error_mm", fall->error_mm);
}

void add_beam(io::JsonWriter& json, const Shot& shot, const std::string& light, const ResolvedProof& job) {
    const optics::BeamKind& kind = shot.beam->kind();
    json.begin_object().add("light", light).key("places_mm").begin_list();
    for (const optics::BeamPlane& plane : shot.beam->planes()) json.value(plane.place);
    json.end_list();
    if (kind.shape != optics::BeamShape::edge) json.add("width_mm", kind.width_mm);
    json.add("tilt_deg", kind.tilt_deg).add("half_angle_deg", kind.half_angle_deg).key("responses").begin_list();
    for (const BeamResponse& response : shot.responses) {
        json.begin_object().add("stack", job.requested.stacks[response.print]).add("slab", response.slab);
        add_fall(json, "half", response.half);
        add_fall(json, "tenth", response.tenth);
        json.add("distance_mm", response.distance_mm).add("luminance", response.luminance);
        json.add("standard_error", response.standard_error).end_object();
    }
    json.end_list().end_object();
}

std::string fall_text(const char* share, const std::optional<FallDistance>& fall) {
    if (!fall) return fmt::format("to a {} nowhere on its face", share);
    return fmt::format("to a {} within {:.3f} +- {:.3f} mm", share, fall->mm, fall->error_mm);
}

std::string response_text(const BeamResponse& response, const ProofScene& scene, const ResolvedProof& job) {
    std::string slab = job.requested.stacks[response.print];
    if (scene.prints[response.print]->boxes.size() > 1) slab += fmt::format(", slab {}", response.slab + 1);
    return fmt::format("    {}: beyond the beam's border light falls {}, {}\n", slab, fall_text("half", response.half),
                       fall_text("tenth", response.tenth));
}

std::string beams_text(const std::vector<Shot>& shots, const ProofScene& scene, const ResolvedProof& job) {
    std::string text;
    for (const Shot& shot : shots) {
        if (!shot.beam) continue;
        text += fmt::format("  {}\n", beam_words(*shot.beam));
        for (const BeamResponse& response : shot.responses) text += response_text(response, scene, job);
        if (shot.responses.empty())
            text += "    how far light goes on is told of flat slabs alone, on whose face the border lies\n";
    }
    return text;
}

std::string light_key(const ResolvedProof& job) {
    std::vector<std::string> words;
    for (const ProofLamp& lamp : job.lamps) words.push_back(lamp.words);
    return fmt::format("{}", fmt::join(words, ", "));
}

JobResult describe(const CameraPicture& picture, const std::vector<Shot>& shots, const ProofScene& scene,
                   const ResolvedProof& job, double seconds) {
    const auto [least, most] = std::minmax_element(picture.samples.begin(), picture.samples.end());
    const optics::CameraView& view = scene.camera.view;
    std::vector<std::string> surfaces;
    for (const auto& print : scene.prints) surfaces.push_back(print->boundary_is);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-proof").add("version", 1).add("stacks", job.requested.stacks);
    json.add("files", job.requested.files).add("size_px", std::array{picture.width_px, picture.height_px});
    json.add("camera_mm", view.position).add("look_at_mm", view.target).add("focal_mm", view.focal_mm);
    json.add("illuminant", scene.prints.front()->stack.illuminant)
        .add("light", light_key(job))
        .add("finish", name_of(job.finish))
        .add("surface", surfaces);
    if (job.backing.kind != optics::Backing::none) json.add("backing", job.backing.words);
    json.add("samples", std::array{*least, *most}).add("paths", picture.paths);
    json.add("standard_error", picture.rms_error).add("complete", picture.complete).add("seconds", seconds);
    if (std::any_of(job.lamps.begin(), job.lamps.end(), [](const ProofLamp& lamp) { return lamp.is_beam(); })) {
        json.key("beams").begin_list();
        for (std::size_t k = 0; k < shots.size(); ++k)
            if (shots[k].beam) add_beam(json, shots[k], job.lamps[k].words, job);
        json.end_list();
    }
    json.add("peak_memory_bytes", peak_memory_bytes()).end_object();
    std::string text = fmt::format(
        "{}: {} x {} pixels, {} to {} samples each\n"
        "  standard error of luminance where a body is seen: {:.4f} (rms; 1 is a white diffuser)\n"
        "  {:.1f} million paths from the camera in {:.1f} s, peak memory {}\n",
        fmt::join(job.requested.files, ", "), picture.width_px, picture.height_px, *least, *most, picture.rms_error,
        double(picture.paths) * 1e-6, seconds, memory_text(peak_memory_bytes()));
    text += beams_text(shots, scene, job);
    if (job.requested.with_target) text += "  the target, on the right, has the print's finish\n";
    if (picture.rms_error > seen_noise)
        text +=
            "  flecks of colour are noise of the picture, not of the print: --error 0.01 takes longer and has less\n";
    if (!picture.complete) text += "  stopped before it was as wanted: noisier than asked for\n";
    return {json.text(), text, picture.complete ? ExitCode::done : ExitCode::unfinished};
}

std::vector<optics::Beam> beams_of(const ProofScene& scene, const ResolvedProof& job,
                                   const std::vector<SeenPiece>& pieces) {
    std::vector<optics::Beam> beams;
    for (const ProofLamp& lamp : job.lamps)
        if (lamp.is_beam()) beams.push_back(make_beam(job, lamp, scene, pieces));
    return beams;
}

/// The sky's upper half is what the camera looks towards; nothing lies before it but the print.
void put_light_behind(optics::CameraScene& camera) {
    const Eigen::Vector3d ahead = (vector_of(camera.view.target) - vector_of(camera.view.position)).normalized(),
                          right = ahead.cross(vector_of(camera.view.up)).normalized();
    camera.sky_axes = {point_of(right), point_of(ahead.cross(right)), point_of(ahead)};
    camera.ground.reset();
}

/// By lamp; what a request to stop cut off is left out.
std::vector<Shot> take_shots(const ProofScene& scene, const ResolvedProof& job, Progress& progress) {
    const ProofOptions& o = job.requested;
    const bool any = std::any_of(job.lamps.begin(), job.lamps.end(), [](const auto& lamp) { return lamp.is_beam(); });
    const std::vector<SeenPiece> pieces = any ? seen_pieces(scene, progress) : std::vector<SeenPiece>();
    // All before the first is drawn: a place that is not seen is refused at once.
    const std::vector<optics::Beam> beams = beams_of(scene, job, pieces);
    std::vector<Shot> shots;
    for (std::size_t k = 0, next = 0; k < job.lamps.size(); ++k) {
        Shot shot;
        optics::CameraScene camera = scene.camera;
        camera.sky = &scene.skies[k];
        if (job.lamps[k].is_beam()) shot.beam = beams[next++];
        camera.beam = shot.beam ? &*shot.beam : nullptr;
        if (job.lamps[k].is_behind()) put_light_behind(camera);
        shot.picture = take_picture(camera,
                                    {.samples = o.samples,
                                     .error = o.error,
                                     .max_samples = std::max(o.samples, 1u << 16),
                                     .seed = o.seed,
                                     .filter_px = o.filter_px},
                                    progress);
        shot.colours = proof_colours(shot.picture, scene);
        if (shot.beam) shot.responses = beam_responses(scene, *shot.beam, pieces, shot.colours);
        shots.push_back(std::move(shot));
        if (!shots.back().picture.complete) break;
    }
    return shots;
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
    const std::vector<Shot> shots = take_shots(*scene, job, progress);
    const CameraPicture picture = one_below_the_other(shots);
    if (!picture.complete) {
        progress.forgive();
        progress.warn(
            named_warning("stopped-early", "stopped: what was drawn so far is written, noisier than was asked for"));
    }
    write_files(picture, shots, *scene, job);
    return describe(picture, shots, *scene, job, watch.lap());
}

}  // namespace voxtone::slicer
