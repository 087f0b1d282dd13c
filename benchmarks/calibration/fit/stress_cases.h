// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stress tests of Iser, Rittig, Wilkie 2025, Sec. 5: synthetic resins from clear to opaque and from black to white,
// measured with noise and fitted again. What an estimator may be asked is bounded by what the patches tell: the
// Cramer-Rao bound, from calibration_baseline.json.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace voxtone::calibration::stress {

struct Plan {
    std::vector<int> tests{1, 2};
    std::string targets = "ABC";
    int seeds = 50;
    std::uint64_t first_seed = 1;
    double noise = 0.005;
};

/// Truth and statistics of one resin at one extinction over all seeds.
struct Row {
    double sigma_t = 0, albedo = 0;
    double sigma_median = 0, sigma_worst = 0;                    ///< |estimate / truth - 1|
    double albedo_median = 0, albedo_worst = 0;                  ///< the same
    double sigma_inside = 0, albedo_inside = 0;                  ///< share of truths within one standard error
    double doubted = 0;                                          ///< share of fits that doubt one of the two
    double sigma_inside_trusted = 0, albedo_inside_trusted = 0;  ///< of those without doubt
    int sigma_trusted = 0, albedo_trusted = 0;
    double ratio_low = 0, ratio_middle = 0, ratio_high = 0;  ///< 16th, 50th, 84th percentile of estimate / truth
    double v_low = 0, v_middle = 0, v_high = 0, v_true = 0;  ///< and of v (resin_coordinates.h)
    // From the baseline; negative: not there.
    double base_sigma = -1, base_albedo = -1, bound_ln_sigma = -1, bound_albedo = -1;
    [[nodiscard]] double sigma_limit() const;  ///< max(1.15 baseline, 0.8 Cramer-Rao)
    [[nodiscard]] double albedo_limit() const;
};

struct Case {
    int test = 0;
    char target = 0;
    std::string base_method;                ///< of the baseline: LSQ, or L1 where there is none
    std::vector<Row> white, black;          ///< one row each; sigma_t and albedo of the test
    std::vector<std::vector<Row>> colours;  ///< by albedo, then by sigma_t
    double seconds = 0;
    int fits = 0;  ///< of one channel
};

[[nodiscard]] std::vector<Case> run(const Plan& plan, const std::string& baseline_file);

/// Rows whose median is above the limit, and how many there are.
struct Verdict {
    int rows = 0, sigma_over = 0, albedo_over = 0;
    double sigma_inside = 0, albedo_inside = 0;  ///< over all rows
    double sigma_inside_trusted = 0, albedo_inside_trusted = 0;
    double worst_sigma = 0, worst_albedo = 0;  ///< largest median / limit
    double mean_ln_sigma = 0,
           mean_ln_albedo = 0;  ///< mean logarithm of median / limit: all rows together, less noisy than one
};
[[nodiscard]] Verdict judge(const Case& of);

/// Fig. 9: estimate / truth and v against the true extinction, one column per target, one row per test and quantity.
[[nodiscard]] std::string figure_svg(const std::vector<Case>& cases);

}  // namespace voxtone::calibration::stress
