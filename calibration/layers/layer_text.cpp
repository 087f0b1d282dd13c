// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/layer_text.h"

#include <fmt/format.h>

#include "io/files/json_writer.h"

namespace voxtone::calibration {

namespace {

std::string worst_text(const std::vector<HeldOutPatch>& worst) {
    std::string text;
    for (const HeldOutPatch& laminate : worst)
        text += fmt::format("  {:>6.2f}  {}\n", laminate.difference, laminate.mixture);
    return text;
}

FitFigures figures_of(const LayerCheck& check) {
    return {{{"laminates", "laminates", check.summary}}, "laminate", check.worst};
}

}  // namespace

FitFigures figures_of(const LayerFit& fit) {
    return {{{"held_out", "laminates left out of the fit", fit.held_out},
             {"fitted", "laminates that were fitted", fit.fitted}},
            "laminate",
            fit.worst};
}

std::string layer_fit_text(const LayerFit& fit) {
    const optics::ResinSet& set = fit.set;
    std::string text = fmt::format("{} resins in {} channels of their own from {} laminates, {:.1f} s\n\n",
                                   set.resins.size(), set.channels.size(), fit.fitted.count, fit.seconds);
    text += figures_text(figures_of(fit));
    text += fmt::format("\nLargest errors{}, layers from the top, mm:\n{}",
                        fit.held_out.count > 0 ? " of laminates left out" : "", worst_text(fit.worst));
    text += instrument_sentence(set) + "\n";
    return text;
}

std::string layer_fit_json(const LayerFit& fit) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-layer-fit").add("version", 1).add("seconds", fit.seconds);
    json.add("channels", fit.set.channels.size()).add("laminates", fit.fitted.count);
    add_figures(json, figures_of(fit));
    json.key("measured").begin_object().add("surface", fit.set.measured.surface);
    json.add("gain", fit.set.measured.gain).end_object();
    return json.add("warnings", fit.warnings).end_object().text();
}

std::string layer_check_text(const LayerCheck& check) {
    return figures_text(figures_of(check)) + "\nLargest errors, layers from the top, mm:\n" + worst_text(check.worst);
}

std::string layer_check_json(const LayerCheck& check) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-layer-check").add("version", 1);
    add_figures(json, figures_of(check));
    return json.end_object().text();
}

}  // namespace voxtone::calibration
