// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/bench_simulation_job.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/bench/bench_list.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph_writer.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

constexpr const char* list_name = "photographs.csv";
constexpr double shot_shift_mm = 1.5;

BenchList list_of(const BenchSimulationJob& job, const optics::ResinSet& set) {
    BenchList list{"checker.tif", "paper.tif", "sheet.tif", {}};
    for (const optics::Resin& resin : set.resins)
        for (const double thickness : job.profiles.thickness_mm)
            for (int shot = 1; shot <= job.shots; ++shot)
                list.slabs.push_back({fmt::format("{}-{}-{}.tif", resin.role, thickness, shot), resin.role, thickness});
    return list;
}

std::vector<fs::path> names_of(const BenchList& list) {
    std::vector<fs::path> names{list_name, list.checker, list.paper, list.sheet};
    for (const SlabPhotograph& slab : list.slabs) names.emplace_back(slab.file);
    return names;
}

void take_photographs(const BenchSimulationJob& job, const EdgeSetup& setup, const std::vector<RenderedSlab>& slabs,
                      const BenchList& list, Progress& progress) {
    const fs::path folder = io::make_folder_for(job.photos, names_of(list), job.profiles.overwrite);
    const BenchCamera camera(setup, render_bare_sheet(setup, job.profiles.bench.seed), job.camera);
    std::uint64_t shot = 0;
    const auto save = [&](const std::string& name, const io::Photograph& photo) {
        io::write_whole_file(folder / name, io::photograph_bytes(photo, name));
        progress.advance();
        progress.check_cancelled();
    };
    progress.begin_stage("photographs", names_of(list).size() - 1, "photographs");
    save(list.checker, camera.of_checker(find_checker("colorchecker24"), shot++));
    save(list.paper, camera.of_paper(shot++));
    save(list.sheet, camera.of_sheet(shot++));
    for (std::size_t k = 0; k < list.slabs.size(); ++k) {
        const double aside = shot_shift_mm * (int(k) % job.shots - (job.shots - 1) / 2.0);
        save(list.slabs[k].file,
             camera.of_slab(slabs[k / std::size_t(job.shots)], job.profiles.bench.bias, {aside, aside / 2}, shot++));
    }
    io::write_whole_file(folder / list_name, bench_list_text(list));
    progress.end_stage();
}

}  // namespace

void BenchSimulationJob::validate() const {
    if (profiles.out.empty() && photos.empty())
        throw UsageError(
            "--out and --photos are missing: nothing to write; name a file for profiles or a folder for "
            "photographs");
    EdgeSimulationJob named = profiles;
    if (named.out.empty()) named.out = photos;
    named.validate();
    if (photos.empty()) return;
    camera.validate();
    expect_within("--shots", shots, 1, 20);
}

JobResult run_bench_simulation(const BenchSimulationJob& job, Progress& progress) {
    job.validate();
    if (job.photos.empty()) return run_edge_simulation(job.profiles, progress);
    const EdgeSimulationJob& wanted = job.profiles;
    const EdgeSetup setup = read_edge_setup(wanted.setup);
    const optics::ResinSet set = simulated_set(wanted);
    const BenchList list = list_of(job, set);
    if (!wanted.out.empty()) io::expect_outputs({wanted.out}, wanted.overwrite);
    static_cast<void>(io::make_folder_for(job.photos, names_of(list), wanted.overwrite));
    progress.begin_stage("paths", 3 * set.resins.size() * wanted.thickness_mm.size(), "channels");
    const std::vector<RenderedSlab> slabs = render_slabs(set, setup, wanted.thickness_mm, wanted.bench, &progress);
    progress.end_stage();
    take_photographs(job, setup, slabs, list, progress);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-edge-simulate").add("version", 1);
    std::string text;
    if (!wanted.out.empty()) text = write_simulated_profiles(wanted, setup, set.name, slabs, json);
    json.add("photographs", (fs::path(job.photos) / list_name).string()).key("slabs").begin_list();
    for (const RenderedSlab& slab : slabs) {
        json.begin_object().add("resin", slab.resin).add("thickness_mm", slab.thickness_mm);
        json.add("gel_above_mm", slab.gel_above_mm).add("gel_below_mm", slab.gel_below_mm).end_object();
    }
    return {json.end_list().end_object().text(),
            text + fmt::format("{}: {} photographs, listed in {}\n", job.photos, list.slabs.size() + 3, list_name)};
}

}  // namespace voxtone::calibration
