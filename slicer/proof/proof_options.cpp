// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_options.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/options/model_choice.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

namespace {

constexpr int most_px = 16384;

void need(bool good, std::string_view key, const std::string& value, std::string_view rule) {
    if (!good) throw UsageError(fmt::format("--{} {}: {}", key, value, rule));
}

std::optional<optics::Point> point_of(std::string_view key, const std::string& text,
                                      std::string_view rule = "must be three lengths in mm: X,Y,Z") {
    if (text.empty()) return std::nullopt;
    const std::vector<std::string> parts = parse_list(text);
    need(parts.size() == 3, key, text, rule);
    optics::Point p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = parse_number<double>(key, parts[a]);
    return p;
}

void read_size(const std::string& text, ResolvedProof& job) {
    const std::size_t x = text.find('x');
    constexpr std::string_view rule = "must be WIDTHxHEIGHT in pixels, each 16 to 16384: 800x600";
    need(x != std::string::npos, "size", text, rule);
    job.width_px = parse_number<int>("size", text.substr(0, x));
    job.height_px = parse_number<int>("size", text.substr(x + 1));
    for (const int px : {job.width_px, job.height_px}) need(px >= 16 && px <= most_px, "size", text, rule);
}

ProofLamp lamp_of(const std::string& text) {
    const ProofLamp lamp{text, value_of<ProofLight>(text)};
    std::vector<std::string> choices = names_of<ProofLight>();
    choices.emplace_back("a picture's file (.exr)");
    if (!lamp.kind && !std::filesystem::path(text).has_extension()) refuse_choice("light", text, choices);
    return lamp;
}

void read_lights(const ProofOptions& o, ResolvedProof& job) {
    bool beam = false, wide = false;
    for (const std::string& text : o.lights) {
        const ProofLamp& lamp = job.lamps.emplace_back(lamp_of(text));
        beam = beam || lamp.is_beam();
        wide = wide || (lamp.is_beam() && lamp.kind != ProofLight::edge);
    }
    if (job.lamps.empty()) job.lamps.push_back(lamp_of("studio"));
    if (o.light_at != "middle") {
        need(beam, "light-at", o.light_at,
             "would be ignored: only a beam lights one place (--light edge, slit, spot or laser)");
        constexpr std::string_view rule = "must be middle, or three lengths in mm: X,Y,Z";
        job.light_at = point_of("light-at", o.light_at, rule);
        need(job.light_at.has_value(), "light-at", o.light_at, rule);
    }
    if (!o.light_width_mm) return;
    const std::string width = fmt::format("{:g}mm", *o.light_width_mm);
    need(wide, "light-width", width,
         "would be ignored: only a slit, a spot and a laser have a width (--light slit, spot or laser)");
    need(*o.light_width_mm > 0 && *o.light_width_mm <= 1000, "light-width", width, "must be above 0, up to 1000mm");
}

bool is_png_or_exr(const std::string& file) { return file.ends_with(".png") || file.ends_with(".exr"); }

void check_numbers(const ProofOptions& o) {
    need(o.focal_mm >= 10 && o.focal_mm <= 2000, "focal", fmt::format("{:g}", o.focal_mm), "must be 10 to 2000 mm");
    need(o.filter_px >= 0 && o.filter_px <= 1, "filter", fmt::format("{:g}", o.filter_px), "must be 0 to 1 pixel");
    need(o.samples >= 2 && o.samples <= 1u << 20, "spp", fmt::format("{}", o.samples), "must be 2 to 1048576");
    need(o.error == 0 || (o.error >= 1e-4 && o.error < 1), "error", fmt::format("{:g}", o.error),
         "must be 0 (none wanted), or 0.0001 up to 1");
    need(o.exposure_ev >= -20 && o.exposure_ev <= 20, "exposure", fmt::format("{:g}", o.exposure_ev),
         "must be -20 to 20 EV");
    need(o.turn_light_deg >= -360 && o.turn_light_deg <= 360, "turn-light", fmt::format("{:g}", o.turn_light_deg),
         "must be -360 to 360 degrees");
    need(o.turn_deg >= -360 && o.turn_deg <= 360, "turn", fmt::format("{:g}", o.turn_deg),
         "must be -360 to 360 degrees");
    for (const double r : o.roughness)
        need(r >= 0 && r <= 0.9, "roughness", fmt::format("{:g},{:g}", o.roughness[0], o.roughness[1]),
             "must be two numbers from 0 (smooth) to 0.9");
    need(o.memory_gib >= 0 && o.memory_gib <= most_memory_gib, "memory", fmt::format("{}", o.memory_gib),
         "must be above 0 GiB, or 0 for half of the machine's");
    need(o.threads >= 0 && o.threads <= 1024, "threads", fmt::format("{}", o.threads), "must be 0 to 1024");
}

}  // namespace

ResolvedProof resolve(const ProofOptions& o) {
    ResolvedProof job;
    job.requested = o;
    if (o.stacks.empty()) throw UsageError("name a stack: an output folder, a folder of PNG layers, a .gcvf file");
    need(!o.files.empty(), "out", "(none)", "name a file: -o FILE.png");
    for (const std::string& file : o.files)
        need(is_png_or_exr(file), "out", file, "the name says the kind of file: .png for the eye, .exr for numbers");
    check_numbers(o);
    if (o.view != "auto") job.view = parse_choice<ProofView>("view", o.view);
    job.up = parse_choice<ProofUp>("up", o.up);
    job.camera = point_of("camera", o.camera);
    job.look_at = point_of("look-at", o.look_at);
    need(!job.camera || o.view == "auto", "view", o.view, "would be ignored: --camera says where the camera stands");
    read_size(o.size, job);
    read_lights(o, job);
    job.finish = parse_choice<ProofFinish>("finish", o.finish);
    if (o.ground != "none") {
        job.ground = parse_number<double>("ground", o.ground);
        need(*job.ground >= 0 && *job.ground <= 1, "ground", o.ground, "must be a reflectance from 0 to 1, or none");
    }
    job.backing = parse_backing("backing", o.backing);
    const bool behind =
        std::any_of(job.lamps.begin(), job.lamps.end(), [](const auto& lamp) { return lamp.is_behind(); });
    need(!behind || job.backing == optics::Backing::none, "backing", o.backing,
         "would lie between the print and --light behind: leave one of the two out");
    need(!behind || !o.with_target, "light", "behind",
         "shows nothing of a target that is opaque: leave --with-target out");
    if (!o.pitch.empty()) job.pitch_mm = parse_pitch_mm(o.pitch);
    for (const std::string& text : o.assign) job.assign.push_back(parse_assignment(text));
    job.memory_bytes = memory_budget(o.memory_gib);
    return job;
}

}  // namespace voxtone::slicer
