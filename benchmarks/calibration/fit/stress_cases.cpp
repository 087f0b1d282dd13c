// SPDX-License-Identifier: GPL-3.0-or-later
#include "stress_cases.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "calibration/fit/resin_fit.h"
#include "calibration/resins/resin_coordinates.h"
#include "tests/calibration/patches/target_samples.h"

namespace voxtone::calibration::stress {

namespace {

constexpr int extinctions = 13;
const std::vector<double> albedos{0.1, 0.9, 0.99, 0.999};
const std::vector<std::string> colours{"c1", "c2", "c3", "c4"};

double extinction(int k) { return 0.1 * std::pow(300.0, k / 12.0); }

// All extinctions at once: each is a channel.
optics::ResinSet truth(int test) {
    optics::ResinSet set;
    for (int k = 0; k < extinctions; ++k) set.channels.wavelengths_nm.push_back(400 + 10 * k);
    const auto add = [&](const std::string& role, double albedo, double sigma_t) {
        set.resins.push_back(
            {role, role, std::vector<double>(extinctions, sigma_t), std::vector<double>(extinctions, albedo)});
    };
    add("W", test == 1 ? 0.999 : 0.99, test == 1 ? 20 : 5);
    add("K", test == 1 ? 0.5 : 0.9, 5);
    for (std::size_t a = 0; a < albedos.size(); ++a) {
        add(colours[a], albedos[a], 0);
        for (int k = 0; k < extinctions; ++k)
            set.resins.back().sigma_t_per_mm[static_cast<std::size_t>(k)] = extinction(k);
    }
    return set;
}

struct Sample {
    double sigma, albedo;
    bool sigma_inside, albedo_inside, sigma_trusted, albedo_trusted;
};

double percentile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    const double at = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

Row statistics(const std::vector<Sample>& samples, double sigma_t, double albedo) {
    Row row;
    row.sigma_t = sigma_t, row.albedo = albedo;
    std::vector<double> sigma, alpha, ratio, v;
    int sigma_in = 0, albedo_in = 0, sigma_in_trusted = 0, albedo_in_trusted = 0, doubted = 0;
    for (const Sample& s : samples) {
        sigma.push_back(std::abs(s.sigma / sigma_t - 1));
        alpha.push_back(std::abs(s.albedo / albedo - 1));
        ratio.push_back(s.sigma / sigma_t);
        v.push_back(v_of_albedo(s.albedo, 0.4));
        sigma_in += s.sigma_inside, albedo_in += s.albedo_inside;
        row.sigma_trusted += s.sigma_trusted, row.albedo_trusted += s.albedo_trusted;
        sigma_in_trusted += s.sigma_inside && s.sigma_trusted, albedo_in_trusted += s.albedo_inside && s.albedo_trusted;
        doubted += !s.sigma_trusted || !s.albedo_trusted;
    }
    const double count = static_cast<double>(samples.size());
    row.sigma_median = percentile(sigma, 0.5), row.sigma_worst = percentile(sigma, 1);
    row.albedo_median = percentile(alpha, 0.5), row.albedo_worst = percentile(alpha, 1);
    row.sigma_inside = sigma_in / count, row.albedo_inside = albedo_in / count, row.doubted = doubted / count;
    row.sigma_inside_trusted = row.sigma_trusted > 0 ? static_cast<double>(sigma_in_trusted) / row.sigma_trusted : 0;
    row.albedo_inside_trusted =
        row.albedo_trusted > 0 ? static_cast<double>(albedo_in_trusted) / row.albedo_trusted : 0;
    row.ratio_low = percentile(ratio, 0.16), row.ratio_middle = percentile(ratio, 0.5),
    row.ratio_high = percentile(ratio, 0.84);
    row.v_low = percentile(v, 0.16), row.v_middle = percentile(v, 0.5), row.v_high = percentile(v, 0.84);
    row.v_true = v_of_albedo(albedo, 0.4);
    return row;
}

double number(const nlohmann::json& value) { return value.is_number() ? value.get<double>() : -1; }

void add_baseline(Case& of, const nlohmann::json& table) {
    for (const auto& entry : table.at("cases")) {
        if (entry.at("test") != of.test || entry.at("target") != std::string(1, of.target)) continue;
        of.base_method = entry.at("method");
        of.white[0].base_sigma = entry.at("white")[0], of.white[0].base_albedo = entry.at("white")[1];
        of.black[0].base_sigma = entry.at("black")[0], of.black[0].base_albedo = entry.at("black")[1];
        for (std::size_t a = 0; a < albedos.size(); ++a)
            for (std::size_t k = 0; k < static_cast<std::size_t>(extinctions); ++k) {
                const auto& values = entry.at("colours").at(a).at("rows").at(k);
                Row& row = of.colours[a][k];
                row.base_sigma = number(values[1]), row.base_albedo = number(values[2]);
                row.bound_ln_sigma = number(values[3]), row.bound_albedo = number(values[4]);
            }
        return;
    }
}

Case run_case(int test, char target, const Plan& plan) {
    const auto began = std::chrono::steady_clock::now();
    const optics::ResinSet set = truth(test);
    const auto seeds = static_cast<std::size_t>(plan.seeds);
    std::vector<ResinFit> fits(seeds);
    parallel_for(0, seeds, 1, [&](std::size_t s) {
        PatchTable table = testing::target(target, colours);
        testing::measure(table, set, plan.noise,
                         (plan.first_seed + s) * 64 + static_cast<std::uint64_t>(test * 8 + target - 'A'));
        FitOptions options;
        options.noise = plan.noise;
        fits[s] = fit_resins(table, options);
    });
    Case result;
    result.test = test, result.target = target;
    const auto collect = [&](const std::string& role, std::size_t from, std::size_t to) {
        const optics::Resin& of = set.resins[static_cast<std::size_t>(set.find(role))];
        std::vector<Sample> samples;
        for (const ResinFit& fit : fits) {
            const FittedResin& resin = fit.resins[static_cast<std::size_t>(fit.set.find(role))];
            for (std::size_t c = from; c < to; ++c) {
                const FittedValue &s = resin.sigma_t[c], &a = resin.albedo[c];
                const auto inside = [](const FittedValue& value, double true_value) {
                    return value.low <= true_value && true_value <= value.high;
                };
                samples.push_back({s.value, a.value, inside(s, of.sigma_t_per_mm[c]), inside(a, of.albedo[c]),
                                   s.doubts.empty(), a.doubts.empty()});
            }
        }
        return statistics(samples, of.sigma_t_per_mm[from], of.albedo[from]);
    };
    result.white = {collect("W", 0, extinctions)};
    result.black = {collect("K", 0, extinctions)};
    for (const std::string& colour : colours) {
        auto& rows = result.colours.emplace_back();
        for (std::size_t k = 0; k < static_cast<std::size_t>(extinctions); ++k)
            rows.push_back(collect(colour, k, k + 1));
    }
    result.fits = plan.seeds * extinctions;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return result;
}

}  // namespace

double Row::sigma_limit() const { return std::max(1.15 * base_sigma, 0.8 * bound_ln_sigma); }
double Row::albedo_limit() const { return std::max(1.15 * base_albedo, 0.8 * bound_albedo / albedo); }

std::vector<Case> run(const Plan& plan, const std::string& baseline_file) {
    std::ifstream file(baseline_file);
    if (!file) throw std::runtime_error("cannot open " + baseline_file);
    const auto table = nlohmann::json::parse(file);
    std::vector<Case> cases;
    for (const int test : plan.tests)
        for (const char target : plan.targets) {
            cases.push_back(run_case(test, target, plan));
            add_baseline(cases.back(), table);
        }
    return cases;
}

Verdict judge(const Case& of) {
    Verdict verdict;
    double sigma_trusted = 0, albedo_trusted = 0;
    for (const auto& rows : of.colours)
        for (const Row& row : rows) {
            ++verdict.rows;
            verdict.sigma_over += row.sigma_median > row.sigma_limit();
            verdict.albedo_over += row.albedo_median > row.albedo_limit();
            verdict.worst_sigma = std::max(verdict.worst_sigma, row.sigma_median / row.sigma_limit());
            verdict.worst_albedo = std::max(verdict.worst_albedo, row.albedo_median / row.albedo_limit());
            verdict.mean_ln_sigma += std::log(row.sigma_median / row.sigma_limit());
            verdict.mean_ln_albedo += std::log(row.albedo_median / row.albedo_limit());
            verdict.sigma_inside += row.sigma_inside, verdict.albedo_inside += row.albedo_inside;
            verdict.sigma_inside_trusted += row.sigma_inside_trusted * row.sigma_trusted,
                sigma_trusted += row.sigma_trusted;
            verdict.albedo_inside_trusted += row.albedo_inside_trusted * row.albedo_trusted,
                albedo_trusted += row.albedo_trusted;
        }
    verdict.mean_ln_sigma /= verdict.rows, verdict.mean_ln_albedo /= verdict.rows;
    verdict.sigma_inside /= verdict.rows, verdict.albedo_inside /= verdict.rows;
    if (sigma_trusted > 0) verdict.sigma_inside_trusted /= sigma_trusted;
    if (albedo_trusted > 0) verdict.albedo_inside_trusted /= albedo_trusted;
    return verdict;
}

}  // namespace voxtone::calibration::stress
