// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/resin_sheet.h"

#include <algorithm>

#include <fmt/core.h>

#include "io/files/markup.h"

namespace voxtone::io {
namespace {

std::string size_line(const StackDescription& stack) {
    return fmt::format(
        "{} layers of {} x {} px = {:.2f} x {:.2f} x {:.2f} mm; a pixel is {:.2f} x {:.2f} um ({:.0f} x {:.0f} dpi), a "
        "layer {:g} um",
        stack.layers, stack.size_px[0], stack.size_px[1], stack.size_mm[0], stack.size_mm[1], stack.size_mm[2],
        stack.pitch_um[0], stack.pitch_um[1], 25400 / stack.pitch_um[0], 25400 / stack.pitch_um[1], stack.pitch_um[2]);
}

}  // namespace

std::string resin_sheet_text(const StackDescription& stack) {
    std::size_t widest = 5;
    for (const auto& resin : stack.resins) widest = std::max(widest, resin.name.size());
    std::string text = fmt::format("Resin assignment for {}\n{}\n\n{:<{}}  role  R   G   B    #hex         ml\n",
                                   stack.printer, size_line(stack), "resin", widest);
    for (const auto& resin : stack.resins)
        text += fmt::format("{:<{}}  {:<4}  {:<3} {:<3} {:<3}  #{:02x}{:02x}{:02x} {:>9.3f}\n", resin.name, widest,
                            resin.role, resin.rgb[0], resin.rgb[1], resin.rgb[2], resin.rgb[0], resin.rgb[1],
                            resin.rgb[2], resin.ml);
    text += fmt::format(
        "\nBackground {} {} {}: no material. Support is added by the printer's software and not counted here.\n",
        stack.background_rgb[0], stack.background_rgb[1], stack.background_rgb[2]);
    return text;
}

std::string resin_sheet_html(const StackDescription& stack) {
    std::string rows;
    for (const auto& resin : stack.resins)
        rows += fmt::format(
            "<tr><td class=\"code\"><span class=\"swatch\" style=\"background:#{0:02x}{1:02x}{2:02x}\"></span>{0}, "
            "{1}, "
            "{2}</td><td class=\"wide-only\">#{0:02x}{1:02x}{2:02x}</td><td>{3}</td><td>{4}</td>"
            "<td class=\"n\">{5:.3f}</td></tr>\n",
            resin.rgb[0], resin.rgb[1], resin.rgb[2], html_text(resin.name), html_text(resin.role), resin.ml);
    return page_start("Resin assignment for " + stack.printer, page_asset("style"),
                      fmt::format("<p class=\"soft\">{}</p>\n", html_text(size_line(stack)))) +
           fmt::format(
               "<section>\n<div class=\"table\"><table>\n<thead><tr><th class=\"code\">R, G, B</th><th "
               "class=\"wide-only\">Hex</th><th>Resin</th><th>Role</th><th class=\"n\">ml</th></tr></thead>\n"
               "<tbody>\n{}</tbody>\n</table></div>\n<p class=\"soft\">Background {}, {}, {}: no material. Support is "
               "added by the printer's software and not counted here.</p>\n</section>\n</main>\n</body>\n</html>\n",
               rows, stack.background_rgb[0], stack.background_rgb[1], stack.background_rgb[2]);
}

}  // namespace voxtone::io
