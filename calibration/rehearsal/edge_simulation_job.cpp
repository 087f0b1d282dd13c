// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/edge_simulation_job.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/rehearsal/sensor.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"
#include "io/profiles/resin_file.h"
#include "optics/edge/edge_scene_paths.h"

namespace voxtone::calibration {
namespace {

constexpr double clear_sigma_t = 1e-4, beyond_mm = 1;

}  // namespace

std::vector<double> seen_by_camera(const RenderedSlab& slab, std::size_t channel, const std::vector<double>& x_mm,
                                   const EdgeSetup& setup) {
    const std::vector<double>& rendered = slab.F[channel];
    constexpr double cell = RenderedSlab::step_mm;
    const double half = setup.pitch_mm / 2, blur = setup.blur_mm;
    std::vector<double> seen;
    for (const double x0 : x_mm) {
        double sum = 0, weights = 0;
        const double reach = half + 4 * blur;
        const auto index = [&](double x) { return static_cast<std::ptrdiff_t>((x + slab.reach_mm) / cell); };
        const auto last = static_cast<std::ptrdiff_t>(rendered.size()) - 1;
        for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, index(x0 - reach)); k <= std::min(last, index(x0 + reach));
             ++k) {
            const double from = static_cast<double>(k) * cell - slab.reach_mm, to = from + cell;
            double weight = std::max(0.0, std::min(to, x0 + half) - std::max(from, x0 - half));
            if (blur > 0) {
                const double d = (from + to) / 2 - x0, s = blur * 1.41421356237309515;
                weight = std::erf((d + half) / s) - std::erf((d - half) / s);
            }
            sum += weight * rendered[static_cast<std::size_t>(k)];
            weights += weight;
        }
        seen.push_back(sum / weights);
    }
    return seen;
}

void EdgeBench::validate() const {
    expect_within("--bias", bias, 0.1, 10);
    expect_within("--noise", noise, 1e-9, 0.5);
    expect_within("--thickness-off", thickness_off, -0.5, 0.5);
    if (gel_from_mm != 0 || gel_to_mm != 0)
        if (!(gel_from_mm > 0 && gel_to_mm >= gel_from_mm && gel_to_mm <= 1))
            throw InputError(fmt::format("--gel: {},{}; expected a range of thicknesses in mm that rises, up to 1",
                                         gel_from_mm, gel_to_mm));
    expect_within("--paths", paths, 1024, 4294967295.0);
}

std::vector<RenderedSlab> render_slabs(const optics::ResinSet& set, const EdgeSetup& setup,
                                       const std::vector<double>& thickness_mm, const EdgeBench& bench,
                                       Progress* progress) {
    std::vector<RenderedSlab> slabs;
    std::uint64_t address = 0;
    for (const optics::Resin& resin : set.resins)
        for (const double thickness : thickness_mm) {
            RenderedSlab slab{resin.role,
                              thickness,
                              setup.assembly.gel_above_mm,
                              setup.assembly.gel_below_mm,
                              setup.width_mm / 2 + beyond_mm,
                              {}};
            if (bench.gel_to_mm > 0) {
                RandomStream random(bench.seed, slabs.size(), 6);
                for (double* layer : {&slab.gel_above_mm, &slab.gel_below_mm})
                    *layer = bench.gel_from_mm + (bench.gel_to_mm - bench.gel_from_mm) * random.uniform();
            }
            for (std::size_t c = 0; c < 3; ++c) {
                const optics::Medium medium = resin.medium(c);
                optics::EdgeScene scene{setup.assembly,
                                        thickness * (1 + bench.thickness_off),
                                        std::max(medium.sigma_t(), clear_sigma_t),
                                        medium.albedo(),
                                        set.g,
                                        setup.sheet(c),
                                        bench.paths,
                                        bench.seed + 1000003 * ++address};
                scene.assembly.gel_above_mm = slab.gel_above_mm;
                scene.assembly.gel_below_mm = slab.gel_below_mm;
                slab.F[c] = optics::render_edge(scene, slab.reach_mm, RenderedSlab::step_mm, progress);
                if (progress) progress->advance();
            }
            slabs.push_back(std::move(slab));
        }
    return slabs;
}

std::vector<EdgeProfile> noisy_profiles(const std::vector<RenderedSlab>& slabs, const EdgeSetup& setup,
                                        const EdgeBench& bench) {
    std::vector<EdgeProfile> profiles;
    std::uint64_t address = 0;
    for (const RenderedSlab& slab : slabs) {
        EdgeProfile profile{slab.resin, slab.thickness_mm, setup.positions(), {}, {}};
        for (std::size_t c = 0; c < 3; ++c) {
            RandomStream random(bench.seed, ++address, 5);
            for (const double v : seen_by_camera(slab, c, profile.x_mm, setup)) {
                const double error = bench.noise * std::sqrt(std::max(v, 0.01));
                profile.value[c].push_back((v + error * normal_number(random)) / bench.bias);
                profile.error[c].push_back(error / bench.bias);
            }
        }
        profiles.push_back(std::move(profile));
    }
    return profiles;
}

std::vector<EdgeProfile> simulate_edge_profiles(const optics::ResinSet& set, const EdgeSetup& setup,
                                                const std::vector<double>& thickness_mm, const EdgeBench& bench,
                                                Progress* progress) {
    return noisy_profiles(render_slabs(set, setup, thickness_mm, bench, progress), setup, bench);
}

void EdgeSimulationJob::validate() const {
    if (out.empty()) throw UsageError("--out is missing: the profiles to write");
    for (const double t : thickness_mm) expect_within("--thickness", t, 0.05, 10);
    bench.validate();
}

optics::ResinSet simulated_set(const EdgeSimulationJob& job) {
    optics::ResinSet set = io::find_resin_set(job.resins);
    if (!set.channels.is_rgb())
        throw InputError(fmt::format("{}: a set of R, G, B is needed; the camera has three channels.", job.resins));
    if (!job.roles.empty()) set = set.subset(job.roles);
    return set;
}

std::string write_simulated_profiles(const EdgeSimulationJob& job, const EdgeSetup& setup, const std::string& set_name,
                                     const std::vector<RenderedSlab>& slabs, io::JsonWriter& json) {
    const std::string comment =
        fmt::format("simulated from {}: values divided by {}, slabs {:+.1f} % thicker than said, {} paths, seed {}",
                    set_name, job.bench.bias, 100 * job.bench.thickness_off, job.bench.paths, job.bench.seed);
    io::write_whole_file(job.out, edge_profiles_text(noisy_profiles(slabs, setup, job.bench), comment));
    json.add("profiles", job.out).add("count", slabs.size());
    return fmt::format("{}: {} profiles of {}\n", job.out, slabs.size(), set_name);
}

JobResult run_edge_simulation(const EdgeSimulationJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs({job.out}, job.overwrite);
    const EdgeSetup setup = read_edge_setup(job.setup);
    const optics::ResinSet set = simulated_set(job);
    progress.begin_stage("paths", 3 * set.resins.size() * job.thickness_mm.size(), "channels");
    const std::vector<RenderedSlab> slabs = render_slabs(set, setup, job.thickness_mm, job.bench, &progress);
    progress.end_stage();
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-edge-simulate").add("version", 1);
    const std::string text = write_simulated_profiles(job, setup, set.name, slabs, json);
    return {json.end_object().text(), text};
}

}  // namespace voxtone::calibration
