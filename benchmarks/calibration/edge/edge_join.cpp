// SPDX-License-Identifier: GPL-3.0-or-later
//
// What edges and patches know of Vero by themselves, and together: edges on the bench of edge_rehearsal.h, patches of
// target B and of the chart of all equal mixtures as the model of halftones has them, with noise. Medians and root mean
// squares over 15 extinctions and albedos and all seeds. Run:
//   build/release/benchmarks/edge_join [SEEDS 5] [PATHS 131072] [NOISE of a patch 0.005] [DICTIONARY]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "benchmarks/calibration/edge/edge_rehearsal.h"
#include "calibration/edge/edge_chart.h"
#include "calibration/resins/resin_coordinates.h"
#include "calibration/target/target_layout.h"
#include "tests/calibration/patches/target_samples.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

constexpr std::array<double, 3> pitch_mm{25.4 / 600, 25.4 / 300, 0.027};

PatchTable patches(TargetLayout layout, double noise, std::uint64_t seed, const PatchModelOptions& model) {
    TargetOptions options;
    options.layout = layout;
    options.roles = {"C", "M", "Y", "K", "W"};
    for (std::size_t k = 0; k < 3; ++k) options.pitch_um[k] = 1000 * pitch_mm[k];
    const Target target = lay_out_target(options);
    PatchTable table;
    table.source = target.layout;
    for (const TargetSquare& square : target.squares)
        table.patches.push_back({square.top, square.backing, target.top_mm, target.base_mm, {}, {}, {}});
    testing::measure(table, optics::vero_opaque(), noise, seed + 5000, model);
    for (Patch& patch : table.patches) patch.error.assign(3, noise);
    return table;
}

class Tally {
public:
    explicit Tally(std::string what) : what_(std::move(what)) {}
    void add(std::string_view role, std::size_t channel, const FittedValue& sigma_t, const FittedValue& albedo) {
        const optics::ResinSet truth = optics::vero_opaque();
        const optics::Resin& resin = truth.resins[static_cast<std::size_t>(truth.find(role))];
        ln_.push_back(std::abs(std::log(sigma_t.value / resin.sigma_t_per_mm[channel])));
        co_.push_back(std::abs(std::log(std::max(1 - albedo.value, 1e-7) / (1 - resin.albedo[channel]))));
        const double error = sigma_t.standard_error / sigma_t.value;
        if (sigma_t.doubts.empty()) ++told_, one_ += ln_.back() < error, two_ += ln_.back() < 2 * error;
    }
    void print() {
        const auto of = [](std::vector<double>& list) {
            double sum = 0;
            for (const double x : list) sum += x * x;
            std::ranges::sort(list);
            return fmt::format("{:.1f} % | {:.1f} %", 100 * list[list.size() / 2],
                               100 * std::sqrt(sum / static_cast<double>(list.size())));
        };
        fmt::print("| {} | {} | {} | {} of {} | {} %, {} % |\n", what_, of(ln_), of(co_), told_, ln_.size(),
                   100 * one_ / told_, 100 * two_ / told_);
    }

private:
    std::string what_;
    std::vector<double> ln_, co_;
    int told_ = 0, one_ = 0, two_ = 0;
};

void add(Tally& tally, const ResinFit& fit) {
    for (const FittedResin& resin : fit.resins)
        for (std::size_t c = 0; c < 3; ++c) tally.add(resin.role, c, resin.sigma_t[c], resin.albedo[c]);
}

void add(Tally& tally, const EdgeFit& fit) {
    for (const EdgeResinFit& resin : fit.resins)
        for (std::size_t c = 0; c < 3; ++c) tally.add(resin.role, c, resin.channel[c].sigma_t, resin.channel[c].albedo);
}

}  // namespace

int main(int count, char** words) {
    const int seeds = count > 1 ? std::atoi(words[1]) : 5;
    const auto paths = static_cast<std::uint32_t>(count > 2 ? std::atoi(words[2]) : 1 << 17);
    const double noise = count > 3 ? std::atof(words[3]) : 0.005;
    const auto dictionary = rehearsal::dictionary(count > 4 ? words[4] : "", {0.4}, paths);
    PatchModelOptions model;
    model.pitch_mm = pitch_mm;
    Tally of_patches("target B"), of_chart("chart of equal mixtures"), of_edges("edges"),
        completed("edges, dark channels by the chart"), with_patches("edges as prior of target B"),
        with_chart("edges as prior of the chart");
    int warnings = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        const auto at = static_cast<std::uint64_t>(seed);
        EdgeProfileTable table(dictionary, rehearsal::assumed_setup(0.006));
        EdgeFit edges = fit_edges(rehearsal::measured(optics::vero_opaque(), paths, 100 + at), table, {});
        const PatchTable b = patches(TargetLayout::b, noise, at, model),
                         chart = patches(TargetLayout::e, noise, at, model);
        add(of_edges, edges);
        FitOptions options;
        options.model = model;
        add(of_patches, fit_resins(b, options));
        add(of_chart, fit_resins(chart, options));
        options.prior = edge_prior(edges);
        const ResinFit joined = fit_resins(b, options), all = fit_resins(chart, options);
        add(with_patches, joined);
        add(with_chart, all);
        warnings += static_cast<int>(joined.warnings.size() + all.warnings.size());
        complete_by_chart(edges, chart, model);
        add(completed, edges);
    }
    fmt::print(
        "{} seeds, {} paths, noise of a patch {}; {} warnings of disagreement\n\n"
        "| | extinction: median error | rms | 1 - albedo: median | rms | extinctions without doubt | of these within "
        "one, two errors |\n|---|---|---|---|---|---|---|\n",
        seeds, paths, noise, warnings);
    for (Tally* tally : {&of_edges, &of_patches, &of_chart, &completed, &with_patches, &with_chart}) tally->print();
    return 0;
}
