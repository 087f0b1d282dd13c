// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/profile_simulation_job.h"

#include <array>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph_writer.h"
#include "io/profiles/profile_file.h"
#include "io/profiles/resin_file.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

constexpr double truth_spacing_mm = 0.044;  // that of the paper, as measurements have by default

constexpr const char* truth_name = "truth.json";
constexpr double card_albedo = 0.18;
constexpr std::array even_names{"card.exr", "card-dark.exr", "lcd-slab.exr", "lcd-screen.exr", "lcd-dark.exr"};

std::string photograph_name(const std::string& series, bool lit, std::size_t k) {
    return fmt::format("{}{}-{:02}.exr", series, lit ? "" : "-dark", k + 1);
}

fs::path output_folder(const ProfileSimulationJob& job) {
    std::vector<fs::path> names{truth_name};
    for (const char* const series : {"reflection", "transmission"})
        for (std::size_t k = 0; k < job.camera.seconds.size(); ++k)
            for (const bool lit : {true, false}) names.emplace_back(photograph_name(series, lit, k));
    names.insert(names.end(), even_names.begin(), even_names.end());
    return io::make_folder_for(job.out, names, job.overwrite);
}

/// NAME-01.exr, NAME-dark-01.exr, ...
void write_series(const SpotScene& scene, const std::string& name, const ProfileSimulationJob& job,
                  Progress& progress) {
    progress.begin_stage(name, job.camera.seconds.size(), "exposures");
    for (std::size_t k = 0; k < job.camera.seconds.size(); ++k) {
        progress.check_cancelled();
        for (const bool lit : {true, false}) {
            const fs::path file = fs::path(job.out) / photograph_name(name, lit, k);
            io::write_whole_file(file, io::photograph_bytes(scene.photograph(k, lit).photograph, file.string()));
        }
        progress.advance();
    }
    progress.end_stage();
}

void write_even_light(const SlabProfiles& slab, const ProfileSimulationJob& job) {
    const EvenPhotographs even = even_photographs(slab, card_albedo, job.camera);
    const std::array all{&even.card, &even.card_dark, &even.slab, &even.screen, &even.lcd_dark};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const fs::path file = fs::path(job.out) / even_names[i];
        io::write_whole_file(file, io::photograph_bytes(all[i]->photograph, file.string()));
    }
}

io::ProfileFile true_profile(const ProfileSimulationJob& job, const std::string& set, const SpotScene& R,
                             const SpotScene& T) {
    const auto samples = static_cast<std::size_t>(job.camera.size_px * job.camera.mm_per_px / 2 / truth_spacing_mm);
    io::ProfileFile truth{fmt::format("{} {}", set, job.role),
                          "simulated: what the photographs were drawn from, seen through spot, blur and pixel",
                          {},
                          {}};
    for (std::size_t c = 0; c < 3; ++c)
        truth.by_channel.push_back(
            {job.thickness_mm, T.truth(c, truth_spacing_mm, samples), R.truth(c, truth_spacing_mm, samples)});
    return truth;
}

/// The command that measures the photographs.
std::string next_command(const ProfileSimulationJob& job) {
    const std::uint32_t half = job.camera.size_px / 2, margin = job.camera.size_px / 16, across = half - 2 * margin,
                        down = job.camera.size_px - 2 * margin;
    return fmt::format(
        "voxtone calibrate profile --reflection {0}/reflection-??.exr --reflection-dark {0}/reflection-dark-??.exr "
        "--card {0}/card.exr --card-dark {0}/card-dark.exr --card-albedo {1} --slab-at {2},{2},{3},{4} --card-at "
        "{5},{2},{3},{4} --transmission {0}/transmission-??.exr --transmission-dark {0}/transmission-dark-??.exr "
        "--lcd {0}/lcd-slab.exr {0}/lcd-screen.exr --lcd-dark {0}/lcd-dark.exr --lcd-at {2},{2},{4},{4} "
        "--thickness {6}mm --mm-per-px {7} -o profile.json",
        job.out, card_albedo, margin, across, down, half + margin, job.thickness_mm, job.camera.mm_per_px);
}

JobResult result_of(const ProfileSimulationJob& job, const SlabProfiles& slab, const Eigen::Vector2d& centre_px,
                    const std::string& truth_file) {
    const std::string next = next_command(job);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-simulate-profile").add("version", 1);
    json.add("folder", job.out).add("truth", truth_file).add("centre_px", centre_px);
    json.add("reflectance", std::array{slab.R[0][0], slab.R[1][0], slab.R[2][0]});
    json.add("transmittance", std::array{slab.T[0][0], slab.T[1][0], slab.T[2][0]}).add("next", next).end_object();
    return {json.text(),
            fmt::format("{}: {} exposures of {} x {} pixels and as many dark frames of each side, five in even light; "
                        "the truth is in "
                        "{}\nMeasure them: {}\n",
                        job.out, job.camera.seconds.size(), job.camera.size_px, job.camera.size_px, truth_file, next)};
}

}  // namespace

void ProfileSimulationJob::validate() const {
    if (!(thickness_mm > 0))
        throw InputError(fmt::format("--thickness: the slab is {} mm thick; it must be above 0", thickness_mm));
    camera.validate();
}

JobResult run_profile_simulation(const ProfileSimulationJob& job, Progress& progress) {
    job.validate();
    const optics::ResinSet set = io::find_resin_set(job.resins);
    const fs::path out = output_folder(job);
    const SlabProfiles slab =
        slab_profiles(set, job.role, job.thickness_mm, job.camera.grid(), job.paths, job.camera.seed, &progress);
    const SpotScene R(slab.R, job.camera), T(slab.T, job.camera);
    write_series(R, "reflection", job, progress);
    write_series(T, "transmission", job, progress);
    write_even_light(slab, job);
    const std::string truth_file = (out / truth_name).string();
    io::write_whole_file(truth_file, io::profile_text(true_profile(job, set.name, R, T)));
    return result_of(job, slab, R.centre_px(), truth_file);
}

}  // namespace voxtone::calibration
