// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/verdict.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/parallel.h"
#include "slicer/colour/region_verdict.h"
#include "slicer/prepare/resin_choice.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

const std::vector<double> histogram_edges{0, 0.5, 1, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30};
constexpr double much_of_the_surface = 0.1;  // above `bad`: what is so large is seen at once

using enum LossCause;
constexpr std::array all_causes{gamut, thin_wall, neighbours};

/// What is off, by cause.
struct Losses {
    std::array<double, all_causes.size()> weight{};  ///< area times difference
    double off_mm2 = 0, bad_mm2 = 0, area_mm2 = 0;
    /// Of the thin walls: the median, by weight, and the cell of a wall no thicker that is most off.
    double thickness_mm = 0;
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();
    std::vector<std::uint32_t> thin_cells;

    [[nodiscard]] double& of(LossCause cause) { return weight[std::size_t(cause)]; }
    [[nodiscard]] double all() const { return weight[0] + weight[1] + weight[2]; }
    [[nodiscard]] double share(LossCause cause) const { return all() > 0 ? weight[std::size_t(cause)] / all() : 0; }
    [[nodiscard]] LossCause main() const {
        return static_cast<LossCause>(std::max_element(weight.begin(), weight.end()) - weight.begin());
    }
};

struct ThinCell {
    double thickness_mm, weight;
    Eigen::Vector3d centre_mm;
};

/// Corners are longer to cross than the wall that they end, so the thickness is that of the middle.
void describe_walls(std::vector<ThinCell> cells, Losses& losses) {
    if (cells.empty()) return;
    std::stable_sort(cells.begin(), cells.end(),
                     [](const ThinCell& a, const ThinCell& b) { return a.thickness_mm < b.thickness_mm; });
    double sum = 0, worst = 0;
    for (const ThinCell& cell : cells) {
        if (cell.weight > worst) {
            worst = cell.weight;
            losses.place_mm = cell.centre_mm;
        }
        losses.thickness_mm = cell.thickness_mm;
        sum += cell.weight;
        if (sum >= losses.of(thin_wall) / 2) return;
    }
}

Losses losses_of(const VerdictSources& s, const JobPrediction& p) {
    const std::vector<double>& difference = p.seen.difference;
    const VerdictLimits& limits = s.job.options.verdict;
    const double thin_mm = 2 * s.job.options.colour.depth_mm;
    Losses losses;
    std::vector<ThinCell> thin;
    std::vector<CellLoss> found(difference.size());
    parallel_for(0, found.size(), 256, [&](std::size_t i) {
        if (difference[i] > limits.good) found[i] = loss_of_cell(p, s.colour, i, thin_mm);
    });
    for (std::size_t i = 0; i < difference.size(); ++i) {
        const optics::SurfaceCell& cell = p.predicted.surface.cells[i];
        const double area = cell.area_mm2, d = difference[i], weight = area * d;
        losses.area_mm2 += area;
        if (d > limits.bad) losses.bad_mm2 += area;
        if (d <= limits.good) continue;
        losses.off_mm2 += area;
        const CellLoss& loss = found[i];
        losses.of(loss.cause) += weight;
        const auto& centre = cell.centre_mm;
        if (loss.cause != thin_wall) continue;
        thin.push_back({loss.wall_mm, weight, {centre[0], centre[1], centre[2]}});
        losses.thin_cells.push_back(static_cast<std::uint32_t>(i));
    }
    describe_walls(std::move(thin), losses);
    return losses;
}

/// Nobody overlooks it.
bool is_bad(const io::ReportRegion& region, const VerdictLimits& limits) {
    constexpr double far = 3;
    return !region.good &&
           ((region.contrast_asked > 0 && region.contrast_asked < 1) || region.de2000 > far * limits.bad);
}

io::VerdictLevel level_of(double mean, double bad_share, const std::vector<io::ReportRegion>& regions,
                          const VerdictLimits& limits) {
    if (mean > limits.bad || std::ranges::any_of(regions, [&](const auto& r) { return is_bad(r, limits); }))
        return io::VerdictLevel::bad;
    return mean > limits.good || bad_share > much_of_the_surface ||
                   !std::ranges::all_of(regions, &io::ReportRegion::good)
               ? io::VerdictLevel::fair
               : io::VerdictLevel::good;
}

