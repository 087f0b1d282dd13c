// SPDX-License-Identifier: GPL-3.0-or-later
#include "graphics_scores.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "flip.h"
#include "halftone/loop/colour_regions.h"
#include "halftone/loop/eye_filter.h"
#include "halftone/loop/paper.h"
#include "optics/colour/colour.h"
#include "scores.h"

namespace voxtone::loop_benchmark {

namespace {

using halftone::ColourRegion;
using halftone::RegionKind;

Eigen::Vector3d lab(const Eigen::Vector3f& rgb) { return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0)); }

double luminance(const Eigen::Vector3f& rgb) {
    return static_cast<double>(Eigen::Vector3f(0.2126F, 0.7152F, 0.0722F).dot(rgb));
}

Eigen::Vector3f mean_of(const Colours& colours, const std::vector<std::uint32_t>& cells) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : cells) sum += colours[i].cast<double>();
    return (sum / static_cast<double>(std::max<std::size_t>(1, cells.size()))).cast<float>();
}

/// Cells of flat slabs within `reach_mm` of another region, or of none.
std::vector<std::uint32_t> rim_cells(const Judgement& j, const std::vector<ColourRegion>& regions) {
    constexpr double reach_mm = 0.5;
    std::vector<int> of(j.target.size(), -1);
    for (std::size_t r = 0; r < regions.size(); ++r)
        for (const std::uint32_t i : regions[r].cells) of[i] = static_cast<int>(r);
    const int reach = std::max(1, static_cast<int>(std::lround(reach_mm / std::sqrt(j.surface.cells[0].area_mm2))));
    const auto columns = static_cast<int>(j.columns), rows = static_cast<int>(j.rows);
    std::vector<std::uint32_t> cells;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto at = static_cast<std::size_t>(y * columns + x);
            bool near = false;
            for (int dy = -reach; dy <= reach && !near; ++dy)
                for (int dx = -reach; dx <= reach && !near; ++dx) {
                    const int nx = x + dx, ny = y + dy;
                    if (nx < 0 || ny < 0 || nx >= columns || ny >= rows || dx * dx + dy * dy > reach * reach) continue;
                    near = of[static_cast<std::size_t>(ny * columns + nx)] != of[at];
                }
            if (near && of[at] >= 0) cells.push_back(static_cast<std::uint32_t>(at));
        }
    return cells;
}

double mean_flip(const Judgement& j, const Colours& print, double viewing_distance_mm) {
    const double cell_mm = std::sqrt(static_cast<double>(j.surface.cells[0].area_mm2));
    const std::vector<double> difference = flip({j.columns, j.rows, j.target}, {j.columns, j.rows, print},
                                                viewing_distance_mm / cell_mm * std::numbers::pi / 180);
    return std::accumulate(difference.begin(), difference.end(), 0.0) / static_cast<double>(difference.size());
}

/// Over the level of its paper.
Colours adapted_print(const Judgement& j) {
    Colours print = j.print();
    const float level = halftone::paper_level(j.surface, j.target, print);
    for (Eigen::Vector3f& rgb : print) rgb /= level;
    return print;
}

}  // namespace

void score_codes(const Judgement& j, GraphicScores& s) { s.codes = read_codes(j, adapted_print(j)); }

