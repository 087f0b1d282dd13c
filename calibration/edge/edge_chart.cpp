// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_chart.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/warning.h"
#include "calibration/resins/resin_coordinates.h"

namespace voxtone::calibration {
namespace {

bool is_told(const EdgeValue& value) { return value.sigma_t.doubts.empty() && value.albedo.doubts.empty(); }

// Gives the channels that were completed.
std::string complete(EdgeResinFit& resin, const FittedResin& found, optics::Resin& in_set) {
    std::string channels;
    for (std::size_t c = 0; c < resin.channel.size(); ++c) {
        EdgeValue& value = resin.channel[c];
        if (is_told(value)) continue;
        value.edges = EdgesAlone{value.sigma_t, value.albedo};
        value.sigma_t = found.sigma_t[c];
        value.albedo = found.albedo[c];
        in_set.sigma_t_per_mm[c] = value.sigma_t.value;
        in_set.albedo[c] = value.albedo.value;
        channels += "RGB"[c];
    }
    return channels;
}

}  // namespace

ResinPrior edge_prior(const EdgeFit& fit) {
    ResinPrior prior{"the edges", fit.set.g, fit.set.eta, {}};
    for (const EdgeResinFit& resin : fit.resins) {
        ResinPrior::Resin& entry = prior.resins.emplace_back();
        entry.role = resin.role;
        for (std::size_t c = 0; c < resin.channel.size(); ++c) {
            const EdgeValue& v = resin.channel[c];
            const FittedValue &sigma_t = v.edges ? v.edges->sigma_t : v.sigma_t,
                              &albedo = v.edges ? v.edges->albedo : v.albedo;
            entry.channel[c] = {{v_of_albedo(albedo.value, prior.g), std::log(sigma_t.value)},
                                prior_precision(v.covariance, albedo.doubts.empty(), sigma_t.doubts.empty())};
        }
    }
    return prior;
}

void complete_by_chart(EdgeFit& fit, const PatchTable& chart, PatchModelOptions model) {
    FitOptions options;
    options.prior = edge_prior(fit);
    options.model = model;
    options.model.g = fit.set.g, options.model.eta = fit.set.eta;
    const ResinFit joint = fit_resins(chart, options);
    fit.chart = EdgeChart{chart.source, joint.patches, 0};
    std::vector<std::string> completed;
    for (EdgeResinFit& resin : fit.resins) {
        const auto found = std::ranges::find(joint.resins, resin.role, &FittedResin::role);
        const bool in_chart = std::ranges::any_of(chart.patches, [&](const Patch& patch) {
            return patch.backing == resin.role ||
                   std::ranges::find(patch.top, resin.role, &ResinShare::role) != patch.top.end();
        });
        if (!in_chart) {
            if (!std::ranges::all_of(resin.channel, is_told))
                fit.warnings.push_back(
                    named_warning("few-patches", fmt::format("{}: no patch of {} has it, so nothing completes what its "
                                                             "edges do not tell. Measure patches with "
                                                             "it.",
                                                             resin.role, chart.source)));
            continue;
        }
        const std::string channels =
            complete(resin, *found, fit.set.resins[static_cast<std::size_t>(fit.set.find(resin.role))]);
        fit.chart->completed += static_cast<int>(channels.size());
        if (!channels.empty()) completed.push_back(fmt::format("{} in {}", resin.role, channels));
    }
    fit.warnings.insert(fit.warnings.end(), joint.warnings.begin(), joint.warnings.end());
    if (!completed.empty())
        fit.set.source += fmt::format("; {} completed by the patches of {}", fmt::join(completed, ", "), chart.source);
}

}  // namespace voxtone::calibration
