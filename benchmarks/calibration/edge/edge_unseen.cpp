// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins that nobody has seen, on the bench of edge_rehearsal.h: how many truths lie within one and two stated errors,
// and within what is wanted. Extinctions from 1.5 to 20 per mm and 1 - albedo from 0.0003 to 0.6, even in their
// logarithms. A value that the fit doubts is counted apart. Run:
//   build/release/benchmarks/edge_unseen [RESINS 20] [PATHS 131072] [SEED 1] [LEVEL 0.006] [DICTIONARY]
// LEVEL: relative error of a photograph's level, here the renderer's noise
#include <cmath>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "base/random.h"
#include "benchmarks/calibration/edge/edge_rehearsal.h"
#include "calibration/resins/resin_coordinates.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

optics::ResinSet drawn(int resins, std::uint64_t seed) {
    optics::ResinSet set = optics::vero_opaque();
    set.resins.clear();
    for (int r = 0; r < resins; ++r) {
        optics::Resin& resin = set.resins.emplace_back();
        resin.role = resin.name = fmt::format("R{}", r + 1);
        for (std::uint64_t c = 0; c < 3; ++c) {
            RandomStream random(seed, 3 * static_cast<std::uint64_t>(r) + c, 23);
            resin.sigma_t_per_mm.push_back(1.5 * std::pow(20 / 1.5, random.uniform()));
            resin.albedo.push_back(1 - 0.0003 * std::pow(0.6 / 0.0003, random.uniform()));
        }
    }
    return set;
}

struct Tally {
    const char* what;
    int values = 0, within_one = 0, within_two = 0, wanted = 0;
    void add(double errors, bool as_wanted) {
        ++values;
        within_one += errors < 1, within_two += errors < 2, wanted += as_wanted;
    }
    void print() const { fmt::print("| {} | {} | {} | {} | {} |\n", what, values, within_one, within_two, wanted); }
};

}  // namespace

int main(int count, char** words) {
    const auto number = [&](int k, std::uint64_t otherwise) {
        return count > k ? static_cast<std::uint64_t>(std::atoll(words[k])) : otherwise;
    };
    const auto resins = static_cast<int>(number(1, 20));
    const auto paths = static_cast<std::uint32_t>(number(2, 1u << 17));
    const std::uint64_t seed = number(3, 1);
    const optics::ResinSet truth = drawn(resins, seed);
    const std::vector<EdgeProfile> profiles = rehearsal::measured(truth, paths, seed);
    EdgeProfileTable table(rehearsal::dictionary(count > 5 ? words[5] : "", {0.4}, 1u << 19),
                           rehearsal::assumed_setup(count > 4 ? std::atof(words[4]) : 0.006));
    const EdgeFit fit = fit_edges(profiles, table, {});
    Tally sigma_t{"extinction; wanted: within 5 %"}, albedo{"albedo; wanted: 1 - albedo within 10 %"},
        pale{"of these 1 - albedo below 0.003"}, doubted{"doubted, extinction"};
    fmt::print(
        "mu {:.4f} +- {:.4f} for {}\n\n| resin | channel | extinction | truth | 1 - albedo | truth |\n"
        "|---|---|---|---|---|---|\n",
        fit.mu, fit.mu_error, rehearsal::bias);
    for (std::size_t r = 0; r < truth.resins.size(); ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            const EdgeValue& v = fit.resins[r].channel[c];
            const double s = truth.resins[r].sigma_t_per_mm[c], a = truth.resins[r].albedo[c];
            const double ln_off = std::abs(std::log(v.sigma_t.value / s)), co = (1 - v.albedo.value) / (1 - a);
            const double v_off = std::abs(v_of_albedo(v.albedo.value, 0.4) - v_of_albedo(a, 0.4));
            fmt::print("| {} | {} | {:.3f} +- {:.3f} | {:.3f} | {:.5f} +- {:.5f} | {:.5f} |\n", truth.resins[r].role,
                       "RGB"[c], v.sigma_t.value, v.sigma_t.standard_error, s, 1 - v.albedo.value,
                       v.albedo.standard_error, 1 - a);
            if (v.sigma_t.doubts.empty())
                sigma_t.add(ln_off / std::sqrt(v.covariance(1, 1)), ln_off < 0.05);
            else
                doubted.add(ln_off / std::sqrt(v.covariance(1, 1)), ln_off < 0.05);
            const double errors = v_off / std::sqrt(v.covariance(0, 0));
            albedo.add(errors, std::abs(co - 1) < 0.1);
            if (1 - a < 0.003) pale.add(errors, std::abs(co - 1) < 0.1);
        }
    fmt::print(
        "\n| {} resins, {} paths, seed {} | values | within one error | within two | as wanted |\n"
        "|---|---|---|---|---|\n",
        resins, paths, seed);
    for (const Tally& tally : {sigma_t, doubted, albedo, pale}) tally.print();
    return 0;
}
