// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/profile_plots.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/report/plot_svg.h"

namespace voxtone::scattering {
namespace {

constexpr double width = 260, height = 200, step_x = width + 68 + 8, step_y = height + 64 + 8;
constexpr double faintest = 1e-5, brightest = 10;
constexpr int plot_points = 160;

std::vector<double> marks_up_to(double most) {
    const double step = most > 6 ? 2 : most > 3 ? 1 : 0.5;
    std::vector<double> marks;
    for (double mark = 0; mark <= most * (1 + 1e-9); mark += step) marks.push_back(mark);
    return marks;
}

// In parts where it is bright enough to be drawn: ripples below zero have no logarithm.
void draw(io::Plot& plot, const optics::HankelGrid& grid, const ProfileCurve& curve, std::size_t channel,
          double most_mm) {
    const std::vector<double> soft =
        grid.blurred(curve.coefficients[channel], 1.5 * grid.reach_mm() / static_cast<double>(grid.size()));
    io::Plot::Points part;
    const auto finish = [&] {
        if (part.size() > 1) plot.line(part, curve.colour, 1.5, curve.dashed);
        part.clear();
    };
    for (int i = 0; i <= plot_points; ++i) {
        const double r = most_mm * i / plot_points, light = grid.profile(soft, r);
        if (light > faintest)
            part.emplace_back(r, light);
        else
            finish();
    }
    finish();
}

}  // namespace

std::string profile_plots(const optics::HankelGrid& grid, const std::vector<std::string>& channels,
                          const std::vector<ProfileRow>& rows, double most_mm) {
    most_mm = std::min(most_mm, grid.reach_mm());
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\" "
        "font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        step_x * static_cast<double>(channels.size()), step_y * static_cast<double>(rows.size()));
    for (std::size_t row = 0; row < rows.size(); ++row)
        for (std::size_t c = 0; c < channels.size(); ++c) {
            io::Plot plot({0, most_mm, false, marks_up_to(most_mm), "distance, mm"},
                          {faintest, brightest, true, {1e-4, 1e-3, 1e-2, 0.1, 1}, "light per mm2"},
                          rows[row].title.empty() ? channels[c] : fmt::format("{}, {}", rows[row].title, channels[c]),
                          width, height);
            double legend = 4;
            for (const ProfileCurve& curve : rows[row].curves) {
                draw(plot, grid, curve, c, most_mm);
                plot.label(0.55 * most_mm, legend, curve.name, curve.colour);
                legend /= 2.6;
            }
            svg += fmt::format("<svg x=\"{:.0f}\" y=\"{:.0f}\">{}</svg>\n", step_x * static_cast<double>(c),
                               step_y * static_cast<double>(row), plot.svg());
        }
    return svg + "</svg>\n";
}

}  // namespace voxtone::scattering
