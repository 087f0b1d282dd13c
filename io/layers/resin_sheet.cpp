// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/layers/resin_sheet.h"

#include <algorithm>

#include <fmt/core.h>

#include "voxtone/io/files/markup.h"

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
            "<tr><td style=\"background:#{0:02x}{1:02x}{2:02x}\"></td><td>{3}</td><td>{4}</td><td>{0}, {1}, {2}</td>"
            "<td>#{0:02x}{1:02x}{2:02x}</td><td class=\"number\">{5:.3f}</td></tr>\n",
            resin.rgb[0], resin.rgb[1], resin.rgb[2], html_text(resin.name), html_text(resin.role), resin.ml);
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Resin assignment</title>\n"
        "<style>body{{font:16px sans-serif;margin:2em}}table{{border-collapse:collapse}}td,th{{border:1px solid #888;"
        "padding:.4em .8em;text-align:left}}td:first-child{{width:4em;print-color-adjust:exact;"
        "-webkit-print-color-adjust:exact}}.number{{text-align:right}}</style>\n"
        "<h1>Resin assignment for {}</h1>\n<p>{}</p>\n"
        "<table>\n<tr><th>colour</th><th>resin</th><th>role</th><th>R, G, "
        "B</th><th>hex</th><th>ml</th></tr>\n{}</table>\n"
        "<p>Background {}, {}, {}: no material. Support is added by the printer's software and not counted "
        "here.</p>\n</html>\n",
        html_text(stack.printer), html_text(size_line(stack)), rows, stack.background_rgb[0], stack.background_rgb[1],
        stack.background_rgb[2]);
}

}  // namespace voxtone::io
