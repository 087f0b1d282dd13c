// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/report_html.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string_view>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/counted.h"
#include "base/machine_memory.h"
#include "base/named_values.h"
#include "base/printable.h"
#include "base/progress_bar.h"
#include "io/files/base64.h"
#include "io/files/markup.h"
#include "io/pictures/webp.h"
#include "io/report/plot_svg.h"
#include "io/report/viewer_section.h"

namespace voxtone::io {

namespace {

/// 1 234 567 with narrow no-break spaces.
std::string grouped(std::uint64_t number) {
    const std::string digits = std::to_string(number);
    std::string result;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) result += "\u202f";
        result += digits[i];
    }
    return result;
}

std::string byte_text(std::uint64_t bytes) {
    const auto value = static_cast<double>(bytes);
    if (value >= 1e9) return fmt::format("{:.2f} GB", value * 1e-9);
    if (value >= 1e6) return fmt::format("{:.0f} MB", value * 1e-6);
    return fmt::format("{:.0f} kB", std::ceil(value * 1e-3));
}

/// Three digits that count: 123 ml, 12.3 ml, 0.0123 ml.
std::string volume_text(double ml) {
    if (ml == 0) return "0 ml";
    return ml >= 100 ? fmt::format("{:.0f} ml", ml) : fmt::format("{:#.3g} ml", ml);
}

std::string rgb_text(const Rgb& rgb) { return fmt::format("{}, {}, {}", rgb[0], rgb[1], rgb[2]); }

void add_card(std::string& html, std::string_view what, std::string_view value, std::string_view more) {
    html += fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n", what, value, more);
}

/// The longest of 1, 2, 5, 10, ... mm that is at most a third of the picture.
double scale_bar_mm(double width_mm) {
    const double power = std::pow(10.0, std::floor(std::log10(width_mm / 3)));
    const double most = width_mm / 3 / power;
    return power * (most >= 5 ? 5 : most >= 2 ? 2 : 1);
}

std::string data_url(const ReportPicture& picture) {
    return fmt::format("data:image/{};base64,{}", is_webp(picture.file) ? "webp" : "png", base64(picture.file));
}

/// A picture on its stage, with a scale bar below where it is to scale. `id`: of the image, may be empty.
std::string stage(const ReportPicture& picture, std::string_view id = "") {
    VOXTONE_EXPECT(picture.width_px > 0 && picture.height_px > 0);
    std::string html = fmt::format(
        "<div class=\"stage\"><div class=\"scaled\" style=\"--aspect:{:.5f}\"><img{} alt=\"{}\" width=\"{}\" "
        "height=\"{}\" loading=\"lazy\" decoding=\"async\" "
        "src=\"{}\">",
        static_cast<double>(picture.width_px) / picture.height_px, id.empty() ? "" : fmt::format(" id=\"{}\"", id),
        html_text(picture.caption), picture.width_px, picture.height_px, data_url(picture));
    if (picture.px_per_mm > 0) {
        const double width_mm = picture.width_px / picture.px_per_mm, bar_mm = scale_bar_mm(width_mm);
        html += fmt::format("<div class=\"scale\" style=\"width:{:.3f}%\"></div><span>{:g} mm</span>",
                            100 * bar_mm / width_mm, bar_mm);
    }
    return html + "</div></div>";
}

void add_pictures(std::string& html, const std::vector<ReportPicture>& pictures) {
    html += "<div class=\"pictures\">\n";
    for (const ReportPicture& picture : pictures)
        html +=
            fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", stage(picture), html_text(picture.caption));
    html += "</div>\n";
}

std::string style_of(const Report& report) {
    std::string style(page_asset("style"));
    if (!report.viewer.empty()) style += page_asset("viewer");
    return style;
}

void add_head(std::string& html, const Report& report) {
    const std::string printer = report.printer_name.empty()
                                    ? std::string()
                                    : fmt::format("<div class=\"soft\">for {} ({})</div>\n",
                                                  html_text(report.printer_name), html_text(report.printer_id));
    html += page_start(report.title, style_of(report), printer, true);
}

