// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/customer_page.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "base/warning.h"
#include "io/files/base64.h"
#include "io/files/markup.h"
#include "io/pictures/webp.h"

namespace voxtone::io {

namespace {

constexpr std::string_view customer_style =
    "body{margin:0;font:17px/1.5 system-ui,sans-serif;color:#222;background:#fff}"
    "header,main{max-width:960px;margin:auto;padding:16px}h1{font-size:26px;margin:8px 0}"
    ".pictures{display:flex;flex-wrap:wrap;gap:16px}figure{margin:0;flex:1 1 280px}"
    ".sides figure{flex:1 1 160px;max-width:200px}"
    "img{width:100%;height:auto;max-height:60vh;object-fit:contain;background:#8a8a8a;border-radius:4px}figcaption{"
    "color:#555}"
    ".verdict{border-left:6px solid #888;padding-left:12px}.good{border-color:#2a8a3a}.fair{border-color:#c98a00}"
    ".bad{border-color:#b3261e}footer{color:#777;font-size:14px}"
    "@media print{img{background:none}}";

/// The shop knows these as targets and predictions.
constexpr std::array<std::array<std::string_view, 2>, 2> shown_to_customer{
    {{"target", "As you asked for it"}, {"predicted", "As the print will look"}}};

bool is_judged(const Report& report) { return report.verdict && report.verdict->level != VerdictLevel::unknown; }

void add_customer_pictures(std::string& html, const Report& report) {
    if (report.views.empty()) return;
    html += "<div class=\"pictures\">\n";
    for (const auto& [caption, of_judged] : shown_to_customer) {
        // Without a prediction the picture is of the mixtures alone.
        const std::string_view words =
            caption == "predicted" && !is_judged(report) ? "In colours that are in reach" : of_judged;
        const std::vector<ReportPicture>& pictures = report.views.front().pictures;
        const auto found = std::ranges::find_if(
            pictures, [&caption = caption](const ReportPicture& p) { return p.caption.starts_with(caption); });
        if (found == pictures.end()) continue;
        html += fmt::format(
            "<figure><img alt=\"{}\" width=\"{}\" height=\"{}\" src=\"data:image/{};base64,{}\">"
            "<figcaption>{}</figcaption></figure>\n",
            words, found->width_px, found->height_px, is_webp(found->file) ? "webp" : "png", base64(found->file),
            words);
    }
    html += "</div>\n";
}

/// Never nothing: a page to send on says whether the print will look as asked, or that nobody knows.
std::string customer_sentence(const Report& report) {
    if (!report.verdict) return "How it will look was not predicted.";
    if (!is_judged(report))
        return "The picture shows the colours that are in reach; how light spreads in the resins was not looked at.";
    return report.verdict->headline.empty() ? report.verdict->sentence : report.verdict->headline;
}

void add_customer_verdict(std::string& html, const Report& report) {
    const bool is_known = is_judged(report);
    html += fmt::format("<p class=\"verdict {}\">{}</p>\n", is_known ? name_of(report.verdict->level) : "",
                        html_text(customer_sentence(report)));
    // Who ordered it is the one who minds that its type cannot be read.
    if (is_known && !report.verdict->but.empty()) html += fmt::format("<p>{}</p>\n", html_text(report.verdict->but));
    if (is_known && report.verdict->paper)
        html += fmt::format(
            "<p>Beside white paper its white is darker: it has {:.0f} % of the light. Its colours are judged as eyes "
            "see them that have got used to it.</p>\n",
            100 * *report.verdict->paper);
}

/// What concerns who ordered it: without its name, and without sentences on options and tools, which are the shop's.
std::string sentence_of(const std::string& warning) {
    const std::string_view name = message_name(warning);
    if (name == "fragile")
        return "Thin parts, or parts that hold to the rest in a point alone, may break when the support is washed off.";
    const std::string text = warning.substr(0, warning.size() - (name.empty() ? 0 : name.size() + 2)) + " ";
    std::string kept;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(". ", at), text.size() - 1);
        std::string sentence = text.substr(at, end - at);
        at = end + 2;
        while (sentence.ends_with(' ') || sentence.ends_with('.')) sentence.pop_back();
        if (sentence.find("--") == std::string::npos && !sentence.empty())
            kept += (kept.empty() ? "" : " ") + sentence + ".";
    }
    return kept;
}

/// What is lost the verdict says, too.
bool says(const Report& report, const std::string& sentence) {
    return is_judged(report) && report.verdict->but.find(sentence) != std::string::npos;
}

void add_customer_warnings(std::string& html, const Report& report) {
    std::vector<std::string> told;
    for (const std::string& warning : report.warnings) {
        const std::string_view name = message_name(warning);
        if (name != "fragile" && name != "lost-colour" && name != "transparent") continue;
        const std::string sentence = sentence_of(warning);
        if (sentence.empty() || says(report, sentence) || std::ranges::find(told, sentence) != told.end()) continue;
        html += fmt::format("<p><strong>Please note:</strong> {}</p>\n", html_text(sentence));
        told.push_back(sentence);
    }
}

/// From the sides that the first picture may not show.
void add_sides(std::string& html, const Report& report) {
    std::string pictures;
    for (const ReportView& view : report.views) {
        if (view.name != "front" && view.name != "right" && view.name != "back" && view.name != "left") continue;
        for (const ReportPicture& picture : view.pictures)
            if (picture.caption.starts_with("predicted"))
                pictures += fmt::format(
                    "<figure><img alt=\"from the {0}\" width=\"{1}\" height=\"{2}\" src=\"data:image/{3};base64,{4}\">"
                    "<figcaption>from the {0}</figcaption></figure>\n",
                    view.name, picture.width_px, picture.height_px, is_webp(picture.file) ? "webp" : "png",
                    base64(picture.file));
    }
    if (!pictures.empty()) html += "<div class=\"pictures sides\">\n" + pictures + "</div>\n";
}

}  // namespace

std::string customer_html(const Report& report, const std::string& customer) {
    std::string html = page_start(report.title, customer_style, "");
    if (!customer.empty()) html += fmt::format("<p>For {}</p>\n", html_text(customer));
    add_customer_verdict(html, report);
    add_customer_pictures(html, report);
    html += fmt::format("<p>Size: {:.1f} x {:.1f} x {:.1f} mm (width, depth, height as it is printed)</p>\n",
                        report.size_mm[0], report.size_mm[1], report.size_mm[2]);
    add_customer_warnings(html, report);
    add_sides(html, report);
    // A prediction of a body keeps the steps of its cells (docs/predict.md).
    const bool is_body = is_judged(report) && !report.verdict->sides.empty();
    html += fmt::format(
        "<footer>Colours on a screen are seen by its own light; a print is seen by that of its room.{}"
        "</footer>\n",
        is_body ? " Fine stripes along curved faces come from how the picture was computed." : "");
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace voxtone::io
