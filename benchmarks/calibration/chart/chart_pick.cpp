// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much the mixtures of `calibrate chart` tell: of a table of measured mixtures those that are nearest to them are
// fitted, each once, and all others foretold.
//
//   chart_pick TABLE [--resins SET] [--patches N,...]
//
// The table is not in the tree: whoever has measured one names it. Near is by ln(share + 0.01).
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "calibration/chart/chart_data.h"
#include "calibration/chart/chart_fit.h"
#include "calibration/chart/chart_mixtures.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_file.h"
#include "calibration/patches/patch_mixture.h"
#include "io/profiles/resin_file.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

Eigen::ArrayXd place_of(const Eigen::VectorXd& shares) { return (shares.array() + 0.01).log(); }

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("How much the mixtures of calibrate chart tell.");
    std::string file, resins = "vero-opaque";
    std::vector<std::size_t> counts{30, 60, 120, 242};
    app.add_option("table", file)->required();
    app.add_option("--resins", resins, "what the chart's colours are expected by")->capture_default_str();
    app.add_option("--patches", counts)->delimiter(',');
    CLI11_PARSE(app, argc, argv);
    const PatchTable table = read_patches(file);
    const ChartData data = chart_data(table);
    const optics::ResinSet set = io::find_resin_set(resins).subset(data.roles);
    fmt::print("patches  mean   95 %   channels\n");
    for (const std::size_t count : counts) {
        std::vector<bool> taken(static_cast<std::size_t>(data.mixtures()));
        for (const std::vector<int>& percents : chart_mixtures(set, count)) {
            Eigen::VectorXd wanted(data.resins());
            for (Eigen::Index r = 0; r < wanted.size(); ++r) wanted[r] = percents[static_cast<std::size_t>(r)] / 100.0;
            Eigen::Index best = -1;
            double least = 1e30;
            for (Eigen::Index i = 0; i < data.mixtures(); ++i) {
                const double far = (place_of(data.shares.row(i).transpose()) - place_of(wanted)).matrix().squaredNorm();
                if (!taken[static_cast<std::size_t>(i)] && far < least) least = far, best = i;
            }
            if (best >= 0) taken[static_cast<std::size_t>(best)] = true;
        }
        PatchTable fitted = table, judged = table;
        fitted.patches.clear(), judged.patches.clear();
        for (const Patch& patch : table.patches) {
            const auto row = std::ranges::find(data.names, mixture_text(patch.top)) - data.names.begin();
            (taken[static_cast<std::size_t>(row)] ? fitted : judged).patches.push_back(patch);
        }
        ChartFitOptions options;
        options.name = "picked";
        options.lengths_from = io::find_resin_set("vero-opaque");
        const ChartFit fit = fit_chart(fitted, options);
        const auto seen = check_resins(fit.set, judged, {}).differences;
        fmt::print("{:>7}  {:.2f}   {:.2f}   {:>8}\n", count, seen.mean, seen.percentile_95, fit.set.channels.size());
        std::fflush(stdout);
    }
    return 0;
}
