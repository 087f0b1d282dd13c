// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/region_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

using halftone::ColourRegion;
using halftone::RegionKind;

constexpr double legible = 0.5;    // contrast, ISO 9241-303
constexpr double ground_mm = 0.5;  // what type is seen against
constexpr double least_mm2 = 0.5;  // of a region that a word is said of

const char* kind_word(RegionKind kind) {
    switch (kind) {
        case RegionKind::paper:
            return "paper";
        case RegionKind::solid:
            return "solid";
        case RegionKind::strokes:
            break;
    }
    return "type and lines";
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

/// Of the cell that lies nearest to the middle of its interior.
std::array<double, 3> place_of(const ColourRegion& region, const optics::Surface& surface) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    const auto centre = [&](std::uint32_t i) {
        const auto& c = surface.cells[i].centre_mm;
        return Eigen::Vector3d(c[0], c[1], c[2]);
    };
    for (const std::uint32_t i : region.interior) middle += centre(i) / static_cast<double>(region.interior.size());
    const std::uint32_t nearest = *std::ranges::min_element(
        region.interior, {}, [&](std::uint32_t i) { return (centre(i) - middle).squaredNorm(); });
    const Eigen::Vector3d at = centre(nearest);
    return {at.x(), at.y(), at.z()};
}

/// Fine detail of graphics that lost much of its contrast; nothing where that is hardly anywhere.
std::optional<io::ReportRegion> lost_detail(const JobPrediction& p) {
    constexpr float strong = 0.08f, enough = 0.6f;
    constexpr double least_lost_mm2 = 0.25, of_graphics = 0.3;
    const optics::Surface& surface = p.predicted.surface;
    double flat = 0, all = 0;
    for (const ColourRegion& of : p.seen.regions) flat += of.area_mm2;
    for (const optics::SurfaceCell& cell : surface.cells) all += static_cast<double>(cell.area_mm2);
    if (flat < of_graphics * all) return std::nullopt;
    io::ReportRegion region;
    double kept = 0;
    float most = 0;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < p.seen.fine.size(); ++i) {
        const halftone::FineContrast& fine = p.seen.fine[i];
        if (fine.wanted < strong || fine.kept >= enough) continue;
        const auto area = static_cast<double>(surface.cells[i].area_mm2);
        region.area_mm2 += area, kept += area * static_cast<double>(fine.kept);
        if (const float lost = fine.wanted * (1 - fine.kept); lost > most) most = lost, worst = i;
    }
    if (region.area_mm2 < least_lost_mm2) return std::nullopt;
    region.kind = "fine detail";
    region.asked = text_of(p.target[worst]), region.printed = text_of(p.predicted.rgb[worst]);
    const auto& centre = surface.cells[worst].centre_mm;
    region.place_mm = {centre[0], centre[1], centre[2]};
    region.contrast = std::max(0.0, kept / region.area_mm2), region.contrast_asked = 1;
    region.why = fmt::format("keeps {:.2f} of its contrast: type as fine as that is hard to read", region.contrast);
    region.good = false;
    return region;
}

double rim_limit(const VerdictLimits& limits) { return 2 * limits.bad; }

std::string what_is_wrong(const io::ReportRegion& region, const VerdictLimits& limits) {
    if (region.contrast_asked >= legible && region.contrast < legible)
        return fmt::format("is hard to read: its contrast is {:.2f}, {:.2f} was asked for and {:g} is legible",
                           region.contrast, region.contrast_asked, legible);
    if (region.de2000 > limits.bad)
        return fmt::format("is printed as {}, {:.0f} off{}", region.printed, *region.de2000,
                           region.out_of_reach ? ": no mixture of the loaded resins is nearer" : "");
    if (region.rim > rim_limit(limits))
        return fmt::format("has a rim of another colour, {:.0f} units of CIELAB in chroma", *region.rim);
    if (region.unevenness > limits.bad) return fmt::format("is uneven, by {:.0f} units of CIELAB", *region.unevenness);
    return {};
}

}  // namespace

double badness(const io::ReportRegion& region, const VerdictLimits& limits) {
    const double read = region.contrast_asked >= legible ? legible / std::max(region.contrast, 1e-3) : 0;
    return std::max({region.de2000.value_or(0) / limits.bad, region.unevenness.value_or(0) / limits.bad,
                     region.rim.value_or(0) / rim_limit(limits), read});
}

