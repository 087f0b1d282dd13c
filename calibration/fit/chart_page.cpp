// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/chart_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibration/chart/chart_text.h"
#include "calibration/fit/patch_page.h"
#include "io/programs/build_identity.h"
#include "io/report/plot_svg.h"
#include "io/report/report_html.h"
#include "optics/colour/colour.h"

namespace voxtone::calibration {

namespace {

using io::ReportSection;
using io::ReportTable;

std::string number(double value) { return fmt::format("{:.2f}", value); }

ReportSection unseen_mixtures(const ChartFit& fit) {
    ReportSection section = figures_section(figures_of(fit), "Mixtures that took no part");
    section.paragraphs.push_back(
        fmt::format("What this set is worth: every mixture was foretold by a fit of others. Its mean error is {:.2f} "
                    "CIEDE2000; half of all people see a difference of 0.8 side by side (Paravina et al. 2015).",
                    fit.held_out.mean));
    if (const std::string honesty = honesty_of(fit); !honesty.empty()) section.paragraphs.push_back(honesty);
    if (!fit.solids.empty()) section.tables.push_back(patches_table("Solids, left out", "resin", fit.solids));
    return section;
}

// Errors left out over the number of channels.
std::string curve_plot(const std::vector<ChannelChoice>& curve) {
    double most = 0;
    io::Plot::Points physics, corrected, physics_of_bands, corrected_of_bands;
    std::vector<double> counts;
    for (const ChannelChoice& choice : curve) {
        const int channels = choice.observer.channels;
        if (counts.empty() || counts.back() != channels) counts.push_back(channels);
        const bool bands = choice.observer.of_spectra;
        (bands ? physics_of_bands : physics).emplace_back(channels, choice.physics);
        (bands ? corrected_of_bands : corrected).emplace_back(channels, choice.with_residual);
        most = std::max({most, choice.physics, choice.with_residual});
    }
    const double step = most > 4 ? 2 : most > 2 ? 1 : 0.5, top = step * std::ceil(most / step + 0.2);
    std::vector<double> marks;
    for (double mark = 0; mark <= top + 1e-9; mark += step) marks.push_back(mark);
    io::Plot plot({counts.front() - 0.5, counts.back() + 0.5, false, counts, "channels"},
                  {0, top, false, marks, "mean CIEDE2000, left out"}, "How many channels");
    const auto draw = [&](const io::Plot::Points& line, const char* colour) {
        plot.line(line, colour);
        for (const auto& [x, y] : line) plot.point(x, y, colour);
    };
    draw(physics, "#d9730d");
    draw(corrected, "#1565c0");
    draw(physics_of_bands, "#c0a000");
    draw(corrected_of_bands, "#2e7d32");
    plot.label(physics[0].first + 0.2, physics[0].second, "physics", "#d9730d");
    plot.label(corrected.back().first - 1.6, corrected.back().second + 0.06 * top, "with residual", "#1565c0");
    if (!physics_of_bands.empty()) {
        plot.label(physics_of_bands[0].first + 0.2, physics_of_bands[0].second + 0.08 * top, "physics, bands",
                   "#c0a000");
        plot.label(corrected_of_bands.back().first - 2.2, corrected_of_bands.back().second - 0.1 * top,
                   "with residual, bands", "#2e7d32");
    }
    return plot.svg();
}

// Albedo of each resin over the channels: what the set knows of its hue.
std::string albedo_plot(const optics::ResinSet& set) {
    const auto channels = static_cast<double>(set.channels.size());
    std::vector<double> at;
    for (std::size_t c = 0; c < set.channels.size(); ++c) at.push_back(static_cast<double>(c + 1));
    io::Plot plot({0.5, channels + 0.5, false, at, "channel"}, {0, 1.1, false, {0, 0.25, 0.5, 0.75, 1}, "albedo"},
                  "Resins by channel");
    const std::vector<std::string> usual{"#0097a7", "#c2185b", "#f9a825", "#212121", "#9e9e9e"};
    std::vector<double> labels;
    for (std::size_t r = 0; r < set.resins.size(); ++r) {
        const std::string_view roles = "CMYKW";
        const std::size_t known = set.resins[r].role.size() == 1 ? roles.find(set.resins[r].role[0]) : roles.npos;
        // Others are told apart by turns around the circle.
        const std::string colour =
            known == roles.npos ? fmt::format("hsl({:.0f},60%,40%)", std::fmod(137.5 * double(r), 360)) : usual[known];
        io::Plot::Points line;
        for (std::size_t c = 0; c < at.size(); ++c) line.emplace_back(at[c], set.resins[r].albedo[c]);
        plot.line(line, colour);
        // No label upon another.
        double height = line.back().second;
        while (std::ranges::any_of(labels, [&](double other) { return std::abs(other - height) < 0.065; }))
            height -= 0.02;
        labels.push_back(height);
        plot.label(line.back().first + 0.05, height, set.resins[r].role, colour);
    }
    return plot.svg();
}

ReportSection channels_of(const ChartFit& fit) {
    const optics::ResinSet& set = fit.set;
    ReportSection section;
    section.title = "Channels and resins";
    section.paragraphs.push_back(fmt::format("{} channels{}; {}. g = {}, eta = {}. {}.", set.channels.size(),
                                             fit.observer.of_spectra ? ", bands of the measured spectra" : "",
                                             set.source, set.g, set.eta, instrument_sentence(set)));
    section.paragraphs.push_back(
        set.residual.empty()
            ? std::string("No residual: none was wanted, or it made mixtures that were left out no better.")
            : fmt::format("What physics leaves is corrected by a residual over {} mixtures, {:.2f} CIEDE2000 in the "
                          "mean; it fades away from them.",
                          set.residual.centres().rows(), fit.residual_size));
    section.paragraphs.push_back(fit.dot_spread_text);
    if (!fit.curve.empty()) section.drawings.push_back({"", curve_plot(fit.curve)});
    section.drawings.push_back({"", albedo_plot(set)});
    ReportTable weights{"Share of the eye's white in each channel, %, and white's scattering",
                        {"Channel", "X", "Y", "Z", "per mm"},
                        {}};
    const Eigen::Vector3d white = optics::colorimetric_white(set.channels.illuminant);
    const int resin = set.find("W");
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        std::vector<std::string> row{fmt::format("{}", c + 1)};
        for (std::size_t k = 0; k < 3; ++k)
            row.push_back(fmt::format("{:.1f}", 100 * set.channels.xyz[c][k] / white[static_cast<Eigen::Index>(k)]));
        std::string scatters = resin < 0 ? std::string() : number(set.resins[std::size_t(resin)].medium(c).sigma_s);
        if (c < fit.length_error.size() && resin >= 0)
            scatters +=
                fmt::format(" +- {:.2f}", set.resins[std::size_t(resin)].medium(c).sigma_s * fit.length_error[c]);
        row.push_back(scatters);
        weights.rows.push_back(row);
    }
    section.tables.push_back(weights);
    return section;
}

ReportSection unseen_laminates(const ChartFit& fit) {
    ReportSection section = figures_section(figures_of(fit), "Laminates that took no part");
    section.paragraphs.push_back(fmt::format("{}. Laminates are named by their layers from the top, mm. {}.",
                                             fit.set.source, instrument_sentence(fit.set)));
    section.drawings.push_back({"", albedo_plot(fit.set)});
    return section;
}

}  // namespace

std::string chart_fit_html(const ChartFit& fit, const PatchTable& table, const PatchCheck& check, const PatchMap& map) {
    io::Report report;
    if (fit.of_laminates) {
        report.program_version = io::program_version();
        report.sections = {unseen_laminates(fit)};
    } else {
        report = patch_report(table, check, fit.set, map, 0);
        report.sections.insert(report.sections.begin(), {unseen_mixtures(fit), channels_of(fit)});
    }
    report.title = fmt::format("Fit of {}", fit.set.name);
    report.warnings = fit.warnings;
    report.total_seconds = fit.seconds;
    return io::report_html(report);
}

}  // namespace voxtone::calibration
