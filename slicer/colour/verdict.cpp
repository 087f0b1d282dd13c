// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/verdict.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/parallel.h"
#include "slicer/colour/region_verdict.h"
#include "slicer/colour/tried_advice.h"
#include "slicer/colour/whole_verdict.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

const std::vector<double> histogram_edges{0, 0.5, 1, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30};
using enum LossCause;
constexpr std::array all_causes{gamut, thin_wall, neighbours};

/// What is off, by cause; by area, and by how far it can be seen.
struct Losses {
    std::array<double, all_causes.size()> weight{};  ///< times difference
    double off = 0, all_seen = 0;
    MeanParts mean;
    ThinWalls walls;

    [[nodiscard]] double& of(LossCause cause) { return weight[std::size_t(cause)]; }
    [[nodiscard]] double all() const { return weight[0] + weight[1] + weight[2]; }
    [[nodiscard]] double share(LossCause cause) const { return all() > 0 ? weight[std::size_t(cause)] / all() : 0; }
    [[nodiscard]] LossCause main() const {
        return static_cast<LossCause>(std::max_element(weight.begin(), weight.end()) - weight.begin());
    }
};

struct ThinCell {
    double thickness_mm, weight;
};

/// Corners are longer to cross than the wall that they end, so the thickness is that of the middle.
void describe_walls(std::vector<ThinCell> cells, Losses& losses) {
    if (cells.empty()) return;
    std::stable_sort(cells.begin(), cells.end(),
                     [](const ThinCell& a, const ThinCell& b) { return a.thickness_mm < b.thickness_mm; });
    double sum = 0;
    for (const ThinCell& cell : cells) {
        losses.walls.wall_mm = cell.thickness_mm;
        sum += cell.weight;
        if (sum >= losses.of(thin_wall) / 2) return;
    }
}

/// Per cell: what its flat area is off in its middle, which no size changes; 0 in none that has a middle.
std::vector<double> off_in_the_middle(const SeenPrint& seen) {
    std::vector<double> off(seen.difference.size(), 0);
    for (std::size_t r = 0; r < seen.regions.size(); ++r)
        if (seen.regions[r].interior.size() < seen.regions[r].cells.size())
            for (const std::uint32_t i : seen.regions[r].cells) off[i] = seen.looks[r].difference;
    return off;
}

Losses losses_of(const VerdictSources& s, const JobPrediction& p, const std::vector<double>& seen) {
    const std::vector<double>& difference = p.seen.difference;
    const VerdictLimits& limits = s.job.options.verdict;
    const double thin_mm = 2 * s.job.options.colour.depth_mm;
    Losses losses;
    std::vector<ThinCell> thin;
    std::vector<CellLoss> found(difference.size());
    std::vector<double> reach(difference.size());
    parallel_for(0, found.size(), 256, [&](std::size_t i) {
        reach[i] = std::min(difference[i], s.colour.separation.gamut_distance(p.target[i]));
        if (difference[i] > limits.good) found[i] = loss_of_cell(p, s.colour, i, thin_mm);
    });
    constexpr double sheet_mm = 0.15;  // one voxel, two where it lies aslant
    const std::vector<double> middle = off_in_the_middle(p.seen);
    double thin_seen = 0, rest = 0, rest_seen = 0;
    for (std::size_t i = 0; i < difference.size(); ++i) {
        const double d = difference[i], left = seen[i] * (d - reach[i]);
        const bool is_off = d > limits.good, is_thin = is_off && found[i].cause == thin_wall;
        losses.all_seen += seen[i], losses.mean.reach += seen[i] * reach[i];
        const double flat = is_thin ? 0 : std::min(left, seen[i] * std::max(0.0, middle[i] - reach[i]));
        losses.mean.flat += flat;
        (is_thin ? losses.mean.thin : losses.mean.neighbours) += left - flat;
        if (is_thin) thin_seen += seen[i];
        if (is_thin && found[i].wall_mm < sheet_mm) losses.mean.thinnest += left;
        if (!is_off || found[i].cause == neighbours) rest += left, rest_seen += seen[i];
        if (!is_off) continue;
        losses.off += seen[i];
        losses.of(found[i].cause) += seen[i] * d;
        if (found[i].cause == gamut && d > limits.bad) losses.mean.reach_off += seen[i];
        if (!is_thin) continue;
        thin.push_back({found[i].wall_mm, seen[i] * d});
        losses.walls.cells.push_back(static_cast<std::uint32_t>(i));
    }
    describe_walls(std::move(thin), losses);
    if (!(losses.all_seen > 0)) return losses;
    for (double* part : {&losses.mean.reach, &losses.mean.thin, &losses.mean.flat, &losses.mean.neighbours,
                         &losses.mean.reach_off, &losses.mean.thinnest})
        *part /= losses.all_seen;
    losses.mean.wall_mm = losses.walls.wall_mm;
    for (const std::uint32_t i : losses.walls.cells)
        losses.mean.thin_mm2 += double(p.predicted.surface.cells[i].area_mm2);
    // Where hardly anything is thick nothing tells what thick walls would be like.
    constexpr double enough = 0.1;
    losses.mean.thick_walls = rest_seen < enough * losses.all_seen
                                  ? losses.mean.thin
                                  : std::min(losses.mean.thin, rest / rest_seen * thin_seen / losses.all_seen);
    return losses;
}

