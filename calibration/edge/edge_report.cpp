// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "calibration/edge/edge_fit_text.h"
#include "calibration/edge/edge_plots.h"
#include "io/programs/build_identity.h"
#include "io/report/plot_svg.h"
#include "io/report/report_html.h"

namespace voxtone::calibration {
namespace {

using io::Plot;
using io::ReportSection;

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

    io::Report report() const {
        io::Report report;
        report.title = "Edge profiles: " + fit_.set.name;
        report.program_version = io::program_version();
        report.warnings = fit_.warnings;
        report.sections = {values(), pictures(), mu(), resins(), similar_media(), setup()};
        return report;
    }

private:
    // A section of this title that begins with these words.
    static ReportSection section(const std::string& title, std::vector<std::string> paragraphs) {
        ReportSection section;
        section.title = title;
        section.paragraphs = std::move(paragraphs);
        return section;
    }

    static std::string published(const std::string& role, std::size_t c) {
        for (const PublishedError& entry : published_errors)
            if (role == entry.role) return entry.error[c] > 0 ? fmt::format("{:.3f}", entry.error[c]) : "none";
        return "";
    }

    ReportSection values() const {
        ReportSection text = section(
            "Values",
            {fit_.set.source + ".",
             fmt::format(
                 "At g = {:.3g}, with standard errors. Beside the distances stand the fit errors that the paper "
                 "gives for Vero Opaque (Elek et al. 2017, supplement, Table 1), whose norm it does not say; "
                 "ours is the root mean square over samples of values, and {:g} times that of gradients, "
                 "summed over the slabs.",
                 fit_.set.g, options_.metric.lambda)});
        text.listing = edge_fit_text(fit_);
        io::ReportTable table{"", {"Resin", "Distance (Eq. 1): R", "G", "B", "The paper's: R", "G", "B"}, {}};
        for (const EdgeResinFit& resin : fit_.resins) {
            std::vector<std::string>& row = table.rows.emplace_back(std::vector{resin.role});
            for (const EdgeValue& v : resin.channel) row.push_back(fmt::format("{:.4f}", v.distance));
            for (std::size_t c = 0; c < 3; ++c) row.push_back(published(resin.role, c));
        }
        text.tables.push_back(table);
        return text;
    }

    ReportSection pictures() const {
        ReportSection slabs =
            section("Slabs", {"What the camera saw of each slab on the edge (times mu), and under it the simulation of "
                              "its fit, in sRGB."});
        for (const EdgeResinFit& resin : fit_.resins) plots(resin).add_strips(slabs);
        return slabs;
    }

    ReportSection mu() const {
        if (fit_.mu_curve.empty()) return section("Bias", {fmt::format("mu = {:.4f} was given.", fit_.mu)});
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
        ReportSection bias = section(
            "Bias",
            {fmt::format("mu = {:.4f} +- {:.4f}: measured values are multiplied by it.", fit_.mu, fit_.mu_error)});
        bias.drawings.push_back({"", plot.svg()});
        return bias;
    }

    EdgePlots plots(const EdgeResinFit& resin) const { return {fit_, resin, profiles_, table_, options_}; }

    ReportSection resins() const {
        ReportSection profiles = section(
            "Profiles",
            {"Measured (dots, times mu) and fitted (lines) profiles across the edge, the slabs of a resin in one plot; "
             "then the gradients per sample that the fit compares; then the fit (black) among its neighbours in the "
             "paper's grid: the next extinctions (orange), albedos (violet) and, where the dictionary has them, "
             "anisotropies (green), with their distances from what was measured. Where neighbours fall together, the "
             "slabs do not tell the value."});
        for (const EdgeResinFit& resin : fit_.resins) {
            if (resin.g_error > 0)
                profiles.paragraphs.push_back(
                    fmt::format("{}: g = {:.3f} +- {:.3f}", resin.role, resin.g, resin.g_error));
            plots(resin).add_profiles(profiles);
        }
        return profiles;
    }

    // What g is worth, in words.
    std::string worth_of_g() const {
        std::vector<std::pair<double, double>> total = fit_.resins.front().by_g;
        for (std::size_t r = 1; r < fit_.resins.size(); ++r)
            for (std::size_t k = 0; k < total.size(); ++k) total[k].second += fit_.resins[r].by_g[k].second;
        const auto best = std::ranges::min_element(total, {}, &std::pair<double, double>::second);
        std::string text =
            fmt::format("All resins together: the distance is least at g = {:g}, {:.4f};", best->first, best->second);
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
                "the media that are similar to the fit (rms): that much is lost where a set is brought to another g",
                100 * std::sqrt(ln / count), std::sqrt(v / count));
        return text + ".";
    }

    ReportSection similar_media() const {
        ReportSection media = section(
            "Similar media",
            {"The distance (Eq. 1) over albedo and extinction for each g, its logarithm from the least of all g (dark) "
             "to 200 times that; the title has that of its g. Cross: where it is least, bright at the g of the fit; "
             "white dot: the medium that similarity (Eqs. 4 to 6) makes of the fit at this g; dashed: all of them.",
             table_.grid().g.size() < 2
                 ? fmt::format("The dictionary has one g, {:g}; with more of them (--g shared, or a dictionary of the "
                               "paper's grid) there is a map for each, and what g is worth.",
                               table_.grid().g.front())
                 : worth_of_g()});
        for (std::size_t r = 0; r < fit_.resins.size(); ++r) {
            add_similarity_curves(fit_.resins[r], media);
            add_similarity_maps(similarity_, fit_, r, media);
        }
        return media;
    }

    ReportSection setup() const {
        ReportSection setup = section("Setup", {});
        setup.listing = edge_setup_text(table_.setup());
        return setup;
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
    return io::report_html(EdgePage(fit, profiles, table, options, similarity).report());
}

}  // namespace voxtone::calibration
