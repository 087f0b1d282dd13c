// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_text.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/patches/patch_mixture.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

namespace {

std::string patches_text(const std::vector<HeldOutPatch>& patches) {
    std::string text;
    for (const HeldOutPatch& patch : patches)
        text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", patch.mixture, patch.difference);
    return text;
}

std::string observer_word(const ObserverChoice& choice) { return choice.of_spectra ? "spectra" : "fitted"; }

void add_patches(io::JsonWriter& json, std::string_view key, std::string_view name,
                 const std::vector<HeldOutPatch>& patches) {
    json.key(key).begin_list();
    for (const HeldOutPatch& patch : patches)
        json.begin_object().add(name, patch.mixture).add("de2000", patch.difference).end_object();
    json.end_list();
}

void add_instrument(io::JsonWriter& json, const optics::ResinSet& set) {
    json.key("measured").begin_object().add("surface", set.measured.surface).add("gain", set.measured.gain);
    json.end_object();
}

std::string worst_laminates(const char* which, const std::vector<HeldOutPatch>& worst) {
    std::string text = fmt::format("\nLargest errors{}, layers from the top, mm:\n", which);
    for (const HeldOutPatch& laminate : worst)
        text += fmt::format("  {:>6.2f}  {}\n", laminate.difference, laminate.mixture);
    return text;
}

FitFigures figures_of(const PatchCheck& check, const PatchTable& table) {
    std::vector<double> differences;
    for (const CheckedPatch& patch : check.patches) differences.push_back(patch.difference);
    return {{{"laminates", "laminates", check.differences}},
            "laminate",
            largest_differences(differences, [&](std::size_t k) { return patch_name(table.patches[k]); })};
}

}  // namespace

std::string figures_text(const FitFigures& figures) {
    std::string text =
        fmt::format("  {:<34} {:>6} {:>7} {:>7} {:>8}\n", "CIEDE2000", "mean", "median", "95 %", "largest");
    for (const auto& [key, name, d] : figures.lines)
        if (d.count > 0)
            text += fmt::format("  {:<34} {:>6.2f} {:>7.2f} {:>7.2f} {:>8.2f}\n", name, d.mean, d.median,
                                d.percentile_95, d.max);
    return text;
}

void add_figures(io::JsonWriter& json, const FitFigures& figures) {
    for (const auto& [key, name, d] : figures.lines) {
        json.key(key).begin_object().add("count", d.count).add("mean_de2000", d.mean).add("median_de2000", d.median);
        json.add("p95_de2000", d.percentile_95).add("max_de2000", d.max).end_object();
    }
    add_patches(json, "worst", figures.patch, figures.worst);
}

io::ReportSection figures_section(const FitFigures& figures, const std::string& title) {
    io::ReportSection section;
    section.title = title;
    section.printed = true;
    io::ReportTable table{"CIEDE2000", {"", "Mean", "Median", "95 %", "Largest"}, {}};
    for (const auto& [key, name, d] : figures.lines)
        if (d.count > 0)
            table.rows.push_back({std::string(trimmed(name)), fmt::format("{:.2f}", d.mean),
                                  fmt::format("{:.2f}", d.median), fmt::format("{:.2f}", d.percentile_95),
                                  fmt::format("{:.2f}", d.max)});
    section.tables = {table, patches_table("Largest errors", figures.patch, figures.worst)};
    return section;
}

io::ReportTable patches_table(const std::string& title, const std::string& name,
                              const std::vector<HeldOutPatch>& patches) {
    io::ReportTable table{title, {name, "CIEDE2000"}, {}};
    for (const HeldOutPatch& patch : patches)
        table.rows.push_back({patch.mixture, fmt::format("{:.2f}", patch.difference)});
    return table;
}

std::string instrument_sentence(const optics::ResinSet& set) {
    return fmt::format("The instrument sees {:.2f} % of neutral light from the surface; its gain is {:.3f}",
                       100 * set.measured.surface, set.measured.gain);
}

