// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/region_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "base/parallel.h"
#include "optics/colour/colour.h"
#include "slicer/colour/evenness.h"
#include "slicer/colour/printed_codes.h"
#include "slicer/colour/printed_labels.h"
#include "slicer/colour/slab_picture.h"
#include "slicer/colour/type_size.h"

namespace voxtone::slicer {

namespace {

using halftone::ColourRegion;
using halftone::RegionKind;

constexpr double legible = 0.5;    // contrast, ISO 9241-303
constexpr double ground_mm = 0.5;  // what type is seen against
constexpr double least_mm2 = 0.5;  // of a region that a word is said of

/// What is narrow on a model is a leg or a stripe, in a photograph a shadow, and seen by its colour; letters on a model
/// are found as small type.
const char* kind_word(RegionKind kind, bool is_page) {
    if (kind == RegionKind::paper) return "paper";
    return kind == RegionKind::strokes && is_page ? "type and lines" : "solid";
}

std::string text_of(const Eigen::Vector3f& rgb) {
    std::array<int, 3> code{};
    for (Eigen::Index c = 0; c < 3; ++c)
        code[static_cast<std::size_t>(c)] =
            static_cast<int>(std::lround(255 * optics::srgb_encode(std::clamp(static_cast<double>(rgb[c]), 0.0, 1.0))));
    return fmt::format("{} ({}, {}, {})", colour_word(rgb), code[0], code[1], code[2]);
}

double luminance(const std::vector<Eigen::Vector3f>& rgb, const optics::Surface& surface,
                 const std::vector<std::uint32_t>& cells) {
    double sum = 0, area = 0;
    for (const std::uint32_t i : cells) {
        const auto a = static_cast<double>(surface.cells[i].area_mm2);
        sum += a * static_cast<double>(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb[i].cwiseMax(0)));
        area += a;
    }
    return area > 0 ? sum / area : 0;
}

double contrast(double a, double b) { return a + b > 0 ? std::abs(a - b) / (a + b) : 0; }

/// The one that lies nearest to the middle of these cells.
std::uint32_t middle_of(const std::vector<std::uint32_t>& cells, const optics::Surface& surface) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    const auto centre = [&](std::uint32_t i) {
        const auto& c = surface.cells[i].centre_mm;
        return Eigen::Vector3d(c[0], c[1], c[2]);
    };
    for (const std::uint32_t i : cells) middle += centre(i) / static_cast<double>(cells.size());
    return *std::ranges::min_element(cells, {}, [&](std::uint32_t i) { return (centre(i) - middle).squaredNorm(); });
}

/// A row before those like it are joined to it.
struct Row {
    io::ReportRegion said;
    Eigen::Vector3f oklab = Eigen::Vector3f::Zero();    ///< of what was asked for
    Eigen::Vector3d printed = Eigen::Vector3d::Zero();  ///< linear sRGB
    std::optional<Eigen::Vector3d> asked_seen = {};     ///< linear sRGB: what the eye makes of what was asked for
    std::vector<std::uint32_t> cells;
};

Eigen::Vector3f oklab_of(const Eigen::Vector3f& rgb) {
    return optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0)).cast<float>();
}

void put_at(std::uint32_t cell, const optics::Surface& surface, io::ReportRegion& region) {
    for (std::size_t a = 0; a < 3; ++a) {
        region.place_mm[a] = double(surface.cells[cell].centre_mm[a]);
        region.normal[a] = double(surface.cells[cell].normal[a]);
    }
}

/// Per cell whether it is no fine detail, however much of its contrast light takes: of an area that is wide, on the
/// edge between two of them, or on that of letters and lines, which are judged as what they are. `least`: what is
/// smaller is no area.
std::vector<char> judged_areas(const JobPrediction& p, const halftone::CellNeighbours& cells, double least) {
    std::vector<int> area(p.target.size(), 0);
    std::vector<char> stroke(p.target.size(), 0);
    int count = 0;
    for (const ColourRegion& of : p.seen.regions) {
        if (of.area_mm2 < least) continue;
        ++count;
        for (const std::uint32_t i : of.cells)
            if (of.interior.size() < of.cells.size())
                area[i] = count;
            else
                stroke[i] = 1;
    }
    std::vector<char> judged(area.size());
    parallel_for(0, judged.size(), 256, [&](std::size_t i) {
        if (judged[i] = area[i] != 0; judged[i]) return;
        int first = 0;
        cells.visit_around(i, [&](std::size_t near) {
            cells.visit_around(near, [&](std::size_t other) {
                judged[i] = judged[i] || stroke[other];
                if (area[other] == 0) return;
                if (first == 0) first = area[other];
                judged[i] = judged[i] || area[other] != first;
            });
        });
    });
    return judged;
}

