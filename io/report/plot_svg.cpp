// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/plot_svg.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/files/base64.h"
#include "io/files/markup.h"

namespace voxtone::io {

namespace {

constexpr double left = 54, right = 14, top = 24, bottom = 40;

double place(const PlotAxis& axis, double value) {
    if (!axis.logarithmic) return (value - axis.from) / (axis.to - axis.from);
    return std::log(std::max(value, 1e-12) / axis.from) / std::log(axis.to / axis.from);
}

}  // namespace

Plot::Plot(PlotAxis x, PlotAxis y, std::string title, double width, double height)
    : x_(std::move(x)), y_(std::move(y)), title_(std::move(title)), width_(width), height_(height) {}

// Kept near the box, so that no number is absurd; the box cuts the rest off.
double Plot::across(double x) const { return width_ * std::clamp(place(x_, x), -2.0, 3.0); }
double Plot::up(double y) const { return height_ * (1 - std::clamp(place(y_, y), -2.0, 3.0)); }

std::string Plot::path(const Points& points) const {
    std::string text;
    for (const auto& [x, y] : points) text += fmt::format("{:.1f},{:.1f} ", across(x), up(y));
    return text;
}

void Plot::line(const Points& points, std::string_view colour, double width, bool dashed) {
    body_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", path(points),
                         colour, width, dashed ? " stroke-dasharray=\"4 3\"" : "");
}

void Plot::band(const Points& low, const Points& high, std::string_view colour) {
    Points around = low;
    around.insert(around.end(), high.rbegin(), high.rend());
    body_ += fmt::format("<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"0.2\"/>\n", path(around), colour);
}

void Plot::point(double x, double y, std::string_view colour, double low, double high) {
    body_ += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\"/>\n",
                         across(x), up(low), up(high), colour);
    point(x, y, colour);
}

void Plot::point(double x, double y, std::string_view colour) {
    body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", across(x), up(y), colour);
}

void Plot::picture(std::span<const std::uint8_t> png) {
    body_ += fmt::format(
        "<image width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" "
        "href=\"data:image/png;base64,{}\"/>\n",
        width_, height_, base64(png));
}

void Plot::label(double x, double y, std::string_view text, std::string_view colour) {
    body_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n", across(x) + 5, up(y) - 4, colour,
                         html_text(text));
}

std::string Plot::svg() const {
    const double all_width = left + width_ + right, all_height = top + height_ + bottom;
    std::string text = fmt::format(
        "<svg width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" font-size=\"10\">\n"
        "<text x=\"{2:.0f}\" y=\"15\" font-size=\"12\">{3}</text>\n<g transform=\"translate({2:.0f},{4:.0f})\">\n",
        all_width, all_height, left, html_text(title_), top);
    for (const double mark : x_.marks) {
        const double x = across(mark);
        text += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.1f}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" "
            "y=\"{2:.1f}\" text-anchor=\"middle\">{3:g}</text>\n",
            x, height_, height_ + 13, mark);
    }
    for (const double mark : y_.marks) {
        const double y = up(mark);
        text += fmt::format(
            "<line x1=\"0\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{1:.1f}\" stroke=\"#ddd\"/><text x=\"-5\" y=\"{2:.1f}\" "
            "text-anchor=\"end\">{3:g}</text>\n",
            width_, y, y + 3, mark);
    }
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", width_ / 2, height_ + 29,
                        html_text(x_.title));
    text += fmt::format("<text transform=\"translate(-42,{:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                        height_ / 2, html_text(y_.title));
    text +=
        fmt::format("<svg width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n{2}</svg>\n", width_, height_, body_);
    return text + fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n</g>\n</svg>\n",
                              width_, height_);
}

}  // namespace voxtone::io
