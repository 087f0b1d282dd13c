// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a chart of measured mixtures is fitted: judged on the mixtures of the same table that took no part.
//
//   chart_benchmark TABLE [--fit N,...] [--draws D] [--channels K,...] [--no-residual] [--printer ID]
//
// For every N (0: a half of them) and K (0: auto) D random draws of N mixtures are fitted, and all others predicted:
// mean and 95th percentile of CIEDE2000 over the draws, of physics alone as well, and seconds; with a printer, what the
// first draw tells of the dot spread of its voxels. The table is not in the tree: whoever has measured one names it.
#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/random.h"
#include "calibration/chart/chart_fit.h"
#include "calibration/patches/patch_check.h"
#include "calibration/patches/patch_file.h"
#include "calibration/patches/patch_mixture.h"
#include "io/profiles/resin_file.h"
#include "slicer/printer/printer.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

struct Cut {
    PatchTable fitted, judged;
};

// N mixtures drawn at random with all their repeats, and the others.
Cut cut_table(const PatchTable& table, std::size_t count, std::uint64_t draw) {
    std::map<std::string, double> key;
    for (const Patch& patch : table.patches) key.try_emplace(mixture_text(patch.top), 0);
    std::vector<std::pair<double, std::string>> order;
    std::uint64_t index = 0;
    for (const auto& [mixture, unused] : key) order.emplace_back(RandomStream(draw, index++, 1).uniform(), mixture);
    std::sort(order.begin(), order.end());
    if (count == 0) count = order.size() / 2;
    for (std::size_t k = 0; k < order.size(); ++k) key[order[k].second] = k < count ? 1 : 0;
    Cut cut{table, table};
    std::erase_if(cut.fitted.patches, [&](const Patch& patch) { return key[mixture_text(patch.top)] == 0; });
    std::erase_if(cut.judged.patches, [&](const Patch& patch) { return key[mixture_text(patch.top)] == 1; });
    return cut;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("How well a chart of measured mixtures is fitted, judged on its other mixtures.");
    std::string file;
    std::vector<std::size_t> counts{0};
    std::vector<int> channels{0};
    int draws = 1;
    bool no_residual = false;
    app.add_option("table", file)->required();
    app.add_option("--fit", counts, "mixtures that are fitted; 0: a half")->delimiter(',');
    app.add_option("--channels", channels, "0: auto")->delimiter(',');
    app.add_option("--draws", draws);
    std::string printer;
    app.add_option("--printer", printer, "whose voxels mixtures are made of; empty: ideal mixtures");
    app.add_flag("--no-residual", no_residual);
    CLI11_PARSE(app, argc, argv);
    const PatchTable table = read_patches(file);
    PatchModelOptions voxels;
    if (!printer.empty()) {
        const auto pitch = slicer::find_printer(printer).sliced_pitch_mm();
        voxels.pitch_mm = {pitch.x(), pitch.y(), pitch.z()};
    }
    fmt::print("fitted  channels  mean   95 %   physics: mean   95 %   seconds\n");
    for (const std::size_t count : counts)
        for (const int wanted : channels) {
            double mean = 0, most = 0, physics_mean = 0, physics_most = 0, seconds = 0, taken = 0;
            std::string spread;
            for (int draw = 0; draw < draws; ++draw) {
                const Cut cut = cut_table(table, count, static_cast<std::uint64_t>(draw));
                ChartFitOptions options;
                options.name = "drawn";
                options.channels = wanted;
                options.residual = !no_residual;
                options.pitch_mm = voxels.pitch_mm;
                options.lengths_from = io::find_resin_set("vero-opaque");
                const ChartFit fit = fit_chart(cut.fitted, options);
                const auto judged = check_resins(fit.set, cut.judged, voxels).differences;
                optics::ResinSet plain = fit.set;
                plain.residual = {};
                const auto by_physics = check_resins(plain, cut.judged, voxels).differences;
                mean += judged.mean / draws, most += judged.percentile_95 / draws;
                physics_mean += by_physics.mean / draws, physics_most += by_physics.percentile_95 / draws;
                if (draw == 0 && !printer.empty()) spread = "        " + fit.dot_spread_text + "\n";
                seconds += fit.seconds / draws;
                taken += static_cast<double>(fit.set.channels.size()) / draws;
            }
            fmt::print("{:>6}  {:>8.1f}  {:.2f}   {:.2f}            {:.2f}   {:.2f}   {:.1f}\n{}", count, taken, mean,
                       most, physics_mean, physics_most, seconds, spread);
            std::fflush(stdout);
        }
    return 0;
}