/// Fine detail of graphics that lost much of its contrast; nothing where that is hardly anywhere. Of a body also what
/// is painted on it too small for a word of its own: eyes, brows, a mouth.
std::optional<Row> lost_detail(const JobPrediction& p, const halftone::CellNeighbours& cells, bool is_picture) {
    constexpr float enough = 0.6f;
    // A black eye of 0.5 mm on white comes to 0.07.
    const float strong = is_picture ? 0.08f : 0.05f;
    const double least_lost_mm2 = is_picture ? 0.25 : 0.1;  // two eyes of 0.3 mm
    const optics::Surface& surface = p.predicted.surface;
    if (!is_graphics(p)) return std::nullopt;
    Row row;
    io::ReportRegion& region = row.said;
    double kept = 0;
    float most = 0;
    std::size_t worst = 0;
    const std::vector<char> judged = judged_areas(p, cells, is_picture ? 0 : least_mm2);
    for (std::size_t i = 0; i < p.seen.fine.size(); ++i) {
        const halftone::FineContrast& fine = p.seen.fine[i];
        if (judged[i] || fine.wanted < strong || fine.kept >= enough) continue;
        const auto area = static_cast<double>(surface.cells[i].area_mm2);
        region.area_mm2 += area, kept += area * static_cast<double>(fine.kept);
        row.cells.push_back(static_cast<std::uint32_t>(i));
        if (const float lost = fine.wanted * (1 - fine.kept); lost > most) most = lost, worst = i;
    }
    if (region.area_mm2 < least_lost_mm2) return std::nullopt;
    region.kind = "fine detail";
    region.asked = text_of(p.target[worst]);
    row.printed = p.predicted.rgb[worst].cast<double>();
    put_at(static_cast<std::uint32_t>(worst), surface, region);
    region.contrast = std::max(0.0, kept / region.area_mm2), region.contrast_asked = 1;
    region.why =
        fmt::format("keeps {:.2f} of its contrast: what is as fine as that is hard to make out", region.contrast);
    region.good = false;
    return row;
}

/// Of pictures: fine lines that run together, whether the eye would tell them apart from its distance or not.
std::optional<Row> lost_lines_row(const RegionSources& s, std::span<const PicturePage> pages) {
    const JobPrediction& p = s.prediction;
    const auto lost = s.is_picture && is_graphics(p) ? lost_lines(p, pages) : std::nullopt;
    if (!lost) return std::nullopt;
    Row row;
    row.cells = lost->cells;
    row.said.kind = "fine detail";
    row.said.asked = text_of(lost->asked);
    row.printed = p.predicted.rgb[lost->worst].cast<double>();
    put_at(lost->worst, p.predicted.surface, row.said);
    row.said.area_mm2 = lost->area_mm2;
    row.said.contrast = lost->kept, row.said.contrast_asked = 1;
    row.said.why = fmt::format("runs together: what is as fine as that keeps {:.2f} of its contrast", lost->kept);
    row.said.good = false;
    return row;
}

/// Whether more than half of the letters cannot be read, and they are what the page is there for.
bool is_little_else(const JobPrediction& p, const TypeSize& type) {
    // Of the page, in ink: an address on a card 0.03, small print of a cover 0.01, a logo's word 0.0085, a line below a
    // photograph 0.003.
    constexpr double part = 0.006;
    double all = 0;
    for (const optics::SurfaceCell& cell : p.predicted.surface.cells) all += double(cell.area_mm2);
    return 2 * type.unread > type.letters && type.told_mm2 > part * all;
}

/// What cannot be read for its size, or is pale.
std::optional<Row> small_type(const RegionSources& s, const std::optional<TypeSize>& type) {
    if (!type || type->is_read_well()) return std::nullopt;
    const JobPrediction& p = s.prediction;
    Row row;
    row.said.kind = "small type";
    row.said.asked = text_of(type->asked);
    row.printed = p.predicted.rgb[type->cell].cast<double>();
    row.said.area_mm2 = type->told_mm2;
    row.said.contrast = type->contrast, row.said.contrast_asked = type->contrast_asked;
    put_at(type->cell, p.predicted.surface, row.said);
    row.cells = {type->cell};
    if (type->unread > 0) {
        row.said.type_mm = type->below_mm;
        row.said.why = fmt::format("below {} is not readable from {:g} mm: {} of {} letters",
                                   type_size_text(type->below_mm), s.viewing_distance_mm, type->unread, type->letters);
        if (type->pale > 0) row.said.why += fmt::format("; {} larger ones are pale", type->pale);
    } else {
        row.said.why = fmt::format("is pale: {} of {} letters have a contrast of {:.2f}, and {:g} is read with ease",
                                   type->pale, type->letters, type->pale_contrast, legible);
    }
    row.said.good = false;
    return row;
}