FitFigures figures_of(const ChartFit& fit) {
    if (fit.of_laminates)
        return {{{"held_out", "laminates left out of the fit", fit.held_out},
                 {"fitted", "laminates that were fitted", fit.fitted}},
                "laminate",
                fit.worst};
    return {{{"held_out", "mixtures left out of the fit", fit.held_out},
             {"held_out_physics", "  the same by physics alone", fit.held_out_physics},
             {"fitted", "mixtures that were fitted", fit.fitted},
             {"squares_held_out", "thin squares left out", fit.squares_held_out},
             {"repeats", "repeats from their own mean", fit.noise}},
            "mixture",
            fit.worst};
}

std::string honesty_of(const ChartFit& fit) {
    std::string text;
    if (fit.residual_anew)
        text = "The residual's lengths and noise are chosen anew without the mixtures that they judge.";
    else if (!fit.set.residual.empty())
        text = fmt::format("The residual's lengths and noise, {} numbers, are chosen on all {} mixtures.",
                           fit.set.resins.size() + 1, fit.held_out.count);
    const auto taken = std::ranges::find(fit.curve, fit.observer, &ChannelChoice::observer);
    if (taken != fit.curve.end())
        text += fmt::format(
            "{}The number of channels is chosen on all: where others choose it for the mixtures that "
            "judge, {:.2f} of the curve is {:.2f}.",
            text.empty() ? "" : " ", taken->with_residual, fit.chosen_anew);
    return text;
}

std::string chart_fit_text(const ChartFit& fit) {
    const optics::ResinSet& set = fit.set;
    std::string text =
        fmt::format("{} resins in {} channels of their own from {} {}, {:.1f} s\n\n", set.resins.size(),
                    set.channels.size(), fit.fitted.count, fit.of_laminates ? "laminates" : "mixtures", fit.seconds);
    text += figures_text(figures_of(fit));
    if (fit.of_laminates)
        return text + worst_laminates(fit.held_out.count > 0 ? " of laminates left out" : "", fit.worst) +
               instrument_sentence(set) + "\n";
    if (const std::string honesty = honesty_of(fit); !honesty.empty()) text += honesty + "\n";
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
    text += instrument_sentence(set) + "\n";
    return text;
}

std::string chart_fit_json(const ChartFit& fit) {
    const optics::ResinSet& set = fit.set;
    io::JsonWriter json;
    json.begin_object().add("format", fit.of_laminates ? "voxtone-layer-fit" : "voxtone-chart-fit").add("version", 1);
    json.add("seconds", fit.seconds).add("channels", set.channels.size());
    if (!fit.of_laminates) json.add("observer", observer_word(fit.observer));
    json.add(fit.of_laminates ? "laminates" : "mixtures", fit.fitted.count);
    add_figures(json, figures_of(fit));
    if (fit.of_laminates) {
        add_instrument(json, set);
        return json.add("warnings", fit.warnings).end_object().text();
    }
    json.key("residual").begin_object().add("centres", set.residual.centres().rows());
    json.add("mean_de2000", fit.residual_size).end_object();
    json.add("length_error", fit.length_error).key("dot_spread").begin_object().add("value", set.dot_spread);
    json.add("error", fit.dot_spread_error).end_object();
    add_instrument(json, set);
    json.key("curve").begin_list();
    for (const ChannelChoice& choice : fit.curve) {
        json.begin_object().add("channels", choice.observer.channels).add("observer", observer_word(choice.observer));
        json.add("physics", choice.physics).add("with_residual", choice.with_residual).end_object();
    }
    json.end_list().add("chosen_anew", fit.chosen_anew).add("residual_anew", fit.residual_anew);
    add_patches(json, "solids", "mixture", fit.solids);
    return json.add("warnings", fit.warnings).end_object().text();
}

std::string laminate_check_text(const PatchCheck& check, const PatchTable& table) {
    const FitFigures figures = figures_of(check, table);
    return figures_text(figures) + worst_laminates("", figures.worst);
}

std::string laminate_check_json(const PatchCheck& check, const PatchTable& table) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-layer-check").add("version", 1);
    add_figures(json, figures_of(check, table));
    return json.end_object().text();
}

}  // namespace voxtone::calibration
