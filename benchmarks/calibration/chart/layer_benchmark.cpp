// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well measured laminates are fitted: a random half of them is, and judges nothing; the other half judges.
//
//   layer_benchmark FILE... [--channels K] [--draw D] [--reversed]
//
// Mean, median and 95th percentile of CIEDE2000, seconds. --reversed: the same with the layers above
// every base upside down: how much their order says.
#include <algorithm>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/random.h"
#include "calibration/chart/chart_fit.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_file.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

// Order of the layers above the base.
void turn_over(PatchTable& chart) {
    for (Patch& patch : chart.patches) {
        std::vector<PatchLayer> layers{{patch.top.front().role, patch.thickness_mm}};
        layers.insert(layers.end(), patch.under.begin(), patch.under.end() - 1);
        std::reverse(layers.begin(), layers.end());
        patch.top = {{layers.front().role, 1}}, patch.thickness_mm = layers.front().thickness_mm;
        std::copy(layers.begin() + 1, layers.end(), patch.under.begin());
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("How well measured laminates are fitted: a half is, the other half judges.");
    std::vector<std::string> files;
    int channels = 0;
    std::uint64_t draw = 0;
    bool reversed = false;
    app.add_option("files", files)->required();
    app.add_option("--channels", channels, "0: as calibrate fit takes them");
    app.add_option("--draw", draw);
    app.add_flag("--reversed", reversed, "layers above the base upside down");
    CLI11_PARSE(app, argc, argv);
    fmt::print("  mean  median   95 %  seconds  channels\n");
    for (const std::string& file : files) {
        PatchTable chart = read_patches(file);
        if (!chart.is_of_laminates()) {
            fmt::print("{}: no laminates\n", file);
            continue;
        }
        if (reversed) turn_over(chart);
        std::vector<std::size_t> order(chart.patches.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        RandomStream random(draw, 7);
        for (std::size_t k = order.size(); k > 1; --k)
            std::swap(order[k - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(k))]);
        PatchTable half = chart, other = chart;
        half.patches.clear(), other.patches.clear();
        for (std::size_t k = 0; k < order.size(); ++k)
            (k < order.size() / 2 ? half : other).patches.push_back(chart.patches[order[k]]);
        const ChartFit fit = fit_chart(half, {.name = "half", .channels = channels, .folds = 0});
        const optics::DifferenceSummary check = check_resins(fit.set, other, {}).differences;
        fmt::print("{:>6.2f}  {:>6.2f}  {:>5.2f}  {:>7.1f}  {:>8}  {} (fitted half {:.2f}, gain {:.3f})\n", check.mean,
                   check.median, check.percentile_95, fit.seconds, fit.set.channels.size(), file, fit.fitted.mean,
                   fit.set.measured.gain);
        std::fflush(stdout);
    }
    return 0;
}
