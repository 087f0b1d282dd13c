// SPDX-License-Identifier: GPL-3.0-or-later
//
// A smaller run of benchmarks/calibration/stress_benchmark: target B of both stress tests, few seeds. The rule for a
// row is that of the benchmark: its median error at most 1.15 times the least-squares baseline's, or 0.8 times the
// Cramer-Rao bound. A median over few seeds scatters by a third, so that rows are judged together.
#include "benchmarks/calibration/fit/stress_cases.h"
#include "tests/places.h"

#include <catch2/catch.hpp>

using namespace voxtone::calibration;

namespace {

const std::string baseline = voxtone::test::test_data() + "/reference/calibration_baseline.json";

stress::Plan plan(double noise, int seeds) {
    stress::Plan p;
    p.targets = "B";
    p.seeds = seeds;
    p.first_seed = 1001;
    p.noise = noise;
    return p;
}

// Errors are on the whole within the limit, and few rows leave it.
bool accepted(const stress::Verdict& v) {
    return v.mean_ln_sigma < 0 && v.mean_ln_albedo < 0 && v.sigma_over <= v.rows / 4 && v.albedo_over <= v.rows / 4;
}

}  // namespace

TEST_CASE("Errors of both stress tests are those of an efficient estimator, and its standard errors are honest") {
    for (const auto& of : stress::run(plan(0.005, 12), baseline)) {
        const stress::Verdict v = stress::judge(of);
        INFO("test " << of.test << ": mean ln of median / limit " << v.mean_ln_sigma << ", " << v.mean_ln_albedo
                     << "; over " << v.sigma_over << ", " << v.albedo_over << " of " << v.rows << "; inside "
                     << v.sigma_inside << ", " << v.albedo_inside << "; trusted " << v.sigma_inside_trusted << ", "
                     << v.albedo_inside_trusted);
        CHECK(v.rows == 52);
        CHECK(accepted(v));
        // 624 truths each, in part dependent: two standard errors are 0.05.
        CHECK(v.sigma_inside > 0.63);
        CHECK(v.sigma_inside < 0.73);
        CHECK(v.albedo_inside > 0.63);
        CHECK(v.albedo_inside < 0.73);
        CHECK(of.white[0].sigma_median < of.white[0].sigma_limit());
        CHECK(of.black[0].sigma_median < of.black[0].sigma_limit() * 1.15);
        CHECK(of.white[0].albedo_median < of.white[0].albedo_limit());
    }
}

TEST_CASE("The stress test rejects a fit of patches that are noisier than it is told") {
    for (const auto& of : stress::run(plan(0.0085, 6), baseline)) CHECK_FALSE(accepted(stress::judge(of)));
}