/// Else there is nothing to print, and nothing to assign resins to.
bool is_of_a_stack(const Report& report) { return report.size_px[2] > 0; }

void add_printing(std::string& html, const ReportPrinting& printing) {
    if (printing.support_ml)
        add_card(html, "Support", "some " + volume_text(*printing.support_ml),
                 "below what hangs over; the printer adds what the print stands on");
    if (printing.passes == 0) return;
    const std::string passes = grouped(printing.passes) + " passes";
    add_card(html, "Printing time", printing.seconds ? "some " + duration_text(*printing.seconds) : passes,
             fmt::format("{}{} a layer. {}", printing.seconds ? passes + ", " : "", printing.passes_of_layer,
                         printing.source));
}

void add_summary(std::string& html, const Report& report) {
    double ml = 0;
    for (const ReportResin& resin : report.resins) ml += resin.ml;
    html += "<dl class=\"cards\">\n";
    add_card(html, "Size, x × y × z",
             fmt::format("{:.2f} × {:.2f} × {:.2f} mm", report.size_mm[0], report.size_mm[1], report.size_mm[2]), "");
    add_card(html, "Layers", grouped(report.size_px[2]), fmt::format("of {:g} µm", report.pitch_um[2]));
    add_card(html, "Bitmaps", fmt::format("{} × {} px", report.size_px[0], report.size_px[1]),
             fmt::format("a pixel is {:.2f} × {:.2f} µm", report.pitch_um[0], report.pitch_um[1]));
    add_card(html, "Resin", volume_text(ml), grouped(report.body_voxels) + " voxels, without support");
    add_printing(html, report.printing);
    add_card(html, "Computed in", duration_text(report.total_seconds),
             report.peak_memory_bytes ? "peak memory " + memory_text(report.peak_memory_bytes) : "");
    if (report.output_bytes) add_card(html, "Written", byte_text(report.output_bytes), "");
    html += "</dl>\n";
}

std::string numbers_of(const std::array<double, 3>& mm) {
    return fmt::format("[{:.3f}, {:.3f}, {:.3f}]", mm[0], mm[1], mm[2]);
}

/// A button that turns the view to a place.
std::string show_button(const std::array<double, 3>& at_mm, const std::array<double, 3>& normal,
                        std::string_view text) {
    return fmt::format(
        "<button type=\"button\" class=\"place screen-only\" data-at=\"{}\" data-normal=\"{}\" "
        "disabled>{}</button>",
        numbers_of(at_mm), numbers_of(normal), text);
}

/// Solids, type, texture and paper, the worst first.
void add_regions(std::string& html, const std::vector<ReportRegion>& regions) {
    constexpr std::size_t most = 8;
    if (regions.empty()) return;
    html +=
        "<section>\n<h2>Solids, type, texture and paper</h2>\n<p class=\"soft\">Each as one thing, those of one colour "
        "together, the worst first, the print's own paper taken for white. Unevenness is the root mean square as seen "
        "within paper and solids, in CIEDE2000; the rim, within 0.6 mm of a solid's edge, is in units of CIELAB; type "
        "and texture are judged by their contrast.</p>\n<div class=\"table\"><table>\n<tr><th>Asked "
        "for</th><th>Printed as</th><th>Where</th><th>mm²</th><th>CIEDE2000</th><th>Unevenness</th><th>Rim</th>"
        "<th></th></tr>\n";
    const auto text = [](const std::optional<double>& figure) {
        return figure ? fmt::format("{:.1f}", *figure) : std::string("–");
    };
    for (std::size_t i = 0; i < std::min(most, regions.size()); ++i) {
        const ReportRegion& region = regions[i];
        const std::string where =
            region.place + (region.pieces > 1 ? fmt::format(", {} places", region.pieces) : std::string());
        const std::string asked =
            region.asked + (region.asked_seen.empty() ? "" : ", to the eye at its size " + region.asked_seen);
        html += fmt::format(
            "<tr><td>{} {}</td><td>{}</td><td>{} {}</td><td>{:.1f}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
            "</tr>\n",
            html_text(region.kind), html_text(asked), html_text(region.printed), html_text(where),
            show_button(region.place_mm, region.normal, "show"), region.area_mm2, text(region.de2000),
            text(region.unevenness), text(region.rim), html_text(region.why));
    }
    html += "</table></div>\n";
    if (regions.size() > most)
        html += fmt::format("<p class=\"soft\">{} more are in report.json.</p>\n", regions.size() - most);
    html += "</section>\n";
}

