// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small line plots as SVG text: one box, two axes (linear or logarithmic), lines, bands, points with error bars,
// labels, and maps of pixels under them.
//
// Why our own: matplot++ is no Debian package, gnuplot-iostream wants gnuplot where the program runs, and a report
// needs one box with lines in it, as text that stays sharp and weighs a few kB.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace voxtone::io {

struct PlotAxis {
    double from = 0, to = 1;
    bool logarithmic = false;
    std::vector<double> marks;  ///< where lines and numbers stand
    std::string title;          ///< plain text
};

class Plot {
public:
    using Points = std::vector<std::pair<double, double>>;

    /// Size of the box, px; axes and titles lie around it.
    Plot(PlotAxis x, PlotAxis y, std::string title, double width = 300, double height = 220);

    /// What leaves the box is cut off. `colour`: any of CSS.
    void line(const Points& points, std::string_view colour, double width = 1.5, bool dashed = false);
    void band(const Points& low, const Points& high, std::string_view colour);
    void point(double x, double y, std::string_view colour, double low, double high);
    void point(double x, double y, std::string_view colour);
    /// A PNG file that fills the box, each of its pixels a rectangle.
    void picture(std::span<const std::uint8_t> png);
    void label(double x, double y, std::string_view text, std::string_view colour);

    [[nodiscard]] std::string svg() const;

private:
    [[nodiscard]] double across(double x) const;
    [[nodiscard]] double up(double y) const;
    [[nodiscard]] std::string path(const Points& points) const;
    PlotAxis x_, y_;
    std::string title_, body_;
    double width_, height_;
};

}  // namespace voxtone::io
