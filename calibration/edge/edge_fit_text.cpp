// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_fit_text.h"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "calibration/fit/fit_text.h"
#include "io/files/json_writer.h"

namespace voxtone::calibration {
namespace {

void write_curve(io::JsonWriter& json, const char* name, const std::vector<std::pair<double, double>>& curve) {
    json.key(name).begin_list();
    for (const auto& [x, y] : curve) json.begin_list().value(x).value(y).end_list();
    json.end_list();
}

// What a doubt means of slabs on an edge.
std::string_view edge_doubt_meaning(Doubt doubt) {
    switch (doubt) {
        case Doubt::opaque:
            return "no edge is seen through its slabs, so nothing tells its extinction; take it from a chart or "
                   "patches, "
                   "or measure a thinner slab";
        case Doubt::dark:
            return "it reflects too little to tell its albedo from 0";
        case Doubt::bound:
            return "at the end of the range of the dictionary; make one that goes on";
        default:
            return "the profiles say little of this value";
    }
}

void write_chart(io::JsonWriter& json, const EdgeChart& chart) {
    json.key("chart").begin_object().add("source", chart.source).add("patches", chart.patches.patches.size());
    json.add("completed", chart.completed).add("mean_de2000", chart.patches.differences.mean);
    json.add("rms", chart.patches.rms).end_object();
}

std::string marks(const FittedValue& value) { return value.doubts.empty() ? " " : "?"; }

}  // namespace

std::string edge_fit_text(const EdgeFit& fit) {
    std::string text = fmt::format("mu = {:.4f} +- {:.4f}, E = {:.3f}\n\n", fit.mu, fit.mu_error, fit.total);
    text += fmt::format("{:<8}{:>3}  {:>19}  {:>25}  {:>9}\n", "resin", "", "sigma_t, 1/mm", "albedo", "Eq. 1");
    std::map<std::string_view, std::string_view> meanings;
    for (const EdgeResinFit& resin : fit.resins) {
        for (std::size_t c = 0; c < 3; ++c) {
            const EdgeValue& v = resin.channel[c];
            text += fmt::format("{:<8}{:>3}  {:>8.3f} +- {:<6.3f}{} {:>11.5f} +- {:<9.5f}{} {:>9.4f}\n",
                                c == 0 ? resin.role : "", "RGB"[c], v.sigma_t.value, v.sigma_t.standard_error,
                                marks(v.sigma_t), v.albedo.value, v.albedo.standard_error, marks(v.albedo), v.distance);
            if (v.edges) text.insert(text.size() - 1, "  by the chart");
            for (const FittedValue* value : {&v.sigma_t, &v.albedo})
                for (const Doubt doubt : value->doubts) meanings[doubt_name(doubt)] = edge_doubt_meaning(doubt);
        }
        if (resin.g_error > 0) text += fmt::format("{:<8}     g {:.3f} +- {:.3f}\n", "", resin.g, resin.g_error);
    }
    for (const auto& [name, meaning] : meanings) text += fmt::format("? {}: {}\n", name, meaning);
    if (fit.chart)
        text +=
            fmt::format("{} channels completed by {}: {} patches, CIEDE2000 mean {:.2f}, rms of a reflectance {:.4f}\n",
                        fit.chart->completed, fit.chart->source, fit.chart->patches.patches.size(),
                        fit.chart->patches.differences.mean, fit.chart->patches.rms);
    for (const std::string& warning : fit.warnings) text += fmt::format("Warning: {}\n", warning);
    return text;
}

std::string edge_fit_json(const EdgeFit& fit, const EdgeFitOptions& options) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-edge-fit").add("version", 1).add("g", fit.set.g).add("eta", fit.set.eta);
    json.add("mu", fit.mu).add("mu_error", fit.mu_error).add("total", fit.total).add("lambda", options.metric.lambda);
    json.add("seconds", fit.seconds).add("warnings", fit.warnings);
    write_curve(json, "mu_curve", fit.mu_curve);
    if (fit.chart) write_chart(json, *fit.chart);
    json.key("resins").begin_list();
    for (const EdgeResinFit& resin : fit.resins) {
        json.begin_object().add("role", resin.role).add("g", resin.g).add("g_error", resin.g_error);
        write_curve(json, "by_g", resin.by_g);
        json.key("channels").begin_list();
        for (std::size_t c = 0; c < 3; ++c) {
            const EdgeValue& v = resin.channel[c];
            json.begin_object()
                .add("channel", std::string(1, "RGB"[c]))
                .add("from", v.edges ? "edges and chart" : "edges");
            add_value(json, "sigma_t_per_mm", v.sigma_t);
            add_value(json, "albedo", v.albedo);
            if (v.edges) {
                json.key("edges").begin_object();
                add_value(json, "sigma_t_per_mm", v.edges->sigma_t);
                add_value(json, "albedo", v.edges->albedo);
                json.end_object();
            }
            json.key("covariance_v_ln_sigma_t").begin_list();
            json.value(v.covariance(0, 0)).value(v.covariance(0, 1)).value(v.covariance(1, 1)).end_list();
            json.add("distance", v.distance);
            json.key("similar").begin_list();
            for (const SimilarEdgeMedium& s : resin.similar[c])
                json.begin_object()
                    .add("g", s.g)
                    .add("sigma_t_fitted", s.fitted.sigma_t)
                    .add("sigma_t_similar", s.similar.sigma_t)
                    .add("albedo_fitted", s.fitted.albedo)
                    .add("albedo_similar", s.similar.albedo)
                    .end_object();
            json.end_list().end_object();
        }
        json.end_list().end_object();
    }
    json.end_list().end_object();
    return json.text();
}

}  // namespace voxtone::calibration