std::optional<io::ReportRegion> judge_thin_walls(const JobPrediction& p, std::span<const std::uint32_t> cells,
                                                 double wall_mm, const Eigen::Vector3d& place_mm,
                                                 const VerdictLimits& limits) {
    io::ReportRegion region;
    Eigen::Vector3f target = Eigen::Vector3f::Zero(), print = target;
    double off = 0;
    for (const std::uint32_t i : cells) {
        const float area = p.predicted.surface.cells[i].area_mm2;
        region.area_mm2 += static_cast<double>(area);
        off += static_cast<double>(area) * p.seen.difference[i];
        target += area * p.seen.target[i], print += area * p.seen.print[i];
    }
    if (region.area_mm2 < least_mm2) return std::nullopt;
    const auto all = static_cast<float>(region.area_mm2);
    region.kind = "thin walls";
    region.asked = text_of(target / all), region.printed = text_of(print / all);
    region.place_mm = {place_mm.x(), place_mm.y(), place_mm.z()};
    off /= region.area_mm2;
    region.de2000 = off;
    region.good = off <= limits.bad;
    if (!region.good)
        region.why = fmt::format("let light pass, {:.0f} off on average: they are {:.1f} mm thick there", off, wall_mm);
    return region;
}

std::string colour_word(const Eigen::Vector3f& rgb) {
    const Eigen::Vector3d lab = optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
    const double chroma = lab.tail<2>().norm(), degrees = std::atan2(lab[2], lab[1]) * 180 / 3.14159265358979323846;
    const double hue = degrees < 0 ? degrees + 360 : degrees;
    if (lab[0] < 22 && chroma < 18) return "black";
    if (chroma < 9) return lab[0] > 90 ? "white" : lab[0] > 65 ? "light grey" : lab[0] > 40 ? "grey" : "dark grey";
    if (hue < 15 || hue >= 345) return lab[0] > 65 ? "pink" : "magenta";
    if (hue < 42) return lab[0] > 70 ? "pink" : lab[0] < 35 && chroma < 45 ? "brown" : "red";
    if (hue < 75) return lab[0] < 48 ? "brown" : "orange";
    if (hue < 108) return lab[0] < 45 ? "olive" : "yellow";
    if (hue < 175) return "green";
    if (hue < 245) return "cyan";
    if (hue < 305) return "blue";
    return "purple";
}

std::vector<io::ReportRegion> judge_regions(const JobPrediction& p, const JobColour& colour,
                                            const VerdictLimits& limits) {
    std::vector<io::ReportRegion> judged;
    const optics::Surface& surface = p.predicted.surface;
    const halftone::CellNeighbours cells(surface);
    for (std::size_t r = 0; r < p.seen.regions.size(); ++r) {
        const ColourRegion& of = p.seen.regions[r];
        const halftone::RegionLook& look = p.seen.looks[r];
        if (of.area_mm2 < least_mm2) continue;
        io::ReportRegion& region = judged.emplace_back();
        region.kind = kind_word(of.kind);
        region.asked = text_of(of.target);
        const Eigen::Vector3d shown = optics::linear_srgb_from_xyz(optics::xyz_from_lab(look.lab, optics::d65_white()));
        region.printed = text_of(shown.cast<float>());
        region.place_mm = place_of(of, surface);
        region.area_mm2 = of.area_mm2, region.de2000 = look.difference;
        if (of.kind == RegionKind::solid)
            region.unevenness = look.unevenness, region.rim = std::max(0.0, p.seen.rims[r]);
        region.out_of_reach = colour.separation.gamut_distance(of.target) >= look.difference / 2;
        if (of.kind == RegionKind::strokes) {
            const double edge = std::sqrt(of.area_mm2 / static_cast<double>(of.cells.size()));
            const std::vector<std::uint32_t> ground =
                cells.around(of, std::max(1, static_cast<int>(std::lround(ground_mm / edge))));
            region.contrast_asked =
                contrast(luminance(p.target, surface, of.cells), luminance(p.target, surface, ground));
            region.contrast =
                contrast(luminance(p.predicted.rgb, surface, of.cells), luminance(p.predicted.rgb, surface, ground));
            // What is seen of strokes is their contrast: the eye mixes their colour with what lies beside them.
            if (region.contrast_asked >= legible) region.de2000.reset();
        }
        region.why = what_is_wrong(region, limits);
        region.good = region.why.empty();
    }
    if (auto detail = lost_detail(p)) judged.push_back(std::move(*detail));
    std::ranges::stable_sort(judged, std::greater<>(),
                             [&](const io::ReportRegion& region) { return badness(region, limits); });
    return judged;
}

}  // namespace voxtone::slicer