std::string count_of_warnings(const Report& report) {
    return report.warnings.size() == 1 ? "1 warning" : fmt::format("{} warnings", report.warnings.size());
}

/// What is worst, with its place; from which side how much is seen; by what.
void add_reasons(std::string& html, const ReportVerdict& v) {
    const bool has_place = v.but_normal != std::array<double, 3>{};
    if (!v.but.empty())
        html += fmt::format("<p>{} {}</p>\n", html_text(v.but),
                            has_place ? show_button(v.but_mm, v.but_normal, "show me") : std::string());
    if (const std::string& why = v.headline.empty() ? v.sentence : v.why; !why.empty())
        html += fmt::format("<p class=\"soft\">{}</p>\n", html_text(why));
    if (v.sides.size() > 1) {
        html += "<p class=\"soft\">Seen from: ";
        for (std::size_t i = 0; i < v.sides.size(); ++i)
            html += fmt::format("{}{} {:.1f}", i ? ", " : "", html_text(v.sides[i].name), v.sides[i].mean);
        html += ".</p>\n";
    }
    if (v.causes.empty()) return;
    html += fmt::format(
        "<p class=\"soft\">{:.0f} % of what is seen differs by more than {:g}. {:.0f} % is clearly off: by more than "
        "{:g}, flecked, or blurred. What differs comes, by area and difference, of ",
        100 * v.off_share, v.good_up_to, 100 * v.wrong_share, v.bad_above);
    for (std::size_t i = 0; i < v.causes.size(); ++i)
        html += fmt::format("{}{} {:.0f} %", i ? ", " : "", html_text(v.causes[i].name), 100 * v.causes[i].share);
    html += ".</p>\n";
}

/// The headline, what is worst, why, what to try; the one figure with its meaning beside them.
void add_verdict(std::string& html, const Report& report) {
    if (!report.verdict) return;
    const ReportVerdict& v = *report.verdict;
    html +=
        fmt::format("<section class=\"verdict {}\" aria-label=\"Will it look as asked?\">\n<h2>{}</h2>\n<div>\n<div>\n",
                    name_of(v.level), html_text(v.headline.empty() ? "Will it look as asked?" : v.headline));
    add_reasons(html, v);
    if (!v.advice.empty()) {
        html += "<p>What to try, and what it would come to:</p>\n<ul>\n";
        for (const ReportAdvice& advice : v.advice) html += fmt::format("<li>{}</li>\n", html_text(advice.text));
        html += "</ul>\n";
    }
    if (!report.warnings.empty())
        html += fmt::format("<p><a href=\"#warnings\">{}</a></p>\n", count_of_warnings(report));
    html += "</div>\n";
    if (v.seen_mean) {
        html += "<dl class=\"cards\">\n";
        const std::string reach =
            v.reach_mean ? fmt::format("; {:.1f} of it no mixture of these resins could avoid", *v.reach_mean) : "";
        add_card(html, "Difference as seen", fmt::format("{:.1f}", *v.seen_mean),
                 fmt::format("CIEDE2000, mean over what is seen of the coloured surface, from {:g} mm; up to {:g} is "
                             "good, above {:g} bad; 0.8 is just visible side by side{}{}",
                             v.viewing_distance_mm, v.good_up_to, v.bad_above, reach,
                             v.paper ? fmt::format("; its white has {:.2f} of the light that was asked for, and is "
                                                   "taken for white",
                                                   *v.paper)
                                     : ""));
        html += "</dl>\n";
    }
    html += "</div>\n</section>\n";
}