GraphicScores graphic_scores(const Judgement& j, double viewing_distance_mm) {
    const halftone::EyeFilter eye(j.surface, viewing_distance_mm, halftone::EyeSurround::none);
    const std::vector<ColourRegion> regions = halftone::colour_regions(j.surface, j.target);
    GraphicScores s;
    s.paper_level = static_cast<double>(halftone::paper_level(j.surface, j.target, j.print()));
    const Colours print = adapted_print(j);
    s.flip = mean_flip(j, print, viewing_distance_mm);
    const Colours near_target = eye.smoothed(j.target), near = eye.smoothed(print);
    const std::vector<halftone::RegionLook> looks = halftone::look_at(regions, j.surface, near_target, near);
    const std::vector<double> seen = differences(eye.filter(j.target), eye.filter(print));
    for (const double d : seen) s.seen += d / static_cast<double>(seen.size());
    std::vector<std::uint32_t> paper;
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const ColourRegion& region = regions[r];
        if (region.kind == RegionKind::paper) paper.insert(paper.end(), region.cells.begin(), region.cells.end());
        if (region.kind != RegionKind::solid) continue;
        s.solids.push_back({region.target, region.area_mm2, looks[r].difference, looks[r].unevenness});
        s.worst_solid = std::max(s.worst_solid, looks[r].difference);
    }
    for (const SolidScore& solid : s.solids) {
        s.mean_solid += solid.difference / static_cast<double>(s.solids.size());
        s.unevenness += solid.unevenness / static_cast<double>(s.solids.size());
    }
    if (!paper.empty()) {
        for (const std::uint32_t i : paper) s.paper += seen[i] / static_cast<double>(paper.size());
        s.paper_chroma = lab(mean_of(print, paper)).tail<2>().norm();
    }
    const std::vector<std::uint32_t> rim = rim_cells(j, regions);
    for (const std::uint32_t i : rim)
        s.rim += (lab(near[i]) - lab(near_target[i])).tail<2>().norm() / static_cast<double>(rim.size());
    std::vector<std::uint32_t> strokes;
    for (const ColourRegion& region : regions)
        if (region.kind == RegionKind::strokes) strokes.insert(strokes.end(), region.cells.begin(), region.cells.end());
    if (!strokes.empty() && regions.front().kind == RegionKind::paper) {
        const auto contrast = [&](const Colours& colours) {
            const double ground = luminance(mean_of(colours, regions.front().cells)),
                         ink = luminance(mean_of(colours, strokes));
            return (ground - ink) / (ground + ink);
        };
        s.contrast = contrast(print) / contrast(j.target);
    }
    return s;
}

namespace {

/// Of the solid that lost most.
double worse_by(const GraphicScores& open, const GraphicScores& loop) {
    double worse = -100;
    for (std::size_t k = 0; k < open.solids.size(); ++k)
        worse = std::max(worse, loop.solids[k].difference - open.solids[k].difference);
    return worse;
}

}  // namespace

std::string graphics_table(const std::vector<GraphicRow>& rows) {
    std::string text =
        "| page | paper's level | solids: mean | worst | most worse by | unevenness | rim | paper | its chroma | "
        "strokes' contrast | "
        "all as seen | FLIP |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    const auto pair = [](double a, double b) {
        return a == 0 && b == 0 ? std::string() : fmt::format("{:.2f} to {:.2f}", a, b);
    };
    for (const GraphicRow& row : rows) {
        const GraphicScores &o = row.scores[0], &l = row.scores[1];
        text += fmt::format("| {}{} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", row.name,
                            row.held_out ? " (held out)" : "", pair(o.paper_level, l.paper_level),
                            pair(o.mean_solid, l.mean_solid), pair(o.worst_solid, l.worst_solid),
                            o.solids.empty() ? std::string() : fmt::format("{:.2f}", worse_by(o, l)),
                            pair(o.unevenness, l.unevenness), pair(o.rim, l.rim), pair(o.paper, l.paper),
                            pair(o.paper_chroma, l.paper_chroma), pair(o.contrast, l.contrast), pair(o.seen, l.seen),
                            fmt::format("{:.3f} to {:.3f}", o.flip, l.flip));
    }
    for (const GraphicRow& row : rows)
        if (row.name == "codes")
            text += fmt::format(
                "\nSmallest modules that are read, mm (0: none), open loop to loop: QR {:g} to {:g}, Code 128 {:g} to "
                "{:g}\n",
                row.scores[0].codes.square_mm, row.scores[1].codes.square_mm, row.scores[0].codes.bars_mm,
                row.scores[1].codes.bars_mm);
    text += "\nSolids, open loop to loop: CIEDE2000, unevenness\n\n";
    for (const GraphicRow& row : rows) {
        text += fmt::format("- {}:", row.name);
        for (std::size_t k = 0; k < row.scores[0].solids.size(); ++k) {
            const SolidScore &o = row.scores[0].solids[k], &l = row.scores[1].solids[k];
            const Eigen::Vector3f code = o.target.cwiseMax(0);
            text += fmt::format(" ({:.0f} {:.0f} {:.0f}, {:.1f} mm2) {:.1f} to {:.1f}, {:.1f} to {:.1f};",
                                255 * optics::srgb_encode(static_cast<double>(code[0])),
                                255 * optics::srgb_encode(static_cast<double>(code[1])),
                                255 * optics::srgb_encode(static_cast<double>(code[2])), o.area_mm2, o.difference,
                                l.difference, o.unevenness, l.unevenness);
        }
        text += "\n";
    }
    return text;
}

}  // namespace voxtone::loop_benchmark
