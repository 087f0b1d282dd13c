// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/calibration/edge/edge_rehearsal.h"

#include "calibration/edge/dictionary_file.h"

namespace voxtone::calibration::rehearsal {

EdgeSetup assumed_setup(double level_error) {
    EdgeSetup setup;
    setup.blur_mm = setup.pitch_mm;
    setup.level_error = level_error;
    return setup;
}

std::vector<EdgeProfile> measured(const optics::ResinSet& set, std::uint32_t paths, std::uint64_t seed) {
    EdgeSetup bench = assumed_setup();
    bench.assembly.gel_above_mm = 0.045;
    bench.assembly.gel_below_mm = 0.015;
    EdgeBench faults;
    faults.bias = bias;
    faults.thickness_off = 0.02;
    faults.paths = paths;
    faults.seed = seed;
    return simulate_edge_profiles(set, bench, {0.5, 1}, faults);
}

std::shared_ptr<const EdgeDictionary> dictionary(const std::string& file, const std::vector<double>& g,
                                                 std::uint32_t paths, const std::vector<double>& thickness_mm) {
    if (!file.empty()) return std::make_shared<const EdgeDictionary>(read_dictionary(file));
    EdgeDictionary traced;
    traced.grid.thickness_mm = thickness_mm;
    traced.grid.g = g;
    for (double s = 0.5; s < 50; s *= 1.22) traced.grid.sigma_t.push_back(s);
    traced.grid.paths = paths;
    for (std::size_t run = 0; run < traced.grid.runs(); ++run)
        traced.records.push_back(edge_record(traced.setup, traced.grid, run));
    return std::make_shared<const EdgeDictionary>(std::move(traced));
}

}  // namespace voxtone::calibration::rehearsal