void add_warnings(std::string& html, const Report& report) {
    if (report.warnings.empty()) return;
    html += fmt::format("<section class=\"warnings\" id=\"warnings\">\n<h2>{}</h2>\n<ul>\n", count_of_warnings(report));
    for (const std::string& warning : report.warnings) html += fmt::format("<li>{}</li>\n", html_text(warning));
    html += "</ul>\n</section>\n";
}

/// Which of many bodies is worth a look: the pictures in the order in which they were asked for.
void add_parts(std::string& html, const Report& report) {
    if (report.parts.empty()) return;
    std::uint64_t copies = 0;
    for (const ReportPart& part : report.parts) copies += part.copies;
    const bool seen = std::any_of(report.parts.begin(), report.parts.end(),
                                  [](const ReportPart& part) { return part.seen_mean.has_value(); });
    html += fmt::format(
        "<section class=\"parts\">\n<h2>Parts</h2>\n<p class=\"soft\">{}, {} in all. A name opens the part's "
        "own "
        "page.<span class=\"screen-only\"> A click on a place turns the view above to it.</span></p>\n<div "
        "class=\"table\"><table>\n<thead><tr><th></th><th>Part</th><th class=\"n\">Copies</th><th class=\"n\">ml each"
        "</th>{}</tr></thead>\n<tbody>\n",
        counted(report.parts.size(), "part"), copies,
        seen ? "<th class=\"n\">Difference as seen</th><th>Worst place</th>" : "<th>Place</th>");
    for (std::size_t i = 0; i < report.parts.size(); ++i) {
        const ReportPart& part = report.parts[i];
        const std::string picture = part.picture.file.empty()
                                        ? std::string()
                                        : fmt::format("<img alt=\"\" src=\"{}\">", data_url(part.picture));
        const std::string name = part.page.empty()
                                     ? html_text(part.name)
                                     : fmt::format("<a href=\"{}\">{}</a>", link_text(part.page), html_text(part.name));
        html += fmt::format(
            "<tr><td class=\"picture\">{}</td><td>{}{}<small>{}</small></td><td class=\"n\">{}</td><td "
            "class=\"n\">{:#.3g}"
            "</td>",
            picture, name, part.about.empty() ? "" : "<small>" + html_text(part.about) + "</small>",
            html_text(part.headline), part.copies, part.ml);
        if (seen)
            html += fmt::format("<td class=\"n\"><i class=\"mark {}\"></i>{}</td>", name_of(part.level),
                                part.seen_mean ? fmt::format("{:.1f}", *part.seen_mean) : std::string("not predicted"));
        html += "<td>";
        if (i < report.viewer.worst.size()) {
            const ViewerPlace& place = report.viewer.worst[i];
            const std::string text = place.words.empty() ? std::string("show it") : html_text(place.words);
            html +=
                fmt::format("<button type=\"button\" class=\"place\" data-place=\"{}\" disabled>{}</button>", i, text);
        }
        html += "</td></tr>\n";
    }
    html += "</tbody>\n</table></div>\n</section>\n";
}

void add_views(std::string& html, const Report& report) {
    if (report.views.empty()) return;
    html += fmt::format("<section class=\"views\">\n<h2>{}</h2>\n<div class=\"tabs\"></div>\n",
                        html_text(report.viewer.heading));
    for (const ReportView& view : report.views) {
        html += fmt::format("<div class=\"view\" data-name=\"{0}\"><h3>{0}</h3>\n", html_text(view.name));
        add_pictures(html, view.pictures);
        html += "</div>\n";
    }
    if (!report.prediction_note.empty())
        html += fmt::format("<p class=\"soft\">{}</p>\n", html_text(report.prediction_note));
    html += "</section>\n";
}

