// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/photo_simulation_job.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/LU>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/target_file.h"
#include "calibration/target/target_surfaces.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph_writer.h"
#include "io/profiles/resin_file.h"
#include "optics/colour/channels.h"
#include "optics/layered/flat_colour.h"

namespace voxtone::calibration {
namespace {

std::vector<std::filesystem::path> outputs(const PhotoSimulationJob& job) {
    std::vector<std::filesystem::path> files{job.out};
    if (!job.truth.empty()) files.emplace_back(job.truth);
    return files;
}

/// What the squares reflect, as if it had been measured.
PatchTable true_table(const Target& target, const TargetColours& colours) {
    PatchTable table;
    const bool wide =
        std::ranges::any_of(colours.squares, [](const Eigen::Vector3d& rgb) { return rgb.minCoeff() < 0; });
    if (wide) table.channels = optics::wide_channels();
    const Eigen::Matrix3d map = wide ? Eigen::Matrix3d(optics::linear_srgb_weights(table.channels)).inverse()
                                     : Eigen::Matrix3d::Identity().eval();
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        const TargetSquare& square = target.squares[s];
        const Eigen::Vector3d rho = map * colours.squares[s];
        table.patches.push_back(patch_of(target, square));
        table.patches.back().rho = {rho[0], rho[1], rho[2]};
    }
    if (wide)
        change_surfaces(table, [&](PatchSurface& surface) {
            const Eigen::Vector3d rho = map * Eigen::Vector3d(surface.rho[0], surface.rho[1], surface.rho[2]);
            surface.rho.assign(rho.begin(), rho.end());
        });
    return table;
}

bool is_table(const PhotoSimulationJob& job) { return std::filesystem::path(job.out).extension() == ".csv"; }

/// The form of the chart, filled in.
std::string measured_form(const PhotoSimulationJob& job, const Target& target, const optics::ResinSet& set) {
    const optics::FlatColour flat(set);
    const optics::Illuminant light = set.channels.is_own() ? set.channels.illuminant : optics::Illuminant::d65;
    const auto places = square_places(target);
    std::string text = fmt::format(
        "# {} of {} as an instrument would read it, noise {} in L, a and b\n# illuminant: {}\n"
        "patch,row,column,{},L,a,b\n",
        job.target, set.name, job.lab_noise, name_of(light), fmt::join(target.roles, ","));
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        std::vector<double> shares(set.resins.size());
        text += fmt::format("{},{},{}", s + 1, places[s][0], places[s][1]);
        for (const std::string& role : target.roles) {
            const auto share = std::ranges::find(target.squares[s].top, role, &ResinShare::role);
            const double part = share == target.squares[s].top.end() ? 0 : share->fraction;
            shares[static_cast<std::size_t>(set.find(role))] = part;
            text += fmt::format(",{:.4g}", part);
        }
        RandomStream random(job.photo.seed, s);
        const Eigen::Vector3d lab = flat.lab(shares);
        for (Eigen::Index k = 0; k < 3; ++k)
            text += fmt::format(",{:.2f}", lab[k] + job.lab_noise * normal_number(random));
        text += "\n";
    }
    return text;
}

JobResult simulate_table(const PhotoSimulationJob& job, const Target& target) {
    if (!target.is_chart())
        throw UsageError(
            fmt::format("--out {}: a table is simulated of charts (calibrate chart); {} is a target for "
                        "photographs: name a .png, .tif or .exr.",
                        job.out, job.target));
    const optics::ResinSet set = io::find_resin_set(job.resins).subset(target.roles);
    io::write_whole_file(job.out, measured_form(job, target, set));
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-simulate").add("version", 1);
    json.add("table", job.out).add("patches", target.squares.size()).end_object();
    return {json.text(), fmt::format("{}: {} patches of {}\n", job.out, target.squares.size(), set.name)};
}

}  // namespace

void PhotoSimulationJob::validate() const {
    photo.validate();
    expect_within("--lab-noise", lab_noise, 0, 10);
}

namespace {

JobResult written(const PhotoSimulationJob& job, SimulatedPhoto photo, const std::string& resins) {
    if (job.eight_bits) photo.photograph.bits = 8;
    io::write_whole_file(job.out, io::photograph_bytes(photo.photograph, job.out));
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-simulate").add("version", 1);
    json.add("photograph", job.out).add("target_corners_px", photo.target_corners_px);
    json.add("checker_corners_px", photo.checker_corners_px).end_object();
    return {json.text(), fmt::format("{}: {} x {} pixels, {} of {}\n", job.out, photo.photograph.width_px,
                                     photo.photograph.height_px, job.target, resins)};
}

JobResult simulate_print(const PhotoSimulationJob& job, Progress& progress) {
    if (is_table(job) || !job.truth.empty())
        throw UsageError(fmt::format("{}: is a print, of which a photograph is drawn (.png, .tif or .exr) and no table",
                                     job.target));
    const FlatThing thing = job.print(progress);
    progress.begin_stage("photograph", 0);
    SimulatedPhoto photo = simulate_photo(thing, find_checker(job.checker), job.photo);
    progress.end_stage();
    return written(job, std::move(photo), job.resins.empty() ? "the resins of its job" : job.resins);
}

}  // namespace

JobResult run_photo_simulation(const PhotoSimulationJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs(outputs(job), job.overwrite);
    if (job.print) return simulate_print(job, progress);
    const Target target = read_target(job.target);
    if (is_table(job)) return simulate_table(job, target);
    const optics::ResinSet set = io::find_resin_set(job.resins);
    progress.begin_stage("photograph", 0);
    const TargetColours colours = reflected_colours(target, set, job.mixtures);
    const TargetColours seen =
        target.is_chart() ? colours : reflected_colours(target, set, job.mixtures, SquareKind::ended);
    SimulatedPhoto photo = simulate_photo(target, seen, find_checker(job.checker), job.photo);
    if (!job.truth.empty())
        io::write_whole_file(job.truth,
                             patch_table_text(true_table(target, colours),
                                              fmt::format("What the squares of {} reflect if made of {}: the truth "
                                                          "behind {}",
                                                          job.target, set.name, job.out)));
    progress.end_stage();
    return written(job, std::move(photo), set.name);
}

}  // namespace voxtone::calibration