std::string reason(LossCause cause, const Losses& losses) {
    if (cause == thin_wall) return fmt::format("light passes through thin walls ({:.1f} mm)", losses.walls.wall_mm);
    if (cause == gamut) return "the loaded resins cannot show these colours";
    return "light spreads between neighbouring colours and at edges";
}

void add_causes(const Losses& losses, io::ReportVerdict& verdict) {
    for (const LossCause cause : all_causes)
        if (losses.share(cause) >= 0.005) verdict.causes.push_back({std::string(name_of(cause)), losses.share(cause)});
    std::stable_sort(verdict.causes.begin(), verdict.causes.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
}

/// Means from each side of a body, by what is seen of each cell from there.
void add_sides(const JobPrediction& p, const SidesSeen& sides, io::ReportVerdict& verdict) {
    constexpr double least_share = 0.02;
    std::array<double, all_sides> seen{}, off{};
    for (std::size_t i = 0; i < p.seen.difference.size(); ++i)
        for (std::size_t side = 0; side < all_sides; ++side) {
            const double area = double(p.predicted.surface.cells[i].area_mm2) * sides.from(static_cast<Side>(side), i);
            seen[side] += area, off[side] += area * p.seen.difference[i];
        }
    const double all = std::accumulate(seen.begin(), seen.end(), 0.0);
    for (std::size_t side = 0; side < all_sides; ++side)
        if (seen[side] > least_share * all)
            verdict.sides.push_back(
                {std::string(name_of(static_cast<Side>(side))), off[side] / seen[side], seen[side] / all});
}

/// The best side and the worst, where a person sees that they differ.
std::string sides_sentence(const io::ReportVerdict& verdict) {
    if (verdict.sides.size() < 2) return {};
    const auto [best, worst] = std::ranges::minmax_element(verdict.sides, {}, &io::ReportVerdict::Side::mean);
    if (worst->mean - best->mean < verdict.good_up_to) return {};
    const auto words = [](const io::ReportVerdict::Side& side) { return from_words(*value_of<Side>(side.name)); };
    std::string text = fmt::format("{} {:.1f}, {} {:.1f}", words(*best), best->mean, words(*worst), worst->mean);
    text.front() = 'F';
    return text + ".";
}

/// "red (255, 0, 0)" -> "red".
std::string word_of(const std::string& colour) { return colour.substr(0, colour.find(" (")); }

/// "But both eyes, ...": the worst thing that is not good, in words; where it is behind.
void add_worst(io::ReportVerdict& verdict) {
    if (verdict.regions.empty() || verdict.regions.front().good) return;
    const io::ReportRegion& worst = verdict.regions.front();
    // Flecks that are hardly seen are not what makes it bad.
    if (verdict.level != io::VerdictLevel::good && worst.why.find(not_even) != std::string::npos &&
        worst.unevenness < spoilt_above)
        return;
    const bool is_colour = worst.kind == "solid" || worst.kind == "paper" || worst.kind == "colour";
    std::string what = worst.type_mm ? std::string("type")
                       : is_colour   ? word_of(worst.asked)
                                     : fmt::format("{}, {}", worst.kind, word_of(worst.asked));
    if (worst.kind == "thin walls" || worst.kind == "fine detail" || worst.kind == "texture") what = worst.kind;
    if (worst.kind == "code" || worst.kind == "label") what = worst.asked;
    std::vector<std::string> where;
    if (worst.pieces > 1) where.push_back(fmt::format("{} places", worst.pieces));
    where.push_back(fmt::format("{}{}", worst.pieces > 1 ? "the largest " : "", worst.place));
    if (!worst.from.empty()) where.push_back("seen " + worst.from);
    const char* lead = verdict.level == io::VerdictLevel::good ? "But" : "Worst:";
    // Of a page its size says where it is.
    verdict.but = worst.type_mm && worst.from.empty()
                      ? fmt::format("{} {} {}.", lead, what, worst.why)
                      : fmt::format("{} {} ({}) {}.", lead, what, fmt::join(where, ", "), worst.why);
    verdict.but_mm = worst.place_mm, verdict.but_normal = worst.normal;
}

void judge_prediction(const VerdictSources& s, const JobPrediction& p, io::ReportVerdict& verdict) {
    const VerdictLimits& limits = s.job.options.verdict;
    const optics::Surface& surface = p.predicted.surface;
    const SidesSeen& sides = p.sides;
    const PlaceWords places(s.body);
    const std::vector<double> seen = seen_areas(surface, sides);
    const Losses losses = losses_of(s, p, seen);
    JudgedRegions regions =
        judge_regions({p, s.colour, sides, places, seen, limits, s.body.is_picture, verdict.viewing_distance_mm,
                       &s.body.model.mesh, s.job.options.marks, s.body.grid.origin_mm},
                      losses.walls);
    verdict.regions = std::move(regions.rows);
    const WholeVerdict whole = judge_whole(p.seen.difference, seen, regions.spoilt, limits, regions.page);
    verdict.level = whole.level;
    verdict.seen_mean = whole.mean, verdict.wrong_share = whole.wrong_share;
    verdict.seen_p95 = weighted_percentile(p.seen.difference, seen, 0.95);
    verdict.reach_mean = losses.mean.reach;
    const std::vector<double> share = histogram_by_area(surface, p.seen.difference, histogram_edges);
    for (std::size_t i = 0; i < share.size(); ++i) verdict.seen_histogram.emplace_back(histogram_edges[i], share[i]);
    verdict.off_share = losses.all_seen > 0 ? losses.off / losses.all_seen : 0;
    if (!s.body.is_picture) add_sides(p, sides, verdict);
    add_worst(verdict);
    verdict.headline = opening_of(whole, limits);
    if (verdict.level != io::VerdictLevel::good) {
        add_causes(losses, verdict);
        if (!verdict.causes.empty())
            verdict.why =
                fmt::format("{} because {}.", losses.share(losses.main()) > 0.9 ? "Nearly all of it" : "Mostly",
                            reason(losses.main(), losses));
    }
    const auto type = std::ranges::find_if(verdict.regions, [](const auto& r) { return r.type_mm.has_value(); });
    const bool all_is_well = verdict.level == io::VerdictLevel::good && type == verdict.regions.end();
    if (!all_is_well) {
        verdict.advice = tried_advice({s.job, s.body, p, seen, s.loop, losses.mean, regions.page, whole});
    }
    constexpr float as_white = 0.97f;  // what paper may give away before a person is told
    if (p.seen.paper < as_white) verdict.paper = p.seen.paper;
    const std::string paper =
        verdict.paper ? fmt::format(" by eyes that take its white, {:.2f} of the light that was asked for, for white",
                                    *verdict.paper)
                      : "";
    std::vector<std::string> sentences{
        fmt::format("{} (CIEDE2000 as seen from {:g} mm{}: up to {:g} is good, above {:g} bad; {:.1f} of it no mixture "
                    "of these resins could avoid).",
                    verdict.headline, verdict.viewing_distance_mm, paper, verdict.good_up_to, verdict.bad_above,
                    losses.mean.reach)};
    const auto code = std::ranges::find_if(
        verdict.regions, [](const io::ReportRegion& region) { return region.kind == "code" && region.good; });
    const std::string scans = code == verdict.regions.end() ? "" : fmt::format("A scanner reads its {}.", code->asked);
    for (const std::string& more : {verdict.but, scans, sides_sentence(verdict), verdict.why})
        if (!more.empty()) sentences.push_back(more);
    if (!verdict.advice.empty()) sentences.push_back(fmt::format("Try: {}.", verdict.advice.front().text));
    verdict.sentence = fmt::format("{}", fmt::join(sentences, " "));
}

/// Of a draft: what the resins reach on a thick body, which is no print.
void judge_gamut(const VerdictSources& s, io::ReportVerdict& verdict) {
    std::string reason = s.why_not_predicted.empty() ? "it was not asked for (--predict)" : s.why_not_predicted;
    if (reason.ends_with(".")) reason.pop_back();
    reason.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(reason.front())));
    const long mapped_percent = std::lround(100 * s.gamut.mapped_share);
    verdict.headline = fmt::format("Colours in reach: {} %", 100 - mapped_percent);
    verdict.why = mapped_percent == 0
                      ? "The loaded resins show nearly all of its colours"
                      : fmt::format(
                            "The loaded resins cannot show {} % of the surface, whose colours are moved: by {:.2g} "
                            "CIEDE2000 on average over all of it",
                            mapped_percent, s.gamut.mean_de2000);
    verdict.why += fmt::format(", on a thick body. How it will look was not predicted: {}.", reason);
    if (s.gamut.mean_de2000 > s.job.options.verdict.good) verdict.advice = advice_on_reach(s.job, s.body);
    verdict.sentence = verdict.headline + ". " + verdict.why;
    if (!verdict.advice.empty()) verdict.sentence += fmt::format(" Try: {}.", verdict.advice.front().text);
}