/// Of pictures.
std::vector<Row> codes_of(const RegionSources& s, PageVerdict& page) {
    std::vector<Row> rows;
    const optics::Surface& surface = s.prediction.predicted.surface;
    for (PrintedCode& code : printed_codes(s.prediction, s.mesh)) {
        Row& row = rows.emplace_back();
        row.said.kind = "code";
        row.said.asked = fmt::format("{} of {:.1f} x {:.1f} mm", code.kind, code.width_mm, code.height_mm);
        const std::uint32_t middle = middle_of(code.cells, surface);
        put_at(middle, surface, row.said);
        row.printed = s.prediction.predicted.rgb[middle].cast<double>();
        for (const std::uint32_t i : code.cells) row.said.area_mm2 += double(surface.cells[i].area_mm2);
        row.said.good = code.is_read;
        if (!code.is_read) row.said.why = "cannot be read by a scanner";
        row.cells = std::move(code.cells);
        if (!code.is_read && code.module_mm > 0)
            page.module_mm = page.module_mm > 0 ? std::min(page.module_mm, code.module_mm) : code.module_mm;
    }
    return rows;
}

std::vector<Row> labels_of(const RegionSources& s) {
    std::vector<Row> rows;
    if (!s.mesh || s.marks.empty()) return rows;
    const JobPrediction& p = s.prediction;
    for (PrintedLabel& label : printed_labels(p, s.marks, s.mesh->decals, s.origin_mm, s.viewing_distance_mm)) {
        Row& row = rows.emplace_back();
        row.said.kind = "label";
        row.said.asked = label.mark->said;
        const std::uint32_t middle = middle_of(label.cells, p.predicted.surface);
        put_at(middle, p.predicted.surface, row.said);
        row.printed = p.predicted.rgb[middle].cast<double>();
        for (const std::uint32_t i : label.cells) row.said.area_mm2 += double(p.predicted.surface.cells[i].area_mm2);
        row.said.good = label.is_read;
        if (label.letters > 0) row.said.contrast = label.contrast, row.said.contrast_asked = 1;
        if (!label.is_read)
            row.said.why = label.letters == 0
                               ? "cannot be read by a scanner"
                               : fmt::format(
                                     "cannot be read: {} of {} letters do not stand out at this size; give it "
                                     "a ground (ground=white), more size=, or another place=",
                                     label.unread, label.letters);
        row.cells = std::move(label.cells);
    }
    return rows;
}

double rim_limit(const VerdictLimits& limits) { return 2 * limits.bad; }

/// A colour is one, in however many places.
bool is_plural(const io::ReportRegion& region) { return region.kind == "type and lines"; }
const char* is_are(const io::ReportRegion& region) { return is_plural(region) ? "are" : "is"; }

bool is_uneven(const io::ReportRegion& region, double above) {
    return region.unevenness > (region.kind == "paper" ? of_paper : 1) * above;
}

/// "yellow (187, 154, 1)", without its numbers.
std::string colour_name(const std::string& colour) { return colour.substr(0, colour.find(" (")); }

/// With how it differs and what was asked for by numbers, where words do not tell the two apart.
std::string printed_text(const Row& row) {
    const io::ReportRegion& region = row.said;
    const std::string& asked = region.asked_seen.empty() ? region.asked : region.asked_seen;
    if (colour_name(asked) != colour_name(region.printed)) return region.printed;
    const Eigen::Vector3d meant =
        region.asked_seen.empty() ? optics::linear_srgb_from_oklab(row.oklab.cast<double>()) : *row.asked_seen;
    return fmt::format("{} {} for {}",
                       shift_word(optics::lab_from_linear_srgb(meant.cwiseMax(0)),
                                  optics::lab_from_linear_srgb(row.printed.cwiseMax(0))),
                       region.printed, asked.substr(asked.find('(')));
}

std::string what_is_wrong(const Row& row, const VerdictLimits& limits) {
    const io::ReportRegion& region = row.said;
    if (region.contrast_asked >= legible && region.contrast < legible)
        return fmt::format("{} hard to read: the contrast is {:.2f}, {:.2f} was asked for and {:g} is legible",
                           is_are(region), region.contrast, region.contrast_asked, legible);
    if (region.de2000 > limits.bad)
        return fmt::format("{} printed as {}, {:.0f} off{}", is_are(region), printed_text(row), *region.de2000,
                           region.out_of_reach ? ": no mixture of the loaded resins is nearer" : "");
    if (region.rim > rim_limit(limits) && region.de2000 > limits.good)
        return fmt::format("{} printed as {}, {:.0f} off, and {} a rim of another colour", is_are(region),
                           printed_text(row), *region.de2000, is_plural(region) ? "have" : "has");
    if (region.rim > rim_limit(limits))
        return fmt::format("{} a rim of another colour, {:.0f} off in chroma", is_plural(region) ? "have" : "has",
                           *region.rim);
    if (is_uneven(region, flecked_above))
        return fmt::format("{} {}: flecked by {:.1f} CIEDE2000", is_are(region), not_even, *region.unevenness);
    return {};
}

