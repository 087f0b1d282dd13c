// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/layer_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibration/chart/chart_text.h"

namespace voxtone::calibration {

namespace {

using LayerJson = nlohmann::ordered_json;

LayerJson object_of(const optics::DifferenceSummary& d) { return LayerJson::parse(difference_json(d)); }

LayerJson worst_json(const std::vector<HeldOutPatch>& worst) {
    LayerJson list = LayerJson::array();
    for (const HeldOutPatch& stack : worst) list.push_back({{"stack", stack.mixture}, {"de2000", stack.difference}});
    return list;
}

std::string worst_text(const std::vector<HeldOutPatch>& worst) {
    std::string text;
    for (const HeldOutPatch& stack : worst) text += fmt::format("  {:>6.2f}  {}\n", stack.difference, stack.mixture);
    return text;
}

std::string dumped(const LayerJson& json) { return json.dump(-1, ' ', false, LayerJson::error_handler_t::replace); }

}  // namespace

std::string layer_fit_text(const LayerFit& fit) {
    const optics::ResinSet& set = fit.set;
    std::string text = fmt::format("{} resins in {} channels of their own from {} stacks of layers, {:.1f} s\n\n",
                                   set.resins.size(), set.channels.size(), fit.fitted.count, fit.seconds);
    text += difference_heading();
    if (fit.held_out.count > 0) text += difference_line("stacks left out of the fit", fit.held_out);
    text += difference_line("stacks that were fitted", fit.fitted);
    text += fmt::format("\nLargest errors{}, layers from the top, mm:\n{}",
                        fit.held_out.count > 0 ? " of stacks left out" : "", worst_text(fit.worst));
    text += fmt::format("The instrument sees {:.2f} % of neutral light from the surface; its gain is {:.3f}\n",
                        100 * set.measured.surface, set.measured.gain);
    return text;
}

std::string layer_fit_json(const LayerFit& fit) {
    return dumped({{"format", "voxtone-layer-fit"},
                   {"version", 1},
                   {"seconds", fit.seconds},
                   {"channels", fit.set.channels.size()},
                   {"stacks", fit.fitted.count},
                   {"fitted", object_of(fit.fitted)},
                   {"held_out", object_of(fit.held_out)},
                   {"measured", {{"surface", fit.set.measured.surface}, {"gain", fit.set.measured.gain}}},
                   {"worst", worst_json(fit.worst)},
                   {"warnings", fit.warnings}});
}

std::string layer_check_text(const LayerCheck& check) {
    return difference_heading() + difference_line("stacks of layers", check.summary) +
           "\nLargest errors, layers from the top, mm:\n" + worst_text(check.worst);
}

std::string layer_check_json(const LayerCheck& check) {
    return dumped({{"format", "voxtone-layer-check"},
                   {"version", 1},
                   {"stacks", object_of(check.summary)},
                   {"worst", worst_json(check.worst)}});
}

}  // namespace voxtone::calibration