/// "red (255, 0, 0), 12.0 mm2 at x 1.0, y 2.0, z 3.0 mm, is printed as ..."
std::string worst_of(const std::vector<io::ReportRegion>& regions, const char* where_more) {
    if (regions.empty() || regions.front().good) return {};
    const io::ReportRegion& worst = regions.front();
    const auto more = std::ranges::count_if(regions, [](const auto& region) { return !region.good; }) - 1;
    return fmt::format("{}{}, {:.1f} mm2 at x {:.1f}, y {:.1f}, z {:.1f} mm, {}{}",
                       worst.kind == "solid" ? "" : worst.kind + " in ", worst.asked, worst.area_mm2, worst.place_mm[0],
                       worst.place_mm[1], worst.place_mm[2], worst.why,
                       more > 0 ? fmt::format(" ({} more: {})", more, where_more) : "");
}

const char* opening(io::VerdictLevel level) {
    switch (level) {
        case io::VerdictLevel::good:
            return "It will look as asked";
        case io::VerdictLevel::fair:
            return "It will look much as asked, with differences that are seen";
        case io::VerdictLevel::bad:
            return "It will not look as asked";
        case io::VerdictLevel::unknown:
            break;
    }
    return "How it will look was not predicted";
}

std::string reason(LossCause cause, const Losses& losses) {
    if (cause == thin_wall)
        return fmt::format(
            "light passes through thin walls ({:.1f} mm at x {:.1f}, y {:.1f}, z {:.1f} mm of the print)",
            losses.thickness_mm, losses.place_mm.x(), losses.place_mm.y(), losses.place_mm.z());
    if (cause == gamut) return "the loaded resins cannot show these colours";
    return "light spreads between neighbouring colours and at edges";
}

std::string advice_on(LossCause cause, const VerdictSources& s) {
    if (cause == gamut) return gamut_advice(s.job, s.body);
    if (cause == thin_wall)
        return fmt::format("make these walls at least {:g} mm thick, or print it larger ({})",
                           2 * s.job.options.colour.depth_mm, s.body.is_picture ? "--thickness" : "--size");
    return "print it larger: details are blurred over half a millimetre whatever their size";
}

void add_causes(const Losses& losses, io::ReportVerdict& verdict) {
    for (const LossCause cause : all_causes)
        if (losses.share(cause) >= 0.005) verdict.causes.push_back({std::string(name_of(cause)), losses.share(cause)});
    std::stable_sort(verdict.causes.begin(), verdict.causes.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
}

void add_advice(const VerdictSources& s, const Losses& losses, io::ReportVerdict& verdict) {
    constexpr double worth_a_word = 0.2;
    if (!s.looped && losses.share(gamut) < 1 - worth_a_word)
        verdict.advice.emplace_back(
            "let the resins be rearranged (--iterations auto): that makes up for much of "
            "the light that spreads and passes");
    if (s.looped && s.cut_short && losses.share(gamut) < 1 - worth_a_word)
        verdict.advice.emplace_back("let the resins be rearranged until it gains no more (--iterations auto)");
    for (const io::ReportVerdict::Cause& named : verdict.causes)
        for (const LossCause cause : all_causes)
            if (named.name == name_of(cause) && named.share >= worth_a_word)
                verdict.advice.push_back(advice_on(cause, s));
}

void judge_prediction(const VerdictSources& s, const JobPrediction& p, io::ReportVerdict& verdict) {
    const optics::DifferenceSummary seen = summarize_by_area(p.predicted.surface, p.seen.difference);
    const Losses losses = losses_of(s, p);
    verdict.regions = judge_regions(p, s.colour, s.job.options.verdict);
    if (auto walls =
            judge_thin_walls(p, losses.thin_cells, losses.thickness_mm, losses.place_mm, s.job.options.verdict)) {
        const auto worse = std::ranges::find_if(verdict.regions, [&](const io::ReportRegion& region) {
            return badness(region, s.job.options.verdict) < badness(*walls, s.job.options.verdict);
        });
        verdict.regions.insert(worse, std::move(*walls));
    }
    verdict.seen_mean = seen.mean;
    verdict.seen_p95 = seen.percentile_95;
    const std::vector<double> share = histogram_by_area(p.predicted.surface, p.seen.difference, histogram_edges);
    for (std::size_t i = 0; i < share.size(); ++i) verdict.seen_histogram.emplace_back(histogram_edges[i], share[i]);
    verdict.off_share = losses.area_mm2 > 0 ? losses.off_mm2 / losses.area_mm2 : 0;
    verdict.level = level_of(seen.mean, losses.area_mm2 > 0 ? losses.bad_mm2 / losses.area_mm2 : 0, verdict.regions,
                             s.job.options.verdict);
    verdict.headline = opening(verdict.level);
    verdict.sentence = fmt::format(
        "{}: seen from {:g} mm it differs by {:.1f} CIEDE2000 on average (up to {:g} is good, "
        "above {:g} bad)",
        verdict.headline, verdict.viewing_distance_mm, seen.mean, verdict.good_up_to, verdict.bad_above);
    if (verdict.level == io::VerdictLevel::good) {
        verdict.sentence += ".";
        return;
    }
    add_causes(losses, verdict);
    add_advice(s, losses, verdict);
    const auto why = [&](const char* where_more) {
        std::vector<std::string> parts;
        if (!verdict.causes.empty())
            parts.push_back(fmt::format("{} because {}",
                                        losses.share(losses.main()) > 0.9 ? "nearly all of it" : "mostly",
                                        reason(losses.main(), losses)));
        if (std::string worst = worst_of(verdict.regions, where_more); !worst.empty())
            parts.push_back(std::move(worst));
        return fmt::format("{}", fmt::join(parts, "; "));
    };
    verdict.why = why("below");
    if (!verdict.why.empty()) verdict.sentence += (verdict.causes.empty() ? "; " : ", ") + why("report");
    if (!verdict.advice.empty()) verdict.sentence += fmt::format("; try this: {}", verdict.advice.front());
    verdict.sentence += ".";
    if (verdict.why.empty()) return;
    verdict.why.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(verdict.why.front())));
    verdict.why += ".";
}

