// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stress tests of the calibration as one table, beside a least-squares baseline and the Cramer-Rao bound, and as
// Fig. 9. Run: build/release/benchmarks/stress_benchmark [--seeds 50] [--targets ABC] [--tests 12] [--svg FILE]
#include <fstream>
#include <iostream>
#include <string>

#include <fmt/format.h>

#include "stress_cases.h"
#include "tests/places.h"

namespace {

using namespace voxtone::calibration::stress;

std::string figure(double value) { return value < 0 ? "-" : fmt::format("{:.3g}", value); }

void print(const Case& c) {
    fmt::print("\nTest {}, target {}: {} fits of one channel in {:.1f} s; baseline {}\n\n", c.test, c.target, c.fits,
               c.seconds, c.base_method);
    fmt::print(
        "| albedo | sigma_t /mm | sigma_t median | baseline | bound | limit | worst | albedo median | baseline | bound "
        "| limit | worst | inside s, a | doubted |\n");
    fmt::print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    const auto row = [](const Row& r) {
        const bool s_over = r.sigma_median > r.sigma_limit(), a_over = r.albedo_median > r.albedo_limit();
        fmt::print(
            "| {:g} | {:.3g} | {:.3g}{} | {} | {} | {} | {:.3g} | {:.3g}{} | {} | {} | {} | {:.3g} | {:.2f}, {:.2f} | "
            "{:.2f} |\n",
            r.albedo, r.sigma_t, r.sigma_median, s_over ? " !" : "", figure(r.base_sigma), figure(r.bound_ln_sigma),
            figure(r.sigma_limit()), r.sigma_worst, r.albedo_median, a_over ? " !" : "", figure(r.base_albedo),
            figure(r.bound_albedo < 0 ? -1 : r.bound_albedo / r.albedo), figure(r.albedo_limit()), r.albedo_worst,
            r.sigma_inside, r.albedo_inside, r.doubted);
    };
    row(c.white.front());
    row(c.black.front());
    for (const auto& rows : c.colours)
        for (const Row& r : rows) row(r);
}

}  // namespace

int main(int count, char** words) {
    Plan plan;
    std::string svg, baseline = voxtone::test::test_data() + "/reference/calibration_baseline.json";
    for (int i = 1; i + 1 < count; i += 2) {
        const std::string name = words[i], value = words[i + 1];
        if (name == "--seeds")
            plan.seeds = std::stoi(value);
        else if (name == "--targets")
            plan.targets = value;
        else if (name == "--tests") {
            plan.tests.clear();
            for (const char digit : value) plan.tests.push_back(digit - '0');
        } else if (name == "--svg")
            svg = value;
        else
            return std::cerr << "unknown option " << name << '\n', 2;
    }
    const auto cases = run(plan, baseline);
    for (const Case& c : cases) print(c);
    fmt::print(
        "\n| test | target | medians over the limit: sigma_t, albedo | of | largest median / limit | truths within one "
        "error: sigma_t, albedo | without doubts | s per channel |\n");
    fmt::print("|---|---|---|---|---|---|---|---|\n");
    for (const Case& c : cases) {
        const Verdict v = judge(c);
        fmt::print("| {} | {} | {}, {} | {} | {:.2f}, {:.2f} | {:.3f}, {:.3f} | {:.3f}, {:.3f} | {:.4f} |\n", c.test,
                   c.target, v.sigma_over, v.albedo_over, v.rows, v.worst_sigma, v.worst_albedo, v.sigma_inside,
                   v.albedo_inside, v.sigma_inside_trusted, v.albedo_inside_trusted, c.seconds / c.fits);
    }
    if (!svg.empty()) std::ofstream(svg) << figure_svg(cases);
    return 0;
}