/// What the file's colours were is not known here, so that the judgement is of those that are left.
void judge_lost_colour(const std::string& lost, bool all_white, io::ReportVerdict& verdict) {
    verdict.level = io::VerdictLevel::bad;
    verdict.headline = "It will not look as asked";
    std::string rest = verdict.sentence;
    rest.front() = char(std::tolower(static_cast<unsigned char>(rest.front())));
    verdict.why = all_white ? "What is left is white everywhere." : "By the colours that are left " + rest;
    verdict.sentence = fmt::format("{}. {} {}", verdict.headline, lost, verdict.why);
    verdict.but = lost;
    verdict.but_normal = {};
}

}  // namespace

double wall_thickness_mm(const optics::ResinVolume& volume, const Eigen::Vector3d& from_mm,
                         const Eigen::Vector3d& normal, double most_mm) {
    const auto& pitch = volume.pitch_mm();
    const auto& size = volume.size();
    const double step = 0.5 * std::min({pitch[0], pitch[1], pitch[2]});
    const double voxel = std::max({pitch[0], pitch[1], pitch[2]});
    const auto solid = [&](double depth) {
        std::array<int, 3> at{};
        for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<Eigen::Index>(a);
            at[a] = static_cast<int>(std::floor((from_mm[axis] - depth * normal[axis]) / pitch[a]));
            if (at[a] < 0 || at[a] >= size[a]) return false;
        }
        return volume.at(at[0], at[1], at[2]) != optics::air;
    };
    // The centre of a cell's faces may lie a little outside of the staircase, or in a notch of it.
    double depth = step;
    while (depth < voxel && !solid(depth)) depth += step;
    while (depth < most_mm && solid(depth)) depth += step;
    return std::min(depth, most_mm);
}

