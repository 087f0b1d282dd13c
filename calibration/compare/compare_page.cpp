// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/compare_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "io/files/base64.h"
#include "io/files/markup.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/srgb_code.h"
#include "io/pictures/webp.h"

namespace voxtone::calibration {

namespace {

constexpr std::string_view page_style =
    ".compare{position:relative;display:grid}.compare img{grid-area:1/1;width:100%;height:auto;image-rendering:"
    "pixelated}.compare img+img{clip-path:inset(0 0 0 var(--cut,50%))}input[type=range]{width:100%}"
    ".swatch{display:inline-block;width:1.4em;height:1.4em;border-radius:4px;vertical-align:middle;border:1px solid "
    "var(--line)}.legend{display:flex;gap:.3rem 1rem;flex-wrap:wrap;color:var(--soft)}"
    ".pictures>figure{flex-basis:10rem}.pictures "
    "img{width:100%;height:auto;image-rendering:pixelated;border-radius:6px}";

/// From nothing (white) over 2.5 (yellow) and 5 (red) to 10 and more (black), CIEDE2000.
constexpr double most_shown = 10;
Eigen::Vector3f colour_of_difference(double difference) {
    static const std::array<std::pair<double, Eigen::Vector3f>, 4> stops{
        {{0, {1, 1, 1}}, {2.5, {1, 0.85f, 0.1f}}, {5, {0.7f, 0.02f, 0.02f}}, {most_shown, {0.02f, 0, 0.02f}}}};
    for (std::size_t i = 1; i < stops.size(); ++i)
        if (difference <= stops[i].first) {
            const auto t = float((difference - stops[i - 1].first) / (stops[i].first - stops[i - 1].first));
            return (1 - t) * stops[i - 1].second + t * stops[i].second;
        }
    return stops.back().second;
}

std::string picture_data(const PredictedPrint& print, const std::vector<Eigen::Vector3f>& rgb) {
    io::Picture8 picture{std::uint32_t(print.columns), std::uint32_t(print.rows), 3, {}};
    for (const Eigen::Vector3f& linear : rgb)
        for (const float value : linear) picture.codes.push_back(io::linear_to_srgb8(std::clamp(value, 0.0f, 1.0f)));
    return fmt::format("data:image/webp;base64,{}", io::base64(io::webp_bytes(picture)));
}

std::string swatch(const Eigen::Vector3d& linear) {
    const auto code = [](double v) { return int(io::linear_to_srgb8(float(std::clamp(v, 0.0, 1.0)))); };
    return fmt::format("<span class=\"swatch\" style=\"background:rgb({},{},{})\"></span>", code(linear[0]),
                       code(linear[1]), code(linear[2]));
}

void add_pictures(std::string& html, const PredictedPrint& print, const PrintDifference& d) {
    const std::string printed = picture_data(print, d.shown), predicted = picture_data(print, print.rgb);
    std::vector<Eigen::Vector3f> map;
    const Eigen::Vector3f left_out = Eigen::Vector3f::Constant(0.6f);
    for (std::size_t i = 0; i < d.difference.size(); ++i)
        map.push_back(d.counts[i] ? colour_of_difference(double(d.difference[i])) : left_out);
    html += fmt::format(
        "<section><h2>Printed and predicted</h2>\n<div class=\"compare\" id=\"both\"><img alt=\"printed\" src=\"{0}\">"
        "<img alt=\"predicted\" src=\"{1}\"></div>\n<label class=\"soft\">left of the line as photographed "
        "(straightened, exposure and cast taken out), right of it as predicted<input type=\"range\" min=\"0\" "
        "max=\"100\" value=\"50\" id=\"cut\"></label>\n"
        "<div class=\"pictures\"><figure><img alt=\"printed\" src=\"{0}\"><figcaption>photograph</figcaption></figure>"
        "<figure><img alt=\"predicted\" src=\"{1}\"><figcaption>prediction</figcaption></figure>\n"
        "<figure><img alt=\"difference\" src=\"{2}\"><figcaption>difference, as an eye sees it</figcaption></figure>"
        "</div>\n<p class=\"legend\">CIEDE2000: <span>{3} 0</span><span>{4} 2.5, good</span><span>{5} 5</span>"
        "<span>{6} 10 and more</span><span>{7} left out</span></p></section>\n",
        printed, predicted, picture_data(print, map), swatch(colour_of_difference(0).cast<double>()),
        swatch(colour_of_difference(2.5).cast<double>()), swatch(colour_of_difference(5).cast<double>()),
        swatch(colour_of_difference(most_shown).cast<double>()), swatch(left_out.cast<double>()));
}

void add_causes(std::string& html, const PredictedPrint& print, const PrintDifference& d, bool has_checker) {
    html += "<section><h2>What it comes of</h2>\n";
    if (d.causes.empty())
        html += "<p>Neither exposure, a cast, blur nor one resin accounts for much of the difference.</p>\n";
    else {
        html += "<ul>\n";
        for (const std::string& cause : d.causes) html += fmt::format("<li>{}</li>\n", io::html_text(cause));
        html += "</ul>\n";
    }
    html += fmt::format(
        "<table><tr><th>mean CIEDE2000</th><th>is left</th></tr>\n<tr><td>as taken</td><td>{:.2f}</td></tr>\n"
        "<tr><td>after the exposure ({:+.2f} EV)</td><td>{:.2f}</td></tr>\n"
        "<tr><td>after the cast ({:.3f}, {:.3f}, {:.3f}){}</td><td>{:.2f}</td></tr>\n"
        "<tr><td>after the blur ({:.3f} mm in all, {:.3f} mm of the print)</td><td>{:.2f}</td></tr></table>\n",
        d.as_taken, d.exposure_ev, d.after_exposure, d.cast[0], d.cast[1], d.cast[2],
        has_checker ? ", which is left in the comparison" : "", d.after_cast, d.spread_mm, d.print_spread_mm,
        d.after_spread);
    if (d.hints.resins.empty()) {
        html += "</section>\n";
        return;
    }
    html +=
        "<h3>How far each resin may be off</h3>\n<p class=\"soft\">All at once, each in its turn the one that may be "
        "far "
        "off.</p>\n<table><tr><th>resin</th><th>its extinction is off by</th><th>which by itself explains of what is "
        "left</th></tr>\n";
    for (std::size_t r = 0; r < d.hints.resins.size(); ++r) {
        const ResinHint& hint = d.hints.resins[r];
        html += fmt::format("<tr><td>{}</td><td>{:+.0f} &plusmn; {:.0f} %</td><td>{:.0f} %</td></tr>\n",
                            io::html_text(print.resin(r)), 100 * hint.change, 100 * hint.error, 100 * hint.explained);
    }
    html += "</table></section>\n";
}

void add_tiles(std::string& html, const PrintDifference& d) {
    html +=
        "<section><h2>Worst places</h2>\n<table><tr><th>place, mm from the upper left</th><th>predicted, printed</th>"
        "<th>CIEDE2000</th><th></th></tr>\n";
    for (std::size_t i = 0; i < std::min(shown_tiles, d.tiles.size()); ++i) {
        const PrintTile& tile = d.tiles[i];
        html += fmt::format(
            "<tr><td>{:.1f} to {:.1f} right, {:.1f} to {:.1f} down</td><td>{} {}</td><td>{:.1f}</td>"
            "<td>{}</td></tr>\n",
            tile.corner_mm.x(), (tile.corner_mm + tile.size_mm).x(), tile.corner_mm.y(),
            (tile.corner_mm + tile.size_mm).y(), swatch(tile.predicted), swatch(tile.printed), tile.ciede2000,
            tile_words(tile));
    }
    html += "</table></section>\n";
}

void add_readings(std::string& html, const PredictedPrint& print, const std::vector<PrintReading>& readings) {
    html += "<section><h2>Photographs</h2>\n<ul>\n";
    for (const PrintReading& reading : readings)
        html += fmt::format("<li>{}</li>\n", io::html_text(reading_words(reading, print)));
    html += fmt::format(
        "</ul>\n<p class=\"soft\">Predicted by {}. What this cannot see: gloss, the direction of the light, colours "
        "that the camera does not tell apart{}{}.</p></section>\n",
        io::html_text(print.model),
        print.of_body ? "; the light is found on the body, so that what all sides that look one way have in common is "
                        "taken for light"
                      : "",
        readings.front().has_checker ? "" : "; without a colour checker also none of the print's own cast");
}

}  // namespace

std::string difference_words(const PrintDifference& d, double viewing_distance_mm) {
    return fmt::format(
        "differs from the prediction by {:.2f} CIEDE2000 on average (median {:.2f}, 95 % {:.2f}) as seen "
        "from {:.0f} mm",
        d.ciede2000.mean, d.ciede2000.median, d.ciede2000.percentile_95, viewing_distance_mm);
}

std::string reading_words(const PrintReading& r, const PredictedPrint& print) {
    const double px_per_mm = r.found.place.px_per_cell() / print.cell_mm.x();
    std::string words =
        fmt::format("{}: {:.1f} pixels a mm, correlation {:.3f}", r.photograph, px_per_mm, r.found.correlation);
    if (r.found.turned_deg != 0) words += fmt::format(", the print lies turned by {} degrees", r.found.turned_deg);
    words +=
        r.light_from_body
            ? fmt::format(
                  ", outlines overlap by {:.1f} %, light falls to {:.0f} % (found on the body, taken out), {:.0f} % "
                  "of what is seen left out (aslant, rims, shadows, gloss)",
                  100 * r.overlap, 100 * r.light_falls_to, 100 * r.left_out)
        : r.light_from_ground ? fmt::format(", light falls to {:.0f} % across it (taken out)", 100 * r.light_falls_to)
                              : ", light taken for even";
    words += r.has_checker ? ", colours by the checker" : ", no checker";
    if (r.camera_blur_mm) words += fmt::format(", blur at its outline {:.3f} mm", *r.camera_blur_mm);
    return words;
}

std::string compare_page(const PredictedPrint& print, const std::vector<PrintReading>& readings,
                         const PrintDifference& d, double viewing_distance_mm) {
    const std::string below = fmt::format("<p>The print {}.</p>", difference_words(d, viewing_distance_mm));
    std::string html = io::page_start(fmt::format("{}: printed and predicted", print.name),
                                      std::string(io::page_asset("style")).append(page_style), below, true);
    add_pictures(html, print, d);
    add_causes(html, print, d, readings.front().has_checker);
    add_tiles(html, d);
    add_readings(html, print, readings);
    html +=
        "<script>document.getElementById(\"cut\").addEventListener(\"input\",e=>document.getElementById(\"both\")"
        ".style.setProperty(\"--cut\",e.target.value+\"%\"))</script>\n</main></body></html>\n";
    return html;
}

}  // namespace voxtone::calibration