void add_prediction(std::string& html, const Report& report) {
    if (!report.prediction) return;
    const ReportPrediction& p = *report.prediction;
    html += "<section class=\"detail\">\n<h2>Predicted against asked for, cell by cell</h2>\n<dl class=\"cards\">\n";
    add_card(html, "Mean difference", fmt::format("{:.2f}", p.mean_de2000), "CIEDE2000");
    add_card(html, "Median", fmt::format("{:.2f}", p.median_de2000), "CIEDE2000");
    add_card(html, "95th percentile", fmt::format("{:.2f}", p.p95_de2000), "CIEDE2000");
    add_card(html, "Largest", fmt::format("{:.2f}", p.max_de2000), "CIEDE2000");
    html +=
        "</dl>\n<div class=\"table\"><table>\n<thead><tr><th>Difference</th><th class=\"n\">Share of the surface</th>"
        "<th></th></tr></thead>\n<tbody>\n";
    double most = 0;
    for (const auto& [edge, share] : p.histogram) most = std::max(most, share);
    for (std::size_t i = 0; i < p.histogram.size(); ++i) {
        const auto& [edge, share] = p.histogram[i];
        const std::string range = i + 1 < p.histogram.size()
                                      ? fmt::format("{:g} – {:g}", edge, p.histogram[i + 1].first)
                                      : fmt::format("{:g} and more", edge);
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{:.1f} %</td><td class=\"meter\"><i "
            "style=\"--share:{:.2f}%\"></i></td></tr>\n",
            range, 100 * share, most > 0 ? 100 * share / most : 0);
    }
    html += fmt::format("</tbody>\n</table></div>\n<p class=\"soft\">{}</p>\n</section>\n", html_text(p.note));
}

/// The errors as seen, one iteration after the other.
std::string loop_plot(const ReportLoop& loop) {
    if (loop.iterations.size() < 2) return {};
    Plot::Points mean, tail;
    double most = 0;
    for (const ReportIteration& i : loop.iterations) {
        mean.emplace_back(i.number, i.mean);
        tail.emplace_back(i.number, i.p95);
        most = std::max(most, i.p95);
    }
    PlotAxis x{double(loop.iterations.front().number), double(loop.iterations.back().number), false, {}, "iteration"};
    for (const ReportIteration& i : loop.iterations)
        if (loop.iterations.size() <= 12 || i.number % 5 == 0) x.marks.push_back(i.number);
    const double step = most > 20 ? 10 : most > 8 ? 5 : 1;
    PlotAxis y{0, std::max(1.0, 1.1 * most), false, {}, "CIEDE2000 as seen"};
    for (double mark = 0; mark <= y.to; mark += step) y.marks.push_back(mark);
    Plot plot(x, y, "mean (blue), 95th percentile (grey), printed (dot)", 460, 200);
    plot.line(tail, "#777777", 1.5, true);
    plot.line(mean, "#0f6f8f", 2);
    for (const ReportIteration& i : loop.iterations)
        if (i.number == loop.best) plot.point(i.number, i.mean, "#0f6f8f");
    return fmt::format("<div class=\"drawings\"><figure>{}<figcaption>Error by iteration</figcaption></figure></div>\n",
                       plot.svg());
}

void add_loop(std::string& html, const Report& report) {
    if (!report.loop) return;
    const ReportLoop& loop = *report.loop;
    html += "<section class=\"detail\">\n<h2>The appearance loop</h2>\n";
    html += fmt::format("<p class=\"soft\">{}</p>\n", html_text(loop.note));
    html +=
        "<div class=\"table\"><table>\n<thead><tr><th>Iteration</th><th class=\"n\">Mean as seen</th><th></th><th "
        "class=\"n\">Median</th>"
        "<th class=\"n\">95th percentile</th><th class=\"n wide-only\">Mean of cells</th><th class=\"n wide-only\">At "
        "limits</th>"
        "<th class=\"n wide-only\">Time</th></tr></thead>\n<tbody>\n";
    double most = 0;
    for (const ReportIteration& i : loop.iterations) most = std::max(most, i.mean);
    for (const ReportIteration& i : loop.iterations) {
        const std::string name = fmt::format("{}{}{}", i.number, i.number == 0 ? ", open loop" : "",
                                             i.number == loop.best ? ", printed" : "");
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{:.2f}</td><td class=\"meter\"><i style=\"--share:{:.2f}%\"></i></td><td "
            "class=\"n\">{:.2f}</td>"
            "<td class=\"n\">{:.2f}</td><td class=\"n wide-only\">{:.2f}</td><td class=\"n wide-only\">{:.1f} %</td>"
            "<td class=\"n wide-only\">{}</td></tr>\n",
            name, i.mean, most > 0 ? 100 * i.mean / most : 0, i.median, i.p95, i.cells_mean, 100 * i.saturated_share,
            duration_text(i.seconds));
    }
    html += "</tbody>\n</table></div>\n" + loop_plot(loop);
    if (!loop.crops.empty()) {
        html += "<h3>Magnified, where the loop changed most</h3>\n";
        add_pictures(html, loop.crops);
    }
    if (!loop.sections.empty()) {
        html += "<h3>A cut through the resins</h3>\n";
        add_pictures(html, loop.sections);
        html += fmt::format("<p class=\"soft\">{}</p>\n", html_text(loop.sections_note));
    }
    html += "</section>\n";
}