double wall_of_cell_mm(const JobPrediction& p, std::size_t i, double most_mm) {
    constexpr double one_way = 0.3;  // of the steepest slope's staircase 0.58 is left
    const optics::Surface& surface = p.predicted.surface;
    const optics::SurfaceCell& cell = surface.cells[i];
    const auto& pitch = p.volume.pitch_mm();
    std::array<double, 3> net{}, all{};
    for (std::uint32_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
        const auto facing = static_cast<std::size_t>(surface.faces[f].facing), axis = facing / 2;
        const double area = pitch[(axis + 1) % 3] * pitch[(axis + 2) % 3];
        net[axis] += facing % 2 ? area : -area, all[axis] += area;
    }
    if (std::hypot(net[0], net[1], net[2]) < one_way * (all[0] + all[1] + all[2])) {
        const auto axis = std::size_t(std::ranges::max_element(all) - all.begin());
        return std::min(most_mm, surface.cell_voxels[axis] * pitch[axis]);
    }
    const Eigen::Vector3d centre(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]);
    return wall_thickness_mm(p.volume, centre, {cell.normal[0], cell.normal[1], cell.normal[2]}, most_mm);
}

CellLoss loss_of_cell(const JobPrediction& p, const JobColour& colour, std::size_t i, double thin_mm) {
    if (colour.separation.gamut_distance(p.target[i]) >= p.seen.difference[i] / 2) return {gamut, thin_mm};
    const double wall = wall_of_cell_mm(p, i, thin_mm);
    return {wall < thin_mm ? thin_wall : neighbours, wall};
}

io::ReportVerdict judge(const VerdictSources& s) {
    io::ReportVerdict verdict;
    verdict.viewing_distance_mm = s.job.options.loop.viewing_distance_mm;
    verdict.good_up_to = s.job.options.verdict.good;
    verdict.bad_above = s.job.options.verdict.bad;
    if (s.prediction) {
        judge_prediction(s, *s.prediction, verdict);
    } else if (s.all_white) {
        verdict.level = io::VerdictLevel::good;
        verdict.headline = "It will look as asked: white everywhere";
        verdict.why = "All of it is white resin, so that there was nothing to rearrange and nothing to predict.";
        verdict.sentence = verdict.headline + ". " + verdict.why;
    } else {
        judge_gamut(s, verdict);
    }
    if (!s.body.model.lost_colour.empty()) judge_lost_colour(s.body.model.lost_colour, s.all_white, verdict);
    return verdict;
}

}  // namespace voxtone::slicer
