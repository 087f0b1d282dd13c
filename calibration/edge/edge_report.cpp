// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "calibration/edge/edge_plots.h"
#include "io/files/markup.h"
#include "io/report/plot_svg.h"

namespace voxtone::calibration {
namespace {

using io::html_text;
using io::Plot;
using io::PlotAxis;

/// On top of the report's: numbers to the right, plots side by side and no wider than the page.
constexpr const char* edge_style = R"(
table { width: auto; font-size: .85rem; }
td, th { text-align: right; white-space: nowrap; padding-left: .75rem; }
td:first-child, th:first-child { text-align: left; padding-left: 0; }
.doubt { color: #d9730d; } .chart { color: #1565c0; }
.note { font-size: .8rem; max-width: 24rem; margin: .1rem 0 .6rem; }
.plots { display: flex; flex-wrap: wrap; gap: .5rem; }
.plots > div { max-width: 100%; }
main svg { max-width: 100%; height: auto; background: #fff; color: #1c1d1f; border-radius: 8px; }
main img { max-width: 40vw; }
)";

// Elek et al. 2017, supplement, Table 1, last columns: fit errors of Vero Opaque; 0: none is given. The paper does not
// say how it normalised its norms.
struct PublishedError {
    const char* role;
    std::array<double, 3> error;
};
constexpr PublishedError published_errors[] = {{"C", {0, 0.009, 0.011}},
                                               {"M", {0.039, 0, 0.008}},
                                               {"Y", {0.041, 0.022, 0}},
                                               {"K", {0.003, 0.002, 0.002}},
                                               {"W", {0.024, 0.017, 0.041}}};

class EdgePage {
public:
    EdgePage(const EdgeFit& fit, const std::vector<EdgeProfile>& profiles, const EdgeProfileTable& table,
             const EdgeFitOptions& options, const EdgeSimilarity& similarity)
        : fit_(fit), profiles_(profiles), table_(table), options_(options), similarity_(similarity) {}

    std::string html() const {
        return io::page_start("Edge profiles: " + fit_.set.name, std::string(io::page_asset("style")) + edge_style,
                              fmt::format("<p class=\"soft\">{}.</p>\n", html_text(fit_.set.source))) +
               warnings() + values() + pictures() + mu() + resins() + similar_media() + setup() +
               "</main>\n</body>\n</html>\n";
    }

private:
    static std::string section(const std::string& title, const std::string& body) {
        return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", title, body);
    }

    std::string warnings() const {
        if (fit_.warnings.empty()) return {};
        std::string text = "<section class=\"warnings\">\n<ul>\n";
        for (const std::string& warning : fit_.warnings) text += fmt::format("<li>{}</li>\n", html_text(warning));
        return text + "</ul>\n</section>\n";
    }

    static std::string cell(const EdgeValue& of, const FittedValue& v, const char* digits) {
        return fmt::format("<td{}>{} &plusmn; {}</td>",
                           !v.doubts.empty() ? " class=\"doubt\""
                           : of.edges        ? " class=\"chart\""
                                             : "",
                           fmt::format(fmt::runtime(digits), v.value),
                           fmt::format(fmt::runtime(digits), v.standard_error));
    }

    static std::string published(const std::string& role, std::size_t c) {
        for (const PublishedError& entry : published_errors)
            if (role == entry.role) return entry.error[c] > 0 ? fmt::format("{:.3f}", entry.error[c]) : "none";
        return "";
    }

    std::string values() const {
        std::string text = fmt::format(
            "<p>At g = {:.3g}. Standard errors; orange: a value that the profiles tell badly; blue: "
            "completed by a chart. The last columns are the fit errors that the paper gives for Vero Opaque (Elek et "
            "al. "
            "2017, supplement, Table 1), whose norm it does not say; ours is the root mean square over samples of "
            "values, "
            "and {:g} times that of gradients, summed over the slabs.</p>\n"
            "<div class=\"table\"><table><tr><th>resin</th><th colspan=\"3\">extinction, 1/mm: R, G, B</th><th "
            "colspan=\"3\">albedo: R, G, "
            "B</th><th colspan=\"3\">distance (Eq. 1): R, G, B</th><th colspan=\"3\">the paper's: R, G, B</th></tr>\n",
            fit_.set.g, options_.metric.lambda);
        for (const EdgeResinFit& resin : fit_.resins) {
            text += fmt::format("<tr><td>{}</td>", html_text(resin.role));
            for (const EdgeValue& v : resin.channel) text += cell(v, v.sigma_t, "{:.3f}");
            for (const EdgeValue& v : resin.channel) text += cell(v, v.albedo, "{:.5f}");
            for (const EdgeValue& v : resin.channel) text += fmt::format("<td>{:.4f}</td>", v.distance);
            for (std::size_t c = 0; c < 3; ++c) text += fmt::format("<td>{}</td>", published(resin.role, c));
            text += "</tr>\n";
        }
        text += "</table></div>\n";
        if (fit_.chart)
            text += fmt::format(
                "<p>Chart: {} of {} patches, predicted within CIEDE2000 {:.2f} in the mean; {} channels "
                "completed.</p>\n",
                html_text(fit_.chart->source), fit_.chart->patches.patches.size(), fit_.chart->patches.differences.mean,
                fit_.chart->completed);
        return section("Values", text);
    }

    std::string pictures() const {
        std::string rows;
        for (const EdgeResinFit& resin : fit_.resins) rows += plots(resin).strips();
        return section(
            "Slabs",
            "<p>What the camera saw of each slab on the edge (times mu), and the simulation of its "
            "fit "
            "beside it, "
            "in sRGB.</p>\n<div class=\"table\"><table><tr><th></th><th>measured</th><th>simulated</th></tr>\n" +
                rows + "</table></div>\n");
    }

    std::string mu() const {
        if (fit_.mu_curve.empty()) return section("Bias", fmt::format("<p>mu = {:.4f} was given.</p>\n", fit_.mu));
        Plot::Points curve(fit_.mu_curve.begin(), fit_.mu_curve.end());
        double most = 0, least = 1e300;
        for (const auto& [m, e] : curve) most = std::max(most, e), least = std::min(least, e);
        std::vector<double> marks;
        for (double m = std::ceil(curve.front().first * 20) / 20; m <= curve.back().first + 1e-9; m += 0.05)
            marks.push_back(m);
        Plot plot({curve.front().first, curve.back().first, false, marks, "mu"},
                  {0, most * 1.05, false, plot_marks(most), "E(mu), Eq. 3"}, "The common factor", 420, 260);
        plot.line(curve, "#1565c0");
        plot.point(fit_.mu, fit_.total, "#c62828");
        return section("Bias",
                       fmt::format("<p>mu = {:.4f} &plusmn; {:.4f}: measured values are multiplied by it.</p>\n{}\n",
                                   fit_.mu, fit_.mu_error, plot.svg()));
    }

    EdgePlots plots(const EdgeResinFit& resin) const { return {fit_, resin, profiles_, table_, options_}; }

    std::string resins() const {
        std::string text =
            "<p>Measured (dots, times mu) and fitted (lines) profiles across the edge, the slabs of "
            "a resin in one plot; under it the gradients per sample that the fit compares; then the fit (black) among "
            "its "
            "neighbours in the paper's grid: the next extinctions (orange), albedos (violet) and, where the dictionary "
            "has "
            "them, anisotropies (green), with their distances from what was measured. Where neighbours fall together, "
            "the slabs do not tell the value.</p>\n";
        for (const EdgeResinFit& resin : fit_.resins) {
            text += fmt::format("<h3>{}</h3>\n", html_text(resin.role));
            if (resin.g_error > 0) text += fmt::format("<p>g = {:.3f} &plusmn; {:.3f}</p>\n", resin.g, resin.g_error);
            const EdgePlots of = plots(resin);
            text += of.profiles() + of.gradients() + of.neighbours();
        }
        return section("Profiles", text);
    }

    // What g is worth, in words.
    std::string worth_of_g() const {
        std::vector<std::pair<double, double>> total = fit_.resins.front().by_g;
        for (std::size_t r = 1; r < fit_.resins.size(); ++r)
            for (std::size_t k = 0; k < total.size(); ++k) total[k].second += fit_.resins[r].by_g[k].second;
        const auto best = std::ranges::min_element(total, {}, &std::pair<double, double>::second);
        std::string text = fmt::format("<p>All resins together: the distance is least at g = {:g}, {:.4f};",
                                       best->first, best->second);
        for (const auto& [g, distance] : total)
            text += fmt::format("{} {:g}: {:+.0f} %", &g == &total.front().first ? " at" : ",", g,
                                100 * (distance / best->second - 1));
        double ln = 0, v = 0, count = 0;
        for (std::size_t r = 0; r < fit_.resins.size(); ++r)
            for (std::size_t c = 0; c < 3; ++c) {
                if (!fit_.resins[r].channel[c].told) continue;
                const EdgeSimilarity::Agreement one = similarity_.agreement(r, c);
                ln += one.ln_sigma_t * one.ln_sigma_t, v += one.v * one.v, ++count;
            }
        if (count > 0)
            text += fmt::format(
                ". Over all channels that edges tell, fits at other g lie {:.1f} % in extinction and {:.4f} in v from "
                "the "
                "media that are similar to the fit (rms): that much is lost where a set is brought to another g.",
                100 * std::sqrt(ln / count), std::sqrt(v / count));
        return text + "</p>\n";
    }

    std::string similar_media() const {
        std::string text =
            "<p>The distance (Eq. 1) over albedo and extinction for each g, its logarithm from "
            "the least of all g (dark) to 200 times that; the title has that of its g. Cross: where it is least, "
            "bright "
            "at the g of the fit; white dot: the medium that similarity (Eqs. 4 to 6) makes of the fit at this g; "
            "dashed: all of them.</p>\n";
        if (table_.grid().g.size() < 2)
            text += fmt::format(
                "<p>The dictionary has one g, {:g}; with more of them (--g shared, or a dictionary of the "
                "paper's grid) there is a map for each, and what g is worth.</p>\n",
                table_.grid().g.front());
        else
            text += worth_of_g();
        for (std::size_t r = 0; r < fit_.resins.size(); ++r)
            text += fmt::format("<h3>{}</h3>\n", html_text(fit_.resins[r].role)) + similarity_curves(fit_.resins[r]) +
                    similarity_maps(similarity_, fit_, r);
        return section("Similar media", text);
    }

    std::string setup() const {
        return section("Setup", fmt::format("<pre>{}</pre>\n", html_text(edge_setup_text(table_.setup()))));
    }

    const EdgeFit& fit_;
    const std::vector<EdgeProfile>& profiles_;
    const EdgeProfileTable& table_;
    const EdgeFitOptions& options_;
    const EdgeSimilarity& similarity_;
};

}  // namespace

std::string edge_report_html(const EdgeFit& fit, const std::vector<EdgeProfile>& profiles,
                             const EdgeProfileTable& table, const EdgeFitOptions& options,
                             const EdgeSimilarity& similarity) {
    return EdgePage(fit, profiles, table, options, similarity).html();
}

}  // namespace voxtone::calibration