void add_gamut(std::string& html, const Report& report) {
    if (!report.gamut) return;
    const ReportGamut& gamut = *report.gamut;
    html += "<section class=\"detail\">\n<h2>Colours that the resins cannot reach</h2>\n<dl class=\"cards\">\n";
    add_card(html, "Surface that was mapped", fmt::format("{:.1f} %", 100 * gamut.mapped_share),
             "of the coloured surface");
    add_card(html, "Mean difference", fmt::format("{:.2f}", gamut.mean_de2000), "CIEDE2000");
    add_card(html, "95th percentile", fmt::format("{:.2f}", gamut.p95_de2000), "CIEDE2000");
    add_card(html, "Largest", fmt::format("{:.2f}", gamut.max_de2000), "CIEDE2000");
    html +=
        "</dl>\n<p class=\"soft\">Colours outside the reach of the loaded resins are mapped into it, keeping their "
        "hue. The "
        "differences are between what was asked for and what it was mapped to, over the whole coloured "
        "surface.</p>\n</section>\n";
}

void add_resins(std::string& html, const Report& report) {
    if (report.resins.empty() || !is_of_a_stack(report)) return;
    html +=
        "<section>\n<h2>Resin assignment</h2>\n<p class=\"soft\">In the printer's software, assign each bitmap colour "
        "the resin "
        "beside it.</p>\n<div class=\"table\"><table>\n<thead><tr><th class=\"code\">Bitmap colour (R, G, "
        "B)</th><th>Resin</th>"
        "<th>Role</th><th class=\"n wide-only\">Voxels</th><th class=\"n\">Volume</th><th "
        "class=\"wide-only\">Share</th></tr></thead>\n<tbody>\n";
    double total_ml = 0;
    std::uint64_t total_voxels = 0;
    for (const ReportResin& resin : report.resins) {
        total_ml += resin.ml;
        total_voxels += resin.voxels;
    }
    for (const ReportResin& resin : report.resins) {
        const std::string& name = resin.shown_name();  // the set's own name stands behind
        const std::string in_set =
            name == resin.name ? std::string() : fmt::format(" <span class=\"soft\">{}</span>", html_text(resin.name));
        const double share =
            total_voxels ? 100.0 * static_cast<double>(resin.voxels) / static_cast<double>(total_voxels) : 0;
        html += fmt::format(
            "<tr><td class=\"code\"><span class=\"swatch\" "
            "style=\"background:rgb({0})\"></span>{0}</td><td class=\"material\">{1}{2}</td><td>{3}</td>"
            "<td class=\"n wide-only\">{4}</td><td class=\"n\">{5}</td><td class=\"meter wide-only\" title=\"{6:.1f} "
            "%\"><i "
            "style=\"--share:{6:.2f}%\"></i></td></tr>\n",
            rgb_text(resin.rgb), html_text(name), in_set, html_text(resin.role), grouped(resin.voxels),
            volume_text(resin.ml), share);
    }
    html += fmt::format(
        "</tbody>\n<tfoot><tr><td>Total</td><td></td><td></td><td class=\"n wide-only\">{}</td><td class=\"n\">{}</td>"
        "<td class=\"wide-only\"></td></tr></tfoot>\n</table></div>\n</section>\n",
        grouped(total_voxels), volume_text(total_ml));
}

