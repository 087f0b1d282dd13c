// SPDX-License-Identifier: GPL-3.0-or-later
#include "drawing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace voxtone::optics::profile_laminates {
namespace {

constexpr double width = 250, height = 190, left = 36, top = 24, right = 8, bottom = 24;
constexpr double lowest = -5, highest = 1;  // powers of ten

std::string path(const Curve& curve, double r_max_mm, const char* style) {
    std::string d;
    bool drawing = false;
    for (std::size_t i = 0; i < curve.r_mm.size(); ++i) {
        const double power = curve.light[i] > 0 ? std::log10(curve.light[i]) : lowest - 1;
        if (curve.r_mm[i] > r_max_mm || power < lowest) {
            drawing = false;
            continue;
        }
        const double x = left + curve.r_mm[i] / r_max_mm * (width - left - right);
        const double y = top + (highest - std::min(power, highest)) / (highest - lowest) * (height - top - bottom);
        d += fmt::format("{}{:.1f} {:.1f} ", drawing ? "L" : "M", x, y);
        drawing = true;
    }
    return fmt::format("<path d=\"{}\" fill=\"none\" {}/>\n", d, style);
}

}  // namespace

std::string draw_panels(const std::vector<Panel>& panels, int columns, double r_max_mm) {
    const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" font-family=\"sans-serif\" "
        "font-size=\"9\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        width * columns, height * rows);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
        svg += fmt::format("<g transform=\"translate({},{})\">\n<text x=\"{}\" y=\"16\" font-size=\"{}\">{}</text>\n",
                           column * width, row * height, left, panels[i].title.size() > 44 ? 7 : 9, panels[i].title);
        for (int power = static_cast<int>(lowest); power <= static_cast<int>(highest); ++power) {
            const double y = top + (highest - power) / (highest - lowest) * (height - top - bottom);
            svg += fmt::format(
                "<path d=\"M{} {} H{}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{}\" text-anchor=\"end\">1e{}</text>\n",
                left, y, width - right, left - 3, y + 3, power);
        }
        for (double r = 0; r <= r_max_mm; r += 1)
            svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{:.0f}</text>\n",
                               left + r / r_max_mm * (width - left - right), height - bottom + 12, r);
        svg += path(panels[i].traced, r_max_mm, "stroke=\"black\" stroke-width=\"1.6\"");
        svg += path(panels[i].predicted, r_max_mm, "stroke=\"#d22\" stroke-width=\"1.2\" stroke-dasharray=\"4 2\"");
        svg += "</g>\n";
    }
    return svg + "</svg>\n";
}

}  // namespace voxtone::optics::profile_laminates
