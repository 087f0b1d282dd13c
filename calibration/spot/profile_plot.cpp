// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/profile_plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/report/plot_svg.h"

namespace voxtone::calibration {
namespace {

constexpr double box_width = 400, box_height = 300, plot_width = 468, plot_height = 364;
constexpr int most_decades = 8;
constexpr double band_errors = 2;

std::string colour(const optics::Channels& channels, std::size_t c) {
    constexpr const char* rgb[] = {"#c62828", "#2e7d32", "#1565c0"};
    if (channels.is_rgb()) return rgb[c];
    const double turn = channels.size() > 1 ? static_cast<double>(c) / static_cast<double>(channels.size() - 1) : 0;
    return fmt::format("hsl({:.0f},70%,40%)", 270 * (1 - turn));
}

// 1, 2 or 5 times a power of ten, four to ten of them up to `to`.
std::vector<double> even_marks(double to) {
    double step = std::pow(10, std::floor(std::log10(to / 4)));
    if (to / step > 10) step *= to / step > 20 ? 5 : 2;
    std::vector<double> marks;
    for (int i = 0; i * step <= to * (1 + 1e-9); ++i) marks.push_back(i * step);
    return marks;
}

std::string one_side(const io::ProfileFile& file, optics::RadialSamples optics::MeasuredProfile::*side,
                     const std::string& name) {
    double highest = 0, lowest = 1e300, reach = 0;
    for (const auto& channel : file.by_channel) {
        const optics::RadialSamples& samples = channel.*side;
        reach = samples.spacing_mm * static_cast<double>(samples.light.size() - 1);
        for (std::size_t i = 0; i < samples.light.size(); ++i) {
            const double f = samples.light[i], noise = samples.error.empty() ? 0 : band_errors * samples.error[i];
            highest = std::max(highest, f);
            if (f > noise) lowest = std::min(lowest, f);
        }
    }
    if (highest <= 0) highest = lowest = 1;
    const int top = static_cast<int>(std::ceil(std::log10(highest))),
              bottom = std::clamp(static_cast<int>(std::floor(std::log10(lowest))), top - most_decades, top - 1);
    io::PlotAxis x{0, reach, false, even_marks(reach), "distance, mm"},
        y{std::pow(10, bottom), std::pow(10, top), true, {}, ""};
    y.title = file.by_channel[0].R.total || file.is_target() ? "light per mm2 of one unit" : "light per mm2";
    for (int decade = bottom; decade <= top; ++decade) y.marks.push_back(std::pow(10, decade));
    io::Plot plot(x, y, fmt::format("{}: {}", file.name, name), box_width, box_height);
    for (std::size_t c = 0; c < file.by_channel.size(); ++c) {
        const optics::RadialSamples& samples = file.by_channel[c].*side;
        io::Plot::Points line, low, high;
        for (std::size_t i = 0; i < samples.light.size(); ++i) {
            const double r = static_cast<double>(i) * samples.spacing_mm, f = samples.light[i];
            line.emplace_back(r, f);
            if (samples.error.empty()) continue;
            low.emplace_back(r, f - band_errors * samples.error[i]);
            high.emplace_back(r, f + band_errors * samples.error[i]);
        }
        if (!low.empty()) plot.band(low, high, colour(file.channels, c));
        plot.line(line, colour(file.channels, c), 1.2);
    }
    return plot.svg();
}

}  // namespace

std::string profile_plot(const io::ProfileFile& profile) {
    const int plots = profile.is_target() ? 1 : 2;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\" "
        "font-family=\"sans-serif\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"white\"/>\n",
        plots * plot_width, plot_height);
    svg += one_side(profile, &optics::MeasuredProfile::R, "reflected");
    if (plots == 2)
        svg += fmt::format("<g transform=\"translate({:.0f},0)\">\n{}</g>\n", plot_width,
                           one_side(profile, &optics::MeasuredProfile::T, "transmitted"));
    return svg + "</svg>\n";
}

}  // namespace voxtone::calibration
