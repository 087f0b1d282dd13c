// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/customer_page.h"

#include <algorithm>
#include <array>
#include <string_view>

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
    "img{width:100%;height:auto;background:#8a8a8a;border-radius:4px}figcaption{color:#555}"
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

/// Without its name, which is the shop's.
std::string sentence_of(const std::string& warning) {
    const std::string_view name = message_name(warning);
    std::string text = warning.substr(0, warning.size() - (name.empty() ? 0 : name.size() + 2));
    while (text.ends_with(' ')) text.pop_back();
    return text.ends_with('.') ? text : text + ".";
}

/// What is lost the verdict says, too.
bool says(const Report& report, const std::string& sentence) {
    return is_judged(report) && report.verdict->but.find(sentence) != std::string::npos;
}

void add_customer_warnings(std::string& html, const Report& report) {
    for (const std::string& warning : report.warnings)
        if (const std::string_view name = message_name(warning);
            (name == "fragile" || name == "lost-colour" || name == "transparent") &&
            !says(report, sentence_of(warning)))
            html += fmt::format("<p><strong>Please note:</strong> {}</p>\n", html_text(sentence_of(warning)));
}

}  // namespace

std::string customer_html(const Report& report, const std::string& customer) {
    std::string html = page_start(report.title, customer_style, "");
    if (!customer.empty()) html += fmt::format("<p>For {}</p>\n", html_text(customer));
    add_customer_pictures(html, report);
    html += fmt::format("<p>Size: {:.1f} x {:.1f} x {:.1f} mm (width, depth, height as it is printed)</p>\n",
                        report.size_mm[0], report.size_mm[1], report.size_mm[2]);
    add_customer_verdict(html, report);
    add_customer_warnings(html, report);
    // A prediction of a body keeps the steps of its cells (docs/predict.md).
    const bool is_body = is_judged(report) && !report.verdict->sides.empty();
    html += fmt::format(
        "<footer>Colours on a screen are seen by its own light; a print is seen by that of its room.{}"
        "</footer>\n",
        is_body ? " Fine stripes along curved faces come from how the picture was computed." : "");
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace voxtone::io
