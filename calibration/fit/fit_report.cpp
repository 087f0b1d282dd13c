// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/fit_report.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "calibration/fit/fit_text.h"
#include "calibration/fit/patch_page.h"
#include "calibration/patches/patch_file.h"
#include "calibration/resins/resin_coordinates.h"
#include "io/report/plot_svg.h"
#include "io/report/report_html.h"
#include "optics/layered/layer_on_base.h"

namespace voxtone::calibration {

namespace {

using io::Plot;
using io::PlotAxis;
using optics::Medium;

// The colour in which a channel or a resin is drawn.
std::string channel_colour(const PatchTable& table, std::size_t channel) {
    if (table.channels.is_rgb()) return channel == 0 ? "#c62828" : channel == 1 ? "#2e7d32" : "#1565c0";
    // A printer's own channels have no hue of their own: they are told apart by turns around the circle.
    if (table.channels.is_own()) return fmt::format("hsl({:.0f},45%,45%)", std::fmod(137.5 * double(channel), 360));
    const double nm = table.channels.wavelengths_nm[channel];
    return fmt::format("hsl({:.0f},70%,40%)", std::clamp(270 - (nm - 420) * 270 / 240, 0.0, 280.0));
}

// All three colours, or three wavelengths that stand for the rest.
std::vector<std::size_t> shown_channels(const PatchTable& table) {
    const std::size_t n = table.channels.size();
    std::set<std::size_t> chosen{n / 6, n / 2, n - 1 - n / 6};
    return {chosen.begin(), chosen.end()};
}

class Page {
public:
    Page(const ResinFit& fit, const PatchTable& table, const FitOptions& options)
        : fit_(fit), table_(table), plan_(patch_plan(options.model)), light_(0), dark_(0) {
        // The set begins with the bases, the lightest first.
        for (std::size_t r = 0; r < fit.resins.size(); ++r)
            if (std::ranges::any_of(table.patches, [&](const Patch& p) { return p.backing == fit.resins[r].role; }))
                dark_ = r;
    }

    io::Report report(const PatchMap& map, double noise) const {
        io::Report report = patch_report(table_, fit_.patches, fit_.set, map, noise);
        report.title = fmt::format("Calibration {}", fit_.set.name);
        report.sections[0].paragraphs.push_back(fmt::format("{}. g = {}, eta = {}. {}", fit_.set.source, fit_.set.g,
                                                            fit_.set.eta, dot_spread_sentence(fit_)));
        report.warnings = fit_.warnings;
        report.sections.push_back(resins());
        if (!std::ranges::any_of(table_.patches, [](const Patch& p) { return p.on != nullptr; }))
            report.sections.push_back(principles());
        report.sections.push_back(values());
        return report;
    }

private:
    Medium medium(std::size_t resin, std::size_t channel) const { return fit_.set.resins[resin].medium(channel); }

