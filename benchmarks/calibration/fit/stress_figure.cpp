// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fig. 9 of Iser, Rittig, Wilkie 2025 for our fit, as an SVG: true extinction to the right, bands from the 16th to the
// 84th percentile, a line at the median; above each test's extinctions, below its albedos.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibration/resins/resin_coordinates.h"
#include "stress_cases.h"

namespace voxtone::calibration::stress {

namespace {

constexpr double width = 300, height = 190, left = 62, top = 40, gap_x = 24, gap_y = 46;
const char* const ink[] = {"#333333", "#1f77b4", "#2ca02c", "#d9730d"};

double across(double sigma_t) { return width * std::log(sigma_t / 0.1) / std::log(300.0); }
// Estimate / truth, 0.1 to 10, one decade each way.
double up_ratio(double ratio) { return height * (0.5 - 0.5 * std::log10(std::min(std::max(ratio, 0.1), 10.0))); }
double up_v(double v) { return height * v; }

std::string band(const std::vector<Row>& rows, const char* colour, double Row::*low, double Row::*middle,
                 double Row::*high, double (*up)(double)) {
    std::string outline, line;
    for (const Row& row : rows) outline += fmt::format("{:.1f},{:.1f} ", across(row.sigma_t), up(row.*low));
    for (auto row = rows.rbegin(); row != rows.rend(); ++row)
        outline += fmt::format("{:.1f},{:.1f} ", across(row->sigma_t), up((*row).*high));
    for (const Row& row : rows) line += fmt::format("{:.1f},{:.1f} ", across(row.sigma_t), up(row.*middle));
    return fmt::format(
        "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"0.22\"/><polyline points=\"{}\" fill=\"none\" stroke=\"{}\" "
        "stroke-width=\"1.6\"/>\n",
        outline, colour, line, colour);
}

std::string text(double x, double y, const std::string& what, const char* anchor = "middle", int size = 11) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\">{}</text>\n", x, y, anchor,
                       size, what);
}

std::string rule(double x1, double y1, double x2, double y2, const char* style) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2, style);
}

const char* const faint = "stroke=\"#dddddd\"";

std::string panel(const Case& of, bool albedo, bool first, bool last) {
    std::string out;
    for (const double s : {0.1, 0.3, 1.0, 3.0, 10.0, 30.0}) {
        out += rule(across(s), 0, across(s), height, faint);
        if (last) out += text(across(s), height + 14, fmt::format("{:g}", s));
    }
    const auto mark = [&](double y, const std::string& label) {
        out += rule(0, y, width, y, faint);
        if (first) out += text(-5, y + 4, label, "end");
    };
    if (albedo) {
        for (const double a : {0.0, 0.5, 0.9, 0.99, 0.999, 0.9999})
            mark(up_v(v_of_albedo(a, 0.4)), fmt::format("{:g}", a));
        for (std::size_t a = 0; a < of.colours.size(); ++a) {
            const double y = up_v(of.colours[a].front().v_true);
            out += rule(0, y, width, y, fmt::format("stroke=\"{}\" stroke-dasharray=\"4 3\"", ink[a]).c_str());
            out += band(of.colours[a], ink[a], &Row::v_low, &Row::v_middle, &Row::v_high, up_v);
        }
    } else {
        for (const double r : {0.1, 0.3, 1.0, 3.0, 10.0}) mark(up_ratio(r), fmt::format("{:g}", r));
        out += rule(0, up_ratio(1), width, up_ratio(1), "stroke=\"#666666\" stroke-dasharray=\"4 3\"");
        for (std::size_t a = 0; a < of.colours.size(); ++a)
            out += band(of.colours[a], ink[a], &Row::ratio_low, &Row::ratio_middle, &Row::ratio_high, up_ratio);
    }
    out += fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888888\"/>\n", width, height);
    return out;
}

}  // namespace

std::string figure_svg(const std::vector<Case>& cases) {
    std::string targets;
    std::vector<int> tests;
    for (const Case& c : cases) {
        if (targets.find(c.target) == std::string::npos) targets += c.target;
        if (std::find(tests.begin(), tests.end(), c.test) == tests.end()) tests.push_back(c.test);
    }
    const double all_width = left + static_cast<double>(targets.size()) * (width + gap_x),
                 all_height = top + static_cast<double>(2 * tests.size()) * (height + gap_y);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\" "
        "font-family=\"sans-serif\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        all_width, all_height);
    double x = left;
    svg += text(x, 16, "albedo of the resin:", "start", 12);
    x += 120;
    for (std::size_t a = 0; a < 4; ++a, x += 70) {
        svg += rule(x, 12, x + 18, 12, fmt::format("stroke=\"{}\" stroke-width=\"3\"", ink[a]).c_str());
        svg += text(x + 23, 16, fmt::format("{:g}", cases.front().colours[a].front().albedo), "start", 12);
    }
    svg +=
        text(all_width - gap_x, 16, "true extinction per mm to the right; bands: 16th to 84th percentile", "end", 12);
    for (const Case& c : cases) {
        const double column = left + static_cast<double>(targets.find(c.target)) * (width + gap_x);
        const auto row = static_cast<double>(std::find(tests.begin(), tests.end(), c.test) - tests.begin());
        for (int quantity = 0; quantity < 2; ++quantity) {
            const double y = top + (2 * row + quantity) * (height + gap_y);
            svg += fmt::format("<g transform=\"translate({:.1f},{:.1f})\">\n", column, y);
            svg += text(width / 2, -6,
                        fmt::format("test {}, target {}: {}", c.test, c.target,
                                    quantity == 0 ? "extinction, estimate / truth" : "albedo"),
                        "middle", 12);
            svg += panel(c, quantity == 1, c.target == targets.front(), true) + "</g>\n";
        }
    }
    return svg + "</svg>\n";
}

}  // namespace voxtone::calibration::stress
