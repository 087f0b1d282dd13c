// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/marker_print.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/files/json_writer.h"
#include "slicer/print/dot_letters.h"

namespace voxtone::slicer {

namespace {

namespace marker_mm {
constexpr double width = 52, depth = 32, plate = 3, raised = 0.5, tower = 1.5, tower_edge = 5, inlay = 0.6;
constexpr double square = 6, square_pitch = 7;
}  // namespace marker_mm

/// Boxes of one resin each.
class Marker {
public:
    explicit Marker(std::size_t resins) : resins_(resins) {}

    void box(std::size_t resin, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
        std::vector<double> fractions(resins_, 0.0);
        fractions[resin] = 1;
        boxes_.push_back({from, to, std::move(fractions)});
    }
    /// Seen from above: `x`, `y`: lower left corner. `from_below`: to be read from there.
    void text(std::string_view words, std::size_t resin, double x, double y, double dot_mm, double z_from, double z_to,
              bool from_below = false) {
        const double step = (letter_columns + 1) * dot_mm, length = step * double(words.size()) - dot_mm;
        for (std::size_t n = 0; n < words.size(); ++n) {
            const auto rows = dot_letter(words[n]);
            for (int row = 0; row < letter_rows; ++row)
                for (int column = 0; column < letter_columns; ++column) {
                    if (!(rows[std::size_t(row)] >> (letter_columns - 1 - column) & 1)) continue;
                    const double along = double(n) * step + column * dot_mm;
                    const double left = from_below ? x + length - along - dot_mm : x + along;
                    const double low = y + (letter_rows - 1 - row) * dot_mm;
                    box(resin, {left, low, z_from}, {left + dot_mm, low + dot_mm, z_to});
                }
        }
    }
    [[nodiscard]] std::vector<PrintBox> take() { return std::move(boxes_); }

private:
    std::size_t resins_;
    std::vector<PrintBox> boxes_;
};

double luma(const io::Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

std::size_t extreme(const std::vector<io::Rgb>& colours, bool lightest) {
    const auto darker = [](const io::Rgb& a, const io::Rgb& b) { return luma(a) < luma(b); };
    return std::size_t((lightest ? std::max_element(colours.begin(), colours.end(), darker)
                                 : std::min_element(colours.begin(), colours.end(), darker)) -
                       colours.begin());
}

/// The role's place, or where it is not loaded the lightest or darkest resin in the bitmaps' colours.
std::size_t resin_of(const std::vector<std::string>& roles, const char* role, const std::vector<io::Rgb>& colours,
                     bool lightest) {
    const auto found = std::find(roles.begin(), roles.end(), role);
    return found != roles.end() ? std::size_t(found - roles.begin()) : extreme(colours, lightest);
}

/// An F of strokes 3 mm wide, 12 x 18 mm.
void add_f(Marker& marker, std::size_t ink, double x, double y) {
    constexpr double top = marker_mm::plate + marker_mm::raised;
    marker.box(ink, {x, y, marker_mm::plate}, {x + 3, y + 18, top});
    marker.box(ink, {x, y + 15, marker_mm::plate}, {x + 12, y + 18, top});
    marker.box(ink, {x, y + 7.5, marker_mm::plate}, {x + 9, y + 10.5, top});
}

/// Steps that narrow to a point.
void add_arrow(Marker& marker, std::size_t ink, double x, double y, double length, bool upward) {
    constexpr double top = marker_mm::plate + marker_mm::raised, shaft = 0.5, head = 2.5, step = 0.25;
    const auto put = [&](double from, double to, double half) {
        if (upward)
            marker.box(ink, {x - half, y + from, marker_mm::plate}, {x + half, y + to, top});
        else
            marker.box(ink, {x + from, y - half, marker_mm::plate}, {x + to, y + half, top});
    };
    put(0, length - head, shaft);
    for (double at = 0; at < head - step / 2; at += step)
        put(length - head + at, length - head + at + step, 1.5 * (1 - at / head));
}

/// The role in the middle of a square, as much of it as there is room for. Framed: of the resin of the plate.
void add_square(Marker& marker, std::size_t resin, std::size_t ink, bool framed, const std::string& role, double x,
                double y) {
    constexpr double top = marker_mm::plate + marker_mm::raised, below = 1.5, frame = 0.4;
    if (framed)
        marker.box(ink, {x - frame, y - frame, marker_mm::plate},
                   {x + marker_mm::square + frame, y + marker_mm::square + frame, top});
    marker.box(resin, {x, y, marker_mm::plate - below}, {x + marker_mm::square, y + marker_mm::square, top});
    const std::string words = role.substr(0, 3);
    const double dots = double(words.size()) * (letter_columns + 1) - 1;
    const double dot = std::min(0.6, (marker_mm::square - 0.8) / dots);
    marker.text(words, ink, x + (marker_mm::square - dots * dot) / 2, y + (marker_mm::square - letter_rows * dot) / 2,
                dot, top - marker_mm::inlay, top);
}

void expect_roles(const std::vector<std::string>& roles) {
    constexpr std::size_t most = 8;
    if (roles.size() < 2 || roles.size() > most)
        throw InputError(
            fmt::format("marker: of {} resins; it takes 2 to {}, one for the plate and others to see on it: "
                        "name them with --load",
                        roles.size(), most));
    for (const std::string& role : roles)
        if (role.empty() || std::count(roles.begin(), roles.end(), role) > 1)
            throw InputError(fmt::format("marker: the resin '{}' is named twice, or not at all (--load)", role));
}

const std::vector<std::string>& how_to_read() {
    static const std::vector<std::string> sentences{
        "Lay the print before you as it lay on the tray, the same side up, and compare it with the picture.",
        "Like the picture: nothing is to be set.",
        "F and TOP mirrored left to right (the tower on the right, in front): set flip_x in the printer's "
        "profile.",
        "F and TOP mirrored front to back (the tower on the left, at the back): set flip_y.",
        "Turned by half (the tower on the right, at the back, the F can be read on its head): set flip_x "
        "and flip_y.",
        "The long side runs from front to back: set swap_xy, and print the marker again.",
        "BOTTOM lies up: the layers were printed in the wrong order.",
        "A square that is not of the resin whose letter it has: two resins changed places when colours were "
        "assigned."};
    return sentences;
}

}  // namespace

BoxPrint marker_boxes(const std::vector<std::string>& roles, const PrinterProfile& printer) {
    expect_roles(roles);
    const std::vector<io::Rgb> colours = printer.display_colours(roles);
    const std::size_t white = resin_of(roles, "W", colours, true);
    std::size_t ink = resin_of(roles, "K", colours, false);
    if (ink == white) ink = white == 0 ? 1 : 0;
    Marker marker(roles.size());
    constexpr double top = marker_mm::plate + marker_mm::raised, z_tower = marker_mm::plate + marker_mm::tower;
    marker.box(white, {0, 0, 0}, {marker_mm::width, marker_mm::depth, marker_mm::plate});
    marker.box(ink, {0, 0, marker_mm::plate}, {marker_mm::tower_edge, marker_mm::tower_edge, z_tower});
    add_f(marker, ink, 8, 10);
    marker.text("TOP", ink, 23, 22, 1, marker_mm::plate, top);
    add_arrow(marker, ink, 8, 4, 9.5, false);
    marker.text("X", ink, 18.5, 1.5, 0.6, marker_mm::plate, top);
    add_arrow(marker, ink, 2.5, 8, 12, true);
    marker.text("Y", ink, 1, 22, 0.6, marker_mm::plate, top);
    for (std::size_t r = 0; r < roles.size(); ++r)
        add_square(marker, r, r == ink ? white : ink, r == white, roles[r],
                   23 + marker_mm::square_pitch * double(r % 4), 13 - marker_mm::square_pitch * double(r / 4));
    marker.text("BOTTOM", ink, 9, 10, 1, 0, marker_mm::inlay, true);
    return {marker.take(), {marker_mm::width, marker_mm::depth, z_tower}, roles, 1, "the marker", how_to_read()};
}

JobResult run_marker_job(const MarkerJob& job, Progress& progress) {
    if (job.out.empty()) throw UsageError("target marker: name the output folder: -o FOLDER");
    const PrinterProfile printer = find_printer(job.printer);
    for (const std::string& warning : printer.warnings()) progress.warn(warning);
    const BoxPrint print = marker_boxes(job.roles.empty() ? printer.default_roles : job.roles, printer);
    const io::StackDescription stack = print_boxes(print, printer, job.out, job.outputs, job.overwrite, progress);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-marker").add("version", 1).add("folder", job.out);
    json.add("printer", printer.id).add("roles", print.roles).add("size_mm", stack.size_mm);
    json.add("layers", stack.layers).add("content_sha256", stack.content_sha256).end_object();
    return {
        json.text(),
        fmt::format("{0}: {1:.0f} x {2:.0f} x {3:.1f} mm, {4} layers; resins {5}\n  print {0}/printer, and compare it "
                    "with the picture in {0}/printer/HOW-TO-PRINT.html\n",
                    job.out, stack.size_mm[0], stack.size_mm[1], stack.size_mm[2], stack.layers,
                    fmt::join(print.roles, ", "))};
}

}  // namespace voxtone::slicer