    // Values over the channels, with errors.
    io::ReportSection resins() const {
        io::ReportSection section;
        section.title = "Resins";
        const bool points = !table_.channels.is_spectral();
        PlotAxis x{
            -0.5, double(table_.channels.size()) - 0.5, false, {}, table_.channels.is_rgb() ? "R, G, B" : "channel"};
        if (!points) {
            const auto& nm = table_.channels.wavelengths_nm;
            x = {nm.front() - 5, nm.back() + 5, false, {}, "wavelength, nm"};
            for (double mark = 50 * std::ceil(nm.front() / 50); mark <= nm.back(); mark += 50) x.marks.push_back(mark);
        }
        const auto at = [&](std::size_t c) {
            return points ? static_cast<double>(c) : table_.channels.wavelengths_nm[c];
        };
        for (const FittedResin& resin : fit_.resins) {
            double least = 1e9, most = 0;
            for (const FittedValue& s : resin.sigma_t)
                least = std::min(least, std::max(s.low, 0.01)), most = std::max(most, s.high);
            Plot sigma(x,
                       {std::min(least / 1.3, 1.0),
                        std::max(most * 1.3, 10.0),
                        true,
                        {0.01, 0.1, 1, 10, 100},
                        "extinction, 1/mm"},
                       fmt::format("{}: extinction", resin.role), 235, 170);
            // Albedo in v, upside down: white on top.
            const double g = fit_.set.g;
            Plot albedo(x, {1, 0, false, {}, "albedo (even in v)"}, fmt::format("{}: albedo", resin.role), 235, 170);
            for (const double mark : {0.0, 0.3, 0.6, 0.9, 0.99, 0.999, 0.9999}) {
                albedo.line({{x.from, v_of_albedo(mark, g)}, {x.to, v_of_albedo(mark, g)}}, "#ddd", 1);
                albedo.label(x.from, v_of_albedo(mark, g), fmt::format("{:g}", mark), "#777");
            }
            draw(sigma, resin.sigma_t, at, points, [](double value) { return value; });
            draw(albedo, resin.albedo, at, points, [&](double value) { return v_of_albedo(value, g); });
            section.drawings.push_back({"", sigma.svg()});
            section.drawings.push_back({"", albedo.svg()});
        }
        return section;
    }

    template <class At, class Map>
    void draw(Plot& plot, const std::vector<FittedValue>& values, At&& at, bool points, Map&& map) const {
        Plot::Points low, high, middle;
        for (std::size_t c = 0; c < values.size(); ++c) {
            low.emplace_back(at(c), map(values[c].low));
            high.emplace_back(at(c), map(values[c].high));
            middle.emplace_back(at(c), map(values[c].value));
        }
        if (!points) {
            plot.band(low, high, "#1565c0");
            plot.line(middle, "#1565c0");
        }
        for (std::size_t c = 0; c < values.size(); ++c) {
            const bool doubted = !values[c].doubts.empty();
            if (points)
                plot.point(middle[c].first, middle[c].second, doubted ? "#d9730d" : channel_colour(table_, c),
                           low[c].second, high[c].second);
            else if (doubted)
                plot.point(middle[c].first, middle[c].second, "#d9730d");
        }
    }

    // Mean of what was measured of a resin's pure squares upon a base; negative where there is none.
    double measured(const std::string& top, const std::string& backing, std::size_t channel,
                    double* thickness_mm = nullptr) const {
        for (const Patch& patch : table_.patches) {
            if (patch.top.size() != 1 || patch.top[0].role != top || patch.backing != backing) continue;
            if (thickness_mm) *thickness_mm = patch.thickness_mm;
            return patch.rho[channel];
        }
        return -1;
    }

