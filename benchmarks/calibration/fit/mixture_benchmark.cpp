// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a calibrated set predicts mixtures that were not in the fit (Iser, Rittig, Wilkie 2025, Sec. 6.1): all 121
// mixtures of C, M, Y, K, W in steps of 20 %, 0.675 mm thick, on white and on black, ideal; and the 120 of C, M, Y, W
// in steps of 1/7. The target is measured with noise; predictions are compared with the truth, and with a noisy
// measurement. Run: build/release/benchmarks/mixture_benchmark [SEEDS]
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibration/fit/resin_fit.h"
#include "tests/calibration/patches/target_samples.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

PatchTable mixtures(const std::vector<std::string>& roles, int steps, bool pure) {
    PatchTable table;
    std::vector<int> parts(roles.size(), 0);
    const std::function<void(std::size_t, int)> fill = [&](std::size_t k, int left) {
        if (k + 1 < roles.size()) {
            for (parts[k] = 0; parts[k] <= left; ++parts[k]) fill(k + 1, left - parts[k]);
            return;
        }
        parts[k] = left;
        Patch patch;
        for (std::size_t r = 0; r < roles.size(); ++r)
            if (parts[r] > 0) patch.top.push_back({roles[r], static_cast<double>(parts[r]) / steps});
        if (patch.top.size() == 1 && !pure) return;
        patch.thickness_mm = 0.675;
        for (const char* base : {"W", "K"}) patch.backing = base, table.patches.push_back(patch);
    };
    fill(0, steps);
    return table;
}

}  // namespace

int main(int count, char** words) {
    const int seeds = count > 1 ? std::atoi(words[1]) : 20;
    const optics::ResinSet truth = optics::vero_opaque();
    fmt::print(
        "| mixtures x bases | target | noise | mean CIEDE2000 | median | worst seed's mean | against noisy patches "
        "|\n|---|---|---|---|---|---|---|\n");
    for (const bool black : {true, false}) {
        PatchTable others =
            black ? mixtures({"C", "M", "Y", "K", "W"}, 5, false) : mixtures({"C", "M", "Y", "W"}, 7, true);
        testing::measure(others, truth, 0, 1);
        for (const char target : {'B', 'C'})
            for (const double noise : {0.005, 0.0025, 0.001}) {
                double mean = 0, median = 0, worst = 0, noisy = 0;
                for (int seed = 1; seed <= seeds; ++seed) {
                    PatchTable table = testing::target(target, {"C", "M", "Y"});
                    testing::measure(table, truth, noise, 100 + static_cast<std::uint64_t>(seed));
                    FitOptions options;
                    options.noise = noise;
                    const ResinFit fit = fit_resins(table, options);
                    const auto check = check_resins(fit.set, others, {});
                    mean += check.differences.mean / seeds, median += check.differences.median / seeds;
                    worst = std::max(worst, check.differences.mean);
                    PatchTable seen = others;
                    testing::measure(seen, truth, noise, 5000 + static_cast<std::uint64_t>(seed));
                    noisy += check_resins(fit.set, seen, {}).differences.mean / seeds;
                }
                fmt::print("| {} x 2 {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", others.patches.size() / 2,
                           black ? "of C M Y K W" : "of C M Y W", target, noise, mean, median, worst, noisy);
            }
    }
    return 0;
}
