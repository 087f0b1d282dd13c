// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/loop_measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "halftone/loop/paper.h"
#include "optics/scene/area_summary.h"

namespace voxtone::halftone {

namespace {

constexpr float most_weight = 4;
constexpr double let_go = 0.25;  // CIEDE2000: nobody sees that a region is so much worse

Eigen::Vector3d lab_of(const Eigen::Vector3f& rgb) {
    return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
}

std::vector<Eigen::Vector3f> lab_of(std::span<const Eigen::Vector3f> rgb) {
    std::vector<Eigen::Vector3f> lab(rgb.size());
    parallel_for(0, rgb.size(), 1024, [&](std::size_t i) { lab[i] = lab_of(rgb[i]).cast<float>(); });
    return lab;
}

}  // namespace

LoopMeasure::LoopMeasure(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                         std::span<const Eigen::Vector3f> shown, const std::vector<char>& in_gamut,
                         double viewing_distance_mm, bool adapts)
    : surface_(surface),
      asked_(target),
      seen_target_(see_target(surface, target, viewing_distance_mm)),
      in_gamut_(in_gamut),
      adapts_(adapts) {
    auto [seen_asked, seen_shown] = eye().views(target, shown);
    lab_asked_ = lab_of(target);
    lab_seen_asked_ = std::move(seen_asked.lab), lab_seen_shown_ = std::move(seen_shown.lab);
    near_asked_ = std::move(seen_asked.smoothed);
    weight_ = weights(std::vector<float>(regions().size(), 1.0f), 0);
}

float LoopMeasure::weight_of(const ColourRegion& region) const {
    return std::min(most_weight, static_cast<float>(std::sqrt(regions().front().area_mm2 / region.area_mm2)));
}

std::vector<float> LoopMeasure::weights(std::span<const float> urgency, float beyond) const {
    std::vector<float> weight(asked_.size());
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = in_gamut_[i] ? 1 : beyond;
    for (std::size_t r = 0; r < regions().size(); ++r)
        for (const std::uint32_t i : regions()[r].cells) weight[i] = urgency[r] * weight_of(regions()[r]);
    return weight;
}

LoopMeasure::Value LoopMeasure::operator()(std::span<const Eigen::Vector3f> rgb,
                                           std::span<const RegionLook> open) const {
    Value value;
    if (adapts_) value.paper = paper_level(surface_, asked_, rgb);
    std::vector<Eigen::Vector3f> adapted(rgb.begin(), rgb.end());
    for (Eigen::Vector3f& colour : adapted) colour /= value.paper;
    auto [as_is, over_paper] = eye().views(rgb, adapted);
    value.views = std::move(as_is);
    // Lab of what is wanted is known; that of the print is found once.
    std::vector<double> off_asked(rgb.size()), off_cells(rgb.size()), off(rgb.size());
    parallel_for(0, rgb.size(), 1024, [&, &lab = over_paper.lab](std::size_t i) {
        const Eigen::Vector3d print = lab[i].cast<double>();
        off_asked[i] = optics::ciede2000(lab_seen_asked_[i].cast<double>(), print);
        off[i] = lab_seen_shown_[i] == lab_seen_asked_[i] ? off_asked[i]
                                                          : optics::ciede2000(lab_seen_shown_[i].cast<double>(), print);
        off_cells[i] = optics::ciede2000(lab_asked_[i].cast<double>(), lab_of(rgb[i]));
    });
    value.seen = optics::summarize_by_area(surface_, off_asked);
    value.cells = optics::summarize_by_area(surface_, off_cells);
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < off.size(); ++i) {
        const double a = static_cast<double>(weight_[i] * surface_.cells[i].area_mm2);
        sum += a * off[i], all += a;
    }
    value.looks = look_at(regions(), surface_, near_asked_, over_paper.smoothed);
    for (std::size_t r = 0; r < open.size(); ++r)
        sum += regions()[r].area_mm2 * static_cast<double>(weight_of(regions()[r])) *
               std::max(0.0, worse_by(value.looks[r], open[r]) - let_go);
    value.score = all > 0 ? sum / all : 0;
    return value;
}

}  // namespace voxtone::halftone
