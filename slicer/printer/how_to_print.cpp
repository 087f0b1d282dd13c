// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/how_to_print.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "io/files/base64.h"
#include "io/files/markup.h"
#include "io/layers/stack_folder.h"
#include "io/pictures/picture_writer.h"
#include "io/printer/printer_folder.h"

namespace voxtone::slicer {

namespace {

using io::html_text;

constexpr io::Rgb tray_rgb{0x3a, 0x3c, 0x40};

constexpr const char* style =
    "ol > li { margin: .9rem 0; max-width: 52rem; }\nol { padding-left: 1.4rem; margin: 0; }\n"
    "li .table { margin: .5rem 0; }\nli th.n { white-space: normal; }\nfigure svg { display: block; width: 100%; "
    "height: auto; max-height: 44rem; background: #3a3c40; "
    "border-radius: 8px; }\n.two { display: grid; grid-template-columns: minmax(0, 3fr) minmax(0, 2fr); gap: 1.5rem; "
    "align-items: start; }\n@media (max-width: 50rem) { .two { grid-template-columns: minmax(0, 1fr); } }\n"
    "@media print { .warnings { border: 2px solid; } }\n";

bool has_layers(const io::StackOutputs& o) { return o.png || !(o.gcvf || o.resin_bitmaps != io::ResinBitmaps::none); }

std::string rgb_text(const io::Rgb& c) { return fmt::format("{}, {}, {}", c[0], c[1], c[2]); }

std::string slice_name(const io::StackDescription& stack, std::uint32_t index) {
    return std::filesystem::path(stack.layer_path(index)).filename().string();
}

std::string stem_of(const io::StackDescription& stack) {
    const std::string name = slice_name(stack, 0);
    return name.substr(0, name.find_first_of("0123456789"));
}

std::string row(const std::string& what, const std::string& value) {
    return fmt::format("<tr><td>{}</td><td class=\"value\"><b>{}</b></td></tr>\n", html_text(what), html_text(value));
}

std::string cards(const io::StackDescription& stack, const PrinterProfile& printer) {
    const auto card = [](const char* what, const std::string& value, const std::string& small) {
        return fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n", what, html_text(value),
                           html_text(small));
    };
    return "<dl class=\"cards\">\n" + card("Printer and mode", printer.name, printer.id) +
           card("Layer thickness", fmt::format("{:g} um", stack.pitch_um[2]),
                fmt::format("{} layers, {:.2f} mm high", stack.layers, stack.size_mm[2])) +
           card("Size",
                fmt::format("{:.2f} x {:.2f} x {:.2f} mm", stack.size_mm[0], stack.size_mm[1], stack.size_mm[2]),
                "width, depth, height; support comes on top of it") +
           "</dl>\n";
}

std::string warnings(const PrinterProfile& printer, const HowToPrint& what) {
    std::string items;
    for (const std::string& name : what.missing)
        items += fmt::format("<li><b>{} is not in this print</b>: it failed, and somebody waits for it</li>\n",
                             html_text(name));
    if (what.remarks.empty())
        items += fmt::format(
            "<li>First print on this machine? Print the marker first, which shows whether prints come out mirrored and "
            "whether each resin is where it was meant: <code>voxtone target marker --printer {} -o "
            "marker</code></li>\n",
            html_text(printer.id));
    for (const std::string& walls : what.fragile) items += "<li><b>Wash with care.</b> " + html_text(walls) + "</li>\n";
    for (const std::string& warning : printer.warnings()) items += "<li>" + html_text(warning) + "</li>\n";
    if (items.empty()) return {};
    return "<section class=\"warnings\">\n<h2>Before you begin</h2>\n<ul>\n" + items + "</ul>\n</section>\n";
}

/// Which pixels are printed: the formats' are each other's negatives.
std::string resin_pixels_text(io::ResinBitmaps bitmaps) {
    if (bitmaps == io::ResinBitmaps::tiff1)
        return " (TIFF of one bit, min-is-white: <b>black is resin, white is none</b>)";
    if (bitmaps == io::ResinBitmaps::png1) return " (PNG of one bit: <b>white is resin, black is none</b>)";
    return {};
}

std::string files_step(const io::StackDescription& stack, const io::StackOutputs& o) {
    std::string text = "<b>Copy this folder</b> to the computer of the printer, as it is. Beside this page it holds ";
    std::vector<std::string> parts;
    if (o.gcvf) parts.push_back("<b>stack.gcvf</b>, the whole print in one file");
    if (has_layers(o))
        parts.push_back(fmt::format("<b>layers</b>, with {} pictures from {} (the lowest) to {} and nothing else",
                                    stack.layers, slice_name(stack, 0), slice_name(stack, stack.layers - 1)));
    if (o.resin_bitmaps != io::ResinBitmaps::none)
        parts.push_back("<b>resins</b>, with one bitmap per resin and layer in a folder for each resin" +
                        resin_pixels_text(o.resin_bitmaps));
    for (std::size_t p = 0; p < parts.size(); ++p)
        text += (p == 0 ? "" : p + 1 == parts.size() ? ", and " : ", ") + parts[p];
    return text + ". A file that is added, left out or changed makes another print, or none.";
}

/// What is typed into the printer's program, or shown by it.
std::string values_table(const io::StackDescription& stack, bool of_layers) {
    const std::string names =
        of_layers ? row("Names of the slices", fmt::format("{}NUMBER.png", stem_of(stack))) +
                        row("First and last number, without gaps",
                            fmt::format("{} to {}", stack.first_layer, stack.first_layer + stack.layers - 1))
                  : std::string();
    return "<div class=\"table\"><table>\n" + names + row("Number of slices", fmt::format("{}", stack.layers)) +
           row("Width and height of a slice", fmt::format("{} x {} px", stack.size_px[0], stack.size_px[1])) +
           row("Resolution, columns and rows",
               fmt::format("{:.6g} x {:.6g} dpi (a pixel is {:.3f} x {:.3f} um)", 25400 / stack.pitch_um[0],
                           25400 / stack.pitch_um[1], stack.pitch_um[0], stack.pitch_um[1])) +
           row("Slice thickness", fmt::format("{:g} um = {:g} mm", stack.pitch_um[2], stack.pitch_um[2] / 1000)) +
           row("Background, where nothing is printed", rgb_text(stack.background_rgb)) + "</table></div>\n";
}

std::string load_step(const io::StackDescription& stack, const PrinterProfile& printer, const io::StackOutputs& o) {
    const std::string program =
        printer.utility.empty() ? "the program that takes bitmaps for this printer" : printer.utility;
    std::string text = fmt::format("<b>Open {}.</b> ", html_text(program));
    if (!printer.mode.empty())
        text += fmt::format("Choose the mode <b>{}</b>; in another mode layers are skipped or printed twice. ",
                            html_text(printer.mode));
    if (o.gcvf)
        text += fmt::format("Load stack.gcvf{}. The file says these values itself; compare what the program shows:\n",
                            has_layers(o) ? ", or the folder layers where it is not taken" : "");
    else
        text += fmt::format("Load the folder {} with these values:\n", has_layers(o) ? "layers" : "resins");
    return text + values_table(stack, has_layers(o));
}

std::string resins_step(const io::StackDescription& stack, const io::StackOutputs& o) {
    std::string rows;
    for (const auto& resin : stack.resins)
        rows += fmt::format(
            "<tr><td class=\"code\"><span class=\"swatch\" style=\"background:#{0:02x}{1:02x}{2:02x}\"></span>{0}, "
            "{1}, "
            "{2}</td><td><b>{3}</b></td><td>{4}</td><td class=\"n\">{5} ml</td></tr>\n",
            resin.rgb[0], resin.rgb[1], resin.rgb[2], html_text(resin.name), html_text(resin.role),
            resin.ml > 0 && resin.ml < 0.095 ? fmt::format("{:.1g}", resin.ml) : fmt::format("{:.2f}", resin.ml));
    std::string how;
    if (o.gcvf) how = "stack.gcvf names the resin of each colour: compare it with what is loaded. ";
    if (has_layers(o)) how += "With the folder layers give each colour its resin by hand, all of them. ";
    if (how.empty()) how = "Give each folder of bitmaps its resin. ";
    return fmt::format(
        "<b>Assign the resins.</b> {}The colours are only names; two that change places spoil the print.\n"
        "<div class=\"table\"><table>\n<thead><tr><th>R, G, B in the pictures</th><th>Resin, as the machine calls "
        "it</th><th>Role</th><th class=\"n\">Needed, without support</th></tr></thead>\n<tbody>\n{}</tbody>\n"
        "</table></div>\n",
        how, rows);
}

std::string mirrors_step(const io::StackDescription& stack) {
    std::string done;
    const io::Orientation& o = stack.orientation;
    if (o.swap_xy) done += "rows and columns exchanged";
    if (o.flip_x) done += std::string(done.empty() ? "" : ", ") + "columns mirrored (flip_x)";
    if (o.flip_y) done += std::string(done.empty() ? "" : ", ") + "rows mirrored (flip_y)";
    return fmt::format(
        "<b>Mirrors.</b> The pictures are written with {}. Seen from above the print must come out as the picture on "
        "this "
        "page shows it. Does it come out mirrored or turned, do not mirror it in the program and in the profile both: "
        "set "
        "flip_x, flip_y or swap_xy in the printer's profile as the marker told, and slice again.",
        done.empty() ? "no mirror and no exchange: columns run to the right, the top row lies at the back"
                     : html_text(done) + ", as the printer's profile asks");
}

std::string support_step() {
    return "<b>Support</b> is not in these files: the printer's program adds it below everything that hangs over. Keep "
           "it "
           "on. It takes resin of its own, which the table does not count.";
}

std::string finish_advice(const PartFinish& part) {
    constexpr double little = 0.1;
    if (part.coloured_mm2 <= 0) return "either: nothing of it is coloured";
    if (part.coloured_matt_mm2 < 0.5) return "glossy: support touches no coloured face";
    if (part.coloured_matt_mm2 < little * part.coloured_mm2) return "glossy: little of its colour is touched";
    return "matt, to look alike all over; or glossy, if what is touched is not looked at";
}

std::string cm2(double mm2) { return fmt::format("{:.2f} cm<sup>2</sup>", mm2 / 100); }

std::string touched_text(const PartFinish& part) {
    if (part.coloured_matt_mm2 < 0.5) return "none";
    const double up_mm2 = part.coloured_matt_mm2 - part.coloured_down_mm2;
    std::string text = cm2(part.coloured_matt_mm2);
    text += up_mm2 < 0.05 * part.coloured_matt_mm2 ? ", facing down"
            : part.coloured_down_mm2 < 0.05 * part.coloured_matt_mm2
                ? ", upright below what hangs over"
                : fmt::format(": {} facing down, the rest upright below what hangs over", cm2(part.coloured_down_mm2));
    if (part.coloured_matt_height_mm[1] < 0.05) return text + "; on the tray itself";
    return text + fmt::format("; {:.1f} to {:.1f} mm above the tray", part.coloured_matt_height_mm[0],
                              part.coloured_matt_height_mm[1]);
}

std::string finish_step(const std::vector<PartFinish>& parts) {
    std::string text =
        "<b>Glossy or matt</b>: set it for each part. In the glossy mode faces that support or the tray touches come "
        "out "
        "matt all the same, and look paler than the rest; in the matt mode all faces are covered and look alike.";
    if (parts.empty()) return text;
    std::string rows;
    for (const PartFinish& part : parts)
        rows +=
            fmt::format("<tr><td>{}{}</td><td class=\"code\">{:.2f} of {}</td><td>{}</td><td>{}</td></tr>\n",
                        html_text(part.name), part.copies == 1 ? "" : fmt::format(" ({} times)", part.copies),
                        part.matt_mm2 / 100, cm2(part.surface_mm2), touched_text(part), html_text(finish_advice(part)));
    return text + fmt::format(
                      "\n<div class=\"table\"><table>\n<thead><tr><th>Part</th><th>On support or tray</th><th>Of "
                      "it coloured</th><th>Advice</th></tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n<p "
                      "class=\"soft\">Counted for support straight below what hangs over, down to the tray; the "
                      "printer's program may widen it.</p>\n",
                      rows);
}

std::string figure(const io::StackDescription& stack, const PictureFromAbove& from_above) {
    if (from_above.picture.codes.empty()) return {};
    const bool swapped = stack.orientation.swap_xy;
    const double w = stack.size_mm[swapped ? 1 : 0], h = stack.size_mm[swapped ? 0 : 1], edge = 0.06 * std::max(w, h);
    std::string marks;
    const double font = 0.035 * std::max(w, h), of_letter = 0.62;
    const std::string back = fmt::format("back, {:.1f} mm", w);
    // A tray that is narrower than what is said of it gets room beside it.
    const double side = std::max(edge, (of_letter * font * double(back.size()) - w) / 2);
    for (std::size_t n = 0; n < stack.members.size(); ++n) {
        const io::StackMember& member = stack.members[n];
        for (std::size_t copy = 0; copy < member.boxes_mm.size(); ++copy) {
            const std::array<double, 6>& box = member.boxes_mm[copy];
            // Copies are told apart: "2.1", "2.2".
            const std::string number = member.boxes_mm.size() > 1 ? fmt::format("{}.{}", n + 1, copy + 1)
                                                                  : fmt::format("{}", n + 1),
                              whole = number + " " + member.name;
            // Where the name finds no room the number does, at half the part's height at least.
            const auto fits = [&](const std::string& words) {
                return of_letter * 0.8 * font * double(words.size()) <= box[3] - box[0];
            };
            const double size =
                fits(number) && 0.8 * font < box[4] - box[1]
                    ? 0.8 * font
                    : std::min(0.8 * (box[4] - box[1]), (box[3] - box[0]) / (of_letter * double(number.size())));
            const std::string& words = fits(whole) ? whole : number;
            // On a plate, or it would be lost on what is printed there.
            marks += fmt::format(
                "<rect x=\"{0:.3f}\" y=\"{1:.3f}\" width=\"{2:.3f}\" height=\"{3:.3f}\" fill=\"none\" "
                "stroke=\"#6cc3df\" stroke-width=\"{4:.3f}\"/>\n<rect x=\"{0:.3f}\" y=\"{1:.3f}\" width=\"{5:.3f}\" "
                "height=\"{6:.3f}\" fill=\"#1c1d1f\"/>\n<text x=\"{7:.3f}\" y=\"{8:.3f}\" font-size=\"{9:.3f}\" "
                "fill=\"#fff\" font-family=\"sans-serif\">{10}</text>\n",
                box[0], h - box[4], box[3] - box[0], box[4] - box[1], 0.004 * std::max(w, h),
                std::min(box[3] - box[0], (of_letter * double(words.size()) + 0.3) * size),
                std::min(box[4] - box[1], 1.4 * size), box[0] + 0.2 * size, h - box[4] + 1.1 * size, size,
                html_text(words));
        }
    }
    const auto text = [&](double x, double y, const char* anchor, const std::string& words) {
        marks += fmt::format(
            "<text x=\"{:.3f}\" y=\"{:.3f}\" font-size=\"{:.3f}\" fill=\"#fff\" text-anchor=\"{}\" "
            "font-family=\"sans-serif\">{}</text>\n",
            x, y, font, anchor, html_text(words));
    };
    text(w / 2, -0.3 * edge, "middle", back);
    text(w / 2, h + 0.75 * edge, "middle", "front");
    marks += fmt::format("<g transform=\"translate({:.3f} {:.3f}) rotate(-90)\">", -0.35 * edge, h / 2);
    text(0, 0, "middle", fmt::format("{:.1f} mm", h));
    marks += "</g>\n";
    return fmt::format(
        "<figure><svg viewBox=\"{:.3f} {:.3f} {:.3f} {:.3f}\" role=\"img\" aria-label=\"The print from "
        "above\">\n<image "
        "x=\"0\" y=\"0\" width=\"{:.3f}\" height=\"{:.3f}\" preserveAspectRatio=\"none\" "
        "href=\"data:image/png;base64,{}\"/>\n{}</svg>\n<figcaption>So it must lie on the tray, <b>seen from "
        "above</b>: "
        "{}. Dark: nothing.</figcaption></figure>\n",
        -side, -edge, w + 2 * side, h + 2 * edge, w, h, io::base64(io::png_bytes(from_above.picture)), marks,
        html_text(from_above.caption));
}

std::string list_of(const std::vector<std::string>& steps) {
    std::string items;
    for (const std::string& step : steps) items += "<li>" + step + "</li>\n";
    return "<ol>\n" + items + "</ol>\n";
}

std::string remarks(const std::vector<std::string>& sentences) {
    if (sentences.empty()) return {};
    std::string items;
    for (const std::string& sentence : sentences) items += "<li>" + html_text(sentence) + "</li>\n";
    return "<section>\n<h2>Once it is printed</h2>\n<ul>\n" + items + "</ul>\n</section>\n";
}

std::string members(const io::StackDescription& stack) {
    if (stack.members.empty()) return {};
    std::string rows;
    for (std::size_t n = 0; n < stack.members.size(); ++n) {
        const io::StackMember& member = stack.members[n];
        std::string size = "-";
        if (!member.boxes_mm.empty()) {
            const auto& b = member.boxes_mm.front();
            size = fmt::format("{:.1f} x {:.1f} x {:.1f} mm", b[3] - b[0], b[4] - b[1], b[5] - b[2]);
        }
        rows += fmt::format(
            "<tr><td class=\"n\">{}</td><td>{}{}</td><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{:.2f} "
            "ml</td><td>{}</td></tr>\n",
            n + 1, html_text(member.name), member.about.empty() ? "" : "<br>" + html_text(member.about),
            member.boxes_mm.size() > 1 ? fmt::format("{0} ({1}.1 to {1}.{0})", member.boxes_mm.size(), n + 1)
                                       : fmt::format("{}", member.boxes_mm.size()),
            size, member.ml, member.verdict.empty() ? "not predicted by itself" : html_text(member.verdict));
    }
    return "<section>\n<h2>What is on the tray</h2>\n<div class=\"table\"><table>\n<thead><tr><th "
           "class=\"n\">No.</th><th>Part</th><th "
           "class=\"n\">Copies</th><th>Size of one</th><th class=\"n\">All of them</th><th>Will it look as asked</th>"
           "</tr></thead>\n<tbody>\n" +
           rows + "</tbody>\n</table></div>\n</section>\n";
}

std::string notes(const PrinterProfile& printer) {
    if (printer.notes.empty()) return {};
    std::string items;
    for (const std::string& note : printer.notes) items += "<li>" + html_text(note) + "</li>\n";
    return "<section>\n<h2>What is known of this printer</h2>\n<ul>\n" + items + "</ul>\n</section>\n";
}

}  // namespace

