// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/edge/edge_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "voxtone/io/files/markup.h"
#include "voxtone/io/report/plot_svg.h"

namespace voxtone::calibration {
namespace {

using io::html_text;
using io::Plot;
using io::PlotAxis;

const char* const edge_style = R"(<style>
body{font-family:sans-serif;margin:24px;max-width:1250px;color:#222;background:#fff}
table{border-collapse:collapse;font-size:13px}td,th{padding:2px 10px;text-align:right;border-bottom:1px solid #ddd}
td:first-child,th:first-child{text-align:left}.doubt{color:#d9730d}
.plots{display:flex;flex-wrap:wrap;gap:8px}pre{background:#f5f5f5;padding:10px;overflow-x:auto;font-size:12px}p{max-width:900px}
</style>)";

constexpr const char* slab_colours[] = {"#1565c0", "#c62828", "#2e7d32", "#6a1b9a"};

Plot::Points points(const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
    Plot::Points list;
    for (Eigen::Index k = 0; k < y.size(); ++k) list.emplace_back(x[k], y[k]);
    return list;
}

std::vector<double> marks_to(double most) {
    double step = std::pow(10, std::floor(std::log10(most / 2)));
    if (most / step > 10) step *= 5;
    std::vector<double> marks;
    for (double v = 0; v <= most * 1.0001; v += step) marks.push_back(v);
    return marks;
}

class EdgePage {
public:
    EdgePage(const EdgeFit& fit, const std::vector<EdgeProfile>& profiles, const EdgeProfileTable& table,
             const EdgeFitOptions& options)
        : fit_(fit), profiles_(profiles), table_(table), options_(options) {}

    std::string html() const {
        return fmt::format(
            "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Edges {0}</title>"
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
            "'unsafe-inline'\">{1}</head><body>\n<h1>Edge profiles: "
            "{0}</h1>\n<p>{2}.</p>\n{3}{4}{5}{6}{7}</body></html>\n",
            html_text(fit_.set.name), edge_style, html_text(fit_.set.source), warnings(), values(), mu(), resins(),
            setup());
    }

private:
    std::string warnings() const {
        std::string text;
        for (const std::string& warning : fit_.warnings)
            text += fmt::format("<p class=\"doubt\">{}</p>\n", html_text(warning));
        return text;
    }

    static std::string cell(const FittedValue& v, const char* digits) {
        return fmt::format("<td{}>{} &plusmn; {}</td>", v.doubts.empty() ? "" : " class=\"doubt\"",
                           fmt::format(fmt::runtime(digits), v.value),
                           fmt::format(fmt::runtime(digits), v.standard_error));
    }

    std::string values() const {
        std::string text = fmt::format(
            "<h2>Values</h2>\n<p>At g = {:.3g}. Standard errors; orange: a value that the profiles tell badly.</p>\n"
            "<table><tr><th>resin</th><th colspan=\"3\">extinction, 1/mm: R, G, B</th><th colspan=\"3\">albedo: R, G, "
            "B</th><th colspan=\"3\">distance (Eq. 1): R, G, B</th></tr>\n",
            fit_.set.g);
        for (const EdgeResinFit& resin : fit_.resins) {
            text += fmt::format("<tr><td>{}</td>", html_text(resin.role));
            for (const EdgeValue& v : resin.channel) text += cell(v.sigma_t, "{:.3f}");
            for (const EdgeValue& v : resin.channel) text += cell(v.albedo, "{:.5f}");
            for (const EdgeValue& v : resin.channel) text += fmt::format("<td>{:.4f}</td>", v.distance);
            text += "</tr>\n";
        }
        return text + "</table>\n";
    }

    std::string mu() const {
        if (fit_.mu_curve.empty()) return fmt::format("<p>mu = {:.4f} was given.</p>\n", fit_.mu);
        Plot::Points curve(fit_.mu_curve.begin(), fit_.mu_curve.end());
        double most = 0, least = 1e300;
        for (const auto& [m, e] : curve) most = std::max(most, e), least = std::min(least, e);
        std::vector<double> marks;
        for (double m = std::ceil(curve.front().first * 20) / 20; m <= curve.back().first + 1e-9; m += 0.05)
            marks.push_back(m);
        Plot plot({curve.front().first, curve.back().first, false, marks, "mu"},
                  {0, most * 1.05, false, marks_to(most), "E(mu), Eq. 3"}, "The common factor", 420, 260);
        plot.line(curve, "#1565c0");
        plot.point(fit_.mu, fit_.total, "#c62828");
        return fmt::format(
            "<h2>Bias</h2>\n<p>mu = {:.4f} &plusmn; {:.4f}: measured values are multiplied by it.</p>\n{}\n", fit_.mu,
            fit_.mu_error, plot.svg());
    }

    std::string resins() const {
        std::string text =
            "<h2>Profiles</h2>\n<p>Measured (dots, times mu) and fitted (lines) profiles across the edge, the slabs of "
            "a resin in one plot; under it the gradients per sample that the fit compares.</p>\n";
        for (const EdgeResinFit& resin : fit_.resins) {
            std::vector<const EdgeProfile*> slabs;
            for (const EdgeProfile& profile : profiles_)
                if (profile.resin == resin.role) slabs.push_back(&profile);
            text += fmt::format("<h3>{}</h3>\n", html_text(resin.role));
            if (resin.g_error > 0) text += fmt::format("<p>g = {:.3f} &plusmn; {:.3f}</p>\n", resin.g, resin.g_error);
            text += similarity(resin);
            std::string profiles, gradients;
            for (std::size_t c = 0; c < 3; ++c) {
                std::vector<std::string> ignored;
                const auto seen = edge_observations(slabs, c, table_, options_.metric, ignored);
                if (!seen.empty()) draw(resin, c, seen, slabs, profiles, gradients);
            }
            text += "<div class=\"plots\">\n" + profiles + "</div>\n<div class=\"plots\">\n" + gradients + "</div>\n";
        }
        return text;
    }

    // Extinctions of the best fits at every g, on the curve that similarity predicts; and how far each g is away.
    static std::string similarity(const EdgeResinFit& resin) {
        if (resin.by_g.size() < 2) return "";
        const double from = resin.by_g.front().first, to = resin.by_g.back().first;
        double farthest = 0, largest = 1;
        for (const auto& [g, distance] : resin.by_g) farthest = std::max(farthest, distance);
        for (const auto& list : resin.similar)
            for (const SimilarEdgeMedium& s : list) largest = std::max({largest, s.fitted.sigma_t, s.similar.sigma_t});
        PlotAxis x{from, to, false, {}, "g"};
        for (double g = std::ceil(from * 5) / 5; g <= to + 1e-9; g += 0.2) x.marks.push_back(g);
        Plot distance(x, {0, farthest * 1.05, false, marks_to(farthest), "distance (Eq. 1)"},
                      fmt::format("{}: what g explains", resin.role), 330, 200);
        distance.line({resin.by_g.begin(), resin.by_g.end()}, "#333");
        Plot media(x, {0, largest * 1.05, false, marks_to(largest), "extinction, 1/mm"},
                   fmt::format("{}: fitted (dots), similar (lines)", resin.role), 330, 200);
        constexpr const char* colours[] = {"#c62828", "#2e7d32", "#1565c0"};
        for (std::size_t c = 0; c < 3; ++c) {
            Plot::Points similar;
            for (const SimilarEdgeMedium& s : resin.similar[c]) {
                similar.emplace_back(s.g, s.similar.sigma_t);
                media.point(s.g, s.fitted.sigma_t, colours[c]);
            }
            media.line(similar, colours[c], 1, true);
        }
        return "<div class=\"plots\">\n" + distance.svg() + media.svg() + "</div>\n";
    }

    void draw(const EdgeResinFit& resin, std::size_t c, const std::vector<EdgeObservation>& seen,
              const std::vector<const EdgeProfile*>& slabs, std::string& profiles, std::string& gradients) const {
        double most = 0.01, steepest = 1e-4;
        for (const EdgeObservation& slab : seen) {
            most = std::max(most, fit_.mu * slab.value.maxCoeff());
            steepest = std::max(steepest, fit_.mu * slab.gradient.maxCoeff());
        }
        const double half = table_.setup().width_mm / 2;
        PlotAxis x{-half, half, false, {}, "mm across the edge"},
            near{-half / 4, half / 4, false, {}, "mm across the edge"};
        for (double m = -std::floor(half); m <= half; ++m) x.marks.push_back(m), near.marks.push_back(m);
        std::erase_if(near.marks, [&](double m) { return std::abs(m) > half / 4; });
        Plot values(x, {0, most * 1.05, false, marks_to(most), "reflectance"},
                    fmt::format("{} in {}", resin.role, "RGB"[c]), 330, 220);
        Plot steps(near, {0, steepest * 1.1, false, marks_to(steepest), "gradient"},
                   fmt::format("{} in {}: gradient", resin.role, "RGB"[c]), 330, 160);
        const EdgeObjective objective(seen, c, table_, options_.metric);
        for (std::size_t s = 0; s < seen.size(); ++s) {
            const char* colour = slab_colours[s % std::size(slab_colours)];
            const EdgeObservation& slab = seen[s];
            for (Eigen::Index k = 0; k < slab.x.size(); k += 4)
                values.point(slab.x[k], fit_.mu * slab.value[k], "#bbb");
            const EdgePoint at = resin.channel[c].at;
            values.line(points(slab.x, objective.simulated(slab, at, resin.g)), colour);
            values.label(-0.95 * half, most * (0.95 - 0.1 * static_cast<double>(s)),
                         fmt::format("{:g} mm", slabs[std::min(s, slabs.size() - 1)]->thickness_mm), colour);
            const Eigen::VectorXd between = (slab.x.head(slab.x.size() - 1) + slab.x.tail(slab.x.size() - 1)) / 2;
            steps.line(points(between, fit_.mu * slab.gradient), "#999", 1);
            steps.line(points(between, objective.simulated_gradient(slab, at, resin.g)), colour);
        }
        profiles += values.svg();
        gradients += steps.svg();
    }

    std::string setup() const {
        return fmt::format("<h2>Setup</h2>\n<pre>{}</pre>\n", html_text(edge_setup_text(table_.setup())));
    }

    const EdgeFit& fit_;
    const std::vector<EdgeProfile>& profiles_;
    const EdgeProfileTable& table_;
    const EdgeFitOptions& options_;
};

}  // namespace

std::string edge_report_html(const EdgeFit& fit, const std::vector<EdgeProfile>& profiles,
                             const EdgeProfileTable& table, const EdgeFitOptions& options) {
    return EdgePage(fit, profiles, table, options).html();
}

}  // namespace voxtone::calibration