std::string layer_label(const ReportLayer& layer) {
    return fmt::format("layer {}, {:.3f} mm", layer.number, layer.height_mm);
}

void add_layers(std::string& html, const Report& report) {
    if (report.layers.empty()) return;
    const std::size_t shown = report.layers.size() / 2;
    html += fmt::format(
        "<section class=\"layers\">\n<h2>Layers</h2>\n<figure>{}</figure>\n"
        "<div class=\"scrub\" hidden><button type=\"button\" id=\"layer-play\">Play</button>"
        "<input type=\"range\" id=\"layer-slider\" min=\"0\" max=\"{}\" value=\"{}\" aria-label=\"Layer\">"
        "<output id=\"layer-label\">{}</output></div>\n",
        stage(report.layers[shown].picture, "layer-picture"), report.layers.size() - 1, shown,
        layer_label(report.layers[shown]));
    html += fmt::format(
        "<p class=\"soft\">{} of {} layers, seen from above, in the bitmap colours of the resins; each pixel is the "
        "mean of "
        "the printer's pixels under it. <span class=\"keys\">The arrow keys step through them.</span></p>\n"
        "<script type=\"application/json\" id=\"layer-data\">[",
        report.layers.size(), grouped(report.size_px[2]));
    for (std::size_t i = 0; i < report.layers.size(); ++i)
        html += fmt::format("{}{{\"label\":{},\"src\":\"{}\"}}", i ? ",\n" : "",
                            in_script(json_quoted(layer_label(report.layers[i]))), data_url(report.layers[i].picture));
    html += "]</script>\n</section>\n";
}

bool is_number(std::string_view cell) {
    return !cell.empty() && cell.find_first_of("0123456789") != cell.npos &&
           cell.find_first_not_of("0123456789.,+-eE% ") == cell.npos;
}

void add_table(std::string& html, const ReportTable& table) {
    const auto numeric = [&](std::size_t column) {
        return std::all_of(table.rows.begin(), table.rows.end(), [&](const auto& row) {
            return column >= row.size() || row[column].empty() || is_number(row[column]);
        });
    };
    if (!table.title.empty()) html += fmt::format("<h3>{}</h3>\n", html_text(table.title));
    html += "<div class=\"table\"><table>\n";
    if (!table.header.empty()) {
        html += "<thead><tr>";
        for (std::size_t c = 0; c < table.header.size(); ++c)
            html += fmt::format("<th{}>{}</th>", numeric(c) ? " class=\"n\"" : "", html_text(table.header[c]));
        html += "</tr></thead>\n";
    }
    html += "<tbody>\n";
    for (const auto& row : table.rows) {
        html += "<tr>";
        for (std::size_t c = 0; c < row.size(); ++c)
            html += fmt::format("<td{}>{}</td>", numeric(c) ? " class=\"n\"" : "", html_text(row[c]));
        html += "</tr>\n";
    }
    html += "</tbody>\n</table></div>\n";
}

void add_drawings(std::string& html, const std::vector<ReportDrawing>& drawings) {
    html += "<div class=\"drawings\">\n";
    for (const ReportDrawing& drawing : drawings)
        html += drawing.caption.empty() ? fmt::format("<figure>{}</figure>\n", drawing.svg)
                                        : fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", drawing.svg,
                                                      html_text(drawing.caption));
    html += "</div>\n";
}

void add_sections(std::string& html, const Report& report) {
    for (const ReportSection& section : report.sections) {
        html += fmt::format("<section{}>\n<h2>{}</h2>\n", section.printed ? "" : " class=\"detail\"",
                            html_text(section.title));
        for (const std::string& paragraph : section.paragraphs)
            html += fmt::format("<p>{}</p>\n", html_text(paragraph));
        if (!section.pictures.empty()) add_pictures(html, section.pictures);
        if (!section.drawings.empty()) add_drawings(html, section.drawings);
        for (const ReportTable& table : section.tables) add_table(html, table);
        if (!section.listing.empty()) html += fmt::format("<pre>{}</pre>\n", html_text(section.listing));
        html += "</section>\n";
    }
}