std::size_t pixel_of_column(const io::StackDescription& stack, std::uint32_t i, std::uint32_t j) {
    std::uint32_t width = stack.size_px[0], height = stack.size_px[1];
    if (stack.orientation.swap_xy) std::swap(width, height);
    std::uint32_t column = i, line = height - 1 - j;
    if (stack.orientation.swap_xy) std::swap(column, line), std::swap(width, height);
    if (stack.orientation.flip_x) column = width - 1 - column;
    if (stack.orientation.flip_y) line = height - 1 - line;
    return std::size_t{line} * width + column;
}

PictureFromAbove picture_from_above(const io::StackDescription& stack, const io::TopmostLayers& topmost,
                                    const ColourOfColumn& colour, std::string caption) {
    const bool swapped = stack.orientation.swap_xy;
    const std::uint32_t columns = stack.size_px[swapped ? 1 : 0], rows = stack.size_px[swapped ? 0 : 1];
    const double w = stack.size_mm[swapped ? 1 : 0], h = stack.size_mm[swapped ? 0 : 1];
    constexpr double longest_px = 480;
    // No more than there are columns and rows: each pixel has one.
    const auto pixels = [&](double mm, std::uint32_t most) {
        const auto wanted = static_cast<std::uint32_t>(std::lround(longest_px * mm / std::max(w, h)));
        return std::clamp<std::uint32_t>(wanted, 1, most);
    };
    struct Seen {
        std::uint32_t i = 0, j = 0;
        std::uint16_t top = 0;
    };
    const std::uint32_t width = pixels(w, columns), height = pixels(h, rows);
    std::vector<Seen> seen(std::size_t{width} * height);
    const auto tops = topmost.indices();
    for (std::uint32_t j = 0; j < rows; ++j) {
        const std::uint64_t y = std::uint64_t{rows - 1 - j} * height / rows;
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint16_t top = tops[pixel_of_column(stack, i, j)];
            Seen& highest = seen[y * width + std::uint64_t{i} * width / columns];
            if (top > highest.top) highest = {i, j, top};
        }
    }
    PictureFromAbove result{{width, height, 3, {}}, std::move(caption)};
    for (const Seen& one : seen) {
        const io::Rgb c = one.top == 0 ? tray_rgb : colour(one.i, one.j, one.top);
        result.picture.codes.insert(result.picture.codes.end(), c.begin(), c.end());
    }
    return result;
}

std::string how_to_print_page(const io::StackDescription& stack, const PrinterProfile& printer,
                              const HowToPrint& what) {
    std::vector<std::string> steps{files_step(stack, what.outputs),
                                   load_step(stack, printer, what.outputs),
                                   resins_step(stack, what.outputs),
                                   mirrors_step(stack),
                                   support_step(),
                                   finish_step(what.parts)};
    const std::string picture = figure(stack, what.from_above);
    return io::page_start(
               "How to print " + what.title, std::string(io::page_asset("style")) + style,
               "<p class=\"soft\">For who stands at the printer. All of this comes from the printer's profile "
               "and the sliced print.</p>\n") +
           cards(stack, printer) + warnings(printer, what) + "<section>\n" +
           (picture.empty() ? list_of(steps)
                            : "<div class=\"two\">\n<div>" + list_of(steps) + "</div>\n" + picture + "</div>\n") +
           "</section>\n" + members(stack) + remarks(what.remarks) + notes(printer) +
           "</main>\n<footer>Written by voxtone. <code>voxtone verify</code> checks this "
           "folder, wherever it was copied.</footer>\n" +
           io::manifest_for_page(io::manifest_text(stack)) + "</body>\n</html>\n";
}

}  // namespace voxtone::slicer