/// What is out of reach is known without a prediction; thin walls and neighbours are not.
void judge_gamut(const VerdictSources& s, io::ReportVerdict& verdict) {
    if (s.gamut.mean_de2000 > s.job.options.verdict.bad) verdict.level = io::VerdictLevel::bad;
    std::string reason = s.why_not_predicted.empty() ? "it was not asked for (--predict)" : s.why_not_predicted;
    if (reason.ends_with(".")) reason.pop_back();
    reason.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(reason.front())));
    const std::string reach =
        s.gamut.mapped_share < 0.005
            ? "on a thick body the loaded resins show nearly all of its colours"
            : fmt::format(
                  "the loaded resins cannot show {:.0f} % of its colours, which are moved by {:.1f} CIEDE2000 "
                  "on average over the surface",
                  100 * s.gamut.mapped_share, s.gamut.mean_de2000);
    if (verdict.level == io::VerdictLevel::bad) {
        verdict.causes.push_back({std::string(name_of(gamut)), 1});
        verdict.advice.push_back(gamut_advice(s.job, s.body));
        verdict.sentence =
            fmt::format("{}: {} (above {:g} is bad); try this: {}. Light in it was not predicted: {}.",
                        opening(verdict.level), reach, verdict.bad_above, verdict.advice.front(), reason);
    } else {
        verdict.sentence = fmt::format("{}: {}; {}.", opening(verdict.level), reason, reach);
    }
}

/// What the file's colours were is not known here, so that the judgement is of those that are left.
void judge_lost_colour(const std::string& lost, io::ReportVerdict& verdict) {
    verdict.level = io::VerdictLevel::bad;
    verdict.headline.clear();
    verdict.sentence = fmt::format("{}. {} Measured against the colours that are left: {}", opening(verdict.level),
                                   lost, verdict.sentence);
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

CellLoss loss_of_cell(const JobPrediction& p, const JobColour& colour, std::size_t i, double thin_mm) {
    if (colour.separation.gamut_distance(p.target[i]) >= p.seen.difference[i] / 2) return {gamut, thin_mm};
    const optics::SurfaceCell& cell = p.predicted.surface.cells[i];
    const Eigen::Vector3d centre(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]);
    const double wall = wall_thickness_mm(p.volume, centre, {cell.normal[0], cell.normal[1], cell.normal[2]}, thin_mm);
    return {wall < thin_mm ? thin_wall : neighbours, wall};
}

std::string gamut_advice(const OpenedJob& job, const JobBody& body) {
    const auto resin = most_helpful_resin(job, body);
    if (!resin) return "choose colours that are less saturated or less dark: no other resin of the set would help much";
    if (!resin->has_slot)
        return fmt::format(
            "print it where {} can be loaded too, in another mode or on another printer: colours out of reach go from "
            "{:.1f} to {:.1f} CIEDE2000 then",
            resin->role, resin->now_de2000, resin->mean_de2000);
    return fmt::format("load {} too (--load): colours out of reach go from {:.1f} to {:.1f} CIEDE2000 then",
                       resin->role, resin->now_de2000, resin->mean_de2000);
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
        verdict.sentence = fmt::format(
            "{}: white everywhere, and all of white resin, so that there was nothing to rearrange and nothing to "
            "predict.",
            opening(verdict.level));
    } else {
        judge_gamut(s, verdict);
    }
    if (!s.body.model.lost_colour.empty()) judge_lost_colour(s.body.model.lost_colour, verdict);
    return verdict;
}

}  // namespace voxtone::slicer