void add_time(std::string& html, const Report& report) {
    if (report.stages.empty()) return;
    double longest = 0;
    for (const ReportStage& stage : report.stages) longest = std::max(longest, stage.seconds);
    html += "<section class=\"detail\">\n<h2>Where the time went</h2>\n<div class=\"table\"><table>\n<tbody>\n";
    for (const ReportStage& stage : report.stages)
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"meter\"><i style=\"--share:{:.2f}%\"></i></td></tr>\n",
            html_text(stage.name), duration_text(stage.seconds), longest > 0 ? 100 * stage.seconds / longest : 0);
    html += "</tbody>\n</table></div>\n</section>\n";
}

struct OptionText {
    std::string operator()(const std::string& text) const { return text; }
    std::string operator()(bool on) const { return on ? "true" : "false"; }
    std::string operator()(const std::vector<std::string>& list) const {
        return fmt::format("{}", fmt::join(list, "\n"));
    }
    template <class Number>
    std::string operator()(Number number) const {
        return fmt::format("{}", number);
    }
};

void add_job(std::string& html, const Report& report) {
    if (report.job.empty()) return;
    html +=
        "<section class=\"detail\">\n<details><summary>The job as it was run</summary>\n<div "
        "class=\"table\"><table>\n<tbody>\n";
    for (const auto& [key, value] : report.job)
        html += fmt::format("<tr><td class=\"key\">{}</td><td class=\"value\">{}</td></tr>\n", html_text(key),
                            html_text(std::visit(OptionText{}, value)));
    html += "</tbody>\n</table></div>\n</details>\n</section>\n";
}

std::size_t picture_bytes(const std::vector<ReportPicture>& pictures) {
    std::size_t bytes = 0;
    for (const ReportPicture& picture : pictures) bytes += picture.file.size() / 3 * 4 + 500;
    return bytes;
}

}  // namespace

std::size_t still_page_bytes(const Report& report) {
    std::size_t bytes = 200'000;  // texts, style, scripts
    for (const ReportView& view : report.views) bytes += picture_bytes(view.pictures);
    for (const ReportPart& part : report.parts) bytes += picture_bytes({part.picture}) + 600;
    for (const ReportLayer& layer : report.layers) bytes += picture_bytes({layer.picture});
    if (report.loop) bytes += picture_bytes(report.loop->crops) + picture_bytes(report.loop->sections);
    for (const ReportSection& section : report.sections) {
        bytes += picture_bytes(section.pictures);
        for (const ReportDrawing& drawing : section.drawings) bytes += drawing.svg.size();
        for (const std::string& paragraph : section.paragraphs) bytes += paragraph.size();
    }
    return bytes;
}

std::string report_html(const Report& report) {
    std::string html;
    add_head(html, report);
    add_verdict(html, report);
    if (!report.verdict) add_warnings(html, report);
    html += viewer_panels(report);
    add_views(html, report);
    if (report.verdict) add_warnings(html, report);
    if (report.verdict) add_regions(html, report.verdict->regions);
    add_parts(html, report);
    if (report.parts.empty()) html += worst_section(report);
    if (is_of_a_stack(report)) add_summary(html, report);
    add_prediction(html, report);
    add_loop(html, report);
    add_resins(html, report);
    add_layers(html, report);
    add_gamut(html, report);
    add_sections(html, report);
    add_time(html, report);
    add_job(html, report);
    html +=
        fmt::format("</main>\n<footer>Made by voxtone {}.{}</footer>\n<script>\n{}</script>\n{}</body>\n</html>\n",
                    html_text(report.program_version), report.job.empty() ? "" : " Figures for programs: report.json.",
                    page_asset("script"), viewer_voxels(report));
    return html;
}

}  // namespace voxtone::io
