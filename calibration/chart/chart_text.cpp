// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace voxtone::calibration {

namespace {

using ChartJson = nlohmann::ordered_json;

ChartJson object_of(const optics::DifferenceSummary& d) { return ChartJson::parse(difference_json(d)); }

ChartJson patches_of(const std::vector<HeldOutPatch>& patches) {
    ChartJson list = ChartJson::array();
    for (const HeldOutPatch& patch : patches)
        list.push_back({{"mixture", patch.mixture}, {"de2000", patch.difference}});
    return list;
}

std::string patches_text(const std::vector<HeldOutPatch>& patches) {
    std::string text;
    for (const HeldOutPatch& patch : patches)
        text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", patch.mixture, patch.difference);
    return text;
}

std::string observer_word(const ObserverChoice& choice) { return choice.of_spectra ? "spectra" : "fitted"; }

}  // namespace

std::string difference_heading() {
    return fmt::format("  {:<34} {:>6} {:>7} {:>7} {:>8}\n", "CIEDE2000", "mean", "median", "95 %", "largest");
}

std::string difference_line(std::string_view what, const optics::DifferenceSummary& d) {
    return fmt::format("  {:<34} {:>6.2f} {:>7.2f} {:>7.2f} {:>8.2f}\n", what, d.mean, d.median, d.percentile_95,
                       d.max);
}

std::string difference_json(const optics::DifferenceSummary& d) {
    return ChartJson{{"count", d.count},
                     {"mean_de2000", d.mean},
                     {"median_de2000", d.median},
                     {"p95_de2000", d.percentile_95},
                     {"max_de2000", d.max}}
        .dump();
}

std::string chart_fit_text(const ChartFit& fit) {
    const optics::ResinSet& set = fit.set;
    std::string text = fmt::format("{} resins in {} channels of their own from {} mixtures, {:.1f} s\n\n",
                                   set.resins.size(), set.channels.size(), fit.fitted.count, fit.seconds);
    text += difference_heading();
    text += difference_line("mixtures left out of the fit", fit.held_out);
    text += difference_line("  the same by physics alone", fit.held_out_physics);
    text += difference_line("mixtures that were fitted", fit.fitted);
    if (fit.squares_held_out.count > 0) text += difference_line("thin squares left out", fit.squares_held_out);
    if (fit.noise.count > 0) text += difference_line("repeats from their own mean", fit.noise);
    if (!fit.curve.empty()) {
        text += "\nMixtures left out, by number of channels: mean by physics, with residual\n";
        for (const ChannelChoice& choice : fit.curve)
            text += fmt::format("  {:>2}  {:.2f}  {:.2f}{}{}\n", choice.observer.channels, choice.physics,
                                choice.with_residual, choice.observer.of_spectra ? "  bands of the spectra" : "",
                                choice.observer == fit.observer ? "  taken" : "");
    }
    if (set.residual.empty())
        text += "\nNo residual: none was wanted, or it made mixtures that were left out no better.\n";
    else
        text += fmt::format("\nResidual: {} mixtures, {:.2f} CIEDE2000 in the mean\n", set.residual.centres().rows(),
                            fit.residual_size);
    if (!fit.length_error.empty()) {
        text += "White scatters, from what tells lengths, per mm:";
        const int white = set.find("W");
        for (std::size_t c = 0; c < fit.length_error.size() && white >= 0; ++c) {
            const double sigma_s = set.resins[static_cast<std::size_t>(white)].medium(c).sigma_s;
            text += fmt::format(" {:.2f} +- {:.2f}", sigma_s, sigma_s * fit.length_error[c]);
        }
        text += "\n";
    }
    text += fit.dot_spread_text + "\n";
    text += fmt::format("Largest errors of mixtures left out: {}\n", patches_text(fit.worst));
    if (!fit.solids.empty()) text += fmt::format("Solids, left out: {}\n", patches_text(fit.solids));
    text += fmt::format("The instrument sees {:.2f} % of neutral light from the surface; its gain is {:.3f}\n",
                        100 * set.measured.surface, set.measured.gain);
    return text;
}

std::string chart_fit_json(const ChartFit& fit) {
    const optics::ResinSet& set = fit.set;
    ChartJson json{{"format", "voxtone-chart-fit"},
                   {"version", 1},
                   {"seconds", fit.seconds},
                   {"channels", set.channels.size()},
                   {"observer", observer_word(fit.observer)},
                   {"mixtures", fit.fitted.count},
                   {"fitted", object_of(fit.fitted)},
                   {"held_out", object_of(fit.held_out)},
                   {"held_out_physics", object_of(fit.held_out_physics)},
                   {"repeats", object_of(fit.noise)},
                   {"residual", {{"centres", set.residual.centres().rows()}, {"mean_de2000", fit.residual_size}}},
                   {"squares_held_out", object_of(fit.squares_held_out)},
                   {"length_error", fit.length_error},
                   {"dot_spread", {{"value", set.dot_spread}, {"error", fit.dot_spread_error}}},
                   {"measured", {{"surface", set.measured.surface}, {"gain", set.measured.gain}}},
                   {"curve", ChartJson::array()},
                   {"worst", patches_of(fit.worst)},
                   {"solids", patches_of(fit.solids)},
                   {"warnings", fit.warnings}};
    for (const ChannelChoice& choice : fit.curve)
        json["curve"].push_back({{"channels", choice.observer.channels},
                                 {"observer", observer_word(choice.observer)},
                                 {"physics", choice.physics},
                                 {"with_residual", choice.with_residual}});
    return json.dump(-1, ' ', false, ChartJson::error_handler_t::replace);
}

}  // namespace voxtone::calibration
