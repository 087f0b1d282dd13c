// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/viewer_section.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "io/files/markup.h"
#include "io/report/viewer_data.h"

namespace voxtone::io {

namespace {

/// In the order in which they use each other.
constexpr std::string_view scripts[] = {"unpack", "colours", "controls", "camera", "surface", "pick",
                                        "voxels", "scene",   "probe",    "stage",  "cut",     "start"};

/// One classic script.
std::string viewer_script() {
    std::string text = "(() => {\n\"use strict\";\n";
    for (const std::string_view name : scripts) text += page_asset(name);
    return text + "})();\n";
}

std::string data_script(std::string_view id, std::string_view json) {
    return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, in_script(json));
}

std::string swatch(const Rgb& rgb) {
    return fmt::format("<span class=\"swatch\" style=\"background:rgb({}, {}, {})\"></span>", rgb[0], rgb[1], rgb[2]);
}

/// A name, or where it is.
std::string place_text(const ViewerPlace& place) {
    if (!place.name.empty()) return fmt::format("{:.2f} {}", place.seen, html_text(place.name));
    const std::string where =
        fmt::format("x {:.1f}, y {:.1f}, z {:.1f} mm", place.at_mm[0], place.at_mm[1], place.at_mm[2]);
    if (place.words.empty()) return fmt::format("{:.1f} at {}", place.seen, where);
    return fmt::format("{:.1f} {} <small>({})</small>", place.seen, html_text(place.words), where);
}

std::string place_item(const ViewerPlace& place, std::size_t number) {
    return fmt::format(
        "<li><button type=\"button\" class=\"place\" data-place=\"{}\" disabled>{}{} {}: {}</button></li>\n", number,
        swatch(place.target), swatch(place.print), place_text(place), html_text(place.cause));
}

/// What the list is of.
std::string worst_sentence(const ReportViewer& viewer) {
    if (viewer.surface && !viewer.surface->parts.empty())
        return fmt::format("Squares that differ most: {} and {}, CIEDE2000, and the value that is farthest off.",
                           viewer.surface->asked, viewer.surface->expected);
    const std::string from =
        viewer.viewing_distance_mm > 0 ? fmt::format(", seen from {:g} mm", viewer.viewing_distance_mm) : "";
    return fmt::format("Places that differ most{}: {} and {}, CIEDE2000, and what limits it there.", from,
                       viewer.surface ? viewer.surface->asked : "target",
                       viewer.surface ? viewer.surface->expected : "print");
}

/// Shares of the surface as bars, one a row.
std::string histogram_table(const std::vector<std::pair<double, double>>& histogram) {
    double most = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < histogram.size(); ++i) {
        most = std::max(most, histogram[i].second);
        if (histogram[i].second > 0) last = i;
    }
    if (most <= 0) return {};
    std::string html =
        "<div class=\"table detail\"><table>\n<thead><tr><th>CIEDE2000 as seen</th><th class=\"n\">Share of the "
        "surface</th><th></th></tr></thead>\n<tbody>\n";
    for (std::size_t i = 0; i <= last; ++i) {
        const std::string range = i + 1 < histogram.size()
                                      ? fmt::format("{:g} to {:g}", histogram[i].first, histogram[i + 1].first)
                                      : fmt::format("{:g} and more", histogram[i].first);
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{:.1f} %</td><td class=\"meter\"><i style=\"--share:{:.2f}%\"></i></td>"
            "</tr>\n",
            range, 100 * histogram[i].second, 100 * histogram[i].second / most);
    }
    return html + "</tbody>\n</table></div>\n";
}

}  // namespace

std::string viewer_panels(const Report& report) {
    if (report.viewer.empty()) return {};
    std::vector<ViewerResin> resins;
    for (const ReportResin& resin : report.resins) resins.push_back({resin.shown_name(), resin.role, resin.rgb});
    std::string html(page_asset("panels"));
    html += data_script("viewer-data", viewer_json(report.viewer, resins, report.prediction_note));
    return html + "<script>\n" + viewer_script() + "</script>\n";
}

std::string viewer_voxels(const Report& report) {
    return report.viewer.voxels ? data_script("voxel-data", voxels_json(*report.viewer.voxels)) : std::string();
}

std::string worst_section(const Report& report) {
    const std::vector<ViewerPlace>& worst = report.viewer.worst;
    if (worst.empty()) return {};
    std::string html = fmt::format(
        "<section>\n<h2>Where it is worst</h2>\n<p class=\"soft\">{}<span class=\"screen-only\"> A click turns the "
        "view above to the place.</span></p>\n<div class=\"worst-grid\"><div><ol class=\"worst\">\n",
        html_text(worst_sentence(report.viewer)));
    for (std::size_t i = 0; i < worst.size(); ++i) html += place_item(worst[i], i);
    html += "</ol>\n</div>\n";
    if (report.verdict) html += histogram_table(report.verdict->seen_histogram);
    html += "</div>\n";
    return html + "</section>\n";
}

}  // namespace voxtone::io