    io::ReportSection principles() const {
        const double g = fit_.set.g;
        io::ReportSection section;
        section.title = "What the Principles see";
        section.paragraphs.push_back(
            "1: reflectance of a base without end against its albedo. 2: of each base's square upon the other, against "
            "the square's optical thickness; flat ends tell nothing. 3: every resin's square upon the dark (to the "
            "right) and the light base (up), on a net of albedos (grey) and optical thicknesses (blue); where the net "
            "is narrow, noise decides.");
        const std::vector<double> tenths{0, 0.2, 0.4, 0.6, 0.8, 1};
        const auto rho = [&](double albedo, double tau, const optics::OrdinateBase& base) {
            return optics::OrdinateLayer(*plan_, {tau * (1 - albedo), tau * albedo}, 1, false).upon(base).rho;
        };
        const auto half_space = [&](const Medium& m) { return optics::OrdinateBase(*plan_, m, false); };

        Plot first({1, 0, false, {}, "albedo (even in v): 0 left, 1 right"}, {0, 1, false, tenths, "reflectance"},
                   "Principle 1");
        Plot::Points curve;
        for (double v = 0.03; v <= 1.0; v += 0.0097) {
            const Medium m = medium_of({v, 0}, g);
            curve.emplace_back(v, rho(m.albedo(), 1, half_space(m)));
        }
        first.line(curve, "#333");
        for (const std::size_t base : {light_, dark_})
            for (const std::size_t c : shown_channels(table_)) {
                const double seen = measured(fit_.resins[base].role, fit_.resins[base].role, c);
                if (seen >= 0)
                    first.point(v_of_albedo(fit_.resins[base].albedo[c].value, g), seen, channel_colour(table_, c));
            }
        section.drawings.push_back({"", first.svg()});

        for (const auto& [top, below] : {std::pair{light_, dark_}, std::pair{dark_, light_}}) {
            Plot second({0.05, 50, true, {0.1, 1, 10}, "optical thickness of the square"},
                        {0, 1, false, tenths, "reflectance"},
                        fmt::format("Principle 2: {} on {}", fit_.resins[top].role, fit_.resins[below].role));
            for (const std::size_t c : shown_channels(table_)) {
                const optics::OrdinateBase base = half_space(medium(below, c));
                Plot::Points points;
                for (double tau = 0.05; tau < 52; tau *= 1.15)
                    points.emplace_back(tau, rho(fit_.resins[top].albedo[c].value, tau, base));
                second.line(points, channel_colour(table_, c));
                double mm = 0;
                const double seen = measured(fit_.resins[top].role, fit_.resins[below].role, c, &mm);
                if (seen >= 0) second.point(fit_.resins[top].sigma_t[c].value * mm, seen, channel_colour(table_, c));
            }
            section.drawings.push_back({"", second.svg()});
        }

        for (const std::size_t c : shown_channels(table_)) {
            const double most_dark = 1.05 * rho(0.9999, 50, half_space(medium(dark_, c)));
            Plot third({0, most_dark, false, tenths, fmt::format("reflectance on {}", fit_.resins[dark_].role)},
                       {0, 1, false, tenths, fmt::format("reflectance on {}", fit_.resins[light_].role)},
                       fmt::format("Principle 3: {}", channel_name(table_.channels, c)));
            const optics::OrdinateBase dark = half_space(medium(dark_, c)), light = half_space(medium(light_, c));
            const std::vector<double> taus{0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8, 25.6};
            const auto net = [&](double albedo, double tau) {
                return std::pair{rho(albedo, tau, dark), rho(albedo, tau, light)};
            };
            for (const double albedo : {0.0, 0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.997, 0.999, 0.9997}) {
                Plot::Points points;
                for (double tau = 0.02; tau < 60; tau *= 1.4) points.push_back(net(albedo, tau));
                third.line(points, "#bbb", 1);
            }
            for (const double tau : taus) {
                Plot::Points points;
                for (double v = 1; v > 0.05; v -= 0.03) points.push_back(net(albedo_of_v(v, g), tau));
                third.line(points, "#90b4d8", 1);
            }
            for (std::size_t r = 0; r < fit_.resins.size(); ++r) {
                const std::string& role = fit_.resins[r].role;
                const double on_dark = measured(role, fit_.resins[dark_].role, c),
                             on_light = measured(role, fit_.resins[light_].role, c);
                if (on_dark < 0 || on_light < 0) continue;
                third.point(on_dark, on_light, channel_colour(table_, c));
                third.label(on_dark, on_light, role, "#222");
            }
            section.drawings.push_back({"", third.svg()});
        }
        return section;
    }

    io::ReportSection values() const {
        io::ReportSection section;
        section.title = "Values";
        section.listing = fit_text(fit_, table_);
        return section;
    }

    const ResinFit& fit_;
    const PatchTable& table_;
    std::shared_ptr<const optics::OrdinatePlan> plan_;
    std::size_t light_, dark_;
};

}  // namespace

std::string fit_report_html(const ResinFit& fit, const PatchTable& table, const FitOptions& options,
                            const PatchMap& map) {
    return io::report_html(Page(fit, table, options).report(map, options.noise));
}

}  // namespace voxtone::calibration