/// How bad a region is, by what is bad: mottle counts twice what a mean does (halftone::worse_by).
double badness(const io::ReportRegion& region, const VerdictLimits& limits) {
    const double read = region.contrast_asked >= legible ? legible / std::max(region.contrast, 1e-3) : 0;
    return std::max({region.de2000.value_or(0) / limits.bad, 2 * region.unevenness.value_or(0) / limits.bad, read});
}

double seen_mm2(const io::ReportRegion& region) { return region.area_mm2 * region.seen_share; }

/// By how much it is noted: eyes of another colour more than a large ground with a breath of mottle.
double note_of(const io::ReportRegion& region, const VerdictLimits& limits) {
    constexpr double rim_mm = 0.5;  // a rim is taken to be that wide, and an area as long as wide
    const double edge_mm = std::sqrt(seen_mm2(region)), rim = region.rim.value_or(0) / rim_limit(limits);
    return std::max(badness(region, limits) * edge_mm, rim * std::sqrt(std::min(1.0, rim_mm / edge_mm)) * edge_mm);
}

/// Walls that lie apart, by boxes of `box_mm` that touch, so that both faces of a wall are one; those that are large
/// enough to speak of, the largest first.
std::vector<std::vector<std::uint32_t>> pieces_of(const std::vector<std::uint32_t>& of, const optics::Surface& surface,
                                                  double box_mm) {
    using Box = std::array<int, 3>;
    std::map<Box, std::vector<std::uint32_t>> waits;
    for (const std::uint32_t i : of) {
        Box box{};
        for (std::size_t a = 0; a < 3; ++a) box[a] = int(std::floor(double(surface.cells[i].centre_mm[a]) / box_mm));
        waits[box].push_back(i);
    }
    std::vector<std::vector<std::uint32_t>> pieces;
    while (!waits.empty()) {
        std::vector<std::uint32_t>& piece = pieces.emplace_back();
        std::vector<Box> next{waits.begin()->first};
        while (!next.empty()) {
            const auto found = waits.find(next.back());
            const Box at = next.back();
            next.pop_back();
            if (found == waits.end()) continue;
            piece.insert(piece.end(), found->second.begin(), found->second.end());
            waits.erase(found);
            for (int n = 0; n < 27; ++n) next.push_back({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
        }
    }
    const auto area = [&](const std::vector<std::uint32_t>& piece) {
        double sum = 0;
        for (const std::uint32_t i : piece) sum += double(surface.cells[i].area_mm2);
        return sum;
    };
    std::ranges::stable_sort(pieces, std::greater<>(), area);
    while (pieces.size() > 1 && area(pieces.back()) < least_mm2) pieces.pop_back();
    return pieces;
}

/// What has lost its detail to light that spreads within it: the colours are right on average, and it looks blurred.
std::optional<Row> blurred_texture(const RegionSources& s, std::vector<char>& spoilt) {
    const JobPrediction& p = s.prediction;
    const optics::Surface& surface = p.predicted.surface;
    const auto lost = lost_texture(surface, p.seen.texture, s.seen);
    if (!lost) return std::nullopt;
    Row row;
    row.cells = lost->cells;
    Eigen::Vector3f target = Eigen::Vector3f::Zero();
    for (const std::uint32_t i : lost->cells) {
        const float part = surface.cells[i].area_mm2 / float(lost->area_mm2);
        target += part * p.seen.target[i], row.printed += (part * p.seen.print[i]).cast<double>();
        spoilt[i] = 1;
    }
    const auto pieces = pieces_of(lost->cells, surface, 1.0);
    row.said.kind = "texture";
    row.said.asked = text_of(target);
    row.said.area_mm2 = lost->area_mm2;
    row.said.pieces = int(pieces.size());
    row.said.contrast = lost->kept, row.said.contrast_asked = 1;
    put_at(middle_of(pieces[0], surface), surface, row.said);
    row.said.why = fmt::format("keeps {:.2f} of its contrast over {:.0f} % of what is seen: it comes out blurred",
                               lost->kept, 100 * lost->seen_share);
    row.said.good = false;
    return row;
}

std::optional<Row> thin_walls(const RegionSources& s, const ThinWalls& walls) {
    const JobPrediction& p = s.prediction;
    Row row;
    Eigen::Vector3f target = Eigen::Vector3f::Zero();
    double off = 0, area_mm2 = 0;
    for (const std::uint32_t i : walls.cells) {
        const double area = p.predicted.surface.cells[i].area_mm2;
        area_mm2 += area, off += area * p.seen.difference[i];
        target += float(area) * p.seen.target[i], row.printed += area * p.seen.print[i].cast<double>();
    }
    if (area_mm2 < least_mm2) return std::nullopt;
    off /= area_mm2, row.printed /= area_mm2;
    row.said.kind = "thin walls";
    row.said.asked = text_of(target / float(area_mm2));
    row.said.area_mm2 = area_mm2, row.said.de2000 = off;
    const auto pieces = pieces_of(walls.cells, p.predicted.surface, std::max(1.0, walls.wall_mm));
    row.said.pieces = int(pieces.size());
    // Legs that hang together have their middle in the body: where it is worst.
    put_at(*std::ranges::max_element(pieces[0], {}, [&](std::uint32_t i) { return s.seen[i] * p.seen.difference[i]; }),
           p.predicted.surface, row.said);
    row.cells = walls.cells;
    row.said.good = off <= s.limits.bad;
    if (!row.said.good)
        row.said.why =
            fmt::format("let light pass, {:.0f} off on average: they are {:.1f} mm thick", off, walls.wall_mm);
    return row;
}

/// Of what has no flat areas: of the worst quarter of all that is clearly off the largest place, for colours that run
/// into each other have no mean to speak of; nothing where what is off is hardly seen.
std::optional<Row> most_off(const RegionSources& s) {
    constexpr double enough = 0.02;  // of what is seen, as of textures that are lost (lost_texture.h)
    const JobPrediction& p = s.prediction;
    const optics::Surface& surface = p.predicted.surface;
    std::vector<std::uint32_t> off;
    double seen = 0;
    for (std::uint32_t i = 0; i < p.seen.difference.size(); ++i)
        if (p.seen.difference[i] > s.limits.bad) off.push_back(i), seen += s.seen[i];
    if (!(seen > enough * std::accumulate(s.seen.begin(), s.seen.end(), 0.0))) return std::nullopt;
    const auto worst = off.begin() + std::ptrdiff_t(off.size() / 4);
    std::ranges::nth_element(off, worst, std::greater<>(), [&](std::uint32_t i) { return p.seen.difference[i]; });
    off.erase(worst + 1, off.end());
    std::ranges::sort(off);
    const auto pieces = pieces_of(off, surface, 1.0);
    Row row;
    Eigen::Vector3f target = Eigen::Vector3f::Zero();
    double difference = 0;
    for (const std::uint32_t i : pieces[0]) {
        const float area = surface.cells[i].area_mm2;
        row.said.area_mm2 += double(area), difference += double(area) * p.seen.difference[i];
        target += area * p.seen.target[i], row.printed += (area * p.seen.print[i]).cast<double>();
    }
    difference /= row.said.area_mm2, target /= float(row.said.area_mm2), row.printed /= row.said.area_mm2;
    row.cells = pieces[0], row.oklab = oklab_of(target);
    row.said.kind = "colour";
    row.said.asked = text_of(target);
    row.said.pieces = int(pieces.size());
    row.said.de2000 = difference;
    put_at(middle_of(pieces[0], surface), surface, row.said);
    row.said.good = false;
    return row;
}

/// Per cell: the flat area that it lies in, no letter or line; no_region: none.
constexpr std::uint32_t no_region = ~std::uint32_t{0};
std::vector<std::uint32_t> flat_areas(const SeenPrint& seen, std::size_t cells) {
    std::vector<std::uint32_t> area(cells, no_region);
    for (std::uint32_t r = 0; r < seen.regions.size(); ++r)
        if (seen.regions[r].kind != RegionKind::strokes)
            for (const std::uint32_t i : seen.regions[r].cells) area[i] = r;
    return area;
}

double edge_of(const ColourRegion& of) { return std::sqrt(of.area_mm2 / static_cast<double>(of.cells.size())); }

/// Whether it is the inside of a letter, of the paper or ground around that, and no type itself.
bool is_counter(const SeenPrint& seen, const ColourRegion& of, const halftone::CellNeighbours& cells,
                std::span<const std::uint32_t> flat) {
    // Chosen on a page of rings with insides of 0.9 mm and by no measurement: letters on a ground of another colour
    // have none of theirs around them but in other letters, which are no flat areas.
    constexpr double within_mm = 1, part = 0.25;
    constexpr float same = 0.03f;  // Oklab, as what is ground in type_rows.cpp
    const Eigen::Vector3f colour = oklab_of(of.target);
    const std::vector<std::uint32_t> around =
        cells.around(of, std::max(1, static_cast<int>(std::lround(within_mm / edge_of(of)))));
    const auto alike = std::ranges::count_if(around, [&](std::uint32_t i) {
        return flat[i] != no_region && (oklab_of(seen.regions[flat[i]].target) - colour).norm() < same;
    });
    return double(alike) > part * double(around.size());
}

Row row_of(const RegionSources& s, std::size_t r, const halftone::CellNeighbours& cells,
           std::span<const EdgeTerms> edges, bool is_page) {
    const JobPrediction& p = s.prediction;
    const optics::Surface& surface = p.predicted.surface;
    const ColourRegion& of = p.seen.regions[r];
    const halftone::RegionLook& look = p.seen.looks[r];
    Row row;
    io::ReportRegion& region = row.said;
    row.cells = of.cells, row.oklab = oklab_of(of.target);
    const auto rgb = [](const Eigen::Vector3d& lab) {
        return Eigen::Vector3d(optics::linear_srgb_from_xyz(optics::xyz_from_lab(lab, optics::d65_white())));
    };
    row.printed = rgb(look.lab), row.asked_seen = rgb(look.asked);
    region.kind = kind_word(of.kind, is_page);
    region.asked = text_of(of.target);
    put_at(middle_of(of.interior, surface), surface, region);
    region.area_mm2 = of.area_mm2, region.de2000 = look.difference;
    if (of.kind == RegionKind::solid) region.rim = std::max(0.0, p.seen.rims[r]);
    if (of.kind != RegionKind::strokes)
        region.unevenness = unevenness_of(of, cells, p.seen.target, p.seen.print, edges);
    region.out_of_reach = s.colour.separation.gamut_distance(of.target) >= look.difference / 2;
    if (of.kind == RegionKind::strokes && is_page) {
        const std::vector<std::uint32_t> ground =
            cells.around(of, std::max(1, static_cast<int>(std::lround(ground_mm / edge_of(of)))));
        region.contrast_asked = contrast(luminance(p.target, surface, of.cells), luminance(p.target, surface, ground));
        region.contrast =
            contrast(luminance(p.predicted.rgb, surface, of.cells), luminance(p.predicted.rgb, surface, ground));
        // What is seen of strokes is their contrast: the eye mixes their colour with what lies beside them. Only what
        // comes out in another hue is another colour all the same: windows that were to be yellow and are grey.
        const Eigen::Vector3d as_light(look.asked[0], look.lab[1], look.lab[2]);
        if (region.contrast_asked >= legible && optics::ciede2000(look.asked, as_light) <= s.limits.bad)
            region.de2000.reset();
    }
    return row;
}

/// Means by area; where the larger one is.
void join(Row& into, const Row& more) {
    io::ReportRegion& a = into.said;
    const io::ReportRegion& b = more.said;
    const double part = b.area_mm2 / (a.area_mm2 + b.area_mm2);
    const auto mean = [&](std::optional<double>& x, const std::optional<double>& y) {
        if (x && y) x = (1 - part) * *x + part * *y;
    };
    mean(a.de2000, b.de2000), mean(a.rim, b.rim);
    if (a.unevenness && b.unevenness)
        a.unevenness = std::sqrt((1 - part) * *a.unevenness * *a.unevenness + part * *b.unevenness * *b.unevenness);
    a.contrast = (1 - part) * a.contrast + part * b.contrast;
    a.contrast_asked = (1 - part) * a.contrast_asked + part * b.contrast_asked;
    into.printed = (1 - part) * into.printed + part * more.printed;
    if (into.asked_seen && more.asked_seen) into.asked_seen = (1 - part) * *into.asked_seen + part * *more.asked_seen;
    if (part > 0.5) a.place_mm = b.place_mm, a.normal = b.normal;
    a.out_of_reach = a.out_of_reach && b.out_of_reach;
    a.area_mm2 += b.area_mm2;
    a.pieces += b.pieces;
    into.cells.insert(into.cells.end(), more.cells.begin(), more.cells.end());
}

/// Of one kind and one colour, to the eye.
bool are_alike(const Row& a, const Row& b) {
    constexpr float one_colour = 0.03f;  // Oklab: a little more than is seen between things that lie apart
    return a.said.kind == b.said.kind && a.said.de2000.has_value() == b.said.de2000.has_value() &&
           (a.oklab - b.oklab).norm() <= one_colour;
}

std::vector<Row> joined(std::vector<Row> rows) {
    std::vector<Row> kinds;
    for (Row& row : rows) {
        const auto alike = std::ranges::find_if(kinds, [&](const Row& other) { return are_alike(other, row); });
        if (alike == kinds.end())
            kinds.push_back(std::move(row));
        else
            join(*alike, row);
    }
    return kinds;
}

/// Whether what is asked for looks clearly otherwise at its size, so that naming it beside the print's would mislead.
bool mixes(const Eigen::Vector3f& asked_oklab, const Eigen::Vector3d& seen, const VerdictLimits& limits) {
    const auto lab = [](const Eigen::Vector3d& rgb) { return optics::lab_from_linear_srgb(rgb.cwiseMax(0)); };
    return optics::ciede2000(lab(optics::linear_srgb_from_oklab(asked_oklab.cast<double>())), lab(seen)) > limits.bad;
}

void say_where(const RegionSources& s, Row& row) {
    double area = 0, seen = 0;
    for (const std::uint32_t i : row.cells) {
        const double a = s.prediction.predicted.surface.cells[i].area_mm2;
        area += a, seen += a * s.sides.weight(i);
    }
    row.said.seen_share = area > 0 ? seen / area : 1;
    row.said.place = s.places.at(row.said.place_mm);
    const Side side = s.sides.main_side(row.cells);
    if (!s.is_picture) row.said.from = from_words(side);
    if (row.asked_seen && row.said.de2000 && mixes(row.oklab, *row.asked_seen, s.limits))
        row.said.asked_seen = text_of(row.asked_seen->cast<float>());
    // Over the paper's level a tint may be brighter than white, and would be told as white.
    row.said.printed = text_of((row.printed / std::max(1.0, row.printed.maxCoeff())).cast<float>());
}

const char* tint_word(double hue) {
    if (hue < 42 || hue >= 320) return "pinkish";
    if (hue < 108) return "yellowish";
    if (hue < 200) return "greenish";
    return hue < 290 ? "bluish" : "purplish";
}

}  // namespace

std::string colour_word(const Eigen::Vector3f& rgb) {
    const Eigen::Vector3d lab = optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
    const double chroma = lab.tail<2>().norm(), degrees = std::atan2(lab[2], lab[1]) * 180 / 3.14159265358979323846;
    const double hue = degrees < 0 ? degrees + 360 : degrees;
    if (lab[0] < 22 && chroma < 18) return "black";
    if (chroma < 9 || (chroma < 13 && lab[0] < 80)) {
        const char* grey = lab[0] > 90 ? "white" : lab[0] > 65 ? "light grey" : lab[0] > 40 ? "grey" : "dark grey";
        return chroma < 4 ? grey : fmt::format("{} {}", tint_word(hue), grey);
    }
    if (hue < 15 || hue >= 345) return lab[0] > 65 ? "pink" : "magenta";
    if (hue < 42) return lab[0] > 70 ? "pink" : lab[0] < 35 && chroma < 45 ? "brown" : "red";
    if (hue < 75 && (lab[0] < 48 || (chroma < 45 && lab[0] < 60))) return "brown";
    if (hue < 100 && chroma < 35) return lab[0] < 58 ? "brown" : "beige";
    if (hue < 75) return "orange";
    if (hue < 108) return lab[0] < 45 || (lab[0] < 60 && chroma < 45) ? "olive" : "yellow";
    if (hue < 175) return "green";
    if (hue < 245) return "cyan";
    if (hue < 310) return "blue";  // sRGB's own lies at 306
    return "purple";
}

namespace {

/// What someone or something reads, or does not.
void add_read(const RegionSources& s, Row read, std::vector<Row>& rows) {
    Row& row = rows.emplace_back(std::move(read));
    say_where(s, row);
    row.said.printed = row.said.good ? "read" : "not read";
}

/// Whether half of it lies within letters: dots, accents, and those that a coarser page joins.
bool is_of_letters(const JobPrediction& p, const std::vector<std::uint32_t>& detail,
                   std::span<const Eigen::AlignedBox2d> letters) {
    const SlabCells slab(p.predicted.surface);
    const auto inside = std::ranges::count_if(detail, [&](std::uint32_t cell) {
        const Eigen::Vector2d at = slab.place(p.predicted.surface.cells[cell]);
        return std::ranges::any_of(letters, [&](const Eigen::AlignedBox2d& box) {
            const Eigen::Vector2d more = 0.5 * box.sizes();
            return Eigen::AlignedBox2d(box.min() - more, box.max() + more).contains(at);
        });
    });
    return 2 * std::size_t(inside) > detail.size();
}

/// What of type and fine detail is lost. Adds a picture's codes to the rows, and says what they and its type are good
/// for.
std::vector<Row> lost_on_page(const RegionSources& s, const halftone::CellNeighbours& cells, std::vector<Row>& rows,
                              PageVerdict& page) {
    const JobPrediction& p = s.prediction;
    const std::vector<PicturePage> pages = s.is_picture ? picture_pages(p, s.mesh) : std::vector<PicturePage>();
    const auto type = unreadable_type(p, s.viewing_distance_mm, pages);
    if (s.is_picture)
        for (Row& code : codes_of(s, page)) {
            if (!code.said.good) page.useless = "a scanner cannot read its code";
            page.served.resize(p.target.size());
            for (const std::uint32_t cell : code.cells) page.served[cell] = code.said.good;
            add_read(s, std::move(code), rows);
        }
    if (page.useless.empty() && type && is_little_else(p, *type)) page.useless = "most of its type cannot be read";
    // What the size of type says the contrast of fine detail need not, nor that of a code which is read.
    if (type) page.smallest_type_mm = type->smallest_mm, page.type_times = type->times;
    std::vector<Row> lost;
    if (auto small = small_type(s, type)) lost.push_back(std::move(*small));
    auto detail = lost.empty() ? lost_detail(p, cells, s.is_picture) : std::nullopt;
    if (!detail && (lost.empty() || !type->letters_at.empty())) detail = lost_lines_row(s, pages);
    if (detail && type && is_of_letters(p, detail->cells, type->letters_at)) detail.reset();
    const auto is_served = [&](std::uint32_t cell) { return !page.served.empty() && page.served[cell] != 0; };
    if (detail && !std::ranges::all_of(detail->cells, is_served)) {
        if (s.is_picture && detail->said.contrast < gone_contrast) page.lost = "some of its detail is gone";
        lost.push_back(std::move(*detail));
    }
    if (s.is_picture && type && type->unread > 0)
        page.lost = type->unread == type->letters ? "none of its type can be read" : "some of its type cannot be read";
    return lost;
}

}  // namespace

std::string shift_word(const Eigen::Vector3d& asked, const Eigen::Vector3d& printed) {
    const Eigen::Vector3d by = printed - asked;
    const double chroma = printed.tail<2>().norm() - asked.tail<2>().norm(),
                 hue = std::sqrt(std::max(0.0, by.tail<2>().squaredNorm() - chroma * chroma));
    if (std::abs(by[0]) >= std::max(std::abs(chroma), hue)) return by[0] < 0 ? "darker" : "lighter";
    if (std::abs(chroma) >= hue) return chroma < 0 ? "greyer" : "stronger";
    if (std::abs(by[1]) > std::abs(by[2])) return by[1] > 0 ? "redder" : "greener";
    return by[2] > 0 ? "yellower" : "bluer";
}

JudgedRegions judge_regions(const RegionSources& s, const ThinWalls& walls) {
    const JobPrediction& p = s.prediction;
    const halftone::CellNeighbours cells(p.predicted.surface);
    const bool is_page = s.is_picture && is_graphics(p);
    JudgedRegions judged;
    judged.spoilt.assign(p.target.size(), 0);
    const std::vector<EdgeTerms> edges =
        p.seen.regions.empty() ? std::vector<EdgeTerms>() : edge_terms(p.predicted.surface, p.target, p.seen.target);
    std::vector<Row> rows;
    const std::vector<std::uint32_t> flat = flat_areas(p.seen, p.target.size());
    for (std::size_t r = 0; r < p.seen.regions.size(); ++r) {
        const ColourRegion& of = p.seen.regions[r];
        if (is_page && of.kind == RegionKind::strokes && is_counter(p.seen, of, cells, flat)) continue;
        Row row = row_of(s, r, cells, edges, is_page);
        if (is_uneven(row.said, spoilt_above))
            for (const std::uint32_t cell : row.cells) judged.spoilt[cell] = 1;
        rows.push_back(std::move(row));
    }
    rows = joined(std::move(rows));
    std::erase_if(rows, [](const Row& row) { return row.said.area_mm2 < least_mm2; });
    for (Row& row : rows) {
        say_where(s, row);
        row.said.why = what_is_wrong(row, s.limits);
        row.said.good = row.said.why.empty();
    }
    for (Row& row : lost_on_page(s, cells, rows, judged.page)) say_where(s, rows.emplace_back(std::move(row)));
    // The bars of a code that is read do what they are there for, whatever their contrast is.
    if (const std::vector<char>& served = judged.page.served; !served.empty())
        std::erase_if(rows, [&](const Row& row) {
            const auto in = std::ranges::count_if(row.cells, [&](std::uint32_t i) { return served[i] != 0; });
            return row.said.kind != "code" && 10 * std::size_t(in) > 9 * row.cells.size();
        });
    for (auto& row : {blurred_texture(s, judged.spoilt), thin_walls(s, walls)})
        if (row) say_where(s, rows.emplace_back(*row));
    for (Row& label : labels_of(s)) {
        if (!label.said.good && judged.page.lost.empty()) judged.page.lost = "a label cannot be read";
        add_read(s, std::move(label), rows);
    }
    if (std::ranges::all_of(rows, [](const Row& row) { return row.said.good; }))
        if (auto row = most_off(s)) {
            say_where(s, rows.emplace_back(*row));
            rows.back().said.why = what_is_wrong(rows.back(), s.limits);
        }
    for (Row& row : rows) judged.rows.push_back(std::move(row.said));
    std::ranges::stable_sort(judged.rows, std::greater<>(), [&](const io::ReportRegion& region) {
        // Of a page first what cannot be made out: nobody minds how even a ground is below words that are lost.
        const int is_lost = region.kind == "code" || region.kind == "label"               ? 2
                            : region.type_mm || (is_page && region.kind == "fine detail") ? 1
                                                                                          : 0;
        return std::tuple(!region.good, is_lost, note_of(region, s.limits));
    });
    return judged;
}

}  // namespace voxtone::slicer
