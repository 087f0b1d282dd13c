// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/photo/photo_simulation_job.h"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "voxtone/calibration/patches/patch_file.h"
#include "voxtone/calibration/target/target_file.h"
#include "voxtone/io/codecs/photograph_writer.h"
#include "voxtone/io/disk/output_files.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/resin_file.h"

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
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        const TargetSquare& square = target.squares[s];
        const Eigen::Vector3d& rho = colours.squares[s];
        table.patches.push_back(
            {square.top, square.backing, target.top_mm, target.base_mm, {rho[0], rho[1], rho[2]}, {}, {}});
    }
    return table;
}

nlohmann::ordered_json points_json(const std::vector<Eigen::Vector2d>& points) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Eigen::Vector2d& p : points) list.push_back({p.x(), p.y()});
    return list;
}

}  // namespace

void PhotoSimulationJob::validate() const { photo.validate(); }

JobResult run_photo_simulation(const PhotoSimulationJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs(outputs(job), job.overwrite);
    const Target target = read_target(job.target);
    const optics::ResinSet set = io::find_resin_set(job.resins);
    progress.begin_stage("photograph", 0);
    const TargetColours colours = reflected_colours(target, set, job.mixtures);
    SimulatedPhoto photo = simulate_photo(target, colours, find_checker(job.checker), job.photo);
    if (job.eight_bits) photo.photograph.bits = 8;
    io::write_whole_file(job.out, io::photograph_bytes(photo.photograph, job.out));
    if (!job.truth.empty())
        io::write_whole_file(job.truth,
                             patch_table_text(true_table(target, colours),
                                              fmt::format("What the squares of {} reflect if made of {}: the truth "
                                                          "behind {}",
                                                          job.target, set.name, job.out)));
    progress.end_stage();
    const nlohmann::ordered_json json{{"format", "voxtone-calibrate-simulate"},
                                      {"version", 1},
                                      {"photograph", job.out},
                                      {"target_corners_px", points_json(photo.target_corners_px)},
                                      {"checker_corners_px", points_json(photo.checker_corners_px)}};
    return {json.dump(), fmt::format("{}: {} x {} pixels, {} of {}\n", job.out, photo.photograph.width_px,
                                     photo.photograph.height_px, job.target, set.name)};
}

}  // namespace voxtone::calibration
